// SPDX-License-Identifier: Apache-2.0
#include "quadtune/workbench/flown/flying_loop.hpp"

#include <cmath>
#include <utility>

#include "quadtune/convention.hpp"
#include "quadtune/discretize/zoh.hpp"
#include "quadtune/model/rotation.hpp"
#include "quadtune/synthesis/lqr.hpp"
#include "quadtune/workbench/design/linearize_or_refuse.hpp"
#include "quadtune/workbench/design/near_hover.hpp"

namespace quadtune {
namespace {

/// Looks up a state of ned in the gains' trim; 0 if the gains do not have it.
class NedTrim {
 public:
  explicit NedTrim(const Gains& gains) {
    const Convention& words = convention(gains.convention, "gains");
    Eigen::VectorXd full = Eigen::VectorXd::Zero(12);
    for (std::size_t i = 0; i < words.states.size(); ++i)
      for (std::size_t j = 0; j < gains.states.size(); ++j)
        if (words.states[i].name == gains.states[j].name) {
          const auto state = static_cast<Eigen::Index>(i);
          full(state) = gains.x0(static_cast<Eigen::Index>(j));
          in_world_axes_ = in_world_axes_ || !words.from_ned.row(state).head<2>().isZero(0);
        }
    x_ = words.from_ned.transpose() * full;
  }

  /// Whether the gains feed back a horizontal position.
  [[nodiscard]] bool in_world_axes() const { return in_world_axes_; }
  [[nodiscard]] double yaw() const { return x_(5); }

  /// The flight condition of this trim.
  [[nodiscard]] FlightCondition condition() const {
    const Eigen::Vector3d ground = rotation_of_euler(x_(3), x_(4), x_(5)) * x_.segment<3>(6);
    const double turn = (x_(10) * std::sin(x_(3)) + x_(11) * std::cos(x_(3))) / std::cos(x_(4));
    // Trims are solved to 1e-10: smaller speeds mean rest, and smaller rates straight flight.
    const auto or_zero = [](double value) { return std::abs(value) < 1e-8 ? 0 : value; };
    return steady_flight(or_zero(ground.head<2>().norm()), or_zero(-ground.z()), or_zero(turn),
                         x_(5));
  }

 private:
  Eigen::Matrix<double, 12, 1> x_;
  bool in_world_axes_ = false;
};

}  // namespace

Gains make_gains(const Vehicle& vehicle, const Linearization& model, const LqrDesign& lqr,
                 const StateFeedback& feedback) {
  Gains gains;
  gains.K = feedback.K;
  gains.K_int = feedback.K_int;
  gains.states = model.plant.states;
  gains.inputs = model.plant.inputs;
  gains.integrals = integral_signals(gains.states, lqr.integrals);
  gains.x0 = model.x0;
  gains.u0 = model.u0;
  gains.vehicle = vehicle.name;
  gains.convention = lqr.convention;
  gains.input_kind = lqr.input_kind;
  gains.sign_law = convention(lqr.convention, "design").sign_law;
  gains.dt = lqr.dt;
  if (lqr.convention == "ned" && gains.K.allFinite()) keep_near_hover(vehicle, gains);
  return gains;
}

Eigen::VectorXcd flying_poles(const Linearization& model, const Gains& gains,
                              const RiccatiResult& riccati) {
  return gains.dt > 0 ? closed_loop_poles(discretize_zoh(model.plant, gains.dt), gains)
                      : riccati.poles;
}

MarginsReport flying_margins(const Linearization& model, const Gains& gains,
                             const RiccatiResult& riccati, MarginsEvidence evidence) {
  std::vector<std::string> inputs = names_or_numbers(gains.inputs, std::ssize(gains.inputs));
  if (gains.dt > 0)
    return margins_report(OpenLoop(open_loop(discretize_zoh(model.plant, gains.dt), gains)),
                          std::move(inputs), evidence);
  const ContinuousLti augmented =
      with_integrals(model.plant, names_or_numbers(gains.integrals, std::ssize(gains.integrals)));
  return margins_report(loop_at_inputs(augmented, riccati.K), std::move(inputs), evidence);
}

Linearization linearization_of(const Vehicle& vehicle, const Gains& gains) {
  LinearizeOptions options;
  options.convention = gains.convention;
  options.inputs = gains.input_kind;
  std::vector<std::string> states;
  states.reserve(gains.states.size());
  for (const Signal& state : gains.states) states.push_back(state.name);
  options.states = {StateSelection::Kind::list, states};
  return linearize_or_refuse(vehicle, NedTrim(gains).condition(), options, place_of(vehicle));
}

std::optional<double> yaw_of(const Gains& gains) {
  if (gains.axes == PositionAxes::heading) return std::nullopt;
  const NedTrim trim(gains);
  return trim.in_world_axes() ? std::optional(trim.yaw()) : std::nullopt;
}

VerifyModel model_of(const Vehicle& vehicle, const Gains& gains) {
  const Linearization model = linearization_of(vehicle, gains);
  return {discretize_zoh(model.plant, gains.dt), model.x0, model.u0};
}

}  // namespace quadtune
