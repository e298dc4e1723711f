// SPDX-License-Identifier: Apache-2.0
#include "quadtune/workbench/schedule/schedule_axes.hpp"

#include <fmt/format.h>

#include <cmath>

#include "quadtune/errors.hpp"
#include "quadtune/internal/text_file.hpp"
#include "quadtune/internal/words.hpp"

namespace quadtune {
namespace {

/// A step reaches the last value if it misses it by at most this share of the step.
constexpr double kRounding = 1e-6;

[[noreturn]] void refuse(const std::string& message) {
  throw OptionError("schedule", "schedule: " + message);
}

std::string without_blanks_around(const std::string& text) {
  const std::size_t first = text.find_first_not_of(" \t");
  if (first == std::string::npos) return "";
  return text.substr(first, text.find_last_not_of(" \t") - first + 1);
}

double number_of(const std::string& word, const std::string& axis) {
  double value = 0;
  if (!internal::read_number(without_blanks_around(word), value))
    refuse(
        fmt::format("'{}' in axis {} is not a finite number, expected first:step:last or one "
                    "value",
                    internal::printable(word), axis));
  return value;
}

/// The value i steps after the first, as the decimal number that was meant: 0.95 and not
/// 0.9500000000000001, and 0 if steps from below reach it.
double stepped(double first, double step, Eigen::Index i) {
  const double value = first + static_cast<double>(i) * step;
  if (std::abs(value) < kRounding * step) return 0;
  return std::stod(fmt::format("{:.14g}", value));
}

std::vector<double> range_values(double first, double step, double last, const std::string& axis) {
  if (!(step > 0)) refuse(fmt::format("axis {} has step {}, expected more than 0", axis, step));
  if (last < first)
    refuse(
        fmt::format("axis {} goes from {} to {}, expected a last value not below the "
                    "first",
                    axis, first, last));
  const double steps = (last - first) / step;
  if (!(steps < static_cast<double>(kMaxSchedulePoints)))
    refuse(fmt::format("axis {} has {:.6g} points, expected at most {}", axis, steps + 1,
                       kMaxSchedulePoints));
  const auto count = static_cast<Eigen::Index>(std::llround(steps));
  if (std::abs(steps - static_cast<double>(count)) > kRounding)
    refuse(
        fmt::format("axis {} goes from {} to {} in {:.6g} steps of {}, expected a whole number, "
                    "so that the last value belongs to the grid",
                    axis, first, last, steps, step));
  std::vector<double> values;
  values.reserve(static_cast<std::size_t>(count) + 1);
  for (Eigen::Index i = 0; i < count; ++i) values.push_back(stepped(first, step, i));
  values.push_back(last);
  return values;
}

std::vector<std::string> split(const std::string& text, char at) {
  std::vector<std::string> parts(1);
  for (const char c : text) {
    if (c == at)
      parts.emplace_back();
    else
      parts.back() += c;
  }
  return parts;
}

ScheduleAxis axis_of(const std::string& text, const std::string& where) {
  const std::size_t equals = text.find('=');
  if (equals == std::string::npos)
    refuse(fmt::format(
        "'{}' is malformed; expected axes such as speed=0:0.5:10 or mass=1, separated by "
        "commas",
        internal::printable(text)));
  const std::string name = without_blanks_around(text.substr(0, equals));
  ScheduleAxis axis;
  axis.quantity = schedule_quantity(internal::printable(name), where);
  const std::vector<std::string> words = split(text.substr(equals + 1), ':');
  if (words.size() == 1) {
    axis.values = {number_of(words[0], name)};
  } else if (words.size() == 3) {
    axis.values = range_values(number_of(words[0], name), number_of(words[1], name),
                               number_of(words[2], name), name);
  } else {
    refuse(fmt::format("axis {} has {} numbers, expected first:step:last or one value", name,
                       words.size()));
  }
  return axis;
}

}  // namespace

std::vector<ScheduleAxis> schedule_axes(const std::string& text, const std::string& where) {
  std::vector<ScheduleAxis> axes;
  for (const std::string& part : split(text, ',')) {
    const std::string axis = without_blanks_around(part);
    if (axis.empty())
      refuse("an axis is empty, expected axes such as speed=0:0.5:10, separated by commas");
    axes.push_back(axis_of(axis, where));
  }
  (void)checked_grid_size(axes, where);
  return axes;
}

}  // namespace quadtune
