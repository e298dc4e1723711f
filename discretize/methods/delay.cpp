// SPDX-License-Identifier: Apache-2.0
#include "quadtune/discretize/delay.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "kernel/exponential_kernel.hpp"
#include "kernel/whole_samples.hpp"
#include "methods/period.hpp"
#include "methods/written_out.hpp"
#include "quadtune/discretize/zoh.hpp"
#include "quadtune/errors.hpp"

namespace quadtune {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

// Each sample of delay adds a state, and the matrices of the states are dense.
constexpr double kMaxSamples = 2000;

using internal::Samples;

std::vector<Samples> in_samples(const Eigen::VectorXd& delays, Index channels, double dt,
                                const std::string& what, double& total) {
  std::vector<Samples> all(static_cast<std::size_t>(channels));
  if (delays.size() == 0) return all;
  if (delays.size() != channels)
    throw InvalidInput("delays", fmt::format("{} {} delays, expected {}, one for each {}",
                                             delays.size(), what, channels, what));
  for (Index i = 0; i < channels; ++i) {
    if (!(delays[i] >= 0) || !std::isfinite(delays[i]))
      throw InvalidInput("delays",
                         fmt::format("the delay of {} {} is {} s, expected a finite number of 0 or "
                                     "more because a negative delay is not causal",
                                     what, i + 1, delays[i]));
    total += delays[i] / dt;
    if (total > kMaxSamples)
      throw InvalidInput(
          "delays", fmt::format("the delays, including that of {} {}, add up to {:.6g} samples, "
                                "expected at most {} because each sample is a state",
                                what, i + 1, total, kMaxSamples));
    all[static_cast<std::size_t>(i)] = internal::in_samples(delays[i], dt, "delays");
  }
  return all;
}

struct Delays {
  std::vector<Samples> input;
  std::vector<Samples> output;
};

Delays in_samples(const ChannelDelays& delays, Index nu, Index ny, double dt) {
  double total = 0;
  Delays result;
  result.input = in_samples(delays.input, nu, dt, "input", total);
  result.output = in_samples(delays.output, ny, dt, "output", total);
  return result;
}

/// Names for all states; unnamed ones are numbered, because the added states have names.
std::vector<Signal> named(const std::vector<Signal>& signals, Index count, const char* letter) {
  std::vector<Signal> all = signals;
  for (Index i = std::ssize(all); i < count; ++i)
    all.push_back({letter + std::to_string(i + 1), ""});
  return all;
}

Signal past(const Signal& signal, double samples) {
  return {fmt::format("{}[k-{:.6g}]", signal.name, samples), signal.unit};
}

/// Adds `count` zero states to the plant.
void append_states(DiscreteLti& plant, Index count) {
  const Index n = plant.A.rows();
  plant.A.conservativeResizeLike(MatrixXd::Zero(n + count, n + count));
  plant.B.conservativeResizeLike(MatrixXd::Zero(n + count, plant.B.cols()));
  plant.C.conservativeResizeLike(MatrixXd::Zero(plant.C.rows(), n + count));
}

/// Sets ones in A so that each of `count` states from `first` on copies its predecessor.
void chain(DiscreteLti& plant, Index first, Index count) {
  for (Index i = first; i + 1 < first + count; ++i) plant.A(i + 1, i) = 1;
}

void delay_input(DiscreteLti& plant, Index input, Index samples, const Signal& signal) {
  if (samples == 0) return;
  const Index first = plant.A.rows();
  append_states(plant, samples);
  plant.A.col(first + samples - 1) = plant.B.col(input);
  plant.C.col(first + samples - 1) = plant.D.col(input);
  plant.B.col(input).setZero();
  plant.D.col(input).setZero();
  plant.B(first, input) = 1;
  chain(plant, first, samples);
  for (Index i = 1; i <= samples; ++i) plant.states.push_back(past(signal, static_cast<double>(i)));
}

void delay_output(DiscreteLti& plant, Index output, const Samples& delay, const Signal& signal) {
  if (delay.whole == 0) return;
  const Index first = plant.A.rows();
  append_states(plant, delay.whole);
  plant.A.row(first) = plant.C.row(output);
  plant.B.row(first) = plant.D.row(output);
  plant.C.row(output).setZero();
  plant.D.row(output).setZero();
  plant.C(output, first + delay.whole - 1) = 1;
  chain(plant, first, delay.whole);
  for (Index i = 1; i <= delay.whole; ++i)
    plant.states.push_back(past(signal, static_cast<double>(i) + delay.fraction));
}

void delay_whole_samples(DiscreteLti& plant, const Delays& delays) {
  const std::vector<Signal> inputs = named(plant.inputs, plant.B.cols(), "u");
  const std::vector<Signal> outputs = named(plant.outputs, plant.C.rows(), "y");
  for (std::size_t j = 0; j < delays.input.size(); ++j)
    delay_input(plant, static_cast<Index>(j), delays.input[j].whole, inputs[j]);
  for (std::size_t i = 0; i < delays.output.size(); ++i)
    delay_output(plant, static_cast<Index>(i), delays.output[i], outputs[i]);
}

/// e^(Ah) and ∫₀^h e^(Aτ) dτ b.
struct Exponential {
  MatrixXd E;
  MatrixXd integral;
};

Exponential exponential(const MatrixXd& A, const MatrixXd& b, double h) {
  Exponential result{MatrixXd::Identity(A.rows(), A.rows()), MatrixXd::Zero(b.rows(), b.cols())};
  if (h > 0 && internal::exponential_and_integral(A, b, h, result.E, result.integral) !=
                   ExponentialStatus::solved)
    internal::refuse_long_period(h, "zoh");
  return result;
}

/// The plant at time h after a sample, 0 < h ≤ dt, with delays of fractions of a sample only:
/// x(k dt + h) = E x[k] + before u[k-1] + now u[k]; y likewise with C and the two parts of D.
struct Later {
  MatrixXd E;
  MatrixXd before;    // (nx × nu)
  MatrixXd now;       // (nx × nu)
  MatrixXd D_before;  // (ny × nu): columns of the inputs whose u[k] has not yet arrived
  MatrixXd D_now;
};

Later later(const ContinuousLti& plant, const MatrixXd& D, const std::vector<Samples>& delays,
            double dt, double h) {
  const Index nx = plant.A.rows();
  const Index nu = plant.B.cols();
  Later result{exponential(plant.A, MatrixXd(nx, 0), h).E, MatrixXd::Zero(nx, nu),
               MatrixXd::Zero(nx, nu), MatrixXd::Zero(D.rows(), nu), MatrixXd::Zero(D.rows(), nu)};
  for (Index j = 0; j < nu; ++j) {
    const double acted = h - delays[static_cast<std::size_t>(j)].fraction * dt;
    const bool here = acted >= -internal::kWholeSample * dt;
    (here ? result.D_now : result.D_before).col(j) = D.col(j);
    const double late = std::max(acted, 0.0);
    const Exponential after = exponential(plant.A, plant.B.col(j), late);
    const Exponential first = exponential(plant.A, plant.B.col(j), h - late);
    result.now.col(j) = after.integral;
    result.before.col(j) = after.E * first.integral;  // e^(A(h-φ)) Γ(φ)
  }
  return result;
}

/// The zero-order hold of a plant with delays of fractions of a sample only.
DiscreteLti hold_with_fractions(const ContinuousLti& plant, double dt, const Delays& delays) {
  DiscreteLti result = internal::with_explicit_outputs(plant, dt);
  const MatrixXd C = result.C;
  const MatrixXd D = result.D;
  const std::vector<Signal> inputs = named(plant.inputs, plant.B.cols(), "u");
  const std::vector<Signal> outputs = named(result.outputs, C.rows(), "y");
  result.states = named(plant.states, plant.A.rows(), "x");

  const Later whole = later(plant, D, delays.input, dt, dt);
  result.A = whole.E;
  result.B = whole.now;
  const Index nx = plant.A.rows();
  MatrixXd recall = MatrixXd::Zero(plant.B.cols(), nx);  // u[k-1] as a function of the states
  for (Index j = 0; j < plant.B.cols(); ++j) {
    const Samples& delay = delays.input[static_cast<std::size_t>(j)];
    if (delay.fraction == 0) continue;
    const Index state = result.A.rows();
    append_states(result, 1);
    recall.conservativeResizeLike(MatrixXd::Zero(recall.rows(), state + 1));
    recall(j, state) = 1;
    result.A.col(state).head(nx) = whole.before.col(j);
    result.B(state, j) = 1;
    result.C.col(state) = D.col(j);
    result.D.col(j).setZero();
    result.states.push_back(
        past(inputs[static_cast<std::size_t>(j)], static_cast<double>(delay.whole + 1)));
  }

  const Index known = result.A.rows();
  for (Index i = 0; i < C.rows(); ++i) {
    const Samples& delay = delays.output[static_cast<std::size_t>(i)];
    if (delay.fraction == 0) continue;
    const Later between = later(plant, D, delays.input, dt, (1 - delay.fraction) * dt);
    const Index state = result.A.rows();
    append_states(result, 1);
    // y(k dt + h) becomes visible φ later, at the next sample.
    result.A.row(state).head(nx) = C.row(i) * between.E;
    result.A.row(state).head(known) +=
        (C.row(i) * between.before + between.D_before.row(i)) * recall;
    result.B.row(state) = C.row(i) * between.now + between.D_now.row(i);
    result.C.row(i).setZero();
    result.D.row(i).setZero();
    result.C(i, state) = 1;
    result.states.push_back(past(outputs[static_cast<std::size_t>(i)], delay.fraction));
  }
  internal::refuse_overflow(result, "zoh");
  return result;
}

void refuse_fraction(const std::vector<Samples>& delays, const Eigen::VectorXd& seconds,
                     const char* what, double dt) {
  for (std::size_t i = 0; i < delays.size(); ++i)
    if (delays[i].fraction > 0)
      throw InvalidInput("delays",
                         fmt::format("the delay of {} {} is {} s, expected a whole number of "
                                     "samples of {} s because only zoh is exact for fractions of a "
                                     "sample",
                                     what, i + 1, seconds[static_cast<Index>(i)], dt));
}

}  // namespace

DiscreteLti discretize_zoh(const ContinuousLti& plant, double dt, const ChannelDelays& channels) {
  validate(plant, "zoh");
  internal::require_period(dt, "zoh");
  const Index ny = plant.C.size() ? plant.C.rows() : plant.A.rows();
  const Delays delays = in_samples(channels, plant.B.cols(), ny, dt);
  DiscreteLti result = hold_with_fractions(plant, dt, delays);
  delay_whole_samples(result, delays);
  return result;
}

DiscreteLti with_delays(const DiscreteLti& plant, const ChannelDelays& channels) {
  validate(plant, "delays");
  internal::require_period(plant.dt, "delays");
  const Index nx = plant.A.rows();
  DiscreteLti result = plant;
  if (plant.C.size() == 0) {
    result.C = MatrixXd::Identity(nx, nx);
    result.outputs = plant.states;
  }
  if (plant.D.size() == 0) result.D = MatrixXd::Zero(result.C.rows(), plant.B.cols());
  const Delays delays = in_samples(channels, plant.B.cols(), result.C.rows(), plant.dt);
  refuse_fraction(delays.input, channels.input, "input", plant.dt);
  refuse_fraction(delays.output, channels.output, "output", plant.dt);
  result.states = named(plant.states, nx, "x");
  delay_whole_samples(result, delays);
  return result;
}

}  // namespace quadtune
