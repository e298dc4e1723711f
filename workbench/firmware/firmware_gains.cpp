// SPDX-License-Identifier: Apache-2.0
#include "quadtune/workbench/firmware/firmware_gains.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "firmware/turn_parts.hpp"
#include "quadtune/exports/firmware_filters.hpp"
#include "quadtune/workbench/firmware/firmware_import.hpp"

namespace quadtune {
namespace {

/// Ms up to this factor above its bound is accepted: the bound is met by iteration.
constexpr double kSlack = 1.02;

/// The group of axes whose gains include a rotation loop, as an index into kFlownAxes.
std::size_t group_of(CascadeAxis axis) {
  const FlownAxis flown = axis == CascadeAxis::pitch  ? FlownAxis::north
                          : axis == CascadeAxis::roll ? FlownAxis::east
                                                      : FlownAxis::yaw;
  return static_cast<std::size_t>(std::find(kFlownAxes.begin(), kFlownAxes.end(), flown) -
                                  kFlownAxes.begin());
}

/// Searches the bound on the Ms of the flown loop with which the firmware's loop meets a bound.
class BoundSearch {
 public:
  BoundSearch() = default;
  explicit BoundSearch(double bound) : target_(bound), asked_(bound) {}

  /// The bound for the next design, smaller than that of the last one.
  /// @param Ms  of the firmware's loop in the last design
  double next(double Ms) {
    // Ms - 1 is roughly proportional to the bandwidth. Later, the secant through the last two
    // designs is more accurate.
    double bound = 1 + (target_ - 1) / (Ms - 1) * (asked_ - 1);
    if (last_Ms_ > Ms) bound = asked_ + (target_ - Ms) * (asked_ - last_asked_) / (Ms - last_Ms_);
    last_asked_ = asked_;
    last_Ms_ = Ms;
    const double from = asked_ - 1;
    return asked_ = std::max(1.05, 1 + std::clamp(bound - 1, 0.5 * from, 0.98 * from));
  }

 private:
  double target_ = 0;
  double asked_ = 0;
  double last_asked_ = 0;
  double last_Ms_ = 0;
};

/// The loop of a group with the largest Ms in any of the firmwares.
struct WorstTurn {
  double Ms = 0;
  CascadeAxis axis = CascadeAxis::roll;
  const Firmware* firmware = nullptr;
};

std::array<WorstTurn, kFlownAxes.size()> worst_turns(const Vehicle& vehicle,
                                                     const std::vector<Firmware>& firmwares,
                                                     const CascadeGains& cascade) {
  constexpr double kUnstable = 100;
  std::array<WorstTurn, kFlownAxes.size()> worst;
  for (const Firmware& firmware : firmwares) {
    const std::vector<Parameter> values = firmware_parameters(firmware, vehicle, cascade).values;
    for (const FirmwareTurn& turn : firmware_turns(firmware, vehicle, values)) {
      WorstTurn& group = worst[group_of(turn.gains.axis)];
      const double Ms = turn.whole.stable ? turn.whole.Ms : kUnstable;
      if (Ms > group.Ms) group = {Ms, turn.gains.axis, &firmware};
    }
  }
  return worst;
}

/// The time constant of the filters before the derivative of the rate of roll [s], the longest of
/// the firmwares; 0 without a firmware.
double derivative_filter(const std::vector<Firmware>& firmwares) {
  double filter = 0;
  for (const Firmware& firmware : firmwares)
    filter = std::max(filter, internal::derivative_time(firmware, CascadeAxis::roll,
                                                        ParameterValues(firmware, {})));
  return filter;
}

/// Lets the roll and pitch loops act on the derivative of the rate, which compensates a part of the
/// motor lag: with the requested lead, or else, if all firmwares are PX4 or ArduPilot, with a share
/// of the motor lag.
void choose_lead(const Vehicle& vehicle, const std::vector<Firmware>& firmwares,
                 FlownGainsOptions& options) {
  const double filter = derivative_filter(firmwares);
  if (!options.rate_lead && filter > 0 &&
      std::all_of(firmwares.begin(), firmwares.end(), [](const Firmware& firmware) {
        return firmware.kind == FirmwareKind::px4 || firmware.kind == FirmwareKind::ardupilot;
      }))
    options.rate_lead = internal::usual_rate_lead(vehicle);
  if (options.rate_lead.value_or(0) == 0 || options.rate_filter > 0) return;
  // That of the defaults of PX4 and ArduPilot, 20 ms to 5.3 ms and 27 ms to 8 ms.
  constexpr double kLeadPerFilter = 4;
  options.rate_filter = firmwares.empty() ? *options.rate_lead / kLeadPerFilter : filter;
}

/// The factor by which the lead of roll and pitch must be multiplied so that ArduPilot, whose D
/// acts on the error of the rate, can represent both loops; 1 if it can represent them already.
double lead_factor(const CascadeGains& gains) {
  constexpr double kReserve = 0.9;
  double factor = 1;
  for (const PidLoop& loop : gains.loops) {
    if (loop.rate_lead == 0) continue;
    const double a = std::abs(loop.Kp / loop.Kd), b = std::abs(loop.Ki / loop.Kd);
    if (!internal::exists_with_error_lead(a, b, loop.rate_lead))
      factor = std::min({factor, kReserve, kReserve * 0.25 / a / loop.rate_lead});
  }
  return factor;
}

}  // namespace

CascadeStructure structure_of(FirmwareKind kind) {
  return kind == FirmwareKind::crazyflie ? CascadeStructure::pid : CascadeStructure::p_pi;
}

FlownGains firmware_gains(const Vehicle& vehicle, const std::vector<Firmware>& firmwares,
                          FlownGainsOptions options) {
  for (const Firmware& firmware : firmwares)
    if (structure_of(firmware.kind) == CascadeStructure::p_pi)
      options.structure = CascadeStructure::p_pi;
  const bool lead_is_free = !options.rate_lead;
  choose_lead(vehicle, firmwares, options);
  const double bound = options.bounds.Ms;
  FlownGains gains = flown_gains(vehicle, options);
  const bool on_error = std::any_of(firmwares.begin(), firmwares.end(), [](const Firmware& one) {
    return one.kind == FirmwareKind::ardupilot;
  });
  constexpr int kMaxShorterLeads = 8;
  for (int i = 0; lead_is_free && on_error && i < kMaxShorterLeads; ++i) {
    const double factor = lead_factor(as_cascade(gains, options.dt));
    if (factor == 1) break;
    options.rate_lead = factor * *options.rate_lead;
    gains = flown_gains(vehicle, options);
  }
  std::array<BoundSearch, kFlownAxes.size()> searches;
  searches.fill(BoundSearch(bound));
  constexpr int kMaxRedesigns = 8;
  for (int i = 0;; ++i) {
    const auto worst = worst_turns(vehicle, firmwares, as_cascade(gains, options.dt));
    std::vector<FlownAxis> exceeding;
    for (std::size_t k = 0; k < worst.size(); ++k) {
      if (worst[k].Ms <= bound * kSlack) continue;
      exceeding.push_back(kFlownAxes[k]);
      options.axis_Ms[k] = searches[k].next(worst[k].Ms);
      if (i == kMaxRedesigns)
        gains.notes.push_back(
            fmt::format("{}: Ms is {:.3f} with the filters and the delay of {} {}, required is {}",
                        to_string(worst[k].axis), worst[k].Ms, to_string(worst[k].firmware->kind),
                        worst[k].firmware->version, bound));
    }
    if (exceeding.empty() || i == kMaxRedesigns) return gains;
    redesign(gains, exceeding, vehicle, options);
  }
}

}  // namespace quadtune
