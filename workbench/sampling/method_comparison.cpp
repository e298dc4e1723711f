// SPDX-License-Identifier: Apache-2.0
#include "quadtune/workbench/sampling/method_comparison.hpp"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <functional>

#include "quadtune/control/cascade_law.hpp"
#include "quadtune/discretize/zoh.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/model/vehicle.hpp"
#include "quadtune/workbench/design/cascade_report.hpp"
#include "quadtune/workbench/design/chosen_law.hpp"
#include "quadtune/workbench/design/standard_lqr.hpp"

namespace quadtune {
namespace {

/// Outputs that follow the four set points: px, py, pz, yaw.
const std::vector<Eigen::Index> kFollowed = {0, 1, 2, 5};

constexpr std::array<DiscretizationMethod, 7> kMethods = {
    DiscretizationMethod::zoh,     DiscretizationMethod::foh,
    DiscretizationMethod::impulse, DiscretizationMethod::euler,
    DiscretizationMethod::tustin,  DiscretizationMethod::backward_euler,
    DiscretizationMethod::matched};

constexpr std::array<PidMethod, 3> kIntegrators = {PidMethod::forward_euler,
                                                   PidMethod::backward_euler, PidMethod::tustin};

/// A law as designed in continuous time, with the plant that it was designed for.
struct Law {
  std::string name;   ///< "lqr", "cascade"
  std::string about;  ///< how it was designed
  ContinuousLti plant;
  ContinuousLti law;  ///< from set points and states to the wrench
  std::function<DiscreteLti(double, PidMethod)> sampled;  ///< the law as implemented
  std::function<Controller(PidMethod)> on_board;          ///< the same as a controller for flights
  bool integrates = false;

  /// "run", or e.g. "run, tustin" if the integration method matters.
  [[nodiscard]] std::string name_of_run(PidMethod method) const {
    return integrates ? "run, " + to_string(method) : "run";
  }
};

Law lqr_law(const CascadeVehicle& vehicle, const Vehicle& file) {
  const RiccatiResult riccati = standard_lqr(vehicle, "discretize");
  Law law;
  law.name = "lqr";
  law.about =
      "LQR, continuous, weights by Bryson's rule; designed without the motors' lag, flown with it";
  law.plant = with_actuator_lag(vehicle.hover, vehicle.lag);
  law.law.A = Eigen::MatrixXd(0, 0);
  law.law.B = Eigen::MatrixXd(0, 16);
  law.law.C = Eigen::MatrixXd(4, 0);
  law.law.D = Eigen::MatrixXd(4, 16);
  law.law.D << riccati.K(Eigen::all, kFollowed), -riccati.K;
  const ContinuousLti held = law.law;
  law.sampled = [held](double dt, PidMethod) {
    return DiscreteLti{held.A, held.B, held.C, held.D, dt, {}, {}, {}};
  };
  const Gains gains = standard_gains(file, "discretize");
  law.on_board = [gains](PidMethod) { return feedback_controller(gains, kUsualPeriod); };
  return law;
}

Law cascade_law_of(const CascadeVehicle& vehicle, const CascadeReport& report) {
  Law law;
  law.name = "cascade";
  law.about = fmt::format(
      "PID cascade of `quadtune pid {} --method loops --dt {:.6g}`, its integrals "
      "continuous",
      report.vehicle, report.specification.dt);
  law.plant = with_actuator_lag(vehicle.hover, vehicle.lag);
  const CascadeGains gains = report.cascade.gains;
  law.law = cascade_law(gains);
  law.integrates = law.law.A.rows() > 0;
  law.sampled = [gains](double dt, PidMethod method) {
    CascadeGains other = gains;
    other.dt = dt;
    return cascade_law(other, method);
  };
  law.on_board = [gains](PidMethod method) {
    CascadeController controller{gains};
    controller.method = method;
    return controller;
  };
  return law;
}

template <class Lti>
Lti followed(Lti loop) {
  loop.C = Eigen::MatrixXd(loop.C(kFollowed, Eigen::all));
  loop.D = Eigen::MatrixXd::Zero(4, loop.B.cols());
  loop.outputs.clear();
  return loop;
}

DiscreteLti run_every(const Law& law, double dt, PidMethod method) {
  return followed(closed_loop(discretize_zoh(law.plant, dt), law.sampled(dt, method)));
}

/// A hundred time constants of the slowest pole, longer than any reasonable sample period.
double longest_period(const ContinuousLti& loop) {
  return 100 / -loop.A.eigenvalues().real().maxCoeff();
}

MethodErrors method_errors(const ContinuousLti& loop, DiscretizationMethod method,
                           const std::array<double, 3>& periods) {
  MethodErrors row;
  row.name = to_string(method);
  row.limit = stability_limit(loop.A.eigenvalues(), method);
  for (std::size_t i = 0; i < periods.size(); ++i) {
    try {
      row.errors[i] = sampling_error(loop, discretize_channels(loop, periods[i], method));
    } catch (const InvalidInput&) {
      row.errors[i].reset();  // e.g. tustin with a pole at 2/dt
    }
  }
  return row;
}

MethodErrors run_errors(const Law& law, const ContinuousLti& loop, PidMethod method,
                        const std::array<double, 3>& periods) {
  MethodErrors row;
  row.name = law.name_of_run(method);
  for (std::size_t i = 0; i < periods.size(); ++i)
    row.errors[i] = sampling_error(loop, run_every(law, periods[i], method));
  row.searched = longest_period(loop);
  row.limit = stability_limit([&](double dt) { return run_every(law, dt, method).A; }, periods[1],
                              row.searched);
  return row;
}

std::vector<MethodErrors> all_errors(const Law& law, const ContinuousLti& loop,
                                     const std::array<double, 3>& periods) {
  std::vector<MethodErrors> rows;
  rows.reserve(kMethods.size() + kIntegrators.size());
  for (const DiscretizationMethod method : kMethods)
    rows.push_back(method_errors(loop, method, periods));
  for (const PidMethod method : kIntegrators) {
    rows.push_back(run_errors(law, loop, method, periods));
    if (!law.integrates) break;
  }
  return rows;
}

std::vector<FlownMethod> flown_rows(const Vehicle& vehicle, const Law& law,
                                    const std::array<double, 3>& periods) {
  std::vector<FlownMethod> rows;
  for (const PidMethod method : kIntegrators) {
    rows.push_back({law.name_of_run(method), flown_at_periods(vehicle, law.on_board(method),
                                                              {periods.begin(), periods.end()})});
    if (!law.integrates) break;
  }
  return rows;
}

ComparedLaw compared(const Vehicle& vehicle, const Law& law, double dt,
                     const std::array<double, 3>& periods, bool flown) {
  ComparedLaw result{law.name, law.about, followed(closed_loop(law.plant, law.law)),
                     run_every(law, dt, PidMethod::forward_euler), ""};
  if (!(result.loop.A.eigenvalues().real().maxCoeff() < 0)) {
    result.why = "the continuous loop is unstable, so there is nothing to compare with";
    return result;
  }
  result.methods = all_errors(law, result.loop, periods);
  if (flown) result.flown = flown_rows(vehicle, law, periods);
  return result;
}

}  // namespace

MethodComparison compare_sampling_methods(const std::string& vehicle_name, double dt, bool flown) {
  const Vehicle vehicle = load_vehicle(vehicle_name);
  const CascadeVehicle hover = cascade_vehicle(vehicle, vehicle_name);
  CascadeSpecification specification;
  specification.dt = dt;
  const CascadeReport report = design_cascade(vehicle, specification, vehicle_name);
  MethodComparison comparison{vehicle.name, dt, {dt / 2, dt, 2 * dt}, flown, {}};
  for (const Law& law : {lqr_law(hover, vehicle), cascade_law_of(hover, report)})
    comparison.laws.push_back(compared(vehicle, law, dt, comparison.periods, flown));
  return comparison;
}

MinMargins min_margins(const FlownLoop& loop) {
  MinMargins min;
  for (const LoopMargins& one : loop.margins.loops) {
    min.phase = std::min(min.phase, one.phase_margin);
    min.Ms = std::max(min.Ms, one.Ms);
    min.disk = std::min(min.disk, one.disk.alpha);
  }
  return min;
}

}  // namespace quadtune
