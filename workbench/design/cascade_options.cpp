// SPDX-License-Identifier: Apache-2.0
#include "quadtune/workbench/design/cascade_options.hpp"

#include <fmt/format.h>

#include <array>
#include <numbers>
#include <utility>
#include <vector>

#include "design/positive_option.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/internal/text_file.hpp"
#include "quadtune/internal/words.hpp"
#include "quadtune/workbench/design/chosen_law.hpp"

namespace quadtune {
namespace {

/// Formats a number for messages.
std::string number(double value) { return fmt::format("{:.6g}", value); }

CascadeAxis axis_of(const std::string& name, const std::string& key) {
  try {
    return cascade_axis(name, key);
  } catch (const InvalidInput& error) {
    throw OptionError(key, error.what());
  }
}

PidMethod method_of(const std::string& word) {
  try {
    return pid_method(word, "integrator");
  } catch (const InvalidInput& error) {
    throw OptionError("integrator", error.what());
  }
}

CascadeStructure structure_of(const std::string& word) {
  try {
    return cascade_structure(word, "structure");
  } catch (const InvalidInput& error) {
    throw OptionError("structure", error.what());
  }
}

/// Calls `use` for each entry of "roll=40,x=2"; a number without a loop applies to all loops first.
template <class Use>
void each_axis(const std::string& text, const std::string& key, const char* what, const Use& use) {
  std::array<bool, kCascadeAxes> came{};
  const auto once = [&](CascadeAxis axis, double value) {
    if (std::exchange(came[index_of(axis)], true))
      throw OptionError(key, fmt::format("{} has loop '{}' twice; expected each loop once", key,
                                         to_string(axis)));
    use(axis, value);
  };
  for (const std::string& word : internal::comma_separated(text)) {
    const std::size_t sign = word.find('=');
    double value = 0;
    const std::string digits = sign == std::string::npos ? word : word.substr(sign + 1);
    if (!internal::read_number(digits, value) || !(value >= 0))
      throw OptionError(
          key, fmt::format("{} has '{}', expected {}", key, internal::printable(word), what));
    if (sign != std::string::npos)
      once(axis_of(word.substr(0, sign), key), value);
    else
      for (const CascadeAxis axis : kAllCascadeAxes) use(axis, value);  // named loops override it
  }
}

void read_sensor_delays(const std::string& text, CascadeSpecification& specification) {
  const double max = kMaxDelaySamples * specification.dt;
  each_axis(text, "sensor-delay", "seconds, 0 or more, or a list like roll=0.005,x=0.02",
            [&](CascadeAxis axis, double delay) {
              if (delay > max)
                throw OptionError(
                    "sensor-delay",
                    fmt::format("sensor-delay of {} is {} s, expected at most "
                                "{} samples, {} s",
                                to_string(axis), number(delay), kMaxDelaySamples, number(max)));
              specification.delay[index_of(axis)] = delay;
            });
}

void read_bandwidths(const std::string& text, CascadeSpecification& specification) {
  const double nyquist = std::numbers::pi / specification.dt;
  each_axis(text, "bandwidth", "a list like roll=40,x=2 in rad/s", [&](CascadeAxis axis, double w) {
    if (!(w > 0) || !(w < nyquist))
      throw OptionError("bandwidth",
                        fmt::format("bandwidth of {} is {} rad/s, expected more than 0 and less "
                                    "than pi/dt = {}",
                                    to_string(axis), number(w), number(nyquist)));
    specification.requirements[index_of(axis)].bandwidth = w;
  });
}

void read_integrals(const std::string& text, CascadeSpecification& specification) {
  for (CascadeRequirement& requirement : specification.requirements) requirement.integral = false;
  const std::vector<std::string> names = internal::comma_separated(text);
  if (names == std::vector<std::string>{"none"}) return;
  for (const std::string& name : names) {
    bool& integral = specification.requirements[index_of(axis_of(name, "integral"))].integral;
    if (std::exchange(integral, true))
      throw OptionError("integral",
                        fmt::format("integral has loop '{}' twice; expected each loop once", name));
  }
}

void require_more_than_one(const std::string& key, const std::optional<double>& value) {
  if (value && !(*value > 1))
    throw OptionError(key, fmt::format("{} is {}, expected more than 1, because the peak "
                                       "of a loop with an integral is at least 1",
                                       key, number(*value)));
}

}  // namespace

CascadeSpecification cascade_specification(const CascadeOptions& options, const Vehicle& vehicle) {
  CascadeSpecification specification = usual_specification(vehicle);
  if (options.dt) {
    require_positive_option("dt", *options.dt, "seconds");
    specification.dt = *options.dt;
  }
  if (options.integrator) specification.method = method_of(*options.integrator);
  if (options.structure) specification.structure = structure_of(*options.structure);
  if (options.motor_lag && !(*options.motor_lag >= 0 && *options.motor_lag <= kMaxLag))
    throw OptionError("motor-lag", fmt::format("motor-lag is {} s, expected 0 to {} s",
                                               number(*options.motor_lag), number(kMaxLag)));
  if (options.rate_lead && !(*options.rate_lead >= 0 && *options.rate_lead <= kMaxLag))
    throw OptionError("rate-lead", fmt::format("rate-lead is {} s, expected 0 to {} s",
                                               number(*options.rate_lead), number(kMaxLag)));
  specification.lag = options.motor_lag;
  read_sensor_delays(options.sensor_delay.value_or(""), specification);
  read_bandwidths(options.bandwidth.value_or(""), specification);
  if (options.integral) read_integrals(*options.integral, specification);
  for (CascadeRequirement& requirement : specification.requirements) {
    if (options.Ms_max) requirement.Ms_max = *options.Ms_max;
    if (options.tracking_max) requirement.tracking_max = *options.tracking_max;
  }
  require_more_than_one("Ms-max", options.Ms_max);
  require_more_than_one("tracking-max", options.tracking_max);
  specification.use_published = options.use_published.value_or(true);
  return specification;
}

}  // namespace quadtune
