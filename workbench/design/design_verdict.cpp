// SPDX-License-Identifier: Apache-2.0
#include "quadtune/workbench/design/design_verdict.hpp"

#include <algorithm>

namespace quadtune {

std::string to_string(DesignFailure failure) {
  switch (failure) {
    case DesignFailure::none:
      return "";
    case DesignFailure::unstable_cascade:
      return "the cascade does not hold the vehicle";
    case DesignFailure::unstable_flown_loop:
      return "the flown loop is unstable";
    case DesignFailure::mission:
      return "a mission failed";
    case DesignFailure::firmware_margins:
      return "the margins on a firmware are too small";
    case DesignFailure::verification:
      return "the written files do not verify";
  }
  return "";
}

DesignFailure failure_of(const DesignOutcome& outcome, const std::vector<WrittenExport>& written) {
  if (outcome.cascade && unstable(*outcome.cascade)) return DesignFailure::unstable_cascade;
  if (!laws_hold(outcome)) return DesignFailure::unstable_flown_loop;
  if (!missions_passed(outcome)) return DesignFailure::mission;
  if (std::any_of(written.begin(), written.end(),
                  [](const WrittenExport& one) { return !one.weak.empty(); }))
    return DesignFailure::firmware_margins;
  const bool verified = std::all_of(written.begin(), written.end(),
                                    [](const WrittenExport& one) { return one.verification.ok(); });
  return verified ? DesignFailure::none : DesignFailure::verification;
}

std::vector<std::string> reasons_against_export(const DesignOutcome& outcome) {
  std::vector<std::string> reasons = unconfirmed_covariances(outcome.design);
  const DesignFailure failure = failure_of(outcome, {});
  if (failure != DesignFailure::none) reasons.push_back(to_string(failure));
  return reasons;
}

std::vector<std::string> design_warnings(const DesignOutcome& outcome) {
  std::vector<std::string> warnings;
  const auto add = [&](const std::string& what, const std::vector<std::string>& some) {
    for (const std::string& warning : some) warnings.push_back(what + warning);
  };
  if (outcome.feedback && !outcome.feedback->riccati.warning.empty())
    add("lqr: ", {outcome.feedback->riccati.warning});
  if (outcome.lqi) add("lqr: ", outcome.lqi->design.notes);
  if (outcome.matrix) add("lqr: ", outcome.matrix->design.notes);
  if (outcome.margins) add("", margin_warnings(*outcome.margins));
  // The loops of a cascade that was designed for the flown plant are judged there: the textbook
  // plant lacks the reaction torque of the rotors, without which yaw has a much smaller margin.
  const bool analysed = std::any_of(outcome.flown.begin(), outcome.flown.end(),
                                    [](const FlownLaw& law) { return law.loop.has_value(); });
  if (outcome.cascade && !(outcome.cascade_for_flown_plant && analysed))
    add("cascade: ", cascade_warnings(*outcome.cascade));
  for (const FlownLaw& law : outcome.flown)
    if (law.loop) add("flown loop: ", margin_warnings(law.loop->margins));
  return warnings;
}

std::vector<std::string> design_notes(const DesignOutcome& outcome) {
  std::vector<std::string> notes;
  const auto add = [&](const std::vector<std::string>& some) {
    for (const std::string& note : some)
      if (std::find(notes.begin(), notes.end(), note) == notes.end()) notes.push_back(note);
  };
  add(outcome.model.notes);
  for (const std::vector<FlownFlight>* flights : {&outcome.flights, &outcome.disturbed})
    for (const FlownFlight& flight : *flights) add(flight.plan.notes);
  if (outcome.design.condition.yaw != 0 && outcome.gains)
    add({"position is in world axes, so K holds at this yaw only"});
  return notes;
}

MissionDiagnoses diagnose_missions(const DesignOutcome& outcome) {
  const auto each = [](const std::vector<FlownFlight>& flights) {
    std::vector<std::optional<Diagnosis>> found;
    found.reserve(flights.size());
    for (const FlownFlight& flight : flights)
      found.push_back(flight.passed ? std::nullopt : std::optional(diagnose(flight.plan, flight)));
    return found;
  };
  return {each(outcome.flights), each(outcome.disturbed)};
}

}  // namespace quadtune
