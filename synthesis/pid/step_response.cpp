// SPDX-License-Identifier: Apache-2.0
#include "quadtune/synthesis/pid/step_response.hpp"

#include <fmt/format.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <complex>
#include <functional>
#include <limits>

#include "margins/disk.hpp"
#include "quadtune/discretize/zoh.hpp"
#include "quadtune/errors.hpp"

namespace quadtune {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::RowVectorXd;
using Eigen::VectorXd;

constexpr int kSteps = 4000;
constexpr int kMaxSteps = 400000;
constexpr double kSettled = 0.02;  ///< relative to the largest distance from the final value
constexpr double kLeft = 8;        ///< the response of an unstable loop ends at this value
constexpr int kMaxTurns = 20;

/// ẋ = A x + Bv v + Bw w, q = Cq x + Dqv v + Dqw w, z = Cz x + Dzv v + Dzw w, where w is the step,
/// z is the output, and q is fed back as v, immediately or after a delay.
struct Feedback {
  MatrixXd A, Bv, Cq, Dqv;
  VectorXd Bw, Dqw;
  RowVectorXd Cz, Dzv;
  double Dzw = 0;
};

/// q = e = w - y is the input of L, and y its output.
Feedback set_point_feedback(const OpenLoop& loop, Index channel) {
  const VectorXd unit = VectorXd::Unit(loop.size(), channel);
  return {loop.A(),
          loop.B(),
          -loop.C(),
          -loop.D(),
          VectorXd::Zero(loop.A().rows()),
          unit,
          loop.C().row(channel),
          loop.D().row(channel),
          0};
}

/// q = u + w is the input of the plant. The integral and the filter of the derivative are states; a
/// derivative without filter computes ẏ from the equations of the plant.
Feedback load_feedback(const ContinuousTransferFunction& plant, const PidGains& gains) {
  ContinuousLti P;
  if (plant.den.size() > 1) {
    P = realize(plant);
  } else {
    P.A.resize(0, 0);
    P.B.resize(0, 1);
    P.C.resize(1, 0);
    P.D = MatrixXd::Constant(1, 1, plant.num[plant.num.size() - 1] / plant.den[0]);
  }
  const Index np = P.A.rows();
  const bool integral = gains.Ki != 0;
  const bool filter = gains.Kd != 0 && gains.Tf > 0;
  const Index n = np + static_cast<Index>(integral) + static_cast<Index>(filter);
  Feedback f;
  f.A = MatrixXd::Zero(n, n);
  f.Bv = MatrixXd::Zero(n, 1);
  f.Bw = VectorXd::Zero(n);
  f.Dqw = VectorXd::Ones(1);
  f.A.topLeftCorner(np, np) = P.A;
  f.Bv.topRows(np) = P.B;
  f.Cz = RowVectorXd::Zero(n);  // y = Cp xp + Dp v
  f.Cz.head(np) = P.C;
  f.Dzv = P.D;
  f.Cq = -gains.Kp * f.Cz;
  f.Dqv = -gains.Kp * P.D;
  if (integral) {  // ẋi = -y
    f.A.row(np) = -f.Cz;
    f.Bv.row(np) = -P.D;
    f.Cq(0, np) += gains.Ki;
  }
  if (filter) {  // Tf ẋf = -y - xf
    f.A.row(n - 1) = -f.Cz / gains.Tf;
    f.A(n - 1, n - 1) -= 1 / gains.Tf;
    f.Bv.row(n - 1) = -P.D / gains.Tf;
    f.Cq += gains.Kd * f.A.row(n - 1);
    f.Dqv += gains.Kd * f.Bv.row(n - 1);
  } else if (gains.Kd != 0) {
    f.Cq -= gains.Kd * (f.Cz * f.A);
    f.Dqv -= gains.Kd * (f.Cz * f.Bv);
  }
  return f;
}

/// With v = q: x' = A x + B w, z = C x + D w.
struct Closed {
  MatrixXd A;
  VectorXd B;
  RowVectorXd C;
  double D;
};

Closed close(const Feedback& f) {
  const Eigen::PartialPivLU<MatrixXd> lu(MatrixXd::Identity(f.Dqv.rows(), f.Dqv.cols()) - f.Dqv);
  const MatrixXd K = lu.solve(f.Cq);
  const VectorXd F = lu.solve(f.Dqw);
  return {f.A + f.Bv * K, f.Bw + f.Bv * F, f.Cz + f.Dzv * K, f.Dzw + f.Dzv.dot(F)};
}

StepResponse simulate_samples(const Closed& loop, double dt, Index count) {
  StepResponse response;
  response.t.reserve(static_cast<std::size_t>(count));
  response.y.reserve(static_cast<std::size_t>(count));
  VectorXd x = VectorXd::Zero(loop.A.rows());
  for (Index k = 0; k < count; ++k) {
    response.t.push_back(static_cast<double>(k) * dt);
    response.y.push_back(loop.C.dot(x) + loop.D);
    x = loop.A * x + loop.B;
  }
  return response;
}

StepResponse simulate_prompt(Closed loop, double duration) {
  const double dt = duration / kSteps;
  if (loop.A.rows() > 0) {
    ContinuousLti plant;
    plant.A = loop.A;
    plant.B = loop.B;
    const DiscreteLti sampled = discretize_zoh(plant, dt);
    loop.A = sampled.A;
    loop.B = sampled.B;
  }
  return simulate_samples(loop, dt, kSteps + 1);
}

/// x⁺ = Φ x + Γ₀ v + Γ₁ v⁺ for linear interpolation from v to v⁺: the zero-order hold of the plant
/// that is augmented by v as a state with a constant derivative.
struct Ramp {
  MatrixXd Phi;
  VectorXd Gamma0, Gamma1, held;  ///< held: ∫ e^(Aτ) dτ Bw
};

Ramp ramp(const Feedback& f, double dt) {
  const Index n = f.A.rows();
  ContinuousLti driven;
  driven.A = MatrixXd::Zero(n + 1, n + 1);
  driven.A.topRows(n) << f.A, f.Bv;
  driven.B = MatrixXd::Zero(n + 1, 2);
  driven.B.col(1).head(n) = f.Bw;
  driven.B(n, 0) = 1;
  const DiscreteLti sampled = discretize_zoh(driven, dt);
  const VectorXd slope = sampled.B.col(0).head(n) / dt;
  return {sampled.A.topLeftCorner(n, n), sampled.A.col(n).head(n) - slope, slope,
          sampled.B.col(1).head(n)};
}

/// Simulates with a step of which the delay is an integer multiple. Every jump then occurs at a
/// time step, where the signals have a value before and a value after it.
StepResponse simulate_delayed(const Feedback& f, double delay, double duration) {
  const double parts = std::ceil(delay / (duration / kSteps));
  const auto late = static_cast<std::size_t>(std::clamp(parts, 1.0, kMaxSteps / 2.0));
  const double dt = delay / static_cast<double>(late);
  const auto count = static_cast<std::size_t>(std::min(duration / dt, double(kMaxSteps))) + 1;
  const Ramp step = ramp(f, dt);
  std::vector<double> before(count + 1);  // q before a time step
  std::vector<double> after(count + 1);   // q after it
  StepResponse response;
  response.t.reserve(2 * count);
  response.y.reserve(2 * count);
  VectorXd x = VectorXd::Zero(f.A.rows());
  for (std::size_t k = 0; k < count; ++k) {
    const double v_before = k > late ? before[k - late] : 0;  // q was 0 until the step
    const double v_after = k >= late ? after[k - late] : 0;
    before[k] = k == 0 ? 0 : f.Cq.row(0).dot(x) + f.Dqv(0, 0) * v_before + f.Dqw[0];
    after[k] = f.Cq.row(0).dot(x) + f.Dqv(0, 0) * v_after + f.Dqw[0];
    const auto output = [&](double v) { return f.Cz.dot(x) + f.Dzv[0] * v + f.Dzw; };
    if (v_before != v_after) {
      response.t.push_back(static_cast<double>(k) * dt);
      response.y.push_back(output(v_before));
    }
    response.t.push_back(static_cast<double>(k) * dt);
    response.y.push_back(output(v_after));
    const double v_next = k + 1 > late ? before[k + 1 - late] : 0;
    x = (step.Phi * x + step.Gamma0 * v_after + step.Gamma1 * v_next + step.held).eval();
  }
  return response;
}

// --- duration ------------------------------------------------------------------------------------

using Simulation = std::function<StepResponse(double)>;

/// The time after which the response stays close to its last value [s].
double settling_time(const StepResponse& response) {
  const double end = response.y.back();
  double largest = 0;
  for (const double y : response.y) largest = std::max(largest, std::abs(y - end));
  for (std::size_t k = response.y.size(); k > 0; --k)
    if (!(std::abs(response.y[k - 1] - end) <= kSettled * largest)) return response.t[k - 1];
  return 0;
}

/// Shortens a sufficient duration to one that shows the transient well.
StepResponse settled(const Simulation& simulate, double duration, double min) {
  constexpr int kMaxTries = 40;
  StepResponse response = simulate(duration);
  for (int i = 0; i < kMaxTries; ++i) {
    const double t = settling_time(response);
    const bool shorten = t < 0.5 * duration && duration > 1.5 * min;
    const bool lengthen = t > 0.9 * duration && i < 8;
    if (!shorten && !lengthen) break;
    duration = lengthen ? 2 * duration : std::max({1.5 * t, duration / 50, min});
    response = simulate(duration);
  }
  return response;
}

/// The number of values up to the n-th extremum; all values if there are fewer.
std::size_t after_turns(const StepResponse& response, int n) {
  const std::vector<double>& y = response.y;
  for (std::size_t k = 2; k < y.size(); ++k)
    if ((y[k] - y[k - 1]) * (y[k - 1] - y[k - 2]) < 0 && --n == 0) return k;
  return y.size();
}

/// The response until it exceeds the limit, or has oscillated often enough.
StepResponse cut_off(StepResponse response) {
  const auto left = std::find_if(response.y.begin(), response.y.end(),
                                 [](double y) { return !(std::abs(y) <= kLeft); });
  const auto values = static_cast<std::size_t>(left - response.y.begin()) + 1;
  const std::size_t count = std::min({values, after_turns(response, kMaxTurns), response.y.size()});
  response.t.resize(count);
  response.y.resize(count);
  return response;
}

/// Extends the duration until the response exceeds the limit or has oscillated often enough.
StepResponse diverging(const Simulation& simulate, double duration) {
  constexpr int kMaxTries = 24;
  StepResponse response = cut_off(simulate(duration));
  for (int i = 0; i < kMaxTries && response.t.back() >= 0.9 * duration; ++i) {
    if (!(std::abs(response.y.back()) <= kLeft)) break;
    duration *= 2;
    response = cut_off(simulate(duration));
  }
  return simulate(response.t.back() > 0 ? response.t.back() : duration);
}

/// Time constants of the fastest and of the slowest pole of the closed loop [s].
struct TimeConstants {
  double min = std::numeric_limits<double>::infinity();
  double max = 0;
};

TimeConstants time_constants(const OpenLoop& loop) {
  TimeConstants found;
  Eigen::VectorXcd poles = loop.closed_loop_poles();
  if (loop.discrete()) poles = (poles.array().log() / loop.dt()).matrix().eval();
  double fastest = 0;
  for (const std::complex<double>& pole : poles)
    if (std::isfinite(std::abs(pole))) fastest = std::max(fastest, std::abs(pole));
  for (const std::complex<double>& pole : poles) {
    if (!std::isfinite(std::abs(pole))) continue;
    // A pole that is smaller than rounding relative to the fastest is not a motion.
    if (std::abs(pole) > 1e-10 * fastest) found.min = std::min(found.min, 1 / std::abs(pole));
    const double decay = std::max(std::abs(pole.real()), 1e-3 * std::abs(pole));
    if (decay > 1e-10 * fastest) found.max = std::max(found.max, 1 / decay);
  }
  if (!std::isfinite(found.min)) found.min = std::max(loop.dt(), loop.delay());
  if (!(found.min > 0)) found.min = 1;
  found.max = std::max(found.max, found.min);
  return found;
}

StepResponse chosen_duration(const OpenLoop& loop, const Simulation& simulate) {
  const TimeConstants constants = time_constants(loop);
  const double min = 5 * (loop.dt() + loop.delay()) + 1e-3 * constants.min;
  return internal::closed_loop_is_stable(loop)
             ? settled(simulate, 10 * constants.max + 20 * (loop.dt() + loop.delay()), min)
             : diverging(simulate, 5 * constants.min + min);
}

void require_duration(double duration) {
  if (!(duration >= 0) || !std::isfinite(duration))
    throw InvalidInput("step response",
                       fmt::format("duration is {} s, expected a finite number >= 0", duration));
}

}  // namespace

StepResponse step_response(const OpenLoop& loop, Index channel, double duration) {
  if (channel < 0 || channel >= loop.size())
    throw InvalidInput("step response",
                       fmt::format("channel is {}, expected 0 to {}", channel, loop.size() - 1));
  require_duration(duration);
  const Feedback feedback = set_point_feedback(loop, channel);
  const Simulation simulate = [&](double T) {
    if (loop.delay() > 0) return simulate_delayed(feedback, loop.delay(), T);
    if (!loop.discrete()) return simulate_prompt(close(feedback), T);
    const double samples = std::clamp(std::round(T / loop.dt()), 5.0, double(kMaxSteps));
    return simulate_samples(close(feedback), loop.dt(), static_cast<Index>(samples) + 1);
  };
  return duration > 0 ? simulate(duration) : chosen_duration(loop, simulate);
}

StepResponse load_step_response(const ContinuousTransferFunction& plant, const PidGains& gains,
                                double duration) {
  require_duration(duration);
  const OpenLoop loop(loop_of(plant, gains));
  const Feedback feedback = load_feedback(plant, gains);
  const Simulation simulate = [&](double T) {
    return plant.delay > 0 ? simulate_delayed(feedback, plant.delay, T)
                           : simulate_prompt(close(feedback), T);
  };
  return duration > 0 ? simulate(duration) : chosen_duration(loop, simulate);
}

}  // namespace quadtune
