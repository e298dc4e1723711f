// SPDX-License-Identifier: Apache-2.0
#include "report/page/decimate.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace quadtune::report {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

/// The two values that represent the rows begin … end - 1 of a column; `end` is also a valid row.
std::pair<double, double> two_for(const std::vector<double>& values, std::size_t begin,
                                  std::size_t end) {
  const std::size_t middle = begin + (end - begin) / 2;
  std::size_t min = end;
  std::size_t max = end;
  std::size_t count = 0;
  for (std::size_t i = begin; i < end; ++i) {
    if (!std::isfinite(values[i])) continue;
    ++count;
    if (min == end || values[i] < values[min]) min = i;
    if (max == end || values[i] > values[max]) max = i;
  }
  if (count == 0) return {kNaN, kNaN};
  if (count == 1) return min < middle ? std::pair(values[min], kNaN) : std::pair(kNaN, values[min]);
  const double a = values[begin], b = values[middle], c = values[end];
  const bool shown = std::isfinite(a) && std::isfinite(b) && std::isfinite(c) &&
                     values[min] >= std::min({a, b, c}) && values[max] <= std::max({a, b, c});
  if (shown) return {a, b};
  return {values[std::min(min, max)], values[std::max(min, max)]};
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
  // Bucket k contains the rows first(k) … first(k + 1) - 1, at least two because n > rows.
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
      const auto [one, other] = two_for(*column, first(k), first(k + 1));
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

}  // namespace quadtune::report
