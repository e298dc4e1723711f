// SPDX-License-Identifier: Apache-2.0
/// Reduces long series to a size that suits a page, without losing peaks.
#pragma once

#include <cstddef>
#include <vector>

namespace quadtune::report {

/// A reduced series: the columns have as many rows as `time`.
struct Decimated {
  std::vector<double> time;                 ///< increasing
  std::vector<std::vector<double>> values;  ///< column by column; NaN if there is no value
};

/// Keeps at most `rows` rows of a series. A series that is not longer is returned unchanged.
///
/// Otherwise the first and the last row are kept, and the rows between are divided into buckets of
/// equal size. Each bucket gives two rows: the column's values at the start and the middle of the
/// bucket. If the bucket contains values outside the range of the line through these points, its
/// minimum and its maximum are kept instead, in their original order. Hence smooth parts stay
/// exact, no peak is lost, and no peak moves by more than a bucket. Values that are not finite
/// count as missing: a bucket with one value keeps it and a NaN, a bucket without values becomes a
/// gap. A gap shorter than a bucket is lost.
///
/// @param time     increasing
/// @param columns  each as long as `time`; not null
/// @param rows     4 or more
[[nodiscard]] Decimated decimate(const std::vector<double>& time,
                                 const std::vector<const std::vector<double>*>& columns,
                                 std::size_t rows);

/// The indices of at most `rows` rows, evenly spaced and including the first and the last. For
/// quantities whose components are meaningful only together, such as an attitude.
///
/// @param size  of the series
/// @param rows  2 or more
[[nodiscard]] std::vector<std::size_t> spread_rows(std::size_t size, std::size_t rows);

}  // namespace quadtune::report
