// SPDX-License-Identifier: Apache-2.0
#include "quadtune/workbench/design/matrix_report.hpp"

#include <fmt/format.h>

#include <cmath>

#include "quadtune/internal/json.hpp"
#include "quadtune/model/vehicle.hpp"
#include "quadtune/workbench/flown/flown_gains.hpp"
#include "report/gains/gains.hpp"
#include "report/loops/loops.hpp"
#include "report/loops/margins_report.hpp"
#include "report/text/print.hpp"

namespace quadtune::report {
namespace {

using internal::Json;

/// The diagonals of the weights: of the 12 states of ned, of the wrench (T, tau_x, tau_y, tau_z),
/// and of the integrals of px, py, pz and yaw.
struct Weights {
  Eigen::RowVectorXd Q = Eigen::RowVectorXd::Zero(12);
  Eigen::RowVectorXd R = Eigen::RowVectorXd::Zero(4);
  Eigen::RowVectorXd Q_integral = Eigen::RowVectorXd::Zero(4);
};

Weights weights_of(const MatrixReport& report) {
  Weights weights;
  for (std::size_t i = 0; i < report.weights.size(); ++i) {
    const AxisWeights& axis = report.weights[i];
    const std::vector<Eigen::Index>& states = states_of(kFlownAxes[i]);
    for (std::size_t j = 0; j < states.size(); ++j)
      weights.Q(states[j]) = axis.q(static_cast<Eigen::Index>(j));
    weights.R(wrench_of(kFlownAxes[i])) = axis.r;
    weights.Q_integral(static_cast<Eigen::Index>(i)) = axis.q_integral;
  }
  return weights;
}

std::string matrix_weights_text(const MatrixReport& report) {
  const Weights weights = weights_of(report);
  return table(weights.Q, {"Q"}, names_of(ned_convention().states)) + "\n" +
         table(weights.Q_integral, {"Q_int"}, standard_integrals()) + "\n" +
         table(weights.R, {"R"}, names_of(ned_convention().wrench));
}

std::string matrix_law_text(const Gains& gains) {
  return fmt::format(
      "a gain on 12 states and one on 4 integrals, every {} s, convention {}\nlaw u = u0 {} "
      "K (x_sp - x) + K_int integral(x_sp - x), position errors in {} axes",
      number(gains.dt), gains.convention,
      gains.sign_law == SignLaw::set_point_minus_state ? "+" : "-", to_string(gains.axes));
}

}  // namespace

std::string family_text(const FlownGains& flown) {
  std::string text;
  for (const FlownAxisGains& axis : flown.axes)
    for (std::size_t i = 0; i < flown.family.size(); ++i) {
      const LoopMargins& margins = axis.margins[i];
      text += fmt::format("{:9}{:31} {} {:5.1f} deg, {:4.1f} dB up, Ms {:.2f}, disk {:.2f}\n",
                          to_string(axis.axis), flown.family[i].name,
                          margins.stable ? "stable  " : "UNSTABLE", degrees(margins.phase_margin),
                          decibels(margins.gain_margin), margins.Ms, margins.disk.alpha);
    }
  if (!text.empty()) text.pop_back();
  return text;
}

Json family_json(const FlownGains& flown) {
  Json axes = Json::array();
  for (const FlownAxisGains& axis : flown.axes)
    for (std::size_t i = 0; i < flown.family.size(); ++i) {
      const LoopMargins& margins = axis.margins[i];
      axes.push_back({{"axis", to_string(axis.axis)},
                      {"plant", flown.family[i].name},
                      {"stable", margins.stable},
                      {"phase_margin_deg", degrees(margins.phase_margin)},
                      {"Ms", margins.Ms},
                      {"disk", margins.disk.alpha}});
    }
  return axes;
}

Json to_json(const MatrixReport& report, const Vehicle& vehicle) {
  const Gains& gains = report.gains;
  const Weights weights = weights_of(report);
  Json json = {{"status", "solved"},
               {"plant", "flown"},
               {"structure", "matrix"},
               {"convention", gains.convention},
               {"sign_law", to_string(gains.sign_law)}};
  add_gains(json, gains);
  json["weights"] = {{"Q", internal::vector_to_json(weights.Q, "Q")},
                     {"Q_integral", internal::vector_to_json(weights.Q_integral, "Q_int")},
                     {"R", internal::vector_to_json(weights.R, "R")}};
  json["family"] = family_json(report.design);
  json["notes"] = report.design.notes;
  add_loops(json, report.flown, report.ideal);
  add_export(json, vehicle, gains, report.estimator);
  return json;
}

std::string to_text(const MatrixReport& report) {
  const Gains& gains = report.gains;
  const std::vector<std::string> inputs = names_of(gains.inputs);
  return section("law", matrix_law_text(gains)) + section("weights", matrix_weights_text(report)) +
         section("gain K", table(gains.K, inputs, names_of(gains.states))) +
         section("integral K", table(gains.K_int, inputs, names_of(gains.integrals))) +
         section("plants of the design", family_text(report.design)) +
         section("flown loop", to_text(report.flown)) +
         section("margins of the flown loop", to_text(report.flown.margins)) +
         section("margins of the ideal plant", to_text(report.ideal));
}

}  // namespace quadtune::report
