// SPDX-License-Identifier: Apache-2.0
#include "quadtune/synthesis/uncertain_loop.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "certify/enclosed_hold.hpp"
#include "certify/enclosed_loop.hpp"
#include "lyapunov/eigenvalues.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/matrix_checks.hpp"

namespace quadtune {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using internal::EnclosedBox;
using internal::Enclosure;
using internal::NumberEnclosure;

/// The matrices of the plant over one period: for its states, and for the outputs of the law that
/// are applied in it.
template <class Matrix>
struct Period {
  Matrix Phi;    ///< factor of x[k]
  Matrix early;  ///< factor of u[k-past], applied before the next output
  Matrix last;   ///< factor of u[k-past+1]; the only one if past = 0
};

/// The rows [D C] and [B A] of the law over [x i].
MatrixXd output_rows(const DiscreteLti& law) {
  MatrixXd rows(law.D.rows(), law.D.cols() + law.A.rows());
  rows << law.D, law.C;
  return rows;
}
MatrixXd memory_rows(const DiscreteLti& law) {
  MatrixXd rows(law.A.rows(), law.B.cols() + law.A.rows());
  rows << law.B, law.A;
  return rows;
}

/// Computes the enclosed matrix of one period of the closed loop with the states
/// [x; i; u[k-1] … u[k-past]].
Enclosure around(const Period<Enclosure>& period, const DiscreteLti& law, int past) {
  const Index nx = period.Phi.rows();
  const Index nu = law.D.rows();
  const Index now = nx + law.A.rows();  // number of states other than past outputs
  const Index n = now + past * nu;
  const Enclosure u(output_rows(law));
  Enclosure M(MatrixXd(MatrixXd::Zero(n, n)));
  const auto put = [&](Index row, Index column, const Enclosure& block) {
    M.mid.block(row, column, block.rows(), block.cols()) = block.mid;
    M.rad.block(row, column, block.rows(), block.cols()) = block.rad;
  };
  put(0, 0, period.Phi);
  put(nx, 0, Enclosure(memory_rows(law)));
  if (past <= 1) {
    // u[k-past+1], or without delay u[k-past], is the current output of the law.
    const Enclosure Bu = period.last * u;
    M.mid.topLeftCorner(nx, now) += Bu.mid;
    M.rad.topLeftCorner(nx, now) += Bu.rad + 0x1p-52 * M.mid.topLeftCorner(nx, now).cwiseAbs();
    M.rad = internal::bounded_above(M.rad);
  } else {
    put(0, now + (past - 2) * nu, period.last);
  }
  if (past == 0) return M;
  put(0, now + (past - 1) * nu, period.early);
  put(now, 0, u);
  for (Index j = 1; j < past; ++j)
    put(now + j * nu, now + (j - 1) * nu, Enclosure(MatrixXd(MatrixXd::Identity(nu, nu))));
  return M;
}

/// The same for matrices of bounds ≥ 0. `with_law` includes the rows of the law itself.
MatrixXd around(const Period<MatrixXd>& period, const DiscreteLti& law, int past, bool with_law) {
  const Index nx = period.Phi.rows();
  const Index nu = law.D.rows();
  const Index now = nx + law.A.rows();
  const MatrixXd u = output_rows(law).cwiseAbs();
  MatrixXd M = MatrixXd::Zero(now + past * nu, now + past * nu);
  M.topLeftCorner(nx, nx) = period.Phi;
  if (past <= 1)
    M.topLeftCorner(nx, now) += period.last * u;
  else
    M.block(0, now + (past - 2) * nu, nx, nu) += period.last;
  if (past > 0) M.block(0, now + (past - 1) * nu, nx, nu) = period.early;
  if (with_law) {
    M.block(nx, 0, law.A.rows(), now) = memory_rows(law).cwiseAbs();
    if (past > 0) M.block(now, 0, nu, now) = u;
    for (Index j = 1; j < past; ++j)
      M.block(now + j * nu, now + (j - 1) * nu, nu, nu) = MatrixXd::Identity(nu, nu);
  }
  return internal::bounded_above(M);
}

/// A + Σ θ_j A_j and B + Σ θ_j B_j.
struct EnclosedPlant {
  Enclosure A, B;
};

EnclosedPlant plant_at(const UncertainLoop& loop, const VectorXd& numbers) {
  EnclosedPlant plant{Enclosure(loop.plant.A), Enclosure(loop.plant.B)};
  for (std::size_t j = 0; j < loop.terms.size(); ++j) {
    const NumberEnclosure number{numbers(static_cast<Index>(j)), 0};
    const PlantTerm& term = loop.terms[j];
    if (term.A.size() > 0) plant.A = plant.A + number * Enclosure(term.A);
    if (term.B.size() > 0) plant.B = plant.B + number * Enclosure(term.B);
  }
  return plant;
}

/// Upper bounds of |A| and |B| over the box.
struct PlantSize {
  MatrixXd A, B;
};

PlantSize plant_size(const UncertainLoop& loop, const EnclosedBox& box) {
  PlantSize size{loop.plant.A.cwiseAbs(), loop.plant.B.cwiseAbs()};
  for (std::size_t j = 0; j < loop.terms.size(); ++j) {
    const auto i = static_cast<Index>(j);
    const double max = std::max(std::abs(box.low(i)), std::abs(box.high(i)));
    const PlantTerm& term = loop.terms[j];
    if (term.A.size() > 0) size.A += max * term.A.cwiseAbs();
    if (term.B.size() > 0) size.B += max * term.B.cwiseAbs();
  }
  return {internal::bounded_above(size.A), internal::bounded_above(size.B)};
}

/// [A B; 0 0]; its exponential contains both matrices of a hold.
MatrixXd augmented(const MatrixXd& A, const MatrixXd& B) {
  MatrixXd Z = MatrixXd::Zero(A.rows() + B.cols(), A.rows() + B.cols());
  Z.topRows(A.rows()) << A, B;
  return Z;
}

MatrixXd or_zero(const MatrixXd& M, Index rows, Index cols) {
  return M.size() > 0 ? M : MatrixXd::Zero(rows, cols);
}

void require_term(const PlantTerm& term, Index nx, Index nu, const std::string& where) {
  if (term.A.size() > 0) {
    require_shape(term.A, nx, nx, where, "A of " + term.name, "the plant's A");
    require_finite(term.A, where, "A of " + term.name);
  }
  if (term.B.size() > 0) {
    require_shape(term.B, nx, nu, where, "B of " + term.name, "the plant's B");
    require_finite(term.B, where, "B of " + term.name);
  }
}

int past_outputs(double delay, double dt) { return static_cast<int>(std::ceil(delay / dt)); }

}  // namespace

void validate(const UncertainLoop& loop, const std::string& where) {
  validate(loop.plant, where);
  const Index nx = loop.plant.A.rows();
  const Index nu = loop.plant.B.cols();
  const Index ni = loop.law.A.rows();
  for (const PlantTerm& term : loop.terms) require_term(term, nx, nu, where);
  require_shape(loop.law.A, ni, ni, where, "the law's A", "one row per column");
  require_shape(loop.law.B, ni, nx, where, "the law's B", "the plant's states");
  require_shape(loop.law.C, nu, ni, where, "the law's C", "the plant's inputs");
  require_shape(loop.law.D, nu, nx, where, "the law's D", "the plant's inputs and states");
  for (const MatrixXd* M : {&loop.law.A, &loop.law.B, &loop.law.C, &loop.law.D})
    require_finite(*M, where, "the law");
  if (!(loop.law.dt > 0) || !std::isfinite(loop.law.dt))
    throw InvalidInput(where, fmt::format("the law's dt is {} s, expected more than 0 because the "
                                          "loop is sampled",
                                          loop.law.dt));
}

void validate(const LoopBox& box, const UncertainLoop& loop, const std::string& where) {
  const auto count = static_cast<Index>(loop.terms.size());
  if (box.low.size() != count || box.high.size() != count)
    throw InvalidInput(where,
                       fmt::format("there are {} lower and {} upper bounds, expected {} of each",
                                   box.low.size(), box.high.size(), count));
  for (Index i = 0; i < count; ++i)
    if (!(box.low(i) <= box.high(i)) || !std::isfinite(box.low(i)) || !std::isfinite(box.high(i)))
      throw InvalidInput(
          where,
          fmt::format("{} is in {} … {}, expected finite bounds in increasing order",
                      loop.terms[static_cast<std::size_t>(i)].name, box.low(i), box.high(i)));
  if (!(box.delay_low >= 0) || !(box.delay_low <= box.delay_high) ||
      !(box.delay_high <= kMaxDelayPeriods * loop.law.dt))
    throw InvalidInput(where,
                       fmt::format("the delay is in {} … {} s, expected bounds in "
                                   "increasing order from 0 to {} periods of {} s",
                                   box.delay_low, box.delay_high, kMaxDelayPeriods, loop.law.dt));
}

MatrixXd closed_loop_matrix(const UncertainLoop& loop, const VectorXd& numbers, double delay) {
  validate(loop, "closed_loop_matrix");
  validate(LoopBox{numbers, numbers, delay, delay}, loop, "closed_loop_matrix");
  const int past = past_outputs(delay, loop.law.dt);
  return internal::enclosed_loop(loop, numbers, past * loop.law.dt - delay, past).mid;
}

double spectral_radius(const UncertainLoop& loop, const VectorXd& numbers, double delay) {
  const VectorXd moduli =
      internal::eigenvalues(closed_loop_matrix(loop, numbers, delay)).cwiseAbs();
  const bool known = moduli.size() > 0 && moduli.allFinite();
  return known ? moduli.maxCoeff() : std::numeric_limits<double>::infinity();
}

namespace internal {

// The interval of `ahead` is widened by the rounding error of past dt - delay.
std::vector<EnclosedBox> same_states(const LoopBox& box, double dt) {
  std::vector<EnclosedBox> parts;
  if (box.delay_high == 0) return {EnclosedBox{box.low, box.high, 0, 0, 0}};
  const int first = std::max(1, past_outputs(box.delay_low, dt));
  const int last = std::max(first, past_outputs(box.delay_high, dt));
  for (int past = first; past <= last; ++past) {
    const double rounding = 0x1p-50 * past * dt;
    const double high = past == first ? past * dt - box.delay_low + rounding : dt;
    const double low = past == last ? past * dt - box.delay_high - rounding : 0;
    parts.push_back({box.low, box.high, std::clamp(low, 0.0, dt), std::clamp(high, 0.0, dt), past});
  }
  return parts;
}

Enclosure enclosed_loop(const UncertainLoop& loop, const VectorXd& numbers, double ahead,
                        int past) {
  const EnclosedPlant plant = plant_at(loop, numbers);
  const EnclosedHold whole = enclosed_hold(plant.A, {loop.law.dt, 0});
  const Enclosure all = whole.Gamma * plant.B;
  if (past == 0) return around({whole.Phi, Enclosure(), all}, loop.law, 0);
  const Enclosure last = enclosed_hold(plant.A, {ahead, 0}).Gamma * plant.B;
  return around({whole.Phi, all - last, last}, loop.law, past);
}

// ∂²/∂a² ∫₀^a e^(Aτ) dτ B = A e^(Aa) B. A parameter that affects A makes e^([A B; 0 0] t)
// nonlinear; a parameter that affects only B does not.
std::vector<MatrixXd> interpolation_errors(const UncertainLoop& loop, const EnclosedBox& box) {
  const Index nx = loop.plant.A.rows();
  const Index nu = loop.plant.B.cols();
  const PlantSize size = plant_size(loop, box);
  std::vector<MatrixXd> errors;
  for (std::size_t j = 0; j < loop.terms.size(); ++j) {
    const auto i = static_cast<Index>(j);
    const double width = bounded_above(box.high(i) - box.low(i));
    const PlantTerm& term = loop.terms[j];
    MatrixXd bend = MatrixXd::Zero(nx + nu, nx + nu);
    if (term.A.size() > 0 && box.high(i) > box.low(i))
      bend = (width * width / 8) *
             exponential_curvature(augmented(size.A, size.B),
                                   augmented(term.A.cwiseAbs(), or_zero(term.B, nx, nu).cwiseAbs()),
                                   loop.law.dt);
    const MatrixXd held = bend.topRightCorner(nx, nu);
    errors.push_back(
        around({bend.topLeftCorner(nx, nx), 2 * held, held}, loop.law, box.past, false));
  }
  MatrixXd ahead = MatrixXd::Zero(nx, nu);
  const double across = bounded_above(box.ahead_high - box.ahead_low);
  if (box.past > 0 && box.ahead_high > box.ahead_low)
    ahead = bounded_above(size.A * hold_size(size.A, box.ahead_high).Phi * size.B *
                          (across * across / 8));
  errors.push_back(around({MatrixXd::Zero(nx, nx), ahead, ahead}, loop.law, box.past, false));
  return errors;
}

MatrixXd loop_size(const UncertainLoop& loop, const EnclosedBox& box) {
  const PlantSize size = plant_size(loop, box);
  const HoldSize hold = hold_size(size.A, loop.law.dt);
  const MatrixXd all = hold.Gamma * size.B;
  return around({hold.Phi, all, all}, loop.law, box.past, true);
}

// If the entries that couple two parts are multiplied by s, every path through another part has a
// factor of at least s². The series of the absolute values has no negative coefficients, so that
// its increase from s = 0 to s = 1 is at most half its second derivative at s = 1. If there are no
// past outputs, a path may also leave through the plant and return through the law.
MatrixXd detour_size(const UncertainLoop& loop, const EnclosedBox& box, const PartNumbers& part) {
  const Index nx = loop.plant.A.rows();
  const Index nu = loop.plant.B.cols();
  const PlantSize size = plant_size(loop, box);
  const auto between = [](MatrixXd M, const Eigen::VectorXi& rows, const Eigen::VectorXi& cols) {
    for (Index i = 0; i < M.rows(); ++i)
      for (Index j = 0; j < M.cols(); ++j)
        if (rows(i) == cols(j)) M(i, j) = 0;
    return M;
  };
  const MatrixXd joins = augmented(between(size.A, part.states, part.states),
                                   between(size.B, part.states, part.inputs));
  const MatrixXd back = 0.5 * exponential_curvature(augmented(size.A, size.B), joins, loop.law.dt);
  const MatrixXd held = back.topRightCorner(nx, nu);
  MatrixXd M = around({back.topLeftCorner(nx, nx), held, held}, loop.law, box.past, false);
  if (box.past > 1) return M;
  Eigen::VectorXi seen(nx + part.memory.size());
  seen << part.states, part.memory;
  const MatrixXd out =
      between(hold_size(size.A, loop.law.dt).Gamma * size.B, part.states, part.inputs);
  M.topLeftCorner(nx, seen.size()) +=
      out * between(output_rows(loop.law).cwiseAbs(), part.inputs, seen);
  return bounded_above(M);
}

}  // namespace internal
}  // namespace quadtune
