// SPDX-License-Identifier: Apache-2.0
/// Makes long records short enough for a page, without losing the peaks.
#pragma once

#include <cstddef>
#include <vector>

namespace quadtune::report {

/// A record to draw: the columns have as many rows as `time`.
struct Decimated {
  std::vector<double> time;                 ///< increasing
  std::vector<std::vector<double>> values;  ///< column by column; NaN where there is none
};

/// Keeps at most `rows` rows of a record. A record of no more rows comes back as it is.
///
/// Otherwise the first and the last row stay, and the rows between are dealt into buckets of equal
/// count, two rows each: a column's values at the bucket's start and middle. Where the bucket goes
/// beyond what a line through these would show, they are its least and its greatest value instead,
/// in the order in which they came. So what is smooth stays exact, no peak is lost, and none is
/// moved by more than a bucket. What is not finite counts as no value: a bucket with one value
/// keeps that and a NaN, a bucket without is a gap. A gap shorter than a bucket is lost.
///
/// @param time     increasing
/// @param columns  each as long as `time`; not null
/// @param rows     4 or more
[[nodiscard]] Decimated decimate(const std::vector<double>& time,
                                 const std::vector<const std::vector<double>*>& columns,
                                 std::size_t rows);

/// The indices of at most `rows` rows, evenly spread, the first and the last among them: for
/// quantities that only mean something together, such as an attitude.
///
/// @param size  of the record
/// @param rows  2 or more
[[nodiscard]] std::vector<std::size_t> spread_rows(std::size_t size, std::size_t rows);

}  // namespace quadtune::report
