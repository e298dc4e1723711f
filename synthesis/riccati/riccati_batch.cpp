// SPDX-License-Identifier: Apache-2.0
#include "quadtune/synthesis/riccati_batch.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <limits>

#include "quadtune/errors.hpp"
#include "riccati/riccati_lanes.hpp"
#include "riccati/riccati_parts.hpp"

namespace quadtune {

using internal::ConstRef;
using internal::Time;
using internal::WeightR;

namespace {

/// Above this size the matrices of the lanes exceed the second-level cache.
constexpr Eigen::Index kLargestInLanes = 32;

/// Number of equations that fit in the registers together.
constexpr std::size_t kAtOnce = internal::kLaneCount;

RiccatiOptions essential(RiccatiOptions options) {
  options.evidence = RiccatiEvidence::essential;
  return options;
}

}  // namespace

struct RiccatiBatch::State {
  Eigen::Index nx;
  Eigen::Index nu;
  RiccatiOptions options;
  RiccatiSolver solver;
  internal::CheckBuffers buffers;
  std::unique_ptr<internal::LaneDoubling> lanes;  // null for large equations
  std::vector<RiccatiResult> results;
  std::string indefinite_Q;
  std::size_t fallbacks = 0;

  State(Eigen::Index nx_, Eigen::Index nu_, RiccatiOptions options_)
      : nx(nx_),
        nu(nu_),
        options(essential(std::move(options_))),
        solver(nx, nu, options),
        results(kLanes) {
    buffers.factor_Q.resize(nx, nx);
    buffers.factor_R.resize(nu, nu);
    if (std::max(nx, nu) <= kLargestInLanes)
      lanes = std::make_unique<internal::LaneDoubling>(nx, nu);
  }

  std::span<const RiccatiResult> solve(Time time, std::span<const RiccatiMatrices> problems) {
    if (problems.empty() || problems.size() > kLanes)
      throw InvalidInput("RiccatiBatch", fmt::format("{} problems are given, expected 1 to {}",
                                                     problems.size(), kLanes));
    const bool fit = fit_for_lanes(time, problems);
    for (std::size_t first = 0; first < problems.size(); first += kAtOnce) {
      const auto group = problems.subspan(first, std::min(kAtOnce, problems.size() - first));
      const bool together = fit && solve_lanes(time, group);
      for (std::size_t lane = 0; lane < group.size(); ++lane) {
        RiccatiResult& result = results[first + lane];
        if (!together || !take_from_lane(static_cast<int>(lane), result))
          solve_alone(time, group[lane], result);
      }
    }
    return results;
  }

 private:
  /// Checks whether all problems are suitable for the lanes. The RiccatiSolver solves the others,
  /// or rejects them with a message.
  bool fit_for_lanes(Time time, std::span<const RiccatiMatrices> problems) {
    bool fit = lanes != nullptr;
    for (const RiccatiMatrices& p : problems) {
      if (p.A.rows() != nx || p.B.cols() != nu) return false;
      const ConstRef A(p.A), B(p.B), Q(p.Q), R(p.R), N(p.N);
      const WeightR weight_R =
          internal::check_problem({time, A, B, Q, R, N}, buffers, indefinite_Q);
      fit = fit && weight_R == WeightR::well_conditioned && indefinite_Q.empty() &&
            (p.N.size() > 0) == (problems[0].N.size() > 0);
    }
    return fit;
  }

  /// Unused lanes repeat the first problem.
  bool solve_lanes(Time time, std::span<const RiccatiMatrices> problems) {
    std::array<const RiccatiMatrices*, kAtOnce> all{};
    for (std::size_t lane = 0; lane < kAtOnce; ++lane)
      all[lane] = &problems[lane < problems.size() ? lane : 0];
    return lanes->solve(time, all, options.max_iterations);
  }

  bool take_from_lane(int lane, RiccatiResult& result) {
    if (!lanes->stable(lane) || !(lanes->residual(lane) <= options.relative_tolerance))
      return false;
    result.X.resize(nx, nx);
    result.K.resize(nu, nx);
    lanes->store(lane, result.X, result.K);
    result.status = RiccatiStatus::solved;
    result.residual = lanes->residual(lane);
    result.rcond = std::numeric_limits<double>::quiet_NaN();
    result.iterations = lanes->iterations();
    result.used_schur = false;
    result.culprit.clear();
    result.warning.clear();
    return true;
  }

  void solve_alone(Time time, const RiccatiMatrices& p, RiccatiResult& result) {
    ++fallbacks;
    result = time == Time::continuous ? solver.care(p.A, p.B, p.Q, p.R, p.N)
                                      : solver.dare(p.A, p.B, p.Q, p.R, p.N);
  }
};

RiccatiBatch::RiccatiBatch(Eigen::Index nx, Eigen::Index nu, RiccatiOptions options)
    : state_(std::make_unique<State>(nx, nu, std::move(options))) {}
RiccatiBatch::~RiccatiBatch() = default;
RiccatiBatch::RiccatiBatch(RiccatiBatch&&) noexcept = default;
RiccatiBatch& RiccatiBatch::operator=(RiccatiBatch&&) noexcept = default;

std::span<const RiccatiResult> RiccatiBatch::care(std::span<const RiccatiMatrices> problems) {
  return state_->solve(Time::continuous, problems);
}

std::span<const RiccatiResult> RiccatiBatch::dare(std::span<const RiccatiMatrices> problems) {
  return state_->solve(Time::discrete, problems);
}

std::size_t RiccatiBatch::fallbacks() const { return state_->fallbacks; }

}  // namespace quadtune
