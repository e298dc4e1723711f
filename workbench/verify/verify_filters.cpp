// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "quadtune/errors.hpp"
#include "quadtune/exports/exporter.hpp"
#include "quadtune/internal/text_file.hpp"
#include "quadtune/synthesis/kalman.hpp"
#include "quadtune/workbench/verify/verify_evidence.hpp"

namespace quadtune {
namespace {

/// Largest difference of two matrices relative to the largest entry of the second; infinite if
/// shapes differ.
double apart(const Eigen::MatrixXd& given, const Eigen::MatrixXd& solved) {
  if (given.rows() != solved.rows() || given.cols() != solved.cols())
    return std::numeric_limits<double>::infinity();
  if (solved.size() == 0) return 0;
  const double largest = solved.cwiseAbs().maxCoeff();
  const double max = (given - solved).cwiseAbs().maxCoeff();
  return max == 0 ? 0 : max / largest;
}

}  // namespace

std::vector<VerifyCheck> check_filters(const std::filesystem::path& directory,
                                       const Manifest& manifest) {
  VerifyCheck check{"gains and covariances of the filters are those of their noise", true, ""};
  // Effect of rounding on a filter with a few states.
  constexpr double kFilterRounding = 1e-8;
  try {
    const Exporter& exporter = exporter_of(manifest.kind, kManifestName);
    if (!exporter.filters) return {};
    double worst = 0;
    const std::vector<KalmanFilter> filters = exporter.filters(directory);
    if (filters.empty()) return {};
    for (const KalmanFilter& filter : filters) {
      const KalmanResult solved = kalman(filter.model, {filter.G, filter.Q, filter.R, filter.N});
      if (!solved.solved())
        throw InvalidInput(internal::printable(filter.name), "solved again: " + solved.culprit);
      for (const auto& [name, given, expected] :
           {std::tuple("M", &filter.M, &solved.M), std::tuple("L", &filter.L, &solved.L),
            std::tuple("P", &filter.P, &solved.P), std::tuple("Z", &filter.Z, &solved.Z)}) {
        const double distance = apart(*given, *expected);
        worst = std::max(worst, distance);
        if (!(distance <= kFilterRounding) && check.ok) {
          check.ok = false;
          check.detail = fmt::format(
              "{}: {} differs by {:.3g} of its largest entry from what A, C, G, Q, R and N give",
              internal::printable(filter.name), name, distance);
        }
      }
    }
    if (check.ok)
      check.detail = fmt::format(
          "solved again: entries differ by at most {:.3g} times the largest of their matrix, "
          "expected "
          "at most {:.2g}",
          worst, kFilterRounding);
  } catch (const InvalidInput& error) {
    check.ok = false;
    check.detail = error.what();
  } catch (const NoSolution& error) {
    check.ok = false;
    check.detail = error.what();
  } catch (const FileError& error) {
    check.ok = false;
    check.detail = error.what();
  }
  return {check};
}

}  // namespace quadtune
