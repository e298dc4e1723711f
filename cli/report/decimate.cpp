// SPDX-License-Identifier: Apache-2.0
#include "report/decimate.hpp"

#include <cmath>
#include <limits>
#include <utility>

namespace quadtune::cli {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

/// The least and the greatest finite value of a bucket, in the order in which they came.
std::pair<double, double> extremes(const std::vector<double>& values, std::size_t begin,
                                   std::size_t end) {
  std::size_t least = end;
  std::size_t greatest = end;
  for (std::size_t i = begin; i < end; ++i) {
    if (!std::isfinite(values[i])) continue;
    if (least == end || values[i] < values[least]) least = i;
    if (greatest == end || values[i] > values[greatest]) greatest = i;
  }
  if (least == end) return {kNaN, kNaN};
  if (least != greatest)
    return {values[std::min(least, greatest)], values[std::max(least, greatest)]};
  // One value, or all the same: where there are several, both halves of the bucket have it.
  std::size_t count = 0;
  for (std::size_t i = begin; i < end; ++i) count += std::isfinite(values[i]) ? 1 : 0;
  if (count > 1) return {values[least], values[least]};
  return least < begin + (end - begin + 1) / 2 ? std::pair(values[least], kNaN)
                                               : std::pair(kNaN, values[least]);
}

}  // namespace

Decimated decimate(const std::vector<double>& time,
                   const std::vector<const std::vector<double>*>& columns, std::size_t rows) {
  Decimated result;
  const std::size_t n = time.size();
  if (n <= rows) {
    result.time = time;
    for (const std::vector<double>* column : columns) result.values.push_back(*column);
    return result;
  }
  const std::size_t buckets = (rows - 2) / 2;
  const std::size_t inner = n - 2;  // rows between the first and the last
  // The bucket k holds the rows first(k) … first(k + 1) - 1, two at least as n > rows.
  const auto first = [&](std::size_t k) { return 1 + k * inner / buckets; };
  result.time.push_back(time.front());
  for (std::size_t k = 0; k < buckets; ++k) {
    const std::size_t begin = first(k);
    result.time.push_back(time[begin]);
    result.time.push_back(time[begin + (first(k + 1) - begin) / 2]);
  }
  result.time.push_back(time.back());
  for (const std::vector<double>* column : columns) {
    std::vector<double> kept = {column->front()};
    kept.reserve(result.time.size());
    for (std::size_t k = 0; k < buckets; ++k) {
      const auto [one, other] = extremes(*column, first(k), first(k + 1));
      kept.push_back(one);
      kept.push_back(other);
    }
    kept.push_back(column->back());
    result.values.push_back(std::move(kept));
  }
  return result;
}

std::vector<std::size_t> spread_rows(std::size_t size, std::size_t rows) {
  std::vector<std::size_t> indices;
  const std::size_t kept = size < rows ? size : rows;
  indices.reserve(kept);
  for (std::size_t i = 0; i < kept; ++i)
    indices.push_back(kept == 1 ? 0 : i * (size - 1) / (kept - 1));
  return indices;
}

}  // namespace quadtune::cli
