// SPDX-License-Identifier: Apache-2.0
#include "flight_code/schedule_program.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <limits>
#include <string_view>
#include <utility>

#include "flight_code/c_structure.hpp"
#include "flight_code/source_text.hpp"
#include "quadtune/convention.hpp"
#include "quadtune/design/flight_code_words.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/exports/schedule_table.hpp"
#include "quadtune/internal/joined.hpp"
#include "quadtune/simulation/random.hpp"

namespace quadtune::exports {
namespace {

/// In the order of qt_point_t; the names are those of QT_WITH_X.
constexpr std::pair<ScheduleQuantity, const char*> kPointMembers[] = {
    {ScheduleQuantity::speed, "SPEED"},
    {ScheduleQuantity::climb, "CLIMB"},
    {ScheduleQuantity::yaw_rate, "YAW_RATE"},
    {ScheduleQuantity::mass, "MASS"},
    {ScheduleQuantity::density, "DENSITY"}};

/// The indices in the schedule of the axes in the order of qt_point_t.
std::vector<Eigen::Index> axes_of_point(const GainSchedule& schedule) {
  std::vector<Eigen::Index> order;
  for (const auto& [quantity, word] : kPointMembers)
    for (std::size_t a = 0; a < schedule.axes.size(); ++a)
      if (schedule.axes[a].quantity == quantity) order.push_back(static_cast<Eigen::Index>(a));
  return order;
}

std::string in_brackets(const std::string& unit) {
  return unit.empty() ? "[1]" : fmt::format("[{}]", in_comment(unit));
}

/// For example "K, K_int, x0 and u0".
std::string numbers_in_words(const GainSchedule& schedule) {
  return schedule.integrals.empty() ? "K, x0 and u0" : "K, K_int, x0 and u0";
}

std::string error_in_words(const GainSchedule& schedule) {
  return schedule.sign_law == SignLaw::set_point_minus_state ? "sp - x" : "x - sp";
}

std::string law_in_words(const GainSchedule& schedule) {
  return fmt::format("u = u0 + K ({}){}", error_in_words(schedule),
                     schedule.integrals.empty() ? "" : " + K_int x_int");
}

std::string sample_time_in_words(const GainSchedule& schedule) {
  return schedule.dt > 0 ? fmt::format("{} s", schedule.dt)
                         : "none, because the law is continuous; use a short period";
}

std::string axis_in_words(const ScheduleAxis& axis) {
  const std::string in_unit = unit(axis.quantity).empty() ? "" : " " + unit(axis.quantity);
  if (axis.values.size() == 1)
    return fmt::format("{}: {}{}, its only value", to_string(axis.quantity), axis.values[0],
                       in_unit);
  return fmt::format("{}: {} to {}{}, {} values", to_string(axis.quantity), axis.values.front(),
                     axis.values.back(), in_unit, axis.values.size());
}

/// Lists the signals with their indices in a vector, one per line.
void add_signals(const char* vector, const std::vector<Signal>& signals, const std::string& rest,
                 std::vector<std::string>& lines) {
  for (std::size_t i = 0; i < signals.size(); ++i)
    lines.push_back(fmt::format("  {}[{}]  {} {}{}", vector, i, in_comment(signals[i].name),
                                in_brackets(signals[i].unit), rest));
}

std::string signals_in_words(const GainSchedule& schedule) {
  std::vector<std::string> lines;
  add_signals("x", schedule.states, "", lines);
  add_signals("u", schedule.inputs, "", lines);
  add_signals("x_int", schedule.integrals,
              fmt::format(", the integral of {}: each sample adds it times the sample time",
                          error_in_words(schedule)),
              lines);
  return internal::joined(lines, "\n * ");
}

/// Size of the constant arrays in bytes; flags are padded to whole words.
std::size_t table_bytes(const GainSchedule& schedule, bool double_precision) {
  std::size_t numbers = static_cast<std::size_t>(schedule.K.size() + schedule.K_int.size() +
                                                 schedule.x0.size() + schedule.u0.size());
  for (const ScheduleAxis& axis : schedule.axes) numbers += axis.values.size();
  const bool holes = schedule.solved_count() < schedule.size();
  const std::size_t flags = holes ? (static_cast<std::size_t>(schedule.size()) + 3) / 4 * 4 : 0;
  return numbers * (double_precision ? sizeof(double) : sizeof(float)) +
         2 * schedule.axes.size() * sizeof(int) + flags;
}

SourceChoices schedule_choices(const GainSchedule& schedule, const ExportContent& content,
                               const std::string& name) {
  SourceChoices c;
  c.name = name;
  c.double_precision = content.flight_code.double_precision;
  c.features.insert("SCHEDULE");
  if (c.double_precision) c.features.insert("DOUBLE");
  if (!schedule.integrals.empty()) c.features.insert("INTEGRALS");
  if (schedule.solved_count() < schedule.size()) c.features.insert("HOLES");
  if (schedule.sign_law == SignLaw::state_minus_set_point)
    c.features.insert("STATE_MINUS_SET_POINT");
  std::vector<std::string> axes;
  std::size_t longest = 1;
  for (std::size_t a = 0; a < schedule.axes.size(); ++a) {
    axes.push_back("  " + axis_in_words(schedule.axes[a]));
    longest = std::max(longest, schedule.axes[a].values.size());
    for (const auto& [quantity, word] : kPointMembers)
      if (schedule.axes[a].quantity == quantity) {
        c.features.insert(word);
        c.sizes[fmt::format("{}_AXIS", word)] = static_cast<int>(a);
      }
  }
  std::size_t values = 0;
  for (const ScheduleAxis& axis : schedule.axes) values += axis.values.size();
  c.sizes["VALUES"] = static_cast<int>(values);
  c.sizes["POINTS"] = static_cast<int>(schedule.size());
  c.sizes["AXES"] = static_cast<int>(schedule.axes.size());
  if (longest > 1) c.features.insert("INTERVALS");
  c.sizes["CORNERS"] = 1 << schedule.axes.size();
  c.sizes["LONGEST_AXIS"] = static_cast<int>(longest);
  c.sizes["STATES"] = static_cast<int>(schedule.states.size());
  c.sizes["INPUTS"] = static_cast<int>(schedule.inputs.size());
  c.sizes["INTEGRALS"] = static_cast<int>(schedule.integrals.size());
  // A number has at most 24 characters, and a blank.
  const std::size_t numbers =
      schedule.axes.size() + 3 * schedule.states.size() + 2 * schedule.inputs.size() +
      schedule.integrals.size() + 2 +
      schedule.inputs.size() * (schedule.states.size() + schedule.integrals.size());
  c.sizes["LONGEST_LINE"] = static_cast<int>(25 * numbers + 2);
  c.words["VEHICLE"] = in_comment(content.vehicle.name);
  c.words["LAW"] = law_in_words(schedule);
  c.words["NUMBERS"] = numbers_in_words(schedule);
  c.words["POINTS"] = fmt::format("{}", schedule.size());
  c.words["SOLVED"] = fmt::format("{}", schedule.solved_count());
  c.words["AXES"] = internal::joined(axes, "\n * ");
  c.words["CONVENTION"] =
      fmt::format("{}: {}", in_comment(schedule.convention),
                  in_comment(convention(schedule.convention, "schedule").description)) +
      (schedule.input_kind == InputKind::wrench
           ? "\n * A wrench is the thrust, which lifts, and torques about the body axes."
           : "");
  c.words["INPUT_KIND"] = to_string(schedule.input_kind);
  c.words["SIGNALS"] = signals_in_words(schedule);
  c.words["YAW"] = fmt::format("{}", schedule.yaw);
  c.words["SAMPLE_TIME"] = sample_time_in_words(schedule);
  c.words["AND_K_INT"] = schedule.integrals.empty() ? "" : " and K_int";
  c.words["BYTES"] = fmt::format("{}", table_bytes(schedule, c.double_precision));
  c.words["OBJECTS"] = fmt::format("{0}.o {0}_table.o", name);
  c.words["HEADERS"] = fmt::format("{0}.h {0}_arithmetic.h {0}_table.h", name);
  c.words["RECORDING"] = kRecordedPoints;
  return c;
}

std::string axes_text(const GainSchedule& schedule, bool double_precision) {
  std::vector<std::string> values;
  std::vector<std::size_t> starts, lengths;
  for (const ScheduleAxis& axis : schedule.axes) {
    const std::string name = to_string(axis.quantity);
    starts.push_back(values.size());
    lengths.push_back(axis.values.size());
    for (std::size_t i = 0; i < axis.values.size(); ++i) {
      values.push_back(c_number(axis.values[i], double_precision, "schedule: " + name));
      if (!double_precision && i > 0 &&
          static_cast<float>(axis.values[i]) == static_cast<float>(axis.values[i - 1]))
        throw InvalidInput(
            "schedule",
            fmt::format("{} has {} after {}, which are the same number in float; expected "
                        "values that differ in float, or double precision",
                        name, axis.values[i], axis.values[i - 1]));
    }
  }
  std::string text;
  for (std::size_t i = 0; i < values.size(); ++i)
    text += (i == 0 ? "" : i % 8 == 0 ? ",\n    " : ", ") + values[i];
  return fmt::format(
      "const qt_real qt_axis_values[QT_VALUES] = {{\n    {}}};\n"
      "const int qt_axis_start[QT_AXES] = {{{}}};\n"
      "const int qt_axis_length[QT_AXES] = {{{}}};\n",
      text, fmt::join(starts, ", "), fmt::join(lengths, ", "));
}

/// The gains, or the trims, of all points; zero at points without them.
/// @param write  writes the values of one point into the structure
std::string points_text(const GainSchedule& schedule, bool double_precision, const char* type,
                        const char* table, const auto& write) {
  Structure c(double_precision, std::numeric_limits<double>::quiet_NaN());
  c.open("");
  for (Eigen::Index p = 0; p < schedule.size(); ++p) {
    c.open("");
    Gains gains = schedule.gains(p);
    if (!schedule.solved(p)) {
      gains.K.setZero();
      gains.K_int.setZero();
      gains.x0.setZero();
      gains.u0.setZero();
    }
    try {
      write(c, gains);
    } catch (const InvalidInput& error) {
      throw InvalidInput("schedule at " + grid_words(schedule.axes, grid_point(schedule.axes, p)),
                         error.what());
    }
    c.close();
  }
  c.close();
  return fmt::format("const {} {}[QT_POINTS] = {}", type, table, c.text());
}

/// The source table.c, with the prefix qt. It may be too long for program_source().
std::string table_text(const GainSchedule& schedule, bool double_precision) {
  std::string text =
      "/* SPDX-License-Identifier: Apache-2.0 */\n"
      "/* The numbers of the schedule; \"table.h\" says what each is. */\n"
      "#include \"table.h\"\n\n";
  text += axes_text(schedule, double_precision) + "\n";
  if (schedule.solved_count() < schedule.size()) {
    text += "const bool qt_has_gain[QT_POINTS] = {\n    ";
    for (Eigen::Index p = 0; p < schedule.size(); ++p)
      text += fmt::format("{}{}",
                          p == 0        ? ""
                          : p % 12 == 0 ? ",\n    "
                                        : ", ",
                          schedule.solved(p) ? "true" : "false");
    text += "};\n\n";
  }
  text += points_text(schedule, double_precision, "qt_gains_t", "qt_gains_table",
                      [](Structure& c, const Gains& gains) {
                        c.matrix("K", gains.K);
                        if (gains.K_int.cols() > 0) c.matrix("K_int", gains.K_int);
                      });
  text += "\n" + points_text(schedule, double_precision, "qt_trim_t", "qt_trim_table",
                             [](Structure& c, const Gains& gains) {
                               c.numbers("x0", of(gains.x0));
                               c.numbers("u0", of(gains.u0));
                             });
  return text;
}

/// Pseudo-random numbers that depend only on their index in the sequence.
class Drawn {
 public:
  double between(double low, double high) {
    const RandomSource<1> source{.seed = 1};
    return low + (high - low) * lane(random_uniform(source, 0, index_++).first, 0);
  }

 private:
  std::uint64_t index_ = 0;
};

/// Points of the grid, and random points up to a quarter of the span beyond it; then points that
/// are not finite.
std::vector<Eigen::VectorXd> points_to_record(const GainSchedule& schedule, int count,
                                              Drawn& drawn) {
  constexpr Eigen::Index kMaxOfGrid = 32;
  std::vector<Eigen::VectorXd> points;
  // The first point has gains, so that later points without gains have previous ones to keep.
  for (Eigen::Index p = 0; points.empty(); ++p)
    if (schedule.solved(p)) points.push_back(grid_point(schedule.axes, p));
  const Eigen::Index of_grid = std::min(schedule.size(), kMaxOfGrid);
  for (Eigen::Index i = 0; i < of_grid; ++i)
    points.push_back(
        grid_point(schedule.axes, of_grid == 1 ? 0 : i * (schedule.size() - 1) / (of_grid - 1)));
  for (int i = 0; i < count; ++i) {
    points.emplace_back(std::ssize(schedule.axes));
    for (std::size_t a = 0; a < schedule.axes.size(); ++a) {
      const double first = schedule.axes[a].values.front(), last = schedule.axes[a].values.back();
      const double beyond = 0.25 * (first < last ? last - first : 1);
      // Includes the value of an axis with a single value.
      const bool met = first == last && i % 2 == 0;
      points.back()(static_cast<Eigen::Index>(a)) =
          met ? first : drawn.between(first - beyond, last + beyond);
    }
  }
  constexpr double kInfinite = std::numeric_limits<double>::infinity();
  for (const double none : {std::numeric_limits<double>::quiet_NaN(), kInfinite, -kInfinite})
    for (Eigen::Index a = 0; a < std::ssize(schedule.axes); ++a) {
      points.push_back(grid_point(schedule.axes, schedule.size() - 1));
      points.back()(a) = none;
    }
  return points;
}

template <class T>
std::string recorded_in(const GainSchedule& schedule, int count) {
  using Vector = typename ScheduleProgram<T>::Vector;
  ScheduleProgram<T> program(schedule);
  Drawn drawn;
  std::string text;
  const auto number = [&](T x) { fmt::format_to(std::back_inserter(text), "{} ", x); };
  const auto numbers = [&](const auto& all) {
    for (Eigen::Index i = 0; i < all.rows(); ++i)
      for (Eigen::Index j = 0; j < all.cols(); ++j) number(all(i, j));
  };
  const auto draw = [&](Eigen::Index size) {
    Vector x(size);
    for (T& entry : x) entry = static_cast<T>(drawn.between(-1, 1));
    return x;
  };
  const std::vector<Eigen::Index> order = axes_of_point(schedule);
  for (const Eigen::VectorXd& point : points_to_record(schedule, count, drawn)) {
    const Vector values = point.cast<T>();
    const Vector sp = draw(program.x0.size()), x = draw(program.x0.size());
    const Vector x_int = draw(program.K_int.cols());
    const auto status = static_cast<T>(program.look_up(values));
    for (const Eigen::Index a : order) number(values(a));
    numbers(sp);
    numbers(x);
    numbers(x_int);
    number(status);  // of the gains
    number(status);  // of the trim
    numbers(program.K);
    numbers(program.K_int);
    numbers(program.x0);
    numbers(program.u0);
    numbers(program.inputs(sp, x, x_int));
    text.back() = '\n';
  }
  return text;
}

std::string recorded_head(const GainSchedule& schedule) {
  std::vector<std::string> values;
  for (const Eigen::Index a : axes_of_point(schedule))
    values.push_back(to_string(schedule.axes[static_cast<std::size_t>(a)].quantity));
  const bool integrals = !schedule.integrals.empty();
  return fmt::format(
      "# Points of a gain schedule, one a line. Numbers of a line: {}; sp, x{};\n"
      "# then what the program gives: status of the gains and of the trim (0 found, 1 nearest, 2 "
      "no "
      "gain,\n# 3 not finite), K row by row{}, x0, u0, and u of the law.\n",
      internal::joined(values, ", "), integrals ? ", x_int" : "",
      integrals ? ", K_int row by row" : "");
}

std::string readme_of(const GainSchedule& schedule, const ExportContent& content,
                      const std::string& name) {
  std::vector<std::string> axes, values;
  for (const ScheduleAxis& axis : schedule.axes) axes.push_back("    - " + axis_in_words(axis));
  for (const Eigen::Index a : axes_of_point(schedule))
    values.push_back(to_string(schedule.axes[static_cast<std::size_t>(a)].quantity));
  const std::string integrals = schedule.integrals.empty() ? "" : "x_int, ";
  return fmt::format(
      "# Gain schedule {0} for the vehicle '{1}'\n\n"
      "C99, `{2}`, no heap, no input or output, no recursion, no state; {3} bytes of constants.\n\n"
      "- Law: `{4}`, with {5} interpolated multilinearly.\n"
      "- Grid: {6} points, of which {7} have gains:\n\n{8}\n\n"
      "- Sample time: {9}.\n\n"
      "[{0}.h]({0}.h) has the functions, with units, axes and the order of states and inputs:\n\n"
      "```c\n"
      "{0}_gains_t gains; /* fill both once at a point that has gains */\n"
      "{0}_trim_t trim;\n"
      "for (;;) {{ /* point_t: {10} */\n"
      "  status = {0}_gains(&estimated_flight, &gains);\n"
      "  trim_status = {0}_trim(&asked_flight, &trim);\n"
      "  {0}_law(&gains, trim.u0, sp, x, {11}u); /* sp: trim.x0, with positions and heading of the "
      "reference */\n"
      "}}\n"
      "```\n\n"
      "Beyond the grid, its nearest edge is used. If the grid has no gain, or a value is not "
      "finite, the previous\ngains are kept; the status reports it.\n\n"
      "`make test` needs only a C compiler. It evaluates the points of [{12}]({12}) and compares "
      "every number bit by bit\nwith what quadtune's own interpolation computes. For a board "
      "compile\n\n    {0}.c {0}_table.c\n\n"
      "with `-std=c99 -ffp-contract=off`. If the compiler contracts products and sums, results "
      "differ in the last bits.\n`-ffast-math` is not allowed; with it, the program does not "
      "compile. `make misra` checks with cppcheck for violations of\nMISRA C:2012. The Makefile "
      "lists the "
      "deviations.\n\n"
      "Commands are not limited to what the motors can do, and integrals do not stop at these "
      "limits: the\n"
      "caller must do both.\n",
      name, in_comment(content.vehicle.name),
      content.flight_code.double_precision ? "double" : "float",
      table_bytes(schedule, content.flight_code.double_precision), law_in_words(schedule),
      numbers_in_words(schedule), schedule.size(), schedule.solved_count(),
      internal::joined(axes, "\n"), sample_time_in_words(schedule), internal::joined(values, ", "),
      integrals, kRecordedPoints);
}

void require_schedule_options(const FlightCodeOptions& options) {
  const auto none = [](const char* what, const std::string& came) {
    if (!came.empty())
      throw InvalidInput("flight code",
                         fmt::format("the {} '{}' cannot be exported with a gain schedule, because "
                                     "such a program contains only the schedule",
                                     what, came));
  };
  none("law", options.law);
  none("adapter", options.adapter);
}

}  // namespace

std::string schedule_program_name(const ExportContent& content) {
  const std::string& asked = content.flight_code.name;
  if (!asked.empty()) {
    require_flight_code_name(asked, "flight code");
    return asked;
  }
  // Must differ from the name of the vehicle's flight program, which may be in the same folder.
  constexpr std::string_view kEnd = "_schedule";
  const std::string name =
      flight_code_name(content.vehicle.name).substr(0, kMaxFlightCodeName - kEnd.size());
  return name + std::string(kEnd);
}

std::vector<FileContent> schedule_program_files(const ExportContent& content) {
  const GainSchedule& schedule = *content.schedule;
  const std::string name = schedule_program_name(content);
  require_schedule_options(content.flight_code);
  if (schedule.solved_count() == 0)
    throw InvalidInput("schedule",
                       "has no gain at any of its points; expected a gain at one point or more");
  const bool double_precision = content.flight_code.double_precision;
  const SourceChoices choices = schedule_choices(schedule, content, name);
  const auto source = [&](const char* from) { return program_source(source_text(from), choices); };
  constexpr int kDrawnPoints = 64;
  return {{name + ".h", source("schedule/program.h")},
          {name + ".c", source("schedule/schedule.c")},
          {name + "_arithmetic.h", source("arithmetic.h")},
          {name + "_table.h", source("schedule/table.h")},
          {name + kTableEnd, with_own_names(table_text(schedule, double_precision), name)},
          {"replay.c", source("schedule/replay.c")},
          {"replay_lines.h", source("replay_lines.h")},
          {"Makefile", source("Makefile")},
          {kRecordedPoints,
           recorded_head(schedule) + recorded_points(schedule, double_precision, kDrawnPoints)},
          {"README.md", readme_of(schedule, content, name)},
          {kScheduleJsonName, schedule_text(schedule, TableFormat::json)}};
}

std::string recorded_points(const GainSchedule& schedule, bool double_precision, int count) {
  return double_precision ? recorded_in<double>(schedule, count)
                          : recorded_in<float>(schedule, count);
}

}  // namespace quadtune::exports
