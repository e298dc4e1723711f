// SPDX-License-Identifier: Apache-2.0
#include "arguments/cascade_arguments.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include "arguments/matrix_arguments.hpp"
#include "arguments/read_number.hpp"
#include "program/command_line.hpp"
#include "program/program.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/internal/suggest.hpp"
#include "quadtune/internal/text_file.hpp"
#include "report/text/print.hpp"

namespace quadtune::cli {
namespace {

/// The sample rate of a flight computer, where nothing else is known.
constexpr double kUsualPeriod = 0.005;  // [s]

CascadeAxis axis_of(const std::string& name, const std::string& option) {
  try {
    return cascade_axis(name, option);
  } catch (const InvalidInput& error) {
    throw UsageError(std::string("quadtune pid: ") + error.what(), option);
  }
}

/// Calls `use` for "roll=40,x=2", and before that for all loops where a number stands alone.
template <class Use>
void each_axis(const std::string& text, const std::string& option, const char* what,
               const Use& use) {
  std::array<bool, kCascadeAxes> came{};
  const auto once = [&](CascadeAxis axis, double value) {
    if (std::exchange(came[index_of(axis)], true))
      throw UsageError(fmt::format("quadtune pid: {} names loop '{}' twice, expected each once",
                                   option, to_string(axis)),
                       option);
    use(axis, value);
  };
  for (const std::string& word : word_list(text)) {
    const std::size_t sign = word.find('=');
    double value = 0;
    const std::string digits = sign == std::string::npos ? word : word.substr(sign + 1);
    if (!read_number(digits, value) || !(value >= 0))
      throw UsageError(fmt::format("quadtune pid: {} has '{}', expected {}", option,
                                   internal::printable(word), what),
                       option);
    if (sign != std::string::npos)
      once(axis_of(word.substr(0, sign), option), value);
    else
      for (const CascadeAxis axis : kAllCascadeAxes) use(axis, value);  // named ones follow
  }
}

void read_bandwidths(const std::string& text, CascadeSpecification& specification) {
  const double nyquist = std::numbers::pi / specification.dt;
  each_axis(text, "--bandwidth", "a list like roll=40,x=2 in rad/s",
            [&](CascadeAxis axis, double w) {
              if (!(w > 0) || !(w < nyquist))
                throw UsageError(
                    fmt::format("quadtune pid: --bandwidth of {} is {} rad/s, expected more than 0 "
                                "and less than pi/dt = {}",
                                to_string(axis), number(w), number(nyquist)),
                    "--bandwidth");
              specification.requirements[index_of(axis)].bandwidth = w;
            });
}

void read_integrals(const std::string& text, CascadeSpecification& specification) {
  for (CascadeRequirement& requirement : specification.requirements) requirement.integral = false;
  const std::vector<std::string> names = word_list(text);
  if (names == std::vector<std::string>{"none"}) return;
  for (const std::string& name : names) {
    bool& integral = specification.requirements[index_of(axis_of(name, "--integral"))].integral;
    if (std::exchange(integral, true))
      throw UsageError(
          fmt::format("quadtune pid: --integral names loop '{}' twice, expected each once", name),
          "--integral");
  }
}

void require_more_than_one(double value, const std::string& option) {
  if (!(value > 1))
    throw UsageError(fmt::format("quadtune pid: {} is {}, expected more than 1 because an integral "
                                 "makes it at least 1",
                                 option, number(value)),
                     option);
}

}  // namespace

void add_cascade_options(CommandLine& line, CascadeArguments& arguments) {
  line.add_number("--dt", arguments.dt,
                  "with V: sample period [s]; that of its published gains, or 0.005")
      ->type_name("T");
  line.add_option(
          "--bandwidth", arguments.bandwidth,
          "with V: where the rate's loop crosses 1 [rad/s]: roll=40,x=2, or one number for all")
      ->type_name("LIST");
  line.add_option(
          "--sensor-delay", arguments.sensor_delay,
          "with V: how late the loops see their values [s]: one number, or roll=0.005,x=0.02")
      ->type_name("LIST");
  line.add_number("--motor-lag", arguments.motor_lag,
                  "with V: time constant of the motors [s]; the vehicle's")
      ->type_name("S");
  line.add_number("--tracking-max", arguments.tracking_max,
                  "with V: max |value / set point| up to this; 1.3")
      ->type_name("M");
  line.add_option("--integral", arguments.integral,
                  "with V: loops that have an integral, or none; all")
      ->type_name("LIST");
  line.add_option("--integrator", arguments.integrator,
                  "with V: euler (default), backward-euler or tustin")
      ->type_name("NAME");
  line.add_flag(
      "--free", arguments.free,
      "with V: do not hold the loops to the Ms, noise and load peak of the published gains");
}

const std::vector<std::string>& cascade_option_names() {
  static const std::vector<std::string> names = {"--dt",         "--bandwidth",    "--sensor-delay",
                                                 "--motor-lag",  "--tracking-max", "--integral",
                                                 "--integrator", "--free"};
  return names;
}

CascadeSpecification cascade_specification(const CommandLine& line,
                                           const CascadeArguments& arguments, double Ms_max,
                                           const Vehicle& vehicle) {
  const auto came = [&](const char* name) { return line.was_given(name); };
  CascadeSpecification specification;
  specification.dt = vehicle.published_cascade ? vehicle.published_cascade->gains.dt : kUsualPeriod;
  if (came("--dt")) {
    require_positive(arguments.dt, "pid", "--dt");
    specification.dt = arguments.dt;
  }
  specification.method = [&] {
    try {
      return pid_method(arguments.integrator, "--integrator");
    } catch (const InvalidInput& error) {
      throw UsageError(std::string("quadtune pid: ") + error.what(), "--integrator");
    }
  }();
  if (came("--motor-lag")) {
    if (arguments.motor_lag < 0 || arguments.motor_lag > kLongestLag)
      throw UsageError(fmt::format("quadtune pid: --motor-lag is {} s, expected 0 to {} s",
                                   number(arguments.motor_lag), number(kLongestLag)),
                       "--motor-lag");
    specification.lag = arguments.motor_lag;
  }
  each_axis(arguments.sensor_delay, "--sensor-delay",
            "seconds, 0 or more, or a list like roll=0.005,x=0.02",
            [&](CascadeAxis axis, double delay) {
              if (delay > kMostDelaySamples * specification.dt)
                throw UsageError(
                    fmt::format("quadtune pid: --sensor-delay of {} is {} s, expected no more than "
                                "{} samples, {} s",
                                to_string(axis), number(delay), kMostDelaySamples,
                                number(kMostDelaySamples * specification.dt)),
                    "--sensor-delay");
              specification.delay[index_of(axis)] = delay;
            });
  read_bandwidths(arguments.bandwidth, specification);
  if (came("--integral")) read_integrals(arguments.integral, specification);
  for (CascadeRequirement& requirement : specification.requirements) {
    if (came("--Ms-max")) requirement.Ms_max = Ms_max;
    if (came("--tracking-max")) requirement.tracking_max = arguments.tracking_max;
  }
  if (came("--Ms-max")) require_more_than_one(Ms_max, "--Ms-max");
  if (came("--tracking-max")) require_more_than_one(arguments.tracking_max, "--tracking-max");
  specification.use_published = !arguments.free;
  return specification;
}

}  // namespace quadtune::cli
