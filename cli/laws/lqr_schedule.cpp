// SPDX-License-Identifier: Apache-2.0
#include "laws/lqr_schedule.hpp"

#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <optional>
#include <ostream>

#include "arguments/matrix_arguments.hpp"
#include "arguments/read_number.hpp"
#include "program/program.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/exports/schedule_table.hpp"
#include "quadtune/internal/text_file.hpp"
#include "quadtune/linearize/linearize.hpp"
#include "quadtune/tuning/schedule.hpp"
#include "report/text/print.hpp"

namespace quadtune::cli {
namespace {

constexpr char kOption[] = "--schedule";
/// A step leads to the last value when it misses it by no more than this share of itself.
constexpr double kRounding = 1e-6;

[[noreturn]] void refuse(const std::string& message) {
  throw UsageError(std::string("quadtune lqr: ") + kOption + ": " + message, kOption);
}

std::string without_blanks_around(const std::string& text) {
  const std::size_t first = text.find_first_not_of(" \t");
  if (first == std::string::npos) return "";
  return text.substr(first, text.find_last_not_of(" \t") - first + 1);
}

double number_of(const std::string& word, const std::string& axis) {
  double value = 0;
  if (!read_number(without_blanks_around(word), value))
    refuse(
        fmt::format("'{}' in axis {} is not a finite number, expected first:step:last or one "
                    "value",
                    internal::printable(word), axis));
  return value;
}

/// i steps from the first value, as decimal as it was written: 0.9, 0.95 and not
/// 0.9500000000000001, and 0 where steps from below meet it.
double stepped(double first, double step, Eigen::Index i) {
  const double value = first + static_cast<double>(i) * step;
  if (std::abs(value) < kRounding * step) return 0;
  return std::stod(fmt::format("{:.14g}", value));
}

std::vector<double> range_values(double first, double step, double last, const std::string& axis) {
  if (!(step > 0)) refuse(fmt::format("axis {} has step {}, expected more than 0", axis, step));
  if (last < first)
    refuse(
        fmt::format("axis {} goes from {} to {}, expected a last value that is no less than the "
                    "first",
                    axis, first, last));
  const double steps = (last - first) / step;
  if (!(steps < static_cast<double>(kMostSchedulePoints)))
    refuse(fmt::format("axis {} has {:.3g} steps, expected no more than {} points", axis, steps,
                       kMostSchedulePoints));
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

ScheduleAxis axis_of(const std::string& text) {
  const std::size_t equals = text.find('=');
  if (equals == std::string::npos)
    refuse(
        fmt::format("'{}' came, expected axes such as speed=0:0.5:10 or mass=1, separated by "
                    "commas",
                    internal::printable(text)));
  const std::string name = without_blanks_around(text.substr(0, equals));
  ScheduleAxis axis;
  axis.quantity = schedule_quantity(internal::printable(name), kOption);
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

std::string count_words(std::size_t count, const char* what) {
  return fmt::format("{} {}{}", count, what, count == 1 ? "" : "s");
}

std::string axis_text(const ScheduleAxis& axis) {
  const std::string of = unit(axis.quantity).empty() ? "" : " " + unit(axis.quantity);
  if (axis.values.size() == 1)
    return fmt::format("{:<9} {}{}", to_string(axis.quantity), number(axis.values[0]), of);
  return fmt::format("{:<9} {} ... {}{}, {} values", to_string(axis.quantity),
                     number(axis.values.front()), number(axis.values.back()), of,
                     axis.values.size());
}

std::string grid_text(const GainSchedule& schedule) {
  std::string text;
  for (const ScheduleAxis& axis : schedule.axes)
    text += (text.empty() ? "" : "\n") + axis_text(axis);
  return text;
}

/// Points of one status, and the first of them.
struct Tally {
  std::size_t count = 0;
  Eigen::Index first = 0;
};

Tally tally(const GainSchedule& schedule, PointStatus status) {
  Tally result;
  for (Eigen::Index i = schedule.size(); i-- > 0;) {
    if (schedule.status[static_cast<std::size_t>(i)] != status) continue;
    ++result.count;
    result.first = i;
  }
  return result;
}

std::string point_words(const GainSchedule& schedule, Eigen::Index point) {
  return grid_words(schedule.axes, grid_point(schedule.axes, point));
}

std::string example(const GainSchedule& schedule, Eigen::Index point) {
  return fmt::format("at {}: {}", point_words(schedule, point),
                     schedule.culprit[static_cast<std::size_t>(point)]);
}

/// "150 of 945 points have no gain, e.g. no trim at …"; empty when all have one.
std::string infeasible_words(const GainSchedule& schedule) {
  std::string words;
  for (const PointStatus status : {PointStatus::no_trim, PointStatus::no_gain}) {
    const Tally found = tally(schedule, status);
    if (found.count == 0) continue;
    words += fmt::format("{}{} of {}: {}, e.g. {}", words.empty() ? "" : "; ", found.count,
                         count_words(static_cast<std::size_t>(schedule.size()), "point"),
                         to_string(status), example(schedule, found.first));
  }
  return words;
}

void print_summary(const GainSchedule& schedule, Context& context) {
  const Tally solved = tally(schedule, PointStatus::solved);
  context.out << section("grid", grid_text(schedule))
              << section("points", fmt::format("{}, {} solved", schedule.size(), solved.count));
  for (const PointStatus status : {PointStatus::no_trim, PointStatus::no_gain}) {
    const Tally found = tally(schedule, status);
    if (found.count > 0)
      context.out << section(to_string(status),
                             fmt::format("{}, the first {}", count_words(found.count, "point"),
                                         example(schedule, found.first)));
  }
  Eigen::Index worst = solved.first;
  for (Eigen::Index i = 0; i < schedule.size(); ++i)
    if (schedule.solved(i) && schedule.residual(i) > schedule.residual(worst)) worst = i;
  const Gains gains = schedule.gains(solved.first);
  const auto inputs = names_or_numbers(gains.inputs, std::ssize(gains.inputs));
  context.out << section("residual", fmt::format("at most {:.2g}, at {}", schedule.residual(worst),
                                                 point_words(schedule, worst)))
              << section(
                     "first gain",
                     fmt::format("at {}\n{}", point_words(schedule, solved.first),
                                 table(gains.K, inputs,
                                       names_or_numbers(gains.states, std::ssize(gains.states)))));
  if (gains.K_int.size() > 0)
    context.out << section(
        "integral K",
        table(gains.K_int, inputs, names_or_numbers(gains.integrals, std::ssize(gains.integrals))));
}

SchedulePoint point_of(const Vehicle& vehicle, const GainSchedule& schedule, Eigen::Index point) {
  return schedule_point(vehicle, schedule.axes, grid_point(schedule.axes, point), schedule.yaw);
}

/// The point whose model tells a reader most: the last that turns, or else the last.
Eigen::Index telling_point(const Vehicle& vehicle, const GainSchedule& schedule) {
  Eigen::Index last = 0;
  for (Eigen::Index i = 0; i < schedule.size(); ++i)
    if (schedule.solved(i)) last = i;
  for (Eigen::Index i = schedule.size(); i-- > 0;) {
    const FlightKind kind = point_of(vehicle, schedule, i).condition.kind;
    if (schedule.solved(i) && (kind == FlightKind::circle || kind == FlightKind::spin)) return i;
  }
  return last;
}

/// What a reader must know of the models, told of one.
void note_model(const Vehicle& vehicle, const GainSchedule& schedule, const LqrDesign& design,
                const Context& context) {
  const Eigen::Index index = telling_point(vehicle, schedule);
  const SchedulePoint point = point_of(vehicle, schedule, index);
  Vehicle moved = vehicle;
  moved.mass = point.mass;
  TrimOptions air;
  air.density_ratio = point.density_ratio;
  for (const std::string& note :
       linearize(moved, point.condition, linearize_options(design), air).notes)
    context.note(fmt::format("lqr: note: at {}: {}", point_words(schedule, index), note));
}

LqrDesign schedule_design(const LqrArguments& arguments, const Vehicle& vehicle) {
  const LinearizeOptions options = linearize_options(arguments.plant);
  const ContinuousLti words = Linearizer(vehicle, options).unsolved().plant;
  return make_design(arguments, words.states, words.inputs);
}

/// How the table is to be written, if at all.
std::optional<TableFormat> wanted_table(const Context& context) {
  if (context.file.empty()) return context.json ? std::optional(TableFormat::json) : std::nullopt;
  TableFormat format = TableFormat::toml;
  try {
    format = table_format(context.file, "-o");
  } catch (const InvalidInput& error) {
    throw UsageError(fmt::format("quadtune lqr: {}", error.what()), "-o");
  }
  if (context.json && format != TableFormat::json)
    throw UsageError(fmt::format("quadtune lqr: -o is '{}' and --json came, expected a name that "
                                 "ends in .json, or no --json",
                                 internal::printable(context.file)),
                     "-o");
  return format;
}

}  // namespace

std::vector<ScheduleAxis> schedule_axes(const std::string& text) {
  std::vector<ScheduleAxis> axes;
  for (const std::string& part : split(text, ',')) {
    const std::string axis = without_blanks_around(part);
    if (axis.empty())
      refuse("an axis is empty, expected axes such as speed=0:0.5:10, separated by commas");
    axes.push_back(axis_of(axis));
  }
  (void)checked_grid_size(axes, kOption);
  return axes;
}

void run_schedule(const LqrArguments& arguments, const std::string& grid, Context& context) {
  const std::vector<ScheduleAxis> axes = schedule_axes(grid);
  const std::optional<TableFormat> format = wanted_table(context);
  const Vehicle vehicle = load_vehicle(arguments.plant.vehicle);
  const LqrDesign design = schedule_design(arguments, vehicle);
  const auto start = std::chrono::steady_clock::now();
  const GainSchedule schedule =
      gain_schedule(vehicle, axes, design, {arguments.plant.yaw, context.threads, &interrupted});
  const std::chrono::duration<double> wall = std::chrono::steady_clock::now() - start;
  const std::string infeasible = infeasible_words(schedule);
  if (schedule.solved_count() == 0)
    throw NoSolution(
        fmt::format("lqr: {}: no point of the schedule has a gain: {}", vehicle.name, infeasible),
        arguments.plant.vehicle);
  note_model(vehicle, schedule, design, context);
  if (!infeasible.empty()) context.note("lqr: warning: " + infeasible);
  context.note(fmt::format("lqr: {} in {:.3f} s",
                           count_words(static_cast<std::size_t>(schedule.size()), "point"),
                           wall.count()));
  if (format)
    context.out << schedule_text(schedule, *format);
  else
    print_summary(schedule, context);
}

}  // namespace quadtune::cli
