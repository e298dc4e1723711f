// SPDX-License-Identifier: Apache-2.0
#include "quadtune/workbench/verify/certify.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "quadtune/errors.hpp"
#include "quadtune/exports/flight_code.hpp"
#include "quadtune/exports/manifest.hpp"
#include "quadtune/exports/read_gains.hpp"
#include "quadtune/internal/text_file.hpp"
#include "quadtune/loop_limits.hpp"
#include "quadtune/model/vehicle_spread.hpp"
#include "quadtune/workbench/design/chosen_law.hpp"
#include "quadtune/workbench/flown/flown_check.hpp"
#include "quadtune/workbench/flown/flying_loop.hpp"
#include "quadtune/workbench/verify/verify_directory.hpp"
#include "verify/manifest_vehicle.hpp"

namespace quadtune {
namespace {

VehicleUncertainty uncertainty_of(const CertifyOptions& options, const Vehicle& vehicle,
                                  double dt) {
  const VehicleSpread spread = spread_of(vehicle);
  const auto ratios = [](double half_width, double usual) {
    const double w = half_width > 0 ? half_width : usual;
    return UncertainRange{1 - w, 1 + w};
  };
  VehicleUncertainty u;
  u.mass = options.mass.value_or(ratios(spread.mass, 0.1));
  u.inertia = options.inertia.value_or(ratios(spread.inertia, 0.2));
  u.thrust = options.thrust.value_or(ratios(spread.thrust, 0.1));
  const double late = vehicle.motor.delay;  // plus up to the jitter and one period for computation
  u.delay = options.delay.value_or(UncertainRange{late, late + vehicle.motor.delay_jitter + dt});
  // Beyond this, the states of the delay make the proof too expensive.
  if (u.delay.high > kMaxDelayPeriods * dt)
    throw OptionError("delay", fmt::format("delay is up to {:.6g} s, expected at most {} periods "
                                           "of {:.6g} s",
                                           u.delay.high, kMaxDelayPeriods, dt));
  const double own = slower_lag(vehicle.rotors.front());
  u.lag = options.lag.value_or(UncertainRange{own * (1 - spread.motor_lag),
                                              std::min(own * (1 + spread.motor_lag), kMaxLag)});
  if (!options.lag && std::any_of(vehicle.rotors.begin(), vehicle.rotors.end(),
                                  [&](const Rotor& rotor) { return slower_lag(rotor) != own; }))
    throw InvalidInput(vehicle.name,
                       "the rotors have different lags, expected --lag LOW:HIGH, one range for all "
                       "of them");
  if (u.lag.high > kMaxLag)
    throw OptionError("lag", fmt::format("lag is up to {:.6g} s, expected at most {:.6g} s",
                                         u.lag.high, kMaxLag));
  return u;
}

/// A requested law of the export before its analysis, and its hover.
struct AskedLaw {
  CertifiedLaw law;
  std::function<PlannedFlight()> hover;  ///< empty if the gains are for another trim
};

AskedLaw asked_feedback(const Gains& gains, const StoredLaws& stored, const CertifyOptions& options,
                        const Vehicle& vehicle) {
  AskedLaw asked;
  asked.law.name = "state feedback";
  asked.law.dt = gains.dt;
  asked.law.family = uncertain_hover(vehicle, gains, uncertainty_of(options, vehicle, gains.dt));
  if (has_flown_loop(linearization_of(vehicle, gains).trim))
    asked.hover = [vehicle, gains, estimator = stored.estimator] {
      return hover_under(vehicle, feedback_controller(gains, gains.dt), estimator,
                         gains.convention);
    };
  return asked;
}

AskedLaw asked_cascade(CascadeDesign cascade, const StoredLaws& stored,
                       const CertifyOptions& options, const Vehicle& vehicle) {
  if (options.integrator) cascade.method = *options.integrator;
  AskedLaw asked;
  asked.law.name = "cascade";
  asked.law.dt = cascade.gains.dt;
  asked.law.family = uncertain_hover(vehicle, cascade.gains, cascade.method,
                                     uncertainty_of(options, vehicle, cascade.gains.dt));
  asked.hover = [vehicle, cascade, estimator = stored.estimator] {
    return hover_under(vehicle, cascade_controller(cascade, cascade.gains), estimator, "");
  };
  return asked;
}

std::vector<AskedLaw> laws_of(const std::string& directory, const CertifyOptions& options,
                              const std::string& controller, const Vehicle& vehicle) {
  if (holds_schedule(directory))
    throw InvalidInput(directory,
                       "the export holds a gain schedule; certify covers one law about "
                       "one hover, so export and certify the gains of a grid point");
  const StoredLaws stored = read_laws(directory);
  const auto asked_for = [&](const char* kind) { return controller.empty() || controller == kind; };
  std::vector<AskedLaw> laws;
  if (stored.gains && asked_for(kStateFeedback))
    laws.push_back(asked_feedback(*stored.gains, stored, options, vehicle));
  if (stored.cascade && asked_for(kCascadedPid))
    laws.push_back(asked_cascade(*stored.cascade, stored, options, vehicle));
  if (options.integrator && !(stored.cascade && asked_for(kCascadedPid)))
    throw OptionError("integrator",
                      "integrator does not apply to a state feedback, expected a PID cascade");
  if (laws.empty())
    throw InvalidInput(directory, fmt::format("the export has no {}, expected {}",
                                              controller.empty() ? "gains" : controller,
                                              stored.gains     ? kStateFeedback
                                              : stored.cascade ? kCascadedPid
                                                               : "a law whose loop can be closed"));
  return laws;
}

/// The flown loops of the box if the gains are for a hover.
FlownBox flown_of(const AskedLaw& asked, const CertifyOptions& options) {
  FlownBox none;
  if (!asked.hover) {
    none.why = "the gains are not for a level hover with the heading north";
    return none;
  }
  FlownBoxOptions box;
  box.also = asked.law.robustness.worst.parameters;
  box.threads = options.threads;
  box.interrupted = options.stop;
  try {
    return flown_box(asked.hover(), asked.law.family, box);
  } catch (const InvalidInput& error) {
    none.why = error.what();
    return none;
  }
}

}  // namespace

bool CertifiedLaw::proved() const { return reason().empty(); }

std::string CertifiedLaw::reason() const {
  if (robustness.worst.unstable())
    return fmt::format("{} is unstable, largest |z| {:.6f}, at {}", name, robustness.worst.radius,
                       describe(family, robustness.worst.parameters));
  if (flown_unstable())
    return fmt::format(
        "{}: the flown loop, with sensors and the estimator {}, is unstable at {}: {}", name,
        flown->worst->estimator, describe(family, flown->parameters), describe(*flown->worst));
  if (family.max_scale < 1)
    return fmt::format("the vehicle cannot hover everywhere in the box: {}",
                       family.max_scale_reason);
  if (robustness.proof.proved()) return "";
  return fmt::format(
      "{}: neither a proof nor an unstable loop was found; a larger budget or a smaller box may "
      "decide. Not proved: {}. The worst loop found has |z| {:.6f}, at {}",
      name, robustness.proof.culprit, robustness.worst.radius,
      describe(family, robustness.worst.parameters));
}

bool CertifyReport::proved() const {
  return !laws.empty() && std::all_of(laws.begin(), laws.end(),
                                      [](const CertifiedLaw& law) { return law.proved(); });
}

std::string CertifyReport::verdict() const {
  if (proved()) return "proved";
  const bool unstable = std::any_of(laws.begin(), laws.end(), [](const CertifiedLaw& law) {
    return law.robustness.worst.unstable() || law.flown_unstable();
  });
  return unstable ? "unstable" : "not proved";
}

CertifyReport certify(const std::string& directory, const CertifyOptions& options) {
  const std::string controller = controller_kind(options.controller, false);
  CertifyReport report{directory, ""};
  const VerifyReport verified = verify_directory(directory, options.vehicle);
  for (const VerifyCheck& check : verified.checks)
    // The proof applies to the laws as they are, even if --force was needed to write them.
    if (!check.ok && check.name != kForcedCheck) {
      report.failed = check;
      return report;
    }
  const Vehicle vehicle =
      internal::vehicle_of_manifest(directory, read_manifest(directory), options.vehicle);
  report.vehicle = vehicle.name;
  RobustnessOptions robustness;
  robustness.seed = options.seed;
  robustness.proof.max_boxes = options.max_boxes;
  robustness.proof.threads = options.threads;
  robustness.proof.interrupted = options.stop;
  for (AskedLaw& asked : laws_of(directory, options, controller, vehicle)) {
    asked.law.robustness = assess_robustness(asked.law.family, robustness);
    if (asked.law.robustness.proof.status == StabilityProofStatus::interrupted) throw Interrupted();
    if (options.flown) asked.law.flown = flown_of(asked, options);
    report.laws.push_back(std::move(asked.law));
  }
  return report;
}

std::string describe(const LoopFamily& family, const Eigen::VectorXd& values) {
  std::string text;
  for (std::size_t i = 0; i < family.parameters.size(); ++i) {
    const UncertainParameter& p = family.parameters[i];
    if (p.low == p.high) continue;
    text += fmt::format("{}{} {:.5g}{}", text.empty() ? "" : ", ", p.name,
                        values(static_cast<Eigen::Index>(i)), p.unit.empty() ? "" : " " + p.unit);
  }
  return text.empty() ? "the only loop of the box" : text;
}

}  // namespace quadtune
