// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <span>

#include "quadtune/errors.hpp"
#include "quadtune/exports/schedule_table.hpp"
#include "quadtune/internal/toml_reader.hpp"
#include "quadtune/matrix_checks.hpp"
#include "schedule/schedule_parts.hpp"

namespace quadtune::exports {
namespace {

using internal::TomlKey;
using internal::TomlTable;

/// Builds the text; numbers are the shortest that read back to the same double.
class TomlText {
 public:
  void line(const std::string& text) { text_ += fmt::format("{}\n", text); }
  void text(const char* key, const std::string& value) {
    text_ += fmt::format("{} = {}\n", key, quoted(value));
  }
  void number(const char* key, double value) {
    text_ += fmt::format("{} = ", key);
    append(value);
    text_ += '\n';
  }
  /// Writes eight numbers per line, because readers limit the length of a line.
  void list(const char* key, std::span<const double> values) {
    text_ += fmt::format("{} = [", key);
    for (std::size_t i = 0; i < values.size(); ++i) {
      if (i > 0) text_ += i % 8 == 0 ? ",\n  " : ", ";
      append(values[i]);
    }
    text_ += "]\n";
  }
  void matrix(const char* key, const Eigen::MatrixXd& M) {
    text_ += fmt::format("{} = [\n", key);
    for (Eigen::Index i = 0; i < M.rows(); ++i) {
      text_ += "  [";
      for (Eigen::Index j = 0; j < M.cols(); ++j) {
        if (j > 0) text_ += ", ";
        append(M(i, j));
      }
      text_ += "],\n";
    }
    text_ += "]\n";
  }
  void signals(const char* key, const std::vector<Signal>& all) {
    text_ += fmt::format("{} = [\n", key);
    for (const Signal& signal : all)
      text_ +=
          fmt::format("  {{ name = {}, unit = {} }},\n", quoted(signal.name), quoted(signal.unit));
    text_ += "]\n";
  }
  [[nodiscard]] std::string take() { return std::move(text_); }

 private:
  /// Appends a number. Whole numbers get a point, because TOML's integers have no -0.
  void append(double value) {
    const std::size_t start = text_.size();
    text_ += fmt::format("{}", value);
    if (text_.find_first_not_of("-0123456789", start) == std::string::npos) text_ += ".0";
  }

  /// A basic string. Control characters, which readers reject, become '?'.
  static std::string quoted(const std::string& value) {
    std::string text = "\"";
    for (const char c : value) {
      if (c == '"' || c == '\\') text += '\\';
      text += static_cast<unsigned char>(c) < 0x20 || c == 0x7f ? '?' : c;
    }
    return text + '"';
  }

  std::string text_;
};

std::span<const double> numbers(const Eigen::VectorXd& v) {
  return {v.data(), static_cast<std::size_t>(v.size())};
}

void write_point(const GainSchedule& schedule, Eigen::Index index, TomlText& out) {
  const auto p = static_cast<std::size_t>(index);
  out.line("\n[[point]]");
  out.list("at", numbers(grid_point(schedule.axes, index)));
  out.text("status", to_string(schedule.status[p]));
  if (!schedule.solved(index)) {
    out.text("culprit", schedule.culprit[p]);
    return;
  }
  const Gains gains = schedule.gains(index);
  const std::string where = fmt::format("point {}", index + 1);
  require_finite(gains.K, where, "K");
  require_finite(gains.K_int, where, "K_int");
  require_finite(gains.x0, where, "x0");
  require_finite(gains.u0, where, "u0");
  out.number("residual", schedule.residual(index));
  out.list("x0", numbers(gains.x0));
  out.list("u0", numbers(gains.u0));
  out.matrix("K", gains.K);
  if (gains.K_int.size() > 0) out.matrix("K_int", gains.K_int);
}

std::vector<Signal> read_signals(const TomlTable& file, const char* key) {
  std::vector<Signal> signals;
  const std::vector<TomlTable> tables = file.tables(key);
  signals.reserve(tables.size());
  for (const TomlTable& table : tables) {
    table.allow({{"name"}, {"unit"}});
    signals.push_back({table.text("name"), table.text("unit")});
  }
  return signals;
}

std::vector<ScheduleAxis> read_axes(const TomlTable& file) {
  std::vector<ScheduleAxis> axes;
  const std::vector<TomlTable> tables = file.tables("axis");
  axes.reserve(tables.size());
  for (const TomlTable& table : tables) {
    table.allow({{"name"}, {"unit"}, {"values"}});
    ScheduleAxis axis;
    axis.quantity = schedule_quantity(table.text("name"), table.where("name"));
    if (table.text("unit") != unit(axis.quantity))
      throw InvalidInput(table.where("unit"),
                         fmt::format("unit of {} is '{}', expected '{}'", to_string(axis.quantity),
                                     table.text("unit"), unit(axis.quantity)));
    const Eigen::VectorXd values = table.vector("values");
    axis.values.assign(values.begin(), values.end());
    (void)checked_grid_size({axis}, table.where("values"));
    axes.push_back(std::move(axis));
  }
  return axes;
}

void require_format(const TomlTable& file) {
  if (file.text("format") != kScheduleFormat)
    throw InvalidInput(file.where("format"), fmt::format("format is '{}', expected '{}'",
                                                         file.text("format"), kScheduleFormat));
  (void)file.integer("format_version", 1, 1);
}

ScheduleHead read_head(const TomlTable& file) {
  ScheduleHead head;
  head.vehicle = file.text("vehicle");
  head.convention = file.text("convention");
  (void)convention(head.convention, file.where("convention"));
  head.input_kind = input_kind(file.text("input_kind"), file.where("input_kind"));
  head.sign_law = sign_law(file.text("sign_law"), file.where("sign_law"));
  head.dt = file.number("dt_s", internal::Range::not_negative());
  head.yaw = file.number("yaw_rad");
  head.states = read_signals(file, "states");
  head.inputs = read_signals(file, "inputs");
  head.integrals = read_signals(file, "integrals");
  head.axes = read_axes(file);
  return head;
}

SchedulePointText read_point(const TomlTable& table, bool integrals) {
  SchedulePointText point;
  point.at = table.vector("at");
  point.status = point_status(table.text("status"), table.where("status"));
  if (point.status != PointStatus::solved) {
    table.allow({{"at"}, {"status"}, {"culprit"}});
    point.culprit = table.text("culprit");
    return point;
  }
  std::vector<TomlKey> known = {{"at"}, {"status"}, {"residual"}, {"x0"}, {"u0"}, {"K"}};
  if (integrals) known.push_back({"K_int"});
  table.allow(known);
  point.residual = table.number("residual", internal::Range::not_negative());
  point.x0 = table.vector("x0");
  point.u0 = table.vector("u0");
  point.K = table.matrix("K");
  if (integrals) point.K_int = table.matrix("K_int");
  return point;
}

}  // namespace

std::string schedule_toml(const GainSchedule& schedule) {
  TomlText out;
  out.text("format", kScheduleFormat);
  out.line("format_version = 1");
  out.text("vehicle", schedule.vehicle);
  out.text("convention", schedule.convention);
  out.text("input_kind", to_string(schedule.input_kind));
  out.text("sign_law", to_string(schedule.sign_law));
  out.number("dt_s", schedule.dt);
  out.number("yaw_rad", schedule.yaw);
  out.signals("states", schedule.states);
  out.signals("inputs", schedule.inputs);
  out.signals("integrals", schedule.integrals);
  for (const ScheduleAxis& axis : schedule.axes) {
    out.line("\n[[axis]]");
    out.text("name", to_string(axis.quantity));
    out.text("unit", unit(axis.quantity));
    out.list("values", axis.values);
  }
  for (Eigen::Index i = 0; i < schedule.size(); ++i) write_point(schedule, i, out);
  return out.take();
}

GainSchedule parse_schedule_toml(const std::string& text, const std::string& origin) {
  const TomlTable file = TomlTable::parse(text, origin, kScheduleTableLimit);
  file.allow({{"format"},
              {"format_version"},
              {"vehicle"},
              {"convention"},
              {"input_kind"},
              {"sign_law"},
              {"dt", "s"},
              {"yaw", "rad"},
              {"states"},
              {"inputs"},
              {"integrals"},
              {"axis"},
              {"point"}});
  require_format(file);
  GainSchedule schedule = start_schedule(read_head(file), file.where("axis"));
  const std::vector<TomlTable> points = file.tables("point");
  require_all_points(points.size(), schedule, file.where("point"));
  for (std::size_t i = 0; i < points.size(); ++i)
    put_point(read_point(points[i], !schedule.integrals.empty()), static_cast<Eigen::Index>(i),
              points[i].where(), schedule);
  return schedule;
}

}  // namespace quadtune::exports
