// SPDX-License-Identifier: Apache-2.0
#include "quadtune/workbench/design/design.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "quadtune/convention.hpp"
#include "quadtune/design/export_target.hpp"
#include "quadtune/discretize/zoh.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/internal/text_file.hpp"
#include "quadtune/workbench/design/chosen_law.hpp"
#include "quadtune/workbench/design/linearize_or_refuse.hpp"
#include "quadtune/workbench/design/lqi_report.hpp"
#include "quadtune/workbench/design/standard_lqr.hpp"
#include "quadtune/workbench/design/usual_design.hpp"
#include "quadtune/workbench/firmware/firmware_gains.hpp"
#include "quadtune/workbench/flight/flight_plan.hpp"
#include "quadtune/workbench/flown/flown_gains.hpp"
#include "quadtune/workbench/flown/flying_loop.hpp"

namespace quadtune {
namespace {

/// Largest difference over the entries of K and K_int, relative to their row, which has its own
/// unit.
class DifferenceSearch {
 public:
  explicit DifferenceSearch(Eigen::VectorXd row_scale) : row_scale_(std::move(row_scale)) {}

  void add(const char* matrix, const Eigen::MatrixXd& published, const Eigen::MatrixXd& here,
           const std::vector<Signal>& rows, const std::vector<Signal>& columns) {
    for (Eigen::Index i = 0; i < published.rows(); ++i)
      for (Eigen::Index j = 0; j < published.cols(); ++j) {
        const double scale = row_scale_(i);
        const double difference = std::abs(here(i, j) - published(i, j));
        worst_.max_relative = std::max(worst_.max_relative, difference / scale);
        // Skip entries that are zero up to rounding: their relative difference is meaningless.
        if (std::abs(published(i, j)) < 1e-9 * scale) continue;
        const double relative = difference / std::abs(published(i, j));
        if (relative <= worst_.max_entry) continue;
        worst_.max_entry = relative;
        worst_.worst = fmt::format("{}({}, {})", matrix, rows[static_cast<std::size_t>(i)].name,
                                   columns[static_cast<std::size_t>(j)].name);
        worst_.published = published(i, j);
        worst_.converged = here(i, j);
      }
  }

  [[nodiscard]] const PublishedDifference& worst() const { return worst_; }

 private:
  Eigen::VectorXd row_scale_;
  PublishedDifference worst_;
};

PublishedDifference compare(const PublishedGains& published, const Gains& gains) {
  Eigen::VectorXd scale = published.K.cwiseAbs().rowwise().maxCoeff();
  if (published.K_int.size())
    scale = scale.cwiseMax(published.K_int.cwiseAbs().rowwise().maxCoeff());
  DifferenceSearch search(scale);
  search.add("K", published.K, gains.K, gains.inputs, gains.states);
  if (published.K_int.size())
    search.add("K_int", published.K_int, gains.K_int, gains.inputs, gains.integrals);
  return search.worst();
}

/// The name of a design in messages: its file, or its name if it has none.
std::string place_of(const Design& design) {
  return design.file.empty() ? design.name : design.file.string();
}

void solve_feedback(DesignOutcome& outcome) {
  const Design& design = outcome.design;
  const std::string where = place_of(design);
  if (!(design.lqr->dt > 0) && !design.exports.empty())
    throw InvalidInput(where,
                       "lqr.dt_s is missing, expected the flight computer's sample period because "
                       "the gains are exported");
  outcome.model =
      linearize_or_refuse(design.vehicle, design.condition, linearize_options(*design.lqr), where);
  outcome.feedback = state_feedback(outcome.model.plant, *design.lqr);
  const RiccatiResult& riccati = outcome.feedback->riccati;
  if (!riccati.solved())
    throw NoSolution(
        fmt::format("{}: lqr: {}: {}", where, to_string(riccati.status), riccati.culprit), where);
  outcome.gains = make_gains(design.vehicle, outcome.model, *design.lqr, *outcome.feedback);
  outcome.poles = flying_poles(outcome.model, *outcome.gains, riccati);
  outcome.margins = flying_margins(outcome.model, *outcome.gains, riccati);
  if (design.lqr->dt > 0) outcome.sampled = discretize_zoh(outcome.model.plant, design.lqr->dt);
  if (design.published) outcome.published = compare(*design.published, *outcome.gains);
}

void solve_lqi(DesignOutcome& outcome) {
  const Vehicle& vehicle = outcome.design.vehicle;
  const std::string where = place_of(outcome.design);
  FlightOptions flight;
  flight.estimator = program_estimator(outcome.design);
  outcome.lqi = lqi_report(vehicle, flown_lqi_options(vehicle, *outcome.design.lqi), flight);
  outcome.gains = outcome.lqi->design.lqi.gains;
  LinearizeOptions words;
  words.inputs = InputKind::wrench;
  outcome.model = linearize_or_refuse(vehicle, outcome.design.condition, words, where);
  outcome.poles = outcome.lqi->design.lqi.riccati.poles;
  outcome.margins = outcome.lqi->flown.margins;
  outcome.sampled = discretize_zoh(outcome.model.plant, outcome.gains->dt);
}

void solve_matrix(DesignOutcome& outcome) {
  const Vehicle& vehicle = outcome.design.vehicle;
  const LqiDesign& asked = *outcome.design.lqi;
  FlightOptions flight;
  flight.estimator = program_estimator(outcome.design);
  outcome.matrix = matrix_report(vehicle, asked, flight);
  outcome.gains = outcome.matrix->gains;
  LinearizeOptions words;
  words.convention = asked.matrix->convention;
  words.inputs = asked.matrix->input_kind;
  outcome.model =
      linearize_or_refuse(vehicle, outcome.design.condition, words, place_of(outcome.design));
  outcome.sampled = discretize_zoh(outcome.model.plant, outcome.gains->dt);
  outcome.poles = closed_loop_poles(*outcome.sampled, *outcome.gains);
  outcome.margins = outcome.matrix->flown.margins;
}

DesignedFilter solve_filter(const KalmanDesign& design, const std::string& where) {
  DesignedFilter result;
  result.evidence = kalman(design.model, {design.G, design.Q, design.R, design.N});
  if (!result.evidence.solved())
    throw NoSolution(fmt::format("{}: kalman {}: {}: {}", where, design.name,
                                 to_string(result.evidence.status), result.evidence.culprit),
                     where);
  result.filter = {design.name,       design.model,     design.G,          design.Q,
                   design.R,          design.N,         result.evidence.M, result.evidence.L,
                   result.evidence.P, result.evidence.Z};
  if (!design.tuned.empty())
    result.filter.noise_source =
        fmt::format("{}{}", design.tuned,
                    design.tuned_verdict.empty() ? "" : ", verdict " + design.tuned_verdict);
  return result;
}

/// Sets the law that flies a mission, and checks that the design has it.
void complete(MissionRequest& mission, const Design& design) {
  mission.controller = controller_kind(mission.controller);
  if (mission.controller.empty())
    mission.controller = design.cascade ? kCascadedPid : kStateFeedback;
  if (mission.controller == kFirmware ||
      (mission.controller == kCascadedPid ? !design.cascade : !has_feedback(design)))
    throw OptionError("controller",
                      fmt::format("controller of the mission '{}' is {}, expected the law that is "
                                  "designed, {}",
                                  internal::printable(mission.mission), mission.controller,
                                  design.cascade ? kCascadedPid : kStateFeedback));
}

/// Gains designed on the flown plant if this is the default and a solution exists.
std::optional<CascadeGains> gains_on_flown_plant(const Vehicle& vehicle,
                                                 const CascadeDesign& cascade,
                                                 const std::vector<Firmware>& firmwares) {
  if (!usually_on_flown_plant(vehicle)) return std::nullopt;
  FlownGainsOptions options;
  options.dt = cascade.gains.dt;
  options.rate_lead = cascade.rate_lead;
  try {
    return as_cascade(firmware_gains(vehicle, firmwares, options), options.dt);
  } catch (const NoSolution&) {
    if (cascade.rate_lead) throw;
    return std::nullopt;
  }
}

/// The firmwares for which a design exports parameters.
std::vector<Firmware> firmwares_of(const Design& design) {
  std::vector<Firmware> firmwares;
  for (const ExportRequest& request : design.exports)
    if (export_target(request.to, place_of(design)).is_firmware)
      firmwares.push_back(firmware(firmware_kind(request.to, place_of(design)), request.firmware,
                                   place_of(design)));
  return firmwares;
}

/// Computes the gains of `cascade` as `quadtune pid V` does, with its period, so that the firmwares
/// can fly them. Limits that are not set get the values of `fly V`.
/// @return  whether the gains are for the flown plant; else the cascade has a specification
bool design_as_usual(const Vehicle& vehicle, CascadeDesign& cascade,
                     const std::vector<Firmware>& firmwares) {
  (void)cascade_vehicle(vehicle, place_of(vehicle));  // throws if it cannot hover
  CascadeController flown;
  if (auto gains = gains_on_flown_plant(vehicle, cascade, firmwares)) {
    cascade.gains = std::move(*gains);
    flown.attitude_limit = kDesignedAttitudeLimit;
  } else {
    cascade.specification = usual_specification(vehicle);
    cascade.specification->dt = cascade.gains.dt;
    for (const Firmware& target : firmwares)
      if (structure_of(target.kind) == CascadeStructure::p_pi)
        cascade.specification->structure = CascadeStructure::p_pi;
    cascade.method = cascade.specification->method;
  }
  if (std::isinf(cascade.attitude_limit)) cascade.attitude_limit = flown.attitude_limit;
  if (std::isinf(cascade.integrator_limit)) cascade.integrator_limit = flown.integrator_limit;
  if (cascade.back_calculation == 0)
    cascade.back_calculation = designed_back_calculation(cascade.gains.dt);
  return !cascade.specification;
}

}  // namespace

LqrDesign usual_lqr(const Vehicle& vehicle, double dt) {
  const LqrWeights weights = standard_weights(cascade_vehicle(vehicle, place_of(vehicle)));
  LqrDesign lqr;
  lqr.input_kind = InputKind::wrench;
  for (const Signal& state : ned_convention().states) lqr.states.push_back(state.name);
  for (const Signal& input : ned_convention().wrench) lqr.inputs.push_back(input.name);
  lqr.Q = weights.Q;
  lqr.R = weights.R;
  lqr.method = LqrMethod::sampled;
  lqr.dt = dt;
  return lqr;
}

CascadeDesign usual_cascade(const Vehicle& vehicle) {
  CascadeDesign cascade;
  cascade.gains.dt = usual_specification(vehicle).dt;
  cascade.velocity_feed_forward = true;
  cascade.conditional_integration = true;
  (void)design_as_usual(vehicle, cascade, {});
  return cascade;
}

DesignOutcome solve_laws(Design design) {
  DesignOutcome outcome;
  outcome.design = std::move(design);
  const Vehicle& vehicle = outcome.design.vehicle;
  const std::string where = place_of(outcome.design);
  if (outcome.design.lqr && outcome.design.lqi)
    throw InvalidInput(where,
                       "the design has weights for both the ideal and the flown plant; "
                       "expected only one of them, because it has one state feedback");
  if (outcome.design.lqi && outcome.design.condition.kind != FlightKind::hover)
    throw InvalidInput(where, fmt::format("the trim is '{}', expected hover, because the flown "
                                          "plant is that of a hover",
                                          to_string(outcome.design.condition.kind)));
  if (outcome.design.lqi && outcome.design.condition.yaw != 0)
    throw InvalidInput(where, fmt::format("the trim has the yaw {} rad, expected 0 because the "
                                          "flown plant hovers with the nose to the north",
                                          outcome.design.condition.yaw));
  if (outcome.design.lqr)
    solve_feedback(outcome);
  else if (outcome.design.lqi && outcome.design.lqi->matrix)
    solve_matrix(outcome);
  else if (outcome.design.lqi)
    solve_lqi(outcome);
  else
    outcome.model = linearize_or_refuse(vehicle, outcome.design.condition, {}, where);
  if (outcome.design.cascade) {
    CascadeDesign& cascade = *outcome.design.cascade;
    if (cascade.rate_lead && !usually_on_flown_plant(vehicle))
      throw InvalidInput(where,
                         "cascade.design.rate_lead_s requires a design on the flown plant, but the "
                         "loops of this vehicle are designed one by one, because it has a "
                         "satellite receiver below 5 Hz and no optical flow");
    if (cascade.gains.loops.empty() && !cascade.specification)
      outcome.cascade_for_flown_plant =
          design_as_usual(vehicle, cascade, firmwares_of(outcome.design));
    outcome.cascade = cascade.specification
                          ? design_cascade(vehicle, *cascade.specification, where)
                          : assess_written_cascade(vehicle, cascade.gains, cascade.method, where);
  }
  return outcome;
}

namespace {

void analyse_flown_loops(DesignOutcome& outcome) {
  const Design& design = outcome.design;
  std::optional<CascadeDesign> cascade = design.cascade;
  if (outcome.cascade) cascade->gains = outcome.cascade->cascade.gains;
  const double dt = outcome.gains && outcome.gains->dt > 0 ? outcome.gains->dt
                    : cascade                              ? cascade->gains.dt
                                                           : 0;
  if (!(dt > 0)) return;
  try {
    outcome.flown = flown_laws(design.vehicle, outcome.gains, cascade,
                               stored_estimator(design.vehicle, program_estimator(design), dt),
                               design.lqr.has_value(), outcome.cascade_for_flown_plant);
  } catch (const std::exception& error) {
    outcome.flown = {{outcome.gains ? "state feedback" : "PID cascade", {}, error.what()}};
  }
}

}  // namespace

DesignOutcome run_design(Design design) {
  DesignOutcome outcome = solve_laws(std::move(design));
  for (const KalmanDesign& filter : outcome.design.kalman)
    outcome.filters.push_back(solve_filter(filter, place_of(outcome.design)));
  analyse_flown_loops(outcome);
  return outcome;
}

bool laws_hold(const DesignOutcome& outcome) {
  return std::all_of(outcome.flown.begin(), outcome.flown.end(),
                     [](const FlownLaw& law) { return law.holds(); });
}

DesignOutcome run_design(const std::filesystem::path& file, const std::vector<std::string>& to) {
  const std::string word = file.string();
  if (names_vehicle(word)) return run_design(usual_design(word, to));
  if (!to.empty())
    throw OptionError("to", fmt::format("to applies to a vehicle, expected [[export]] tables in {} "
                                        "instead, because a design file lists its exports",
                                        internal::printable(word)));
  return run_design(load_design(file));
}

std::vector<std::string> unconfirmed_covariances(const Design& design) {
  std::vector<std::string> doubts;
  const auto add = [&](const std::string& tuned, const std::string& filter,
                       const std::string& verdict) {
    if (verdict.empty() || verdict == "pass") return;
    doubts.push_back(fmt::format("the verdict on {} of {} is '{}'", internal::printable(tuned),
                                 filter, internal::printable(verdict)));
  };
  for (const KalmanDesign& filter : design.kalman)
    add(filter.tuned, "filter " + filter.name, filter.tuned_verdict);
  if (const auto& estimator = design.estimator)
    add(estimator->tuned, "the estimator", estimator->model.verdict);
  return doubts;
}

DesignOutcome design(const Vehicle& vehicle, const DesignRequirements& requirements,
                     const std::function<bool()>& stop) {
  Design asked;
  asked.name = requirements.name.empty() ? vehicle.name : requirements.name;
  asked.vehicle = vehicle;
  asked.condition = requirements.condition;
  asked.lqr = requirements.lqr;
  asked.lqi = requirements.lqi;
  asked.cascade = requirements.cascade;
  const bool usual = !has_feedback(asked) && !asked.cascade;
  if (usual) asked.cascade = usual_cascade(vehicle);
  asked.kalman = requirements.kalman;
  asked.missions = requirements.missions;
  for (MissionRequest& mission : asked.missions) complete(mission, asked);
  DesignOutcome outcome = run_design(std::move(asked));
  outcome.cascade_for_flown_plant = usual && !outcome.design.cascade->specification;
  outcome.flights =
      fly_missions(outcome, requirements.seed, requirements.keep_logs, stop, requirements.seeds);
  outcome.disturbed = fly_disturbed(outcome, requirements.seed, stop);
  return outcome;
}

}  // namespace quadtune
