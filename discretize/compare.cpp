// SPDX-License-Identifier: Apache-2.0
#include "quadtune/discretize/compare.hpp"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

#include "quadtune/discretize/matched.hpp"
#include "quadtune/discretize/zoh.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/frequency_response.hpp"
#include "quadtune/internal/border.hpp"

namespace quadtune {
namespace {

using Complex = std::complex<double>;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXcd;

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr const char* kWhere = "compare";

double spectral_radius(const MatrixXd& A) {
  return A.rows() > 0 ? A.eigenvalues().cwiseAbs().maxCoeff() : 0;
}

/// The relative error of a pole s that became z.
double moved(Complex s, Complex z, double dt) {
  const double size = std::abs(s) * dt;
  const double distance = std::abs(std::log(z * std::exp(-s * dt)));
  return size > 0 ? distance / size : distance / dt;
}

/// The smallest relative error between s and any pole of `sampled`.
double nearest_of(Complex s, const VectorXcd& sampled, double dt) {
  double nearest = kInfinity;
  for (const Complex& z : sampled)
    if (std::abs(z) > 0) nearest = std::min(nearest, moved(s, z, dt));
  return nearest;
}

/// Matches each pole with the nearest pole of the other system, in both directions. Poles that
/// decay to less than 1e-6 within a sample, and delays, have no accurate digits and are excluded.
double pole_error(const VectorXcd& continuous, const VectorXcd& sampled, double dt) {
  constexpr double kGone = 1e-6;
  double error = 0;
  for (const Complex& s : continuous)
    if (std::exp(s.real() * dt) > kGone) error = std::max(error, nearest_of(s, sampled, dt));
  for (const Complex& z : sampled) {
    if (std::abs(z) < kGone) continue;
    double nearest = kInfinity;
    for (const Complex& s : continuous) nearest = std::min(nearest, moved(s, z, dt));
    error = std::max(error, nearest);
  }
  return error;
}

/// Responses of every channel to a step of its own input.
class Steps {
 public:
  explicit Steps(const DiscreteLti& plant)
      : plant_(plant), x_(MatrixXd::Zero(plant.A.rows(), plant.B.cols())) {}

  /// Returns the outputs of this sample and advances to the next.
  Eigen::VectorXd next() {
    const Index channels = plant_.B.cols();
    Eigen::VectorXd y(channels);
    for (Index i = 0; i < channels; ++i)
      y(i) = plant_.C.row(i).dot(x_.col(i)) + (plant_.D.size() > 0 ? plant_.D(i, i) : 0);
    x_ = (plant_.A * x_ + plant_.B).eval();
    return y;
  }

 private:
  const DiscreteLti& plant_;
  MatrixXd x_;  ///< one column per channel
};

double step_error(const ContinuousLti& loop, const DiscreteLti& sampled, double slowest) {
  const DiscreteLti exact = discretize_zoh(loop, sampled.dt);
  constexpr double kDied = 7;  // time constants: 1e-3
  constexpr double kMax = 20000;
  const double samples = std::clamp(std::ceil(kDied / (slowest * sampled.dt)), 10.0, kMax);
  Steps here(sampled);
  Steps there(exact);
  const Index channels = loop.B.cols();
  Eigen::VectorXd error = Eigen::VectorXd::Zero(channels);
  Eigen::VectorXd size = Eigen::VectorXd::Zero(channels);
  for (int k = 0; k < static_cast<int>(samples); ++k) {
    const Eigen::VectorXd y = there.next();
    error = error.cwiseMax((here.next() - y).cwiseAbs());
    size = size.cwiseMax(y.cwiseAbs());
  }
  return (error.array() / size.array()).maxCoeff();
}

double frequency_error(const ContinuousLti& loop, const DiscreteLti& sampled, double slowest) {
  const FrequencyResponse exact(loop);
  const FrequencyResponse response(sampled);
  const double nyquist = std::numbers::pi / sampled.dt;
  const double lowest = std::min(0.01 * slowest, 0.1 * nyquist);
  constexpr int kPoints = 400;
  const Index channels = loop.B.cols();
  Eigen::VectorXd error = Eigen::VectorXd::Zero(channels);
  Eigen::VectorXd size = Eigen::VectorXd::Zero(channels);
  for (int k = 0; k <= kPoints; ++k) {
    const double w = lowest * std::pow(nyquist / lowest, double(k) / kPoints);
    const VectorXcd G = exact.at(w).diagonal();
    error = error.cwiseMax((response.at(w).diagonal() - G).cwiseAbs());
    size = size.cwiseMax(G.cwiseAbs());
  }
  return (error.array() / size.array()).maxCoeff();
}

/// The states that can be reached from `from` through nonzero entries of A.
std::vector<bool> reached(const Eigen::Matrix<bool, -1, -1>& linked, std::vector<bool> from) {
  bool changed = true;
  while (changed) {
    changed = false;
    for (Index j = 0; j < linked.cols(); ++j) {
      if (!from[static_cast<std::size_t>(j)]) continue;
      for (Index i = 0; i < linked.rows(); ++i)
        if (linked(i, j) && !from[static_cast<std::size_t>(i)]) {
          from[static_cast<std::size_t>(i)] = true;
          changed = true;
        }
    }
  }
  return from;
}

/// The entries that exceed rounding.
Eigen::Matrix<bool, -1, -1> pattern(const MatrixXd& M) {
  const double rounding =
      M.size() > 0 ? std::numeric_limits<double>::epsilon() * M.cwiseAbs().maxCoeff() : 0;
  return (M.cwiseAbs().array() > rounding).matrix();
}

std::vector<bool> as_list(const Eigen::Matrix<bool, -1, -1>& entries) {
  std::vector<bool> list;
  list.reserve(static_cast<std::size_t>(entries.size()));
  for (Index i = 0; i < entries.size(); ++i) list.push_back(entries(i));
  return list;
}

/// Combines systems in parallel without coupling.
DiscreteLti beside(const std::vector<DiscreteLti>& parts, double dt) {
  Index n = 0;
  for (const DiscreteLti& part : parts) n += part.A.rows();
  const auto channels = static_cast<Index>(parts.size());
  DiscreteLti all;
  all.dt = dt;
  all.A = MatrixXd::Zero(n, n);
  all.B = MatrixXd::Zero(n, channels);
  all.C = MatrixXd::Zero(channels, n);
  all.D = MatrixXd::Zero(channels, channels);
  Index at = 0;
  for (Index i = 0; i < channels; ++i) {
    const DiscreteLti& part = parts[static_cast<std::size_t>(i)];
    const Index size = part.A.rows();
    all.A.block(at, at, size, size) = part.A;
    all.B.block(at, i, size, 1) = part.B;
    all.C.block(i, at, 1, size) = part.C;
    if (part.D.size() > 0) all.D(i, i) = part.D(0, 0);
    at += size;
  }
  return all;
}

}  // namespace

ContinuousLti channel_of(const ContinuousLti& plant, Index input, Index output) {
  validate(plant, kWhere);
  const MatrixXd C =
      plant.C.size() > 0 ? plant.C : MatrixXd::Identity(plant.A.rows(), plant.A.rows());
  if (input < 0 || input >= plant.B.cols() || output < 0 || output >= C.rows())
    throw InvalidInput(kWhere, fmt::format("input {} and output {} do not exist, expected less "
                                           "than {} and {}",
                                           input, output, plant.B.cols(), C.rows()));
  const Eigen::Matrix<bool, -1, -1> linked = pattern(plant.A);
  const std::vector<bool> driven = reached(linked, as_list(pattern(plant.B.col(input))));
  const std::vector<bool> seen =
      reached(linked.transpose(), as_list(pattern(C.row(output).transpose())));
  std::vector<Index> kept;
  for (Index i = 0; i < plant.A.rows(); ++i)
    if (driven[static_cast<std::size_t>(i)] && seen[static_cast<std::size_t>(i)]) kept.push_back(i);
  /// No state is both reached and observed, but a system must have a state.
  if (kept.empty()) kept.push_back(0);
  ContinuousLti channel;
  channel.A = plant.A(kept, kept);
  channel.B = plant.B(kept, std::vector{input});
  channel.C = C(std::vector{output}, kept);
  channel.D = MatrixXd::Zero(1, 1);
  if (plant.D.size() > 0) channel.D(0, 0) = plant.D(output, input);
  return channel;
}

DiscreteLti discretize_channels(const ContinuousLti& loop, double dt, DiscretizationMethod method) {
  std::vector<DiscreteLti> parts;
  const Index channels = loop.B.cols();
  parts.reserve(static_cast<std::size_t>(channels));
  for (Index i = 0; i < channels; ++i)
    parts.push_back(discretize(channel_of(loop, i, i), dt, method));
  for (DiscreteLti& part : parts)
    if (part.C.size() == 0) part.C = MatrixXd::Identity(part.A.rows(), part.A.rows());
  return beside(parts, dt);
}

SamplingError sampling_error(const ContinuousLti& loop, const DiscreteLti& sampled) {
  validate(loop, kWhere);
  validate(sampled, kWhere);
  const Index channels = loop.B.cols();
  if (loop.C.rows() != channels || sampled.B.cols() != channels || sampled.C.rows() != channels)
    throw InvalidInput(kWhere,
                       fmt::format("{} inputs and {} outputs, sampled {} and {}, expected "
                                   "four equal numbers",
                                   channels, loop.C.rows(), sampled.B.cols(), sampled.C.rows()));
  const VectorXcd poles = loop.A.eigenvalues();
  const double slowest = -poles.real().maxCoeff();
  if (!(slowest > 0))
    throw InvalidInput(kWhere, fmt::format("a pole has real part {:.3g}, expected less than 0 "
                                           "because errors of unstable responses are meaningless",
                                           -slowest));
  const VectorXcd z = sampled.A.eigenvalues();
  SamplingError error;
  error.stable = z.cwiseAbs().maxCoeff() < 1;
  error.pole = pole_error(poles, z, sampled.dt);
  error.step = error.stable ? step_error(loop, sampled, slowest) : kInfinity;
  error.frequency = error.stable ? frequency_error(loop, sampled, slowest) : kInfinity;
  return error;
}

double stability_limit(const VectorXcd& poles, DiscretizationMethod method) {
  if (method != DiscretizationMethod::euler) return kInfinity;
  double limit = kInfinity;
  for (const Complex& s : poles)
    if (std::abs(s) > 0) limit = std::min(limit, std::max(0.0, -2 * s.real() / std::norm(s)));
  return limit;
}

double stability_limit(const std::function<MatrixXd(double)>& sampled, double dt, double longest) {
  const auto stable = [&](double period) { return spectral_radius(sampled(period)) < 1; };
  constexpr double kStep = 1.0625;
  constexpr double kReach = 1e4;
  double low = dt;
  double high = dt;
  if (stable(dt)) {
    while (stable(high)) {
      low = high;
      if (low >= longest) return kInfinity;
      high = std::min(kStep * high, std::max(longest, dt));
    }
  } else {
    while (!stable(low)) {
      high = low;
      low /= kStep;
      if (low * kReach < dt) return 0;
    }
  }
  return internal::border(stable, low, high, 1e-9).holds;
}

}  // namespace quadtune
