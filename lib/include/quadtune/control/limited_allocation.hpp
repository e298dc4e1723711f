// SPDX-License-Identifier: Apache-2.0
/// What a flight program does when the motors cannot produce the wrench that its law commands.
/// Theory: docs/theory.md, "Commands beyond the motors".
#pragma once

#include <array>
#include <string>

#include "quadtune/control/allocation.hpp"
#include "quadtune/model/vehicle.hpp"
#include "quadtune/scalar.hpp"

namespace quadtune {

/// Which part of a wrench is given up when the motors cannot produce all of it.
enum class AllocationRule {
  /// Yaw torque first, then thrust; roll and pitch torque last and in proportion to each other. The
  /// thrust is raised or lowered as far as roll and pitch torque need it.
  prioritized,
  clipped,  ///< each motor's command is cut at its own limit, as the source programs do
};
/// "prioritized", "clipped", and back.
[[nodiscard]] std::string to_string(AllocationRule rule);
/// @throws InvalidInput  naming the word and the two that exist.
[[nodiscard]] AllocationRule allocation_rule(const std::string& name, const std::string& where);

/// Set once: the range of each rotor's thrust as the flight program knows it.
template <class T>
struct ThrustLimits {
  std::array<T, kMaxRotors> least{};     ///< [N]
  std::array<T, kMaxRotors> greatest{};  ///< [N]
  T floor = T(0);  ///< collective thrust that a law does not go below [N], ≥ 0
};

/// Share of the weight below which no law takes the collective thrust under
/// AllocationRule::prioritized: rotors that stand still take their lag to produce a torque again.
inline constexpr double kLeastCollective = 0.15;

/// The thrusts at the least and the greatest command of the motors, and the floor.
/// @throws InvalidInput  as allocation()
[[nodiscard]] ThrustLimits<double> thrust_limits(const Vehicle& vehicle);

/// A wrench with which all rotors are within their limits, and whether it is another than asked.
template <class T>
struct LimitedWrench {
  Eigen::Matrix<T, 4, 1> wrench = Eigen::Matrix<T, 4, 1>::Zero();  ///< [T τx τy τz]
  MaskOf<T> limited{};
};

/// Thrusts that an allocation gives to a wrench, before any limit [N].
template <class T>
[[nodiscard]] RotorSpeeds<T> thrusts_of_wrench(const Allocation<T>& allocation,
                                               const Eigen::Matrix<T, 4, 1>& wrench) {
  RotorSpeeds<T> thrusts(allocation.rotors);
  const Eigen::Matrix<T, 4, 1> change = wrench - allocation.wrench0;
  for (int i = 0; i < allocation.rotors; ++i) {
    T thrust = allocation.thrust0(i);
    for (int j = 0; j < 4; ++j) thrust += allocation.P(i, j) * change(j);
    thrusts(i) = thrust;
  }
  return thrusts;
}

/// The wrench of thrusts: the inverse of thrusts_of_wrench() for thrusts that come from it.
template <class T>
[[nodiscard]] Eigen::Matrix<T, 4, 1> wrench_of_thrusts(const Allocation<T>& allocation,
                                                       const RotorSpeeds<T>& thrusts) {
  Eigen::Matrix<T, 4, 1> wrench = allocation.wrench0;
  for (int j = 0; j < 4; ++j)
    for (int i = 0; i < allocation.rotors; ++i)
      wrench(j) += allocation.M(j, i) * (thrusts(i) - allocation.thrust0(i));
  return wrench;
}

/// The wrench nearest to `asked` by AllocationRule::prioritized; `asked` itself, bit by bit, where
/// the rotors can produce it. An entry that is not finite counts as out of reach.
///
/// 1. Roll and pitch torque are multiplied by the largest factor, at most 1, for which some
///    collective thrust keeps all rotors within their limits.
/// 2. The thrust is moved into the range in which they are, not below the floor where that range
///    allows it.
/// 3. The yaw torque is multiplied by the largest factor, at most 1, that then remains.
template <class T>
[[nodiscard]] LimitedWrench<T> prioritized(const Allocation<T>& allocation,
                                           const ThrustLimits<T>& limits,
                                           const Eigen::Matrix<T, 4, 1>& asked) {
  // A limit counts as kept within this share of the weight, so that rounding limits nothing.
  const T slack = T(1e-9) * allocation.wrench0(0);
  LimitedWrench<T> result{asked, false};
  MaskOf<T> within = asked(0) >= limits.floor;
  const RotorSpeeds<T> thrusts = thrusts_of_wrench(allocation, asked);
  for (int i = 0; i < allocation.rotors; ++i) {
    const auto k = static_cast<std::size_t>(i);
    within = both(within, both(thrusts(i) >= limits.least[k] - slack,
                               thrusts(i) <= limits.greatest[k] + slack));
  }
  result.limited = negated(within);
  if (!any(result.limited)) return result;

  // Rotor i carries b + e T + s d of the collective T and of the share s of roll and pitch torque.
  const T x = select(is_finite(asked(1)), asked(1), T(0));
  const T y = select(is_finite(asked(2)), asked(2), T(0));
  const T z = select(is_finite(asked(3)), asked(3), T(0));
  const T collective = select(is_finite(asked(0)), asked(0), allocation.wrench0(0));
  RotorSpeeds<T> b(allocation.rotors), d(allocation.rotors);
  for (int i = 0; i < allocation.rotors; ++i) {
    b(i) = allocation.thrust0(i);
    for (int j = 0; j < 4; ++j) b(i) -= allocation.P(i, j) * allocation.wrench0(j);
    d(i) = allocation.P(i, 1) * x + allocation.P(i, 2) * y;
  }
  const auto lifts = [&](int i) { return allocation.P(i, 0) > T(0); };
  const auto least_collective = [&](int i, const T& s) {
    return (limits.least[static_cast<std::size_t>(i)] - b(i) - s * d(i)) / allocation.P(i, 0);
  };
  const auto greatest_collective = [&](int i, const T& s) {
    return (limits.greatest[static_cast<std::size_t>(i)] - b(i) - s * d(i)) / allocation.P(i, 0);
  };
  T share = T(1);
  for (int i = 0; i < allocation.rotors; ++i)
    for (int j = 0; j < allocation.rotors; ++j) {
      if (i == j) continue;
      const T room = greatest_collective(j, T(0)) - least_collective(i, T(0));
      const T need = d(j) / allocation.P(j, 0) - d(i) / allocation.P(i, 0);
      const MaskOf<T> counts = both(both(lifts(i), lifts(j)), need > T(0));
      share = select(counts, lesser(share, greater(room, T(0)) / need), share);
    }
  T low = limits.floor, high = T(std::numeric_limits<double>::infinity());
  for (int i = 0; i < allocation.rotors; ++i) {
    low = select(lifts(i), greater(low, least_collective(i, share)), low);
    high = select(lifts(i), lesser(high, greatest_collective(i, share)), high);
  }
  const T thrust = lesser(greater(collective, low), high);
  T yaw = T(1);
  for (int i = 0; i < allocation.rotors; ++i) {
    const auto k = static_cast<std::size_t>(i);
    const T carried = b(i) + allocation.P(i, 0) * thrust + share * d(i);
    const T more = allocation.P(i, 3) * z;
    const T room = select(more > T(0), limits.greatest[k] - carried, carried - limits.least[k]);
    yaw = select(more == T(0), yaw, lesser(yaw, greater(room, T(0)) / magnitude(more)));
  }
  const Eigen::Matrix<T, 4, 1> made = {thrust, share * x, share * y, yaw * z};
  for (int j = 0; j < 4; ++j) result.wrench(j) = select(result.limited, made(j), result.wrench(j));
  return result;
}

/// The wrench that is left where each rotor's thrust is cut at its own limit.
template <class T>
[[nodiscard]] LimitedWrench<T> clipped(const Allocation<T>& allocation,
                                       const ThrustLimits<T>& limits,
                                       const Eigen::Matrix<T, 4, 1>& asked) {
  LimitedWrench<T> result{asked, false};
  RotorSpeeds<T> thrusts = thrusts_of_wrench(allocation, asked);
  for (int i = 0; i < allocation.rotors; ++i) {
    const auto k = static_cast<std::size_t>(i);
    const T cut = clamped(thrusts(i), limits.least[k], limits.greatest[k]);
    result.limited = either(result.limited, negated(cut == thrusts(i)));
    thrusts(i) = cut;
  }
  if (!any(result.limited)) return result;
  const Eigen::Matrix<T, 4, 1> made = wrench_of_thrusts(allocation, thrusts);
  for (int j = 0; j < 4; ++j) result.wrench(j) = select(result.limited, made(j), result.wrench(j));
  return result;
}

}  // namespace quadtune
