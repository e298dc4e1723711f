// SPDX-License-Identifier: Apache-2.0
#include "report/loops/method_comparison.hpp"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <optional>
#include <ostream>
#include <utility>
#include <vector>

#include "quadtune/control/cascade_law.hpp"
#include "quadtune/discretize/compare.hpp"
#include "quadtune/discretize/zoh.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/frequency_response.hpp"
#include "quadtune/internal/json.hpp"
#include "quadtune/model/vehicle.hpp"
#include "quadtune/workbench/design/cascade_report.hpp"
#include "quadtune/workbench/design/chosen_law.hpp"
#include "quadtune/workbench/design/standard_lqr.hpp"
#include "quadtune/workbench/flown/flown_periods.hpp"
#include "report/plots/comparison_figure.hpp"
#include "report/text/print.hpp"

namespace quadtune::report {
namespace {

using internal::finite_or_null;
using internal::Json;

/// Outputs that the four set points ask for: px, py, pz, yaw.
const std::vector<Eigen::Index> kFollowed = {0, 1, 2, 5};

constexpr std::array<DiscretizationMethod, 7> kMethods = {
    DiscretizationMethod::zoh,     DiscretizationMethod::foh,
    DiscretizationMethod::impulse, DiscretizationMethod::euler,
    DiscretizationMethod::tustin,  DiscretizationMethod::backward_euler,
    DiscretizationMethod::matched};

constexpr std::array<PidMethod, 3> kIntegrators = {PidMethod::forward_euler,
                                                   PidMethod::backward_euler, PidMethod::tustin};

/// A law as designed in continuous time, with the plant it was designed on.
struct Law {
  std::string name;   ///< "lqr", "cascade"
  std::string about;  ///< how it was designed
  ContinuousLti plant;
  ContinuousLti law;                                      ///< set points and states to the wrench
  std::function<DiscreteLti(double, PidMethod)> sampled;  ///< the law as it runs
  std::function<Controller(PidMethod)> on_board;          ///< the same as a flight's controller
  bool integrates = false;
};

/// One row: a way to sample, at all periods.
struct Row {
  std::string name;
  std::array<std::optional<SamplingError>, 3> errors;  ///< none where the method cannot be had
  double limit = 0;                                    ///< stable up to this period [s]
  double searched = 0;  ///< up to which it was looked for; 0 where a formula gives it
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
      "PID cascade of `quadtune pid {} --method loops --dt {}`, its integrals "
      "continuous",
      report.vehicle, number(report.specification.dt));
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

/// A hundred time constants of the slowest pole: nobody samples so rarely.
double longest_period(const ContinuousLti& loop) {
  return 100 / -loop.A.eigenvalues().real().maxCoeff();
}

Row method_row(const ContinuousLti& loop, DiscretizationMethod method,
               const std::array<double, 3>& periods) {
  Row row;
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

Row flown_row(const Law& law, const ContinuousLti& loop, PidMethod method,
              const std::array<double, 3>& periods) {
  Row row;
  row.name = law.integrates ? "run, " + to_string(method) : "run";
  for (std::size_t i = 0; i < periods.size(); ++i)
    row.errors[i] = sampling_error(loop, run_every(law, periods[i], method));
  row.searched = longest_period(loop);
  row.limit = stability_limit([&](double dt) { return run_every(law, dt, method).A; }, periods[1],
                              row.searched);
  return row;
}

std::vector<Row> rows_of(const Law& law, const ContinuousLti& loop,
                         const std::array<double, 3>& periods) {
  std::vector<Row> rows;
  rows.reserve(kMethods.size() + kIntegrators.size());
  for (const DiscretizationMethod method : kMethods)
    rows.push_back(method_row(loop, method, periods));
  for (const PidMethod method : kIntegrators) {
    rows.push_back(flown_row(law, loop, method, periods));
    if (!law.integrates) break;
  }
  return rows;
}

// --- the plant that flies ------------------------------------------------------------------------

/// A law as it runs, on the flown plant at all periods.
struct FlownRow {
  std::string name;
  std::vector<FlownPeriod> periods;
};

std::vector<FlownRow> flown_rows(const Vehicle& vehicle, const Law& law,
                                 const std::array<double, 3>& periods) {
  std::vector<FlownRow> rows;
  for (const PidMethod method : kIntegrators) {
    rows.push_back(
        {law.integrates ? "run, " + to_string(method) : "run",
         flown_at_periods(vehicle, law.on_board(method), {periods.begin(), periods.end()})});
    if (!law.integrates) break;
  }
  return rows;
}

/// The smallest margins of all loops at one period.
struct LeastMargins {
  double phase = std::numeric_limits<double>::infinity();  ///< [rad]
  double Ms = 0;
  double disk = 2;
};

LeastMargins least_of(const FlownLoop& loop) {
  LeastMargins least;
  for (const LoopMargins& one : loop.margins.loops) {
    least.phase = std::min(least.phase, one.phase_margin);
    least.Ms = std::max(least.Ms, one.Ms);
    least.disk = std::min(least.disk, one.disk.alpha);
  }
  return least;
}

// --- text ----------------------------------------------------------------------------------------

std::string percent(const std::optional<SamplingError>& error, double SamplingError::*part) {
  if (!error) return "-";
  const double value = (*error).*part;
  if (!error->stable)
    return part == &SamplingError::pole && std::isfinite(value) ? fmt::format("{:.2g}", 100 * value)
                                                                : "lost";
  if (!std::isfinite(value)) return "-";
  if (value < 1e-7) return "0";  // what multiple poles leave of rounding
  return 100 * value < 99.5 ? fmt::format("{:.2g}", 100 * value)
                            : fmt::format("{:.0f}", 100 * value);
}

std::string law_text(const Law& law, const std::vector<Row>& rows,
                     const std::array<double, 3>& periods) {
  std::string text = law.about + "\n";
  text += fmt::format("{:<22}{:^24}{:^24}{:^24}{:>11}\n", "", "poles [%]", "step [%]",
                      "frequency [%]", "stable to");
  text += fmt::format("{:<22}", "method");
  for (int part = 0; part < 3; ++part)
    for (const double dt : periods) text += fmt::format("{:>8}", number(dt));
  text += fmt::format("{:>11}", "[s]");
  for (const Row& row : rows) {
    text += fmt::format("\n{:<22}", row.name);
    for (double SamplingError::*part :
         {&SamplingError::pole, &SamplingError::step, &SamplingError::frequency})
      for (const std::optional<SamplingError>& error : row.errors)
        text += fmt::format("{:>8}", percent(error, part));
    text += fmt::format("{:>11}", std::isfinite(row.limit) ? fmt::format("{:.4g}", row.limit)
                                  : row.searched > 0       ? fmt::format("> {:.3g}", row.searched)
                                                           : "any");
  }
  return text;
}

std::string flown_text(const std::vector<FlownRow>& rows, const std::array<double, 3>& periods) {
  std::string estimator;
  for (const FlownRow& row : rows)
    for (const FlownPeriod& at : row.periods)
      if (at.loop) estimator = ", estimator " + at.loop->estimator;
  std::string text = fmt::format("\non the flown plant: rotor lag, sensors{}\n", estimator);
  text += fmt::format("{:<22}{:^24}{:^24}{:^24}\n", "", "phase margin [deg]", "Ms", "disk margin");
  text += fmt::format("{:<22}", "law");
  for (int part = 0; part < 3; ++part)
    for (const double dt : periods) text += fmt::format("{:>8}", number(dt));
  std::vector<std::string> reasons;
  for (const FlownRow& row : rows) {
    std::array<std::string, 3> columns;
    for (const FlownPeriod& at : row.periods) {
      if (!at.loop || at.loop->grows()) {
        const std::string reason = fmt::format(
            "{} s: {}", number(at.dt), at.loop ? "unstable; " + in_words(*at.loop) : at.why);
        for (std::string& column : columns) column += fmt::format("{:>8}", at.loop ? "lost" : "-");
        if (std::find(reasons.begin(), reasons.end(), reason) == reasons.end())
          reasons.push_back(reason);
        continue;
      }
      const LeastMargins least = least_of(*at.loop);
      columns[0] += std::isfinite(least.phase) ? fmt::format("{:>8.1f}", degrees(least.phase))
                                               : fmt::format("{:>8}", "any");
      columns[1] += fmt::format("{:>8.2f}", least.Ms);
      columns[2] += fmt::format("{:>8.2f}", least.disk);
    }
    text += fmt::format("\n{:<22}{}{}{}", row.name, columns[0], columns[1], columns[2]);
  }
  for (const std::string& reason : reasons) text += "\n" + reason;
  return text;
}

// --- JSON ----------------------------------------------------------------------------------------

void add_rows(Json& methods, const Law& law, const std::vector<Row>& rows,
              const std::array<double, 3>& periods) {
  for (const Row& row : rows)
    for (std::size_t i = 0; i < periods.size(); ++i) {
      if (!row.errors[i]) continue;
      const SamplingError& error = *row.errors[i];
      methods.push_back({{"law", law.name},
                         {"name", row.name},
                         {"dt", periods[i]},
                         {"pole_error", finite_or_null(error.pole)},
                         {"step_error", finite_or_null(error.step)},
                         {"frequency_error", finite_or_null(error.frequency)},
                         {"stable", error.stable},
                         {"stable_up_to_s", finite_or_null(row.limit)}});
    }
}

void add_flown(Json& flown, const Law& law, const std::vector<FlownRow>& rows) {
  for (const FlownRow& row : rows)
    for (const FlownPeriod& at : row.periods) {
      Json entry = {{"law", law.name}, {"name", row.name}, {"dt", at.dt}};
      if (!at.loop) {
        entry["why"] = at.why;
        flown.push_back(entry);
        continue;
      }
      const bool lost = at.loop->grows();
      entry["estimator"] = at.loop->estimator;
      entry["stable"] = !lost;
      entry["slowest_mode"] = in_words(*at.loop);
      const LeastMargins least = least_of(*at.loop);
      entry["phase_margin_deg"] = lost ? Json(nullptr) : Json(finite_or_null(degrees(least.phase)));
      entry["Ms"] = lost ? Json(nullptr) : Json(finite_or_null(least.Ms));
      entry["disk"] = lost ? Json(nullptr) : Json(finite_or_null(least.disk));
      flown.push_back(entry);
    }
}

// --- picture -------------------------------------------------------------------------------------

/// Outputs of a channel after a step of its set point.
std::vector<double> step_of(const DiscreteLti& loop, Eigen::Index channel, std::size_t samples) {
  std::vector<double> y;
  y.reserve(samples);
  Eigen::VectorXd x = Eigen::VectorXd::Zero(loop.A.rows());
  const double through = loop.D.size() > 0 ? loop.D(channel, channel) : 0;
  for (std::size_t k = 0; k < samples; ++k) {
    y.push_back(loop.C.row(channel).dot(x) + through);
    x = (loop.A * x + loop.B.col(channel)).eval();
  }
  return y;
}

SampledMethod picture_of(const std::string& name, const DiscreteLti& sampled,
                         const ContinuousLti& loop, const Comparison& comparison) {
  SampledMethod method;
  method.name = name;
  method.outputs = step_of(sampled, 0, comparison.times.size());
  const FrequencyResponse exact(loop);
  const FrequencyResponse response(sampled);
  method.frequency_error.reserve(comparison.frequencies.size());
  for (const double w : comparison.frequencies)
    method.frequency_error.push_back(std::abs(response.at(w)(0, 0) / exact.at(w)(0, 0) - 1.0));
  method.poles = sampled.A.eigenvalues();
  return method;
}

/// The set point of x of the cascade: the slowest chain of loops, where periods matter least, and
/// the fastest poles, where they matter most.
Figure figure_of(const std::string& vehicle, const Law& law, const ContinuousLti& loop, double dt) {
  Comparison comparison;
  comparison.dt = dt;
  comparison.title =
      fmt::format("{}: {}, x by its set point, every {} s", vehicle, law.name, number(dt));
  const Eigen::VectorXcd poles = loop.A.eigenvalues();
  const double duration = 7 / -poles.real().maxCoeff();
  const auto samples = static_cast<std::size_t>(std::clamp(duration / dt, 50.0, 4000.0));
  for (std::size_t k = 0; k < samples; ++k) comparison.times.push_back(double(k) * dt);
  comparison.exact = step_of(discretize_zoh(loop, dt), 0, samples);
  comparison.continuous = {comparison.times, comparison.exact};
  const double nyquist = std::numbers::pi / dt;
  for (int k = 0; k < 200; ++k)
    comparison.frequencies.push_back(nyquist * std::pow(1e4, double(k - 199) / 199));
  comparison.exact_poles = (poles * dt).array().exp();
  for (const DiscretizationMethod method :
       {DiscretizationMethod::zoh, DiscretizationMethod::foh, DiscretizationMethod::euler,
        DiscretizationMethod::backward_euler, DiscretizationMethod::tustin,
        DiscretizationMethod::matched})
    comparison.methods.push_back(
        picture_of(to_string(method), discretize_channels(loop, dt, method), loop, comparison));
  comparison.methods.push_back(
      picture_of("run, euler", run_every(law, dt, PidMethod::forward_euler), loop, comparison));
  return comparison_figure(comparison);
}

}  // namespace

MethodComparison compare_methods(const std::string& vehicle_name, double dt, bool flown) {
  const Vehicle vehicle = load_vehicle(vehicle_name);
  const CascadeVehicle hover = cascade_vehicle(vehicle, vehicle_name);
  CascadeSpecification specification;
  specification.dt = dt;
  const CascadeReport report = design_cascade(vehicle, specification, vehicle_name);
  const std::array<Law, 2> laws = {lqr_law(hover, vehicle), cascade_law_of(hover, report)};
  const std::array<double, 3> periods = {dt / 2, dt, 2 * dt};
  Json json = {{"vehicle", vehicle.name}, {"dt", dt}};
  json["methods"] = Json::array();
  json["not_compared"] = Json::array();
  if (flown) json["flown"] = Json::array();
  std::string text = section("vehicle", vehicle.name +
                                            " at hover: errors of x, y, z and yaw after "
                                            "their set points, the worst of the four");
  for (const Law& law : laws) {
    const ContinuousLti loop = followed(closed_loop(law.plant, law.law));
    if (!(loop.A.eigenvalues().real().maxCoeff() < 0)) {
      const std::string why = "the continuous loop is not stable: nothing to compare with";
      json["not_compared"].push_back({{"law", law.name}, {"why", why}});
      text += section(law.name, law.about + "\n" + why);
      continue;
    }
    const std::vector<Row> rows = rows_of(law, loop, periods);
    add_rows(json["methods"], law, rows, periods);
    std::string about = law_text(law, rows, periods);
    if (flown) {
      const std::vector<FlownRow> on_plant = flown_rows(vehicle, law, periods);
      add_flown(json["flown"], law, on_plant);
      about += flown_text(on_plant, periods);
    }
    text += section(law.name, about);
  }
  const Law& drawn = laws[1];
  return {std::move(json), std::move(text), [name = vehicle.name, drawn, dt] {
            return figure_of(name, drawn, followed(closed_loop(drawn.plant, drawn.law)), dt);
          }};
}

}  // namespace quadtune::report
