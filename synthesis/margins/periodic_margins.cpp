// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <cmath>
#include <complex>

#include "margins/channel_response.hpp"
#include "margins/loop_grid.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/synthesis/periodic_loop.hpp"

namespace quadtune {
namespace {

using Complex = std::complex<double>;
using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Eigen::VectorXcd;

}  // namespace

/// With P(k, j) = A[k-1] … A[j] and λ = e^(jw dt): the periodic state is x[0] = (λ^N - P(N, 0))⁻¹
/// Σ_j λ^j P(N, j+1) B[j], and the mean output 1/N Σ_k λ^-k C P(k, 0) x[0] + Σ_m λ^-m h[m],
/// h[m] = 1/N Σ_{k ≥ m} C P(k, k-m+1) B[k-m].
struct MeanResponse::Reduced {
  double dt = 0;
  Index inputs = 0, outputs = 0;
  MatrixXcd T;                   ///< P(N, 0) in Schur form, U T Uᴴ
  MatrixXcd enter;               ///< Uᴴ P(N, j+1) B[j], N columns for each input
  MatrixXcd leave;               ///< C P(k, 0) U / N, the rows of step k below those of k - 1
  std::vector<MatrixXd> within;  ///< h[m]; h[0] is 0
};

MeanResponse::MeanResponse(const PeriodicLti& plant) : reduced_(std::make_unique<Reduced>()) {
  validate(plant, "mean response");
  const std::size_t N = plant.period();
  const Index nx = plant.A.front().rows();
  Reduced& r = *reduced_;
  r.dt = plant.dt;
  r.inputs = plant.B.front().cols();
  r.outputs = plant.C.rows();
  const double share = 1 / static_cast<double>(N);
  MatrixXd whole = MatrixXd::Identity(nx, nx);
  MatrixXd leave(static_cast<Index>(N) * r.outputs, nx);
  for (std::size_t k = 0; k < N; ++k) {
    leave.middleRows(static_cast<Index>(k) * r.outputs, r.outputs) = share * plant.C * whole;
    whole = (plant.A[k] * whole).eval();
  }
  const Eigen::ComplexSchur<MatrixXd> schur(whole);
  r.T = schur.matrixT();
  r.leave = leave * schur.matrixU();
  r.enter.resize(nx, static_cast<Index>(N) * r.inputs);
  r.within.assign(N, MatrixXd::Zero(r.outputs, r.inputs));
  for (std::size_t j = 0; j < N; ++j) {
    MatrixXd moved = plant.B[j];  // P(k, j+1) B[j], k = j + 1
    for (std::size_t k = j + 1; k < N; ++k) {
      r.within[k - j] += share * plant.C * moved;
      moved = (plant.A[k] * moved).eval();
    }
    const MatrixXcd arrived = schur.matrixU().adjoint() * moved;
    for (Index i = 0; i < r.inputs; ++i)
      r.enter.col(i * static_cast<Index>(N) + static_cast<Index>(j)) = arrived.col(i);
  }
}

MeanResponse::~MeanResponse() = default;
MeanResponse::MeanResponse(MeanResponse&&) noexcept = default;
MeanResponse& MeanResponse::operator=(MeanResponse&&) noexcept = default;

MatrixXcd MeanResponse::at(double w) const {
  const Reduced& r = *reduced_;
  const auto N = static_cast<Index>(r.within.size());
  const Complex step = std::polar(1.0, w * r.dt);
  VectorXcd turn(N);  // λ^k
  turn(0) = 1;
  for (Index k = 1; k < N; ++k) turn(k) = turn(k - 1) * step;
  MatrixXcd x(r.T.rows(), r.inputs);
  for (Index i = 0; i < r.inputs; ++i) x.col(i).noalias() = r.enter.middleCols(i * N, N) * turn;
  MatrixXcd shifted = -r.T;
  shifted.diagonal().array() += std::polar(1.0, w * r.dt * static_cast<double>(N));
  shifted.triangularView<Eigen::Upper>().solveInPlace(x);
  const MatrixXcd left = r.leave * x;
  MatrixXcd y = MatrixXcd::Zero(r.outputs, r.inputs);
  for (Index k = 0; k < N; ++k)
    y += std::conj(turn(k)) * (left.middleRows(k * r.outputs, r.outputs) +
                               r.within[static_cast<std::size_t>(k)].cast<Complex>());
  return y;
}

LoopMargins loop_margins(const PeriodicLti& loop, double skew) {
  validate(loop, "loop_margins");
  if (loop.C.rows() != 1 || loop.B.front().cols() != 1)
    throw InvalidInput("loop_margins",
                       fmt::format("the loop has {} inputs and {} outputs, expected one channel",
                                   loop.B.front().cols(), loop.C.rows()));
  if (!std::isfinite(skew))
    throw InvalidInput("loop_margins", fmt::format("skew is {}, expected a finite number", skew));
  // S is the response from a signal added at the cut to the input of the plant: 1 minus the fed
  // back signal.
  const auto closing = [](const PeriodicLti& open) {
    PeriodicLti result = open;
    result.A = closed(open);
    return result;
  };
  // If no state is part of the loop, keep any.
  PeriodicLti part = loop_part(loop);
  if (part.C.cols() == 0) part = loop;
  const PeriodicLti closed_loop = closing(part);
  const MeanResponse response_of_closed(closed_loop);
  PeriodicLti reversed = closed_loop;
  for (MatrixXd& A : reversed.A) A = A.reverse().eval();
  for (MatrixXd& B : reversed.B) B = B.colwise().reverse().eval();
  reversed.C = part.C.rowwise().reverse().eval();
  const MeanResponse again(reversed);
  const VectorXcd poles = periodic_poles(closed(loop));
  internal::ChannelResponse response;
  response.sensitivity = [&](double w) { return 1.0 - response_of_closed.at(w)(0, 0); };
  // The mean response of the open loop has poles at the multiples of 2π/(N dt) for each integrator,
  // as narrow as rounding; that of the closed loop does not.
  response.at = [&](double w) { return 1.0 / response.sensitivity(w) - 1.0; };
  response.again = [&](double w) { return 1.0 / (1.0 - again.at(w)(0, 0)) - 1.0; };
  response.grid = internal::loop_grid(
      {.roots = {periodic_poles(part.A), periodic_poles(closed_loop.A)}, .dt = loop.dt});
  response.discrete = true;
  response.stable =
      poles.size() == 0 || std::log(poles.cwiseAbs().maxCoeff()) <= kNeutralGrowth * loop.dt;
  return internal::margins_of(response, skew);
}

}  // namespace quadtune
