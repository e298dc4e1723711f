// SPDX-License-Identifier: Apache-2.0
#include "quadtune/workbench/sampling/method_comparison.hpp"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "quadtune/discretize/zoh.hpp"
#include "quadtune/frequency_response.hpp"
#include "quadtune/internal/json.hpp"
#include "report/loops/loops.hpp"
#include "report/plots/comparison_figure.hpp"
#include "report/plots/figure.hpp"
#include "report/text/print.hpp"
#include "report/text/rows.hpp"

namespace quadtune::report {
namespace {

using internal::Json;

// --- text ----------------------------------------------------------------------------------------

/// The two lines of headings of a table: three columns for each quantity, one for each period.
Cells headings(const std::string& first, const std::array<const char*, 3>& quantities,
               const std::array<double, 3>& periods) {
  Cells cells = {{""}, {first}};
  for (const char* quantity : quantities)
    for (std::size_t i = 0; i < 3; ++i) {
      cells[0].emplace_back(i == 2 ? quantity : "");
      cells[1].push_back(number(periods[i]));
    }
  return cells;
}

std::string percent(const std::optional<SamplingError>& error, double SamplingError::*part) {
  if (!error) return "-";
  const double value = (*error).*part;
  if (!error->stable)
    return part == &SamplingError::pole && std::isfinite(value) ? fmt::format("{:.2g}", 100 * value)
                                                                : "lost";
  if (!std::isfinite(value)) return "-";
  if (value < 1e-7) return "0";  // rounding of multiple poles
  return 100 * value < 99.5 ? fmt::format("{:.2g}", 100 * value)
                            : fmt::format("{:.0f}", 100 * value);
}

std::string limit_text(const MethodErrors& method) {
  if (std::isfinite(method.limit)) return fmt::format("{:.4g}", method.limit);
  return method.searched > 0 ? fmt::format("> {:.3g}", method.searched) : "any";
}

std::string methods_text(const ComparedLaw& law, const std::array<double, 3>& periods) {
  Cells cells = headings("method", {"poles [%]", "step [%]", "frequency [%]"}, periods);
  cells[0].emplace_back("stable to");
  cells[1].emplace_back("[s]");
  for (const MethodErrors& method : law.methods) {
    cells.push_back({method.name});
    for (double SamplingError::*part :
         {&SamplingError::pole, &SamplingError::step, &SamplingError::frequency})
      for (const std::optional<SamplingError>& error : method.errors)
        cells.back().push_back(percent(error, part));
    cells.back().push_back(limit_text(method));
  }
  return aligned(cells);
}

std::string flown_law_text(const ComparedLaw& law, const std::array<double, 3>& periods) {
  std::string estimator;
  for (const FlownMethod& method : law.flown)
    for (const FlownPeriod& at : method.periods)
      if (at.loop) estimator = ", estimator " + at.loop->estimator;
  Cells cells = headings("law", {"phase margin [deg]", "Ms", "disk margin"}, periods);
  std::vector<std::string> reasons;
  for (const FlownMethod& method : law.flown) {
    std::vector<std::string> phase, Ms, disk;
    for (const FlownPeriod& at : method.periods) {
      if (!at.loop || at.loop->grows()) {
        const std::string reason = fmt::format(
            "{} s: {}", number(at.dt), at.loop ? "unstable; " + describe(*at.loop) : at.why);
        for (auto* column : {&phase, &Ms, &disk}) column->emplace_back(at.loop ? "lost" : "-");
        if (std::find(reasons.begin(), reasons.end(), reason) == reasons.end())
          reasons.push_back(reason);
        continue;
      }
      const MinMargins min = min_margins(*at.loop);
      phase.push_back(std::isfinite(min.phase) ? fmt::format("{:.1f}", degrees(min.phase)) : "any");
      Ms.push_back(fmt::format("{:.2f}", min.Ms));
      disk.push_back(fmt::format("{:.2f}", min.disk));
    }
    cells.push_back({method.name});
    for (const auto* column : {&phase, &Ms, &disk})
      cells.back().insert(cells.back().end(), column->begin(), column->end());
  }
  std::string text =
      fmt::format("\non the flown plant: rotor lag, sensors{}\n{}", estimator, aligned(cells));
  for (const std::string& reason : reasons) text += "\n" + reason;
  return text;
}

// --- JSON ----------------------------------------------------------------------------------------

void add_methods(Json& methods, const ComparedLaw& law, const std::array<double, 3>& periods) {
  for (const MethodErrors& row : law.methods)
    for (std::size_t i = 0; i < periods.size(); ++i) {
      if (!row.errors[i]) continue;
      const SamplingError& error = *row.errors[i];
      methods.push_back({{"law", law.name},
                         {"name", row.name},
                         {"dt", periods[i]},
                         {"pole_error", error.pole},
                         {"step_error", error.step},
                         {"frequency_error", error.frequency},
                         {"stable", error.stable},
                         {"stable_up_to_s", row.limit}});
    }
}

void add_flown(Json& flown, const ComparedLaw& law) {
  for (const FlownMethod& row : law.flown)
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
      entry["slowest_mode"] = describe(*at.loop);
      const MinMargins min = min_margins(*at.loop);
      entry["phase_margin_deg"] = lost ? Json(nullptr) : Json(degrees(min.phase));
      entry["Ms"] = lost ? Json(nullptr) : Json(min.Ms);
      entry["disk"] = lost ? Json(nullptr) : Json(min.disk);
      flown.push_back(entry);
    }
}

// --- picture -------------------------------------------------------------------------------------

/// The outputs of a channel after a step of its set point.
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

}  // namespace

Json to_json(const MethodComparison& comparison) {
  Json json = {{"vehicle", comparison.vehicle}, {"dt", comparison.dt}};
  json["methods"] = Json::array();
  json["not_compared"] = Json::array();
  if (comparison.flown) json["flown"] = Json::array();
  for (const ComparedLaw& law : comparison.laws) {
    if (!law.why.empty()) json["not_compared"].push_back({{"law", law.name}, {"why", law.why}});
    add_methods(json["methods"], law, comparison.periods);
    if (comparison.flown) add_flown(json["flown"], law);
  }
  return json;
}

std::string to_text(const MethodComparison& comparison) {
  std::string text = section("vehicle", comparison.vehicle +
                                            " at hover: errors of x, y, z and yaw in following "
                                            "their set points, the largest of the four");
  for (const ComparedLaw& law : comparison.laws) {
    std::string about = law.about + "\n" + law.why;
    if (law.why.empty()) about += methods_text(law, comparison.periods);
    if (!law.flown.empty()) about += flown_law_text(law, comparison.periods);
    text += section(law.name, about);
  }
  return text;
}

Figure sampling_figure(const MethodComparison& methods) {
  const ComparedLaw& law = methods.laws.back();
  const ContinuousLti& loop = law.loop;
  const double dt = methods.dt;
  Comparison comparison;
  comparison.dt = dt;
  comparison.title = fmt::format("{}: {}, x following its set point, every {} s", methods.vehicle,
                                 law.name, number(dt));
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
  comparison.methods.push_back(picture_of("run, euler", law.run, loop, comparison));
  return comparison_figure(comparison);
}

}  // namespace quadtune::report
