// SPDX-License-Identifier: Apache-2.0
/// Multilinear interpolation in a grid: the location of values on the axes and the weights of the
/// grid points. Used by the library, in double, and by exported C, in its precision.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <vector>

namespace quadtune::internal {

/// The location of a value on an axis: between `low` and low + 1, at fraction `share` of the
/// interval.
template <class T>
struct GridPlace {
  Eigen::Index low = 0;
  T share = 0;
  Eigen::Index length = 1;  ///< number of values on the axis
};

/// @param axis   ≥ 1 ascending values
/// @param value  between the first and the last of them
template <class T>
[[nodiscard]] GridPlace<T> place_on_axis(const std::vector<T>& axis, T value) {
  const auto length = static_cast<Eigen::Index>(axis.size());
  if (length == 1) return {};
  const auto above = std::upper_bound(axis.begin() + 1, axis.end() - 1, value);
  const auto low = static_cast<std::size_t>(above - axis.begin()) - 1;
  return {static_cast<Eigen::Index>(low), (value - axis[low]) / (axis[low + 1] - axis[low]),
          length};
}

/// A corner of the cell that contains the values: a grid point with its weight.
template <class T>
struct GridCorner {
  Eigen::Index point = 0;
  T weight = 1;
};

/// @param places  one per axis; the last axis varies fastest
/// @param corner  less than 2^axes; bit a selects the end of axis a
template <class T>
[[nodiscard]] GridCorner<T> corner_of_cell(const std::vector<GridPlace<T>>& places,
                                           unsigned corner) {
  GridCorner<T> result;
  for (std::size_t a = 0; a < places.size(); ++a) {
    const GridPlace<T>& place = places[a];
    const bool high = (corner >> a & 1u) != 0;
    result.weight *= high ? place.share : T(1) - place.share;
    result.point =
        result.point * place.length + std::min(place.low + (high ? 1 : 0), place.length - 1);
  }
  return result;
}

}  // namespace quadtune::internal
