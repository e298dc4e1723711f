// SPDX-License-Identifier: Apache-2.0
#include "quadtune/synthesis/periodic_loop.hpp"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <numeric>

#include "quadtune/errors.hpp"

namespace quadtune {
namespace {

using Complex = std::complex<double>;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXcd;

void require_matrix(const MatrixXd& M, Index rows, Index cols, const std::string& name,
                    const std::string& where) {
  if (M.rows() != rows || M.cols() != cols)
    throw InvalidInput(where, fmt::format("{} is {} x {}, expected {} x {}", name, M.rows(),
                                          M.cols(), rows, cols));
  if (!M.allFinite())
    throw InvalidInput(
        where, fmt::format("{} has an entry that is not finite, expected finite numbers", name));
}

using Edges = Eigen::Matrix<bool, Eigen::Dynamic, Eigen::Dynamic>;

/// The union of the nonzero patterns of the matrices.
Edges edges_of(const std::vector<MatrixXd>& A) {
  MatrixXd sum = A.front().cwiseAbs();
  for (std::size_t k = 1; k < A.size(); ++k) sum += A[k].cwiseAbs();
  return sum.array() != 0;
}

/// The plant restricted to the kept states.
PeriodicLti part(const PeriodicLti& plant, const std::vector<Index>& kept) {
  if (std::ssize(kept) == plant.A.front().rows()) return plant;
  PeriodicLti result;
  result.dt = plant.dt;
  result.inputs = plant.inputs;
  result.outputs = plant.outputs;
  for (const MatrixXd& A : plant.A) result.A.push_back(A(kept, kept));
  for (const MatrixXd& B : plant.B) result.B.push_back(B(kept, Eigen::all));
  result.C = plant.C(Eigen::all, kept);
  if (!plant.states.empty())
    for (const Index i : kept) result.states.push_back(plant.states[static_cast<std::size_t>(i)]);
  return result;
}

/// Marks all states that are reached from the marked ones along nonzero entries, in any number of
/// steps.
void spread(const Edges& edges, std::vector<bool>& marked) {
  std::vector<Index> waiting;
  for (std::size_t i = 0; i < marked.size(); ++i)
    if (marked[i]) waiting.push_back(static_cast<Index>(i));
  while (!waiting.empty()) {
    const Index from = waiting.back();
    waiting.pop_back();
    for (Index to = 0; to < edges.rows(); ++to) {
      if (!edges(to, from) || marked[static_cast<std::size_t>(to)]) continue;
      marked[static_cast<std::size_t>(to)] = true;
      waiting.push_back(to);
    }
  }
}

/// Returns the z with z^N = multiplier that is nearest to one of `candidates`.
Complex root_near(Complex multiplier, std::size_t N, const VectorXcd& candidates) {
  const double size = std::pow(std::abs(multiplier), 1.0 / static_cast<double>(N));
  const double turn = 2 * std::acos(-1.0) / static_cast<double>(N);
  Complex best = 0;
  double nearest = std::numeric_limits<double>::infinity();
  for (std::size_t m = 0; m < N; ++m) {
    const Complex z = std::polar(
        size, std::arg(multiplier) / static_cast<double>(N) + static_cast<double>(m) * turn);
    for (const Complex& c : candidates) {
      const double distance = std::abs(z - c);
      if (distance >= nearest) continue;
      nearest = distance;
      best = z;
    }
  }
  return best;
}

/// The states in groups that are decoupled in all steps, ordered by their first state.
std::vector<std::vector<Index>> independent(const std::vector<MatrixXd>& A) {
  const Edges one_way = edges_of(A);
  const Edges edges = one_way.array() || one_way.transpose().array();
  std::vector<std::vector<Index>> groups;
  std::vector<bool> placed(static_cast<std::size_t>(edges.rows()), false);
  for (std::size_t i = 0; i < placed.size(); ++i) {
    if (placed[i]) continue;
    std::vector<bool> reached(placed.size(), false);
    reached[i] = true;
    spread(edges, reached);
    std::vector<Index> group;
    for (std::size_t j = 0; j < reached.size(); ++j)
      if (reached[j]) {
        group.push_back(static_cast<Index>(j));
        placed[j] = true;
      }
    groups.push_back(std::move(group));
  }
  return groups;
}

std::vector<MatrixXd> of_group(const std::vector<MatrixXd>& A, const std::vector<Index>& group) {
  std::vector<MatrixXd> result;
  result.reserve(A.size());
  for (const MatrixXd& step : A) result.emplace_back(step(group, group));
  return result;
}

MatrixXd product(const std::vector<MatrixXd>& A) {
  MatrixXd P = A.front();
  for (std::size_t k = 1; k < A.size(); ++k) P = (A[k] * P).eval();
  return P;
}

MatrixXd mean(const std::vector<MatrixXd>& A) {
  MatrixXd sum = A.front();
  for (std::size_t k = 1; k < A.size(); ++k) sum += A[k];
  return sum / static_cast<double>(A.size());
}

}  // namespace

void validate(const PeriodicLti& plant, const std::string& where) {
  if (!(plant.dt > 0) || !std::isfinite(plant.dt))
    throw InvalidInput(where, fmt::format("dt is {} s, expected a positive period", plant.dt));
  if (plant.A.empty() || plant.B.size() != plant.A.size())
    throw InvalidInput(where, fmt::format("there are {} matrices A and {} matrices B, expected "
                                          "equal numbers and at least one",
                                          plant.A.size(), plant.B.size()));
  const Index nx = plant.A.front().rows();
  const Index nu = plant.B.front().cols();
  for (std::size_t k = 0; k < plant.A.size(); ++k) {
    require_matrix(plant.A[k], nx, nx, fmt::format("A[{}]", k), where);
    require_matrix(plant.B[k], nx, nu, fmt::format("B[{}]", k), where);
  }
  require_matrix(plant.C, plant.C.rows(), nx, "C", where);
}

PeriodicLti periodic(const DiscreteLti& plant) {
  validate(plant, "periodic plant");
  if (plant.D.size() > 0 && !plant.D.isZero(0))
    throw InvalidInput("periodic plant", "D is not zero, expected a plant without feed-through");
  PeriodicLti result;
  result.A = {plant.A};
  result.B = {plant.B};
  result.C =
      plant.C.size() > 0 ? plant.C : MatrixXd(MatrixXd::Identity(plant.A.rows(), plant.A.rows()));
  result.dt = plant.dt;
  result.states = plant.states;
  result.inputs = plant.inputs;
  result.outputs = plant.C.size() > 0 ? plant.outputs : plant.states;
  return result;
}

PeriodicLti loop_part(const PeriodicLti& plant, std::vector<Index>* kept) {
  validate(plant, "periodic plant");
  const auto nx = static_cast<std::size_t>(plant.A.front().rows());
  const Edges edges = edges_of(plant.A);
  std::vector<bool> moved(nx, false), seen(nx, false);
  for (const MatrixXd& B : plant.B)
    for (std::size_t i = 0; i < nx; ++i)
      if (!B.row(static_cast<Index>(i)).isZero(0)) moved[i] = true;
  for (std::size_t i = 0; i < nx; ++i) seen[i] = !plant.C.col(static_cast<Index>(i)).isZero(0);
  spread(edges, moved);
  spread(edges.transpose().eval(), seen);
  std::vector<Index> both;
  for (std::size_t i = 0; i < nx; ++i)
    if (moved[i] && seen[i]) both.push_back(static_cast<Index>(i));
  if (kept != nullptr) *kept = both;
  return part(plant, both);
}

PeriodicLti cut_at_inputs(const PeriodicLti& plant, const DiscreteLti& law) {
  validate(plant, "periodic loop");
  const Index np = plant.A.front().rows(), nl = law.A.rows();
  const Index nu = plant.B.front().cols(), ny = plant.C.rows();
  if (law.D.rows() != nu || law.D.cols() != ny)
    throw InvalidInput(
        "periodic loop",
        fmt::format("the law has {} inputs and {} outputs, expected {} and {} of the "
                    "plant",
                    law.D.cols(), law.D.rows(), ny, nu));
  if (std::abs(law.dt - plant.dt) > 1e-9 * plant.dt)
    throw InvalidInput("periodic loop",
                       fmt::format("the plant is sampled every {} s, the law every "
                                   "{} s, expected the same period",
                                   plant.dt, law.dt));
  PeriodicLti loop;
  loop.dt = plant.dt;
  for (std::size_t k = 0; k < plant.period(); ++k) {
    MatrixXd A = MatrixXd::Zero(np + nl, np + nl);
    A.topLeftCorner(np, np) = plant.A[k];
    A.bottomLeftCorner(nl, np) = law.B * plant.C;
    A.bottomRightCorner(nl, nl) = law.A;
    MatrixXd B = MatrixXd::Zero(np + nl, nu);
    B.topRows(np) = plant.B[k];
    loop.A.push_back(std::move(A));
    loop.B.push_back(std::move(B));
  }
  loop.C = MatrixXd(nu, np + nl);
  loop.C << -law.D * plant.C, -law.C;
  loop.states = plant.states;
  for (std::size_t i = 0; i < static_cast<std::size_t>(nl) && !plant.states.empty(); ++i)
    loop.states.push_back(i < law.states.size() ? law.states[i]
                                                : Signal{fmt::format("law {}", i + 1), ""});
  loop.inputs = plant.inputs;
  loop.outputs = plant.inputs;
  return loop;
}

PeriodicLti cut_at_outputs(const PeriodicLti& plant, const DiscreteLti& law) {
  PeriodicLti loop = cut_at_inputs(plant, law);
  const Index np = plant.A.front().rows(), nl = law.A.rows(), ny = plant.C.rows();
  for (std::size_t k = 0; k < plant.period(); ++k) {
    const MatrixXd& B = plant.B[k];
    loop.A[k].topRightCorner(np, nl) = B * law.C;
    loop.A[k].bottomLeftCorner(nl, np).setZero();
    MatrixXd in(np + nl, ny);
    in << B * law.D, law.B;
    loop.B[k] = std::move(in);
  }
  loop.C = MatrixXd::Zero(ny, np + nl);
  loop.C.leftCols(np) = -plant.C;
  loop.inputs = plant.outputs;
  loop.outputs = plant.outputs;
  return loop;
}

std::vector<MatrixXd> closed(const PeriodicLti& loop) {
  std::vector<MatrixXd> A = loop.A;
  for (std::size_t k = 0; k < A.size(); ++k) A[k] -= loop.B[k] * loop.C;
  return A;
}

PeriodicLti channel(const PeriodicLti& loop, Index index) {
  PeriodicLti one = loop;
  for (std::size_t k = 0; k < one.period(); ++k) {
    for (Index j = 0; j < loop.C.rows(); ++j)
      if (j != index) one.A[k] -= loop.B[k].col(j) * loop.C.row(j);
    one.B[k] = loop.B[k].col(index).eval();
  }
  one.C = loop.C.row(index).eval();
  const auto pick = [&](std::vector<Signal>& signals) {
    if (!signals.empty()) signals = {signals[static_cast<std::size_t>(index)]};
  };
  pick(one.inputs);
  pick(one.outputs);
  return one;
}

std::vector<PeriodicLti> decoupled_channels(const PeriodicLti& loop) {
  const std::vector<std::vector<Index>> groups = independent(closed(loop));
  std::vector<PeriodicLti> channels;
  for (Index i = 0; i < loop.C.rows(); ++i) {
    const auto touches = [&](Index state) {
      return loop.C(i, state) != 0 ||
             std::any_of(loop.B.begin(), loop.B.end(),
                         [&](const MatrixXd& B) { return B(state, i) != 0; });
    };
    std::vector<Index> own;
    for (const std::vector<Index>& group : groups)
      if (std::any_of(group.begin(), group.end(), touches))
        own.insert(own.end(), group.begin(), group.end());
    std::sort(own.begin(), own.end());
    channels.push_back(channel(own.empty() ? loop : part(loop, own), i));
  }
  return channels;
}

VectorXcd periodic_poles(const std::vector<MatrixXd>& A) {
  VectorXcd poles(A.front().rows());
  Index at = 0;
  for (const std::vector<Index>& group : independent(A)) {
    const std::vector<MatrixXd> steps = of_group(A, group);
    auto own = poles.segment(at, std::ssize(group));
    at += std::ssize(group);
    own = product(steps).eigenvalues();
    if (A.size() == 1) continue;
    const VectorXcd candidates = mean(steps).eigenvalues();
    for (Complex& z : own) z = root_near(z, A.size(), candidates);
  }
  std::stable_sort(poles.begin(), poles.end(),
                   [](Complex a, Complex b) { return std::abs(a) > std::abs(b); });
  return poles;
}

NamedMode largest_mode(const std::vector<MatrixXd>& A, const std::vector<Signal>& states,
                       const Eigen::VectorXd& scale) {
  NamedMode mode;
  Eigen::VectorXd size = Eigen::VectorXd::Zero(A.front().rows());
  double largest = -1;
  for (const std::vector<Index>& group : independent(A)) {
    const std::vector<MatrixXd> steps = of_group(A, group);
    const Eigen::EigenSolver<MatrixXd> solver(product(steps));
    Index at = 0;
    const double here = solver.eigenvalues().cwiseAbs().maxCoeff(&at);
    if (here <= largest || std::isnan(largest)) continue;
    largest = here;
    mode.z = A.size() > 1 ? root_near(solver.eigenvalues()(at), A.size(), mean(steps).eigenvalues())
                          : solver.eigenvalues()(at);
    size.setZero();
    size(group) = solver.eigenvectors().col(at).cwiseAbs().cwiseQuotient(scale(group));
  }
  std::vector<Index> order(static_cast<std::size_t>(size.size()));
  std::iota(order.begin(), order.end(), Index{0});
  std::stable_sort(order.begin(), order.end(), [&](Index a, Index b) { return size(a) > size(b); });
  constexpr double kShown = 0.3;
  for (const Index i : order) {
    if (mode.states.size() == 3 || size(i) < kShown * size(order.front())) break;
    const std::string& name = states[static_cast<std::size_t>(i)].name;
    // Delayed samples of one quantity have the same name.
    if (std::find(mode.states.begin(), mode.states.end(), name) == mode.states.end())
      mode.states.push_back(name);
  }
  return mode;
}

}  // namespace quadtune
