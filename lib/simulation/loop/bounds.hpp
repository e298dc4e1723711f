// SPDX-License-Identifier: Apache-2.0
/// Ranges of the numbers in missions: wide enough for any multirotor.
#pragma once

#include <fmt/format.h>

#include <Eigen/Core>
#include <string>

#include "quadtune/errors.hpp"
#include "quadtune/internal/toml_reader.hpp"

namespace quadtune::internal {

inline constexpr double kMax = 86400;        // [s], a day
inline constexpr double kFarthest = 1e5;     // [m], limit of the flat-earth model
inline constexpr double kWidestAngle = 1e4;  // [rad], several turns included

inline constexpr double kMinWay = 1e-6;  // [m], below which two points count as equal

inline constexpr Range kTimes{0, Range::Bound::closed, kMax, Range::Bound::closed};
inline constexpr Range kDurations{0, Range::Bound::open, kMax, Range::Bound::closed};
inline constexpr Range kPlaces{-kFarthest, Range::Bound::closed, kFarthest, Range::Bound::closed};
inline constexpr Range kHeights{0, Range::Bound::closed, kFarthest, Range::Bound::closed};
inline constexpr Range kSizes{0, Range::Bound::open, kFarthest, Range::Bound::closed};
inline constexpr Range kSpeeds{0, Range::Bound::open, 1000, Range::Bound::closed};
inline constexpr Range kAngles{-kWidestAngle, Range::Bound::closed, kWidestAngle,
                               Range::Bound::closed};
inline constexpr Range kCounts{0, Range::Bound::open, 1e6, Range::Bound::closed};
inline constexpr Range kShares{0, Range::Bound::closed, 1, Range::Bound::closed};
inline constexpr Range kLimits{0, Range::Bound::closed, 1e12, Range::Bound::closed};

/// @throws InvalidInput  "where: speed is -1 m/s, expected more than 0 …"; NaN is always rejected
inline void require_within(double value, const Range& range, const std::string& where,
                           const std::string& what, const std::string& unit) {
  if (range.holds(value)) return;
  throw InvalidInput(where, fmt::format("{} is {}{}{}, expected {}", what, value,
                                        unit.empty() ? "" : " ", unit, range.words()));
}

/// Checks a position in the world, which must not be below the ground.
/// @param position  north-east-down [m]
inline void require_place(const Eigen::Vector3d& position, const std::string& where,
                          const std::string& what) {
  require_within(position.x(), kPlaces, where, "north of " + what, "m");
  require_within(position.y(), kPlaces, where, "east of " + what, "m");
  require_within(0 - position.z(), kHeights, where, "height of " + what, "m");
}

}  // namespace quadtune::internal
