// SPDX-License-Identifier: Apache-2.0
#include "margins/loop_parts.hpp"

#include <algorithm>
#include <numeric>

#include "lyapunov/lapack.hpp"

namespace quadtune::internal {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

constexpr double kNoCoupling = 1e-10;

/// The influence of the plant's states, the law's states and the plant's inputs on each other:
/// bounds of |entries| over the box, balanced so that rows and columns have similar norms.
MatrixXd balanced_pattern(const UncertainLoop& loop, const EnclosedBox& box) {
  const Index nx = loop.plant.A.rows();
  const Index ni = loop.law.A.rows();
  const Index nu = loop.plant.B.cols();
  MatrixXd A = loop.plant.A.cwiseAbs();
  MatrixXd B = loop.plant.B.cwiseAbs();
  for (std::size_t j = 0; j < loop.terms.size(); ++j) {
    const auto i = static_cast<Index>(j);
    const double max = std::max(std::abs(box.low(i)), std::abs(box.high(i)));
    if (loop.terms[j].A.size() > 0) A += max * loop.terms[j].A.cwiseAbs();
    if (loop.terms[j].B.size() > 0) B += max * loop.terms[j].B.cwiseAbs();
  }
  MatrixXd W = MatrixXd::Zero(nx + ni + nu, nx + ni + nu);
  W.block(0, 0, nx, nx) = loop.law.dt * A;
  W.block(0, nx + ni, nx, nu) = loop.law.dt * B;
  W.block(nx, 0, ni, nx) = loop.law.B.cwiseAbs();
  W.block(nx, nx, ni, ni) = loop.law.A.cwiseAbs();
  W.block(nx + ni, 0, nu, nx) = loop.law.D.cwiseAbs();
  W.block(nx + ni, nx, nu, ni) = loop.law.C.cwiseAbs();
  const auto n = static_cast<lapack_int>(W.rows());
  Eigen::VectorXd scale(W.rows());
  lapack_int low = 0;
  lapack_int high = 0;
  // If balancing fails, the entries keep their units, and the parts are larger.
  (void)LAPACKE_dgebal(LAPACK_COL_MAJOR, 'S', n, W.data(), n, &low, &high, scale.data());
  return W;
}

/// Groups of nodes that are connected by significant entries.
std::vector<std::vector<Index>> groups(const MatrixXd& W) {
  const Index n = W.rows();
  std::vector<Index> leader(static_cast<std::size_t>(n));
  std::iota(leader.begin(), leader.end(), 0);
  const auto find = [&](Index i) {
    while (leader[static_cast<std::size_t>(i)] != i) i = leader[static_cast<std::size_t>(i)];
    return i;
  };
  for (Index i = 0; i < n; ++i)
    for (Index j = 0; j < n; ++j) {
      const double largest = std::max(W.row(i).maxCoeff(), W.col(j).maxCoeff());
      if (i != j && W(i, j) > kNoCoupling * largest)
        leader[static_cast<std::size_t>(find(i))] = find(j);
    }
  std::vector<std::vector<Index>> all(static_cast<std::size_t>(n));
  for (Index i = 0; i < n; ++i) all[static_cast<std::size_t>(find(i))].push_back(i);
  std::erase_if(all, [](const std::vector<Index>& group) { return group.empty(); });
  return all;
}

MatrixXd taken(const MatrixXd& M, const std::vector<Index>& rows, const std::vector<Index>& cols) {
  return M.size() > 0
             ? MatrixXd(M(rows, cols))
             : MatrixXd::Zero(static_cast<Index>(rows.size()), static_cast<Index>(cols.size()));
}

/// Copies the terms that affect the part.
void take_terms(const UncertainLoop& whole, LoopPart& part) {
  for (std::size_t j = 0; j < whole.terms.size(); ++j) {
    PlantTerm term{whole.terms[j].name, {}, {}};
    if (whole.terms[j].A.size() > 0) term.A = taken(whole.terms[j].A, part.states, part.states);
    if (whole.terms[j].B.size() > 0) term.B = taken(whole.terms[j].B, part.states, part.inputs);
    if (term.A.isZero(0)) term.A.resize(0, 0);
    if (term.B.isZero(0)) term.B.resize(0, 0);
    if (term.A.size() == 0 && term.B.size() == 0) continue;
    part.terms.push_back(static_cast<Index>(j));
    part.loop.terms.push_back(std::move(term));
  }
}

void take(const UncertainLoop& whole, LoopPart& part) {
  part.loop.plant.A = taken(whole.plant.A, part.states, part.states);
  part.loop.plant.B = taken(whole.plant.B, part.states, part.inputs);
  for (const Index i : part.states)
    if (!whole.plant.states.empty())
      part.loop.plant.states.push_back(whole.plant.states[static_cast<std::size_t>(i)]);
  part.loop.law.A = taken(whole.law.A, part.memory, part.memory);
  part.loop.law.B = taken(whole.law.B, part.memory, part.states);
  part.loop.law.C = taken(whole.law.C, part.inputs, part.memory);
  part.loop.law.D = taken(whole.law.D, part.inputs, part.states);
  part.loop.law.dt = whole.law.dt;
  take_terms(whole, part);
}

}  // namespace

EnclosedBox LoopPart::share(const EnclosedBox& box) const {
  EnclosedBox mine = box;
  mine.low = box.low(terms);
  mine.high = box.high(terms);
  return mine;
}

std::vector<Index> LoopPart::places(const UncertainLoop& whole, int past) const {
  const Index nx = whole.plant.A.rows();
  const Index ni = whole.law.A.rows();
  std::vector<Index> at = states;
  for (const Index i : memory) at.push_back(nx + i);
  for (int j = 0; j < past; ++j)
    for (const Index i : inputs) at.push_back(nx + ni + j * whole.plant.B.cols() + i);
  return at;
}

PartNumbers part_numbers(const UncertainLoop& loop, const std::vector<LoopPart>& parts) {
  PartNumbers numbers{Eigen::VectorXi(loop.plant.A.rows()), Eigen::VectorXi(loop.law.A.rows()),
                      Eigen::VectorXi(loop.plant.B.cols())};
  for (std::size_t i = 0; i < parts.size(); ++i) {
    numbers.states(parts[i].states).setConstant(static_cast<int>(i));
    numbers.memory(parts[i].memory).setConstant(static_cast<int>(i));
    numbers.inputs(parts[i].inputs).setConstant(static_cast<int>(i));
  }
  return numbers;
}

LoopPart whole_loop(const UncertainLoop& loop) {
  LoopPart part;
  const auto all = [](Index count) {
    std::vector<Index> indices(static_cast<std::size_t>(count));
    std::iota(indices.begin(), indices.end(), 0);
    return indices;
  };
  part.states = all(loop.plant.A.rows());
  part.memory = all(loop.law.A.rows());
  part.inputs = all(loop.plant.B.cols());
  take(loop, part);
  return part;
}

std::vector<LoopPart> loop_parts(const UncertainLoop& loop, const EnclosedBox& box) {
  const Index nx = loop.plant.A.rows();
  const Index ni = loop.law.A.rows();
  std::vector<LoopPart> parts;
  std::vector<Index> idle;  // inputs without any coupling
  for (const std::vector<Index>& group : groups(balanced_pattern(loop, box))) {
    LoopPart part;
    for (const Index i : group)
      (i < nx        ? part.states
       : i < nx + ni ? part.memory
                     : part.inputs)
          .push_back(i < nx        ? i
                     : i < nx + ni ? i - nx
                                   : i - nx - ni);
    if (part.states.empty() && part.memory.empty())
      idle.insert(idle.end(), part.inputs.begin(), part.inputs.end());
    else
      parts.push_back(std::move(part));
  }
  if (parts.empty()) return {whole_loop(loop)};
  parts.front().inputs.insert(parts.front().inputs.end(), idle.begin(), idle.end());
  for (LoopPart& part : parts) take(loop, part);
  return parts;
}

}  // namespace quadtune::internal
