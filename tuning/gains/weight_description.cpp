// SPDX-License-Identifier: Apache-2.0
#include "gains/weight_description.hpp"

#include <fmt/format.h>

#include <Eigen/QR>
#include <Eigen/SVD>
#include <cmath>
#include <limits>
#include <numbers>

#include "quadtune/internal/joined.hpp"

namespace quadtune::internal {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// A direction counts as not determined if it changes the gain by less than this, relative, for an
/// e-fold of a weight: smaller derivatives are rounding errors.
constexpr double kSeen = 1e-9;
/// Half width of the interval of a logarithm from which a weight is hardly seen: a factor of ten.
constexpr double kHardly = std::numbers::ln10;

/// Rows that span the same space in reduced echelon form: each has a 1 where all others have 0.
MatrixXd eliminated(MatrixXd rows) {
  for (Index i = 0; i < rows.rows(); ++i) {
    Index pivot_row = i, pivot = 0;
    rows.bottomRows(rows.rows() - i).cwiseAbs().maxCoeff(&pivot_row, &pivot);
    rows.row(i).swap(rows.row(i + pivot_row));
    rows.row(i) /= rows(i, pivot);
    for (Index k = 0; k < rows.rows(); ++k)
      if (k != i) rows.row(k) -= rows(k, pivot) * rows.row(i);
  }
  return rows;
}

/// Describes a direction of the logarithms of the weights along which the gain is constant.
std::string describe(const VectorXd& direction, const std::vector<Index>& main,
                     const std::vector<std::string>& names) {
  const auto name = [&](Index g) { return names[static_cast<std::size_t>(g)]; };
  if (main.size() == 1) return fmt::format("{}: the gain does not determine it", name(main[0]));
  const double a = direction(main[0]), b = direction(main[1]);
  if (main.size() == 2 && std::abs(std::abs(a) - std::abs(b)) < 1e-3 * std::abs(a))
    return fmt::format("only the {} of {} {} {} is determined", a * b > 0 ? "ratio" : "product",
                       name(main[0]), a * b > 0 ? "to" : "and", name(main[1]));
  // Both signs are the same direction; rounding must not determine the text.
  if (a < 0) return describe(-direction, main, names);
  std::vector<std::string> up, down;
  for (const Index g : main) {
    if (std::abs(direction(g) - 1) < 1e-3) up.push_back(name(g));
    if (std::abs(direction(g) + 1) < 1e-3) down.push_back(name(g));
  }
  if (up.size() + down.size() == main.size())
    return fmt::format(
        "a factor common to {}{}", internal::joined(up, " "),
        down.empty() ? "" : fmt::format(", its inverse to {}", internal::joined(down, " ")));
  std::vector<std::string> words;
  words.reserve(main.size());
  for (const Index g : main) words.push_back(fmt::format("{:+.2f} log {}", direction(g), name(g)));
  return fmt::format("the direction {}", internal::joined(words, " "));
}

/// Marks the weights in directions that the gain does not determine, and describes the directions.
void name_unseen(const MatrixXd& directions, const std::vector<std::string>& names,
                 std::vector<MatchedWeight>& groups, std::vector<std::string>& unseen) {
  const MatrixXd rows = eliminated(directions);
  for (const auto& row : rows.rowwise()) {
    std::vector<Index> main;
    for (Index g = 0; g < row.size(); ++g)
      if (std::abs(row(g)) > 1e-3) main.push_back(g);
    for (const Index g : main) {
      MatchedWeight& group = groups[static_cast<std::size_t>(g)];
      group.verdict = main.size() == 1 ? WeightVerdict::not_seen : WeightVerdict::combination;
      if (main.size() > 1) continue;  // its interval is for a fixed position along the direction
      group.low = 0;
      group.high = std::numeric_limits<double>::infinity();
    }
    unseen.push_back(describe(row.transpose(), main, names));
  }
}

/// The directions of the weights other than the common factor, which the gain does not determine.
struct Directions {
  VectorXd squared_width;  ///< of the interval of each free weight, in logarithms
  MatrixXd seen;           ///< orthonormal effects of the directions on the scaled differences
  MatrixXd not_seen;       ///< one direction per row, over all groups
};

/// @param free  groups whose weight is greater than 0
Directions directions_of(const WeightKnowledge& of, const std::vector<Index>& free) {
  const auto n = static_cast<Index>(free.size());
  Directions result{VectorXd::Zero(n), MatrixXd(of.by_weights.rows(), 0),
                    MatrixXd(0, of.values.size())};
  if (n < 2) return result;
  const MatrixXd ones = MatrixXd::Ones(n, 1);
  const MatrixXd all = Eigen::HouseholderQR<MatrixXd>(ones).householderQ();
  const MatrixXd beside = all.rightCols(n - 1);
  const MatrixXd J = of.by_logarithms(Eigen::all, free) * beside;
  const Eigen::JacobiSVD<MatrixXd> svd(J, Eigen::ComputeThinU | Eigen::ComputeFullV);
  const VectorXd share = of.share_of_R(free);
  for (Index k = 0; k < n - 1; ++k) {
    VectorXd direction = beside * svd.matrixV().col(k);
    direction.array() -= share.dot(direction);  // keep the mean of log R
    const double sigma = k < svd.singularValues().size() ? svd.singularValues()(k) : 0;
    if (sigma > kSeen) {
      result.squared_width += (of.tolerance / sigma * direction).cwiseAbs2();
      result.seen.conservativeResize(Eigen::NoChange, result.seen.cols() + 1);
      result.seen.rightCols(1) = svd.matrixU().col(k);
    } else {
      result.not_seen.conservativeResize(result.not_seen.rows() + 1, Eigen::NoChange);
      result.not_seen.bottomRows(1).setZero();
      for (Index i = 0; i < n; ++i)
        result.not_seen(result.not_seen.rows() - 1, free[static_cast<std::size_t>(i)]) =
            direction(i);
    }
  }
  return result;
}

}  // namespace

void describe_weights(const WeightKnowledge& of, std::vector<MatchedWeight>& groups,
                      std::vector<std::string>& unseen) {
  std::vector<Index> free;
  for (Index g = 0; g < of.values.size(); ++g)
    if (of.values(g) > 0) free.push_back(g);
  const Directions directions = directions_of(of, free);
  for (std::size_t i = 0; i < free.size(); ++i) {
    MatchedWeight& group = groups[static_cast<std::size_t>(free[i])];
    group.value = of.values(free[i]);
    const double width = std::sqrt(directions.squared_width(static_cast<Index>(i)));
    group.low = group.value * std::exp(-width);
    group.high = group.value * std::exp(width);
    group.verdict = width > kHardly ? WeightVerdict::hardly_seen : WeightVerdict::seen;
  }
  for (Index g = 0; g < of.values.size(); ++g) {
    if (of.values(g) > 0) continue;
    MatchedWeight& group = groups[static_cast<std::size_t>(g)];
    const bool fixed = of.fixed[static_cast<std::size_t>(g)];
    group.value = group.low = 0;
    group.verdict = fixed ? WeightVerdict::fixed : WeightVerdict::at_zero;
    // The part that the other weights cannot compensate.
    VectorXd alone = of.by_weights.col(g);
    alone -= (directions.seen * (directions.seen.transpose() * alone)).eval();
    group.high = fixed ? 0 : of.tolerance / alone.norm();
  }
  if (directions.not_seen.rows() > 0) name_unseen(directions.not_seen, of.names, groups, unseen);
}

}  // namespace quadtune::internal
