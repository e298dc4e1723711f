// SPDX-License-Identifier: Apache-2.0
/// The behaviour of flight code if the motors cannot produce the commanded wrench.
/// Theory: docs/theory.md, "Commands beyond the motors".
#pragma once

#include <array>
#include <string>

#include "quadtune/control/allocation.hpp"
#include "quadtune/model/vehicle.hpp"
#include "quadtune/scalar.hpp"

namespace quadtune {

/// The rule by which a wrench is reduced if the motors cannot produce all of it.
enum class AllocationRule {
  /// Reduces yaw torque first, then thrust; roll and pitch torque last and in proportion to each
  /// other. The thrust is raised or lowered as far as roll and pitch torque require it.
  prioritized,
  /// Saturates each motor's command at its own limit, as the source programs do.
  clipped,
};
/// "prioritized" or "clipped".
[[nodiscard]] std::string to_string(AllocationRule rule);
/// @throws InvalidInput  with the unknown name and the two valid ones.
[[nodiscard]] AllocationRule allocation_rule(const std::string& name, const std::string& where);

/// Settings: the range of each rotor's thrust as known to the flight code.
template <class T>
struct ThrustLimits {
  std::array<T, kMaxRotors> min{};  ///< [N]
  std::array<T, kMaxRotors> max{};  ///< [N]
  /// Lower bound of the collective thrust [N], ≥ 0.
  T floor = T(0);
};

/// Minimum collective thrust under AllocationRule::prioritized, as a fraction of the weight:
/// stopped rotors would need their lag time before they produce a torque again.
inline constexpr double kMinCollective = 0.15;

/// The thrusts at the minimum and maximum command of the motors, and the lower bound `floor`.
/// @throws InvalidInput  as allocation()
[[nodiscard]] ThrustLimits<double> thrust_limits(const Vehicle& vehicle);

/// A wrench that all rotors can produce within their limits, and whether it differs from the
/// request.
template <class T>
struct LimitedWrench {
  Eigen::Matrix<T, 4, 1> wrench = Eigen::Matrix<T, 4, 1>::Zero();  ///< [T τx τy τz]
  MaskOf<T> limited{};  ///< whether the wrench differs from the request
};

/// The thrusts that an allocation assigns to a wrench, before limits [N].
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

/// The wrench of thrusts: the inverse of thrusts_of_wrench() on its range.
template <class T>
[[nodiscard]] Eigen::Matrix<T, 4, 1> wrench_of_thrusts(const Allocation<T>& allocation,
                                                       const RotorSpeeds<T>& thrusts) {
  Eigen::Matrix<T, 4, 1> wrench = allocation.wrench0;
  for (int j = 0; j < 4; ++j)
    for (int i = 0; i < allocation.rotors; ++i)
      wrench(j) += allocation.M(j, i) * (thrusts(i) - allocation.thrust0(i));
  return wrench;
}

/// The wrench nearest to `asked` under AllocationRule::prioritized. Returns `asked` unchanged, bit
/// by bit, if the rotors can produce it and its thrust is not below the floor. Otherwise, a torque
/// that is not finite is replaced by 0, and a thrust that is not finite by that of hover; then:
///
/// 1. Roll and pitch torque are multiplied by the largest factor, at most 1, for which some
///    collective thrust keeps all rotors within their limits.
/// 2. The thrust is moved into that range of collective thrusts, and not below the floor if the
/// range allows it.
/// 3. The yaw torque is multiplied by the largest factor, at most 1, that is then feasible.
template <class T>
[[nodiscard]] LimitedWrench<T> prioritized(const Allocation<T>& allocation,
                                           const ThrustLimits<T>& limits,
                                           const Eigen::Matrix<T, 4, 1>& asked) {
  // Limits are checked with this fraction of the weight as tolerance, so that rounding does not
  // saturate.
  const T slack = T(1e-9) * allocation.wrench0(0);
  LimitedWrench<T> result{asked, false};
  MaskOf<T> within = asked(0) >= limits.floor;
  const RotorSpeeds<T> thrusts = thrusts_of_wrench(allocation, asked);
  for (int i = 0; i < allocation.rotors; ++i) {
    const auto k = static_cast<std::size_t>(i);
    within = logical_and(within, logical_and(thrusts(i) >= limits.min[k] - slack,
                                             thrusts(i) <= limits.max[k] + slack));
  }
  result.limited = logical_not(within);
  if (!any(result.limited)) return result;

  // The thrust of rotor i is b + e T + s d for collective thrust T and fraction s of roll and pitch
  // torque.
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
  const auto min_collective = [&](int i, const T& s) {
    return (limits.min[static_cast<std::size_t>(i)] - b(i) - s * d(i)) / allocation.P(i, 0);
  };
  const auto max_collective = [&](int i, const T& s) {
    return (limits.max[static_cast<std::size_t>(i)] - b(i) - s * d(i)) / allocation.P(i, 0);
  };
  T share = T(1);
  for (int i = 0; i < allocation.rotors; ++i)
    for (int j = 0; j < allocation.rotors; ++j) {
      if (i == j) continue;
      const T room = max_collective(j, T(0)) - min_collective(i, T(0));
      const T need = d(j) / allocation.P(j, 0) - d(i) / allocation.P(i, 0);
      const MaskOf<T> counts = logical_and(logical_and(lifts(i), lifts(j)), need > T(0));
      share = select(counts, min_of(share, max_of(room, T(0)) / need), share);
    }
  T low = limits.floor, high = T(std::numeric_limits<double>::infinity());
  for (int i = 0; i < allocation.rotors; ++i) {
    low = select(lifts(i), max_of(low, min_collective(i, share)), low);
    high = select(lifts(i), min_of(high, max_collective(i, share)), high);
  }
  const T thrust = min_of(max_of(collective, low), high);
  T yaw = T(1);
  for (int i = 0; i < allocation.rotors; ++i) {
    const auto k = static_cast<std::size_t>(i);
    const T carried = b(i) + allocation.P(i, 0) * thrust + share * d(i);
    const T more = allocation.P(i, 3) * z;
    const T room = select(more > T(0), limits.max[k] - carried, carried - limits.min[k]);
    yaw = select(more == T(0), yaw, min_of(yaw, max_of(room, T(0)) / abs_of(more)));
  }
  const Eigen::Matrix<T, 4, 1> made = {thrust, share * x, share * y, yaw * z};
  for (int j = 0; j < 4; ++j) result.wrench(j) = select(result.limited, made(j), result.wrench(j));
  return result;
}

/// The wrench that results if each rotor's thrust saturates at its own limit.
template <class T>
[[nodiscard]] LimitedWrench<T> clipped(const Allocation<T>& allocation,
                                       const ThrustLimits<T>& limits,
                                       const Eigen::Matrix<T, 4, 1>& asked) {
  LimitedWrench<T> result{asked, false};
  RotorSpeeds<T> thrusts = thrusts_of_wrench(allocation, asked);
  for (int i = 0; i < allocation.rotors; ++i) {
    const auto k = static_cast<std::size_t>(i);
    const T cut = clamped(thrusts(i), limits.min[k], limits.max[k]);
    result.limited = logical_or(result.limited, logical_not(cut == thrusts(i)));
    thrusts(i) = cut;
  }
  if (!any(result.limited)) return result;
  const Eigen::Matrix<T, 4, 1> made = wrench_of_thrusts(allocation, thrusts);
  for (int j = 0; j < 4; ++j) result.wrench(j) = select(result.limited, made(j), result.wrench(j));
  return result;
}

}  // namespace quadtune
