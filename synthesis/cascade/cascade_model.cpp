// SPDX-License-Identifier: Apache-2.0
#include "cascade/cascade_model.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "lyapunov/eigenvalues.hpp"
#include "margins/loop_grid.hpp"
#include "quadtune/errors.hpp"

namespace quadtune {

using Complex = std::complex<double>;
using Eigen::Index;
using Eigen::MatrixXd;

namespace internal {

PidIntegral::PidIntegral(PidMethod method, double period)
    : dt(period), now(pid_quadrature<double>(method).now * period) {}

Complex PidIntegral::at(double w) const {
  // dt/(z - 1) + now without cancellation: z - 1 = 2j sin(w dt/2) e^(jw dt/2).
  const double half = 0.5 * w * dt;
  return now + dt * std::polar(1.0, -half) / Complex(0, 2 * std::sin(half));
}

CascadePlant closed_loop(const CascadePlant& plant, const PidGains& gains, PidMethod method,
                         LoopInput input) {
  const bool set_point = input == LoopInput::set_point;
  const PidIntegral integral(method, plant.dt);
  const double at_once = gains.Kp + gains.Ki * integral.now;
  const Index n = plant.A.rows();
  const Index ni = gains.Ki != 0 ? 1 : 0;
  CascadePlant loop;
  loop.dt = plant.dt;
  loop.outputs = plant.outputs;
  loop.A = MatrixXd::Zero(n + ni, n + ni);
  loop.A.topLeftCorner(n, n) =
      plant.A - plant.B * (at_once * plant.C.row(0) + gains.Kd * plant.C.row(1));
  loop.B = MatrixXd::Zero(n + ni, 1);
  loop.B.topRows(n) = set_point ? MatrixXd(plant.B * at_once) : plant.B;
  loop.C = MatrixXd::Zero(2, n + ni);
  loop.C.leftCols(n) = plant.C;
  loop.D = MatrixXd::Zero(2, 1);
  if (ni > 0) {
    loop.A.topRightCorner(n, 1) = plant.B;
    loop.A.bottomLeftCorner(1, n) = -gains.Ki * plant.dt * plant.C.row(0);
    loop.A(n, n) = 1;
    if (set_point) loop.B(n, 0) = gains.Ki * plant.dt;
  }
  return loop;
}

CascadeResponses::CascadeResponses(const CascadePlant& plant, PidMethod method, double slowest)
    : plant_(plant), response_(plant), integral_(method, plant.dt), method_(method) {
  const double nyquist = std::numbers::pi / plant.dt;
  constexpr double kWidest = 1e8;  // below this, rounding dominates a sampled integrator
  constexpr double kNarrowest = 1e2;
  grid_ = loop_grid({.roots = {eigenvalues(plant.A)}, .dt = plant.dt},
                    nyquist / std::clamp(nyquist / slowest, kNarrowest, kWidest), nyquist);
  points_.reserve(grid_.size());
  for (const double w : grid_) points_.push_back(at(w));
}

CascadeResponses::Point CascadeResponses::at(double w) const {
  const Eigen::MatrixXcd y = response_.at(w);
  return {y(0, 0), y(1, 0), integral_.at(w)};
}

CascadePlant CascadeResponses::closed(const PidGains& gains) const {
  return closed_loop(plant_, gains, method_, LoopInput::command);
}

bool CascadeResponses::stable(const PidGains& gains) const {
  return eigenvalues(closed(gains).A).cwiseAbs().maxCoeff() < 1 - 1e-12;
}

/// max |f(point) S|
template <class F>
double CascadeResponses::peak(const PidGains& gains, const F& f) const {
  const auto size = [&](const Point& p) {
    const Complex L = (gains.Kp + gains.Ki * p.integral) * p.value + gains.Kd * p.rate;
    return std::sqrt(std::norm(f(p)) / std::norm(1.0 + L));
  };
  std::vector<double> values;
  values.reserve(points_.size());
  for (const Point& p : points_) values.push_back(size(p));
  return highest_peak([&](double w) { return size(at(w)); }, grid_, values).value;
}

double CascadeResponses::Ms(const PidGains& gains) const {
  return peak(gains, [](const Point&) { return Complex(1); });
}
double CascadeResponses::value_noise(const PidGains& gains) const {
  return peak(gains, [&](const Point& p) { return gains.Kp + gains.Ki * p.integral; });
}
double CascadeResponses::tracking_peak(const PidGains& gains) const {
  return peak(gains, [&](const Point& p) { return (gains.Kp + gains.Ki * p.integral) * p.value; });
}

void require_cascade_plant(const CascadePlant& plant) {
  const char* where = "cascade loop";
  validate(plant, where);
  if (plant.B.cols() != 1 || plant.C.rows() != 2)
    throw InvalidInput(where, fmt::format("the plant has {} inputs and {} outputs, expected 1 "
                                          "(command) and 2 (value and rate)",
                                          plant.B.cols(), plant.C.rows()));
  if (plant.D.size() > 0 && !plant.D.isZero(0))
    throw InvalidInput(where,
                       "D is not 0, expected a plant without feed-through because "
                       "otherwise the loop is algebraic");
}

}  // namespace internal

DiscreteLti cut_at_command(const CascadePlant& plant, const PidGains& gains, PidMethod method) {
  internal::require_cascade_plant(plant);
  const internal::PidIntegral integral(method, plant.dt);
  const Index n = plant.A.rows();
  const Index ni = gains.Ki != 0 ? 1 : 0;
  DiscreteLti loop;
  loop.dt = plant.dt;
  loop.A = MatrixXd::Zero(n + ni, n + ni);
  loop.A.topLeftCorner(n, n) = plant.A;
  loop.B = MatrixXd::Zero(n + ni, 1);
  loop.B.topRows(n) = plant.B;
  loop.C = MatrixXd::Zero(1, n + ni);
  loop.C.leftCols(n) =
      (gains.Kp + gains.Ki * integral.now) * plant.C.row(0) + gains.Kd * plant.C.row(1);
  loop.D = MatrixXd::Zero(1, 1);
  if (ni > 0) {
    loop.A.bottomLeftCorner(1, n) = gains.Ki * plant.dt * plant.C.row(0);
    loop.A(n, n) = 1;
    loop.C(0, n) = 1;
  }
  return loop;
}

CascadePlant closed_at_command(const CascadePlant& plant, const PidGains& gains, PidMethod method) {
  internal::require_cascade_plant(plant);
  return internal::closed_loop(plant, gains, method, internal::LoopInput::set_point);
}

}  // namespace quadtune
