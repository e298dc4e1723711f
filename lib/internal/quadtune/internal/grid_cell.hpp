// SPDX-License-Identifier: Apache-2.0
/// Multilinear interpolation in a grid: where values lie on its axes, and which of its points count
/// how much. Written once for the library, in double, and for exported C, in its precision too.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <vector>

namespace quadtune::internal {

/// Where a value lies on an axis: between the values `low` and low + 1, at `share` of the way.
template <class T>
struct GridPlace {
  Eigen::Index low = 0;
  T share = 0;
  Eigen::Index length = 1;  ///< number of values of the axis
};

/// @param axis   ≥ 1 ascending values
/// @param value  from the first of them to the last
template <class T>
[[nodiscard]] GridPlace<T> place_on_axis(const std::vector<T>& axis, T value) {
  const auto length = static_cast<Eigen::Index>(axis.size());
  if (length == 1) return {};
  const auto above = std::upper_bound(axis.begin() + 1, axis.end() - 1, value);
  const auto low = static_cast<std::size_t>(above - axis.begin()) - 1;
  return {static_cast<Eigen::Index>(low), (value - axis[low]) / (axis[low + 1] - axis[low]),
          length};
}

/// A corner of the cell that the values lie in: a point of the grid, with its weight.
template <class T>
struct GridCorner {
  Eigen::Index point = 0;
  T weight = 1;
};

/// @param places  one for each axis; the last axis runs fastest
/// @param corner  less than 2^axes; bit a says which end of axis a
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
