// SPDX-License-Identifier: Apache-2.0
#include "logs/mat/mat_tables.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <optional>
#include <string_view>

#include "logs/clock_unit.hpp"
#include "logs/log_titles.hpp"
#include "quadtune/internal/counted.hpp"
#include "quadtune/internal/text_file.hpp"

namespace quadtune::internal {
namespace {

constexpr std::size_t kMaxColumns = 10000;     // of a matrix that counts as a log
constexpr std::string_view kUnits = "units.";  // struct of units in quadtune's own logs

// A real matrix as rows of channels.
struct Matrix {
  const MatArray* array = nullptr;
  std::size_t rows = 0;
  std::size_t columns = 0;
  // Rows are along the last dimension, so that consecutive entries belong to one row
  bool rows_last = false;
};

struct Leaf {
  std::string name;
  Matrix matrix;
};

bool is_scalar_struct(const MatArray& array) {
  return array.kind == MatClass::structure && array.rows() == 1 && array.columns() == 1;
}

// Whether an array contains real numbers.
bool is_numeric(const MatArray* array) {
  return array != nullptr && array->is_numeric() && !array->complex;
}

std::optional<Matrix> matrix_of(const MatArray* array) {
  if (!is_numeric(array) || array->dimensions.size() > 3 || array->data.empty())
    return std::nullopt;
  const std::vector<std::size_t>& size = array->dimensions;
  const std::size_t entries = array->entries();
  if (size.size() == 3) return Matrix{array, size[2], entries / size[2], true};
  if (size[0] == 1) return Matrix{array, size[1], 1, true};
  return Matrix{array, size[0], entries / size[0], false};
}

std::vector<double> column_of(const Matrix& matrix, std::size_t column, MemoryBudget& budget) {
  budget.charge(matrix.rows * sizeof(double));
  std::vector<double> values(matrix.rows);
  for (std::size_t i = 0; i < matrix.rows; ++i)
    values[i] = matrix.array->number(matrix.rows_last ? i * matrix.columns + column
                                                      : column * matrix.rows + i);
  return values;
}

// A text of at most 1000 characters; empty for anything else.
std::string text_of(const MatArray* array) {
  constexpr std::size_t kMaxLetters = 1000;
  if (array == nullptr || array->kind != MatClass::text || !array->is_matrix() ||
      array->entries() > kMaxLetters)
    return "";
  return width_of(array->type) == 1 ? std::string(array->data) : array->utf16_text().value_or("");
}

// The title of a vector that is named like a clock; empty for any other name.
std::optional<LogTitle> clock_title(const Leaf& leaf) {
  if (leaf.matrix.columns != 1 || leaf.matrix.rows < 2) return std::nullopt;
  const std::size_t dot = leaf.name.rfind('.');
  const std::string name = dot == std::string::npos ? leaf.name : leaf.name.substr(dot + 1);
  if (name == "tout" || name == "rt_tout") return LogTitle{name, "s", 1, false};
  const LogTitle title = title_of(name);
  return title.ticks > 0 ? std::optional(title) : std::nullopt;
}

class Finder {
 public:
  Finder(MemoryBudget& budget, std::vector<std::string>& notes) : budget_(budget), notes_(notes) {}

  std::vector<MatTable> tables(const std::vector<MatArray>& variables) {
    for (const MatArray& variable : variables)
      if (!is_scalar_struct(variable)) gather(variable, std::string(variable.name), "");
    make_tables("");
    for (const MatArray& variable : variables) {
      if (!is_scalar_struct(variable)) continue;
      const std::string name(variable.name);
      if (is_simulink(variable))
        add_simulink(variable, name);
      else
        gather_fields(variable, "", name);
      make_tables(is_own(variable) ? "" : name);
    }
    report_scalars();
    return std::move(tables_);
  }

 private:
  static bool is_simulink(const MatArray& array) {
    const MatArray* const signals = array.field("signals");
    return is_numeric(array.field("time")) && signals != nullptr &&
           signals->kind == MatClass::structure && signals->is_matrix();
  }

  // A flight log of quadtune, with the same channel names as in CSV.
  static bool is_own(const MatArray& array) { return text_of(array.field("format")) == kMatFormat; }

  void gather_fields(const MatArray& array, const std::string& prefix, const std::string& scope) {
    const bool own = prefix.empty() && is_own(array);
    for (std::size_t i = 0; i < array.fields.size(); ++i) {
      const std::string_view field = array.fields[i];
      if (own && (field == "about" || field == "about_keys" || field == "columns" ||
                  field == "events" || field == "format_version"))
        continue;
      const MatArray& value = array.parts[i];
      if (!is_scalar_struct(value))
        gather(value, fmt::format("{}{}", prefix, field), scope);
      else if (is_simulink(value))
        add_simulink(value, fmt::format("{}.{}{}", scope, prefix, field));
      else
        gather_fields(value, fmt::format("{}{}.", prefix, field), scope);
    }
  }

  // The name of a struct is a prefix of the names of all its contents, so long names must be
  // charged.
  void charge_name(const std::string& name) { budget_.charge(sizeof(Leaf) + 3 * name.size()); }

  // A variable or field that is not a struct.
  void gather(const MatArray& value, const std::string& name, const std::string& scope) {
    charge_name(scope + name);
    if (const std::string text = text_of(&value); !text.empty()) {
      if (name.starts_with(kUnits)) units_[name.substr(kUnits.size())] = text;
      return;
    }
    const std::optional<Matrix> matrix = matrix_of(&value);
    const std::string full = scope.empty() ? name : scope + '.' + name;
    if (!matrix)
      note(full, what_is(value));
    else if (matrix->columns > kMaxColumns)
      note(full, fmt::format("has {} columns, expected at most {},", matrix->columns, kMaxColumns));
    else if (matrix->rows * matrix->columns == 1)
      scalars_.push_back(full);
    else
      leaves_.push_back({name, *matrix});
  }

  static std::string what_is(const MatArray& value) {
    switch (value.kind) {
      case MatClass::text:
        return "";
      case MatClass::cell:
        return "is a cell array";
      case MatClass::structure:
        return "is an array of structs";
      case MatClass::sparse:
        return "is a sparse matrix";
      case MatClass::object:
      case MatClass::opaque:
        return "is an object: save a timeseries as a struct";
      default:
        break;
    }
    if (value.complex) return "is complex";
    if (value.is_numeric() && value.data.empty()) return "";
    return "is not a vector or matrix of numbers";
  }

  void note(const std::string& name, const std::string& what) {
    if (!what.empty())
      notes_.push_back(fmt::format("'{}' {} and is ignored", printable(name), what));
  }

  // The clock among the gathered leaves; the least nested one.
  const Leaf* clock() const {
    const Leaf* best = nullptr;
    const auto depth = [](const Leaf& leaf) {
      return std::count(leaf.name.begin(), leaf.name.end(), '.');
    };
    for (const Leaf& leaf : leaves_)
      if (clock_title(leaf) && (best == nullptr || depth(leaf) < depth(*best))) best = &leaf;
    return best;
  }

  // The times of a clock [s]; empty, with a note, if its unit is not stated and ambiguous.
  std::vector<double> times_of(const Leaf& leaf, const std::string& scope) {
    std::vector<double> time = column_of(leaf.matrix, 0, budget_);
    const LogTitle title = clock_title(leaf).value_or(LogTitle{});
    const ClockSample sample = sample_of_clock(time);
    const std::string name = printable(scope.empty() ? leaf.name : scope + '.' + leaf.name);
    double ticks = title.ticks;
    if (!title.guessed) {
      if (is_no_time(sample, ticks)) {
        notes_.push_back(
            fmt::format("'{}' is not used as a clock because it is stated in {}, but its "
                        "values, such as {:.6g}, would be after the year 2286",
                        name, name_of_ticks(ticks), sample.time));
        ticks = 0;
      }
    } else {
      const ClockUnit unit = unit_of_clock(sample);
      ticks = unit.ticks;
      if (ticks == 0)
        notes_.push_back(fmt::format(
            "'{}' states no unit and is not used as a clock because {}: rename it {}_{}", name,
            unit.reason, printable(leaf.name), unit.unit));
      else if (ticks != 1 || sample.step >= kSlowStep)
        notes_.push_back(fmt::format(
            "the clock '{}' states no unit and {}{}", name, unit.reason,
            sample.step > 0 ? fmt::format(", with samples {:.4g} s apart", sample.step / ticks)
                            : ""));
    }
    if (ticks == 0) return {};
    for (double& t : time) t /= ticks;
    return time;
  }

  // Converts the gathered leaves to groups, one per number of rows, in order of appearance.
  void make_tables(const std::string& scope) {
    const Leaf* own_clock = clock();
    const std::vector<double> own_time =
        own_clock == nullptr ? std::vector<double>{} : times_of(*own_clock, scope);
    if (own_time.empty()) own_clock = nullptr;
    std::map<std::size_t, std::size_t> group_of_rows;
    std::vector<std::vector<const Leaf*>> groups;
    for (const Leaf& leaf : leaves_) {
      if (&leaf == own_clock) continue;
      const auto [at, is_new] = group_of_rows.try_emplace(leaf.matrix.rows, groups.size());
      if (is_new) groups.emplace_back();
      groups[at->second].push_back(&leaf);
    }
    for (const std::vector<const Leaf*>& group : groups) {
      const std::size_t rows = group.front()->matrix.rows;
      MatTable table;
      table.group.name = groups.size() == 1 ? scope
                         : scope.empty()    ? fmt::format("rows{}", rows)
                                            : fmt::format("{}.rows{}", scope, rows);
      for (const Leaf* leaf : group) {
        const auto unit = units_.find(leaf->name);
        add_columns(leaf->name, unit == units_.end() ? title_of(leaf->name).unit : unit->second,
                    leaf->matrix, table);
      }
      if (own_clock != nullptr && own_clock->matrix.rows == rows)
        table.time = own_time;
      else
        take_file_clock(rows, table);
      finish(std::move(table));
    }
    if (scope.empty() && own_clock != nullptr) file_time_ = own_time;
    leaves_.clear();
    units_.clear();
  }

  void take_file_clock(std::size_t rows, MatTable& table) {
    if (file_time_.size() != rows) return;
    budget_.charge(rows * sizeof(double));
    table.time = file_time_;
  }

  void add_columns(const std::string& name, const std::string& unit, const Matrix& matrix,
                   MatTable& table) {
    for (std::size_t i = 0; i < matrix.columns; ++i) {
      charge_name(name);
      table.group.channels.push_back(
          {matrix.columns == 1 ? name : fmt::format("{}[{}]", name, i + 1), unit});
      table.columns.push_back(column_of(matrix, i, budget_));
    }
  }

  void add_simulink(const MatArray& array, const std::string& name) {
    const std::optional<Matrix> clock = matrix_of(array.field("time"));
    const MatArray& signals = *array.field("signals");
    const std::size_t count = signals.entries();
    std::map<std::size_t, MatTable> by_rows;
    for (std::size_t i = 0; i < count; ++i) {
      const std::string label = label_of(signals, i, count);
      charge_name(name + label);
      const std::optional<Matrix> values = matrix_of(signals.field("values", i));
      if (!values || values->columns > kMaxColumns) {
        note(fmt::format("{}.{}", name, label), "has no numeric values, or too many per row,");
        continue;
      }
      add_columns(label, "", *values, by_rows[values->rows]);
    }
    for (auto& [rows, table] : by_rows) {
      table.group.name = by_rows.size() == 1 ? name : fmt::format("{}.rows{}", name, rows);
      if (clock && clock->columns == 1 && clock->rows == rows)
        table.time = column_of(*clock, 0, budget_);
      else
        take_file_clock(rows, table);
      finish(std::move(table));
    }
  }

  // Simulink's label of a signal, or else its index.
  static std::string label_of(const MatArray& signals, std::size_t i, std::size_t count) {
    std::string label = text_of(signals.field("label", i));
    if (!label.empty()) return label;
    return count == 1 ? "values" : fmt::format("values_{}", i + 1);
  }

  // Removes the rows whose time was never set.
  void leave_out_strays(MatTable& table) {
    const ClockSample sample = sample_of_clock(table.time);
    if (!zero_is_stray(sample, 1)) return;
    const std::vector<double> time = table.time;
    const auto without = [&](std::vector<double>& values) {
      std::size_t kept = 0;
      for (std::size_t i = 0; i < time.size(); ++i)
        if (time[i] != 0) values[kept++] = values[i];
      values.resize(kept);
    };
    without(table.time);
    if (table.time.size() == time.size()) return;
    for (std::vector<double>& column : table.columns) without(column);
    const std::size_t left_out = time.size() - table.time.size();
    notes_.push_back(fmt::format(
        "{0} of {1} of '{2}' {4} at time 0 (clock not set) and {4} left out; the others are around "
        "{3:.6g} s",
        left_out, counted(time.size(), "row"), printable(table.group.name), sample.time,
        left_out == 1 ? "is" : "are"));
  }

  void finish(MatTable table) {
    charge_name(table.group.name);
    leave_out_strays(table);
    table.group.timed = !table.time.empty();
    std::map<std::string, int> seen;
    for (LogChannel& channel : table.group.channels)
      if (const int times = ++seen[channel.name]; times > 1)
        channel.name += fmt::format("#{}", times);
    tables_.push_back(std::move(table));
  }

  void report_scalars() {
    if (scalars_.empty()) return;
    constexpr std::size_t kNamed = 5;
    std::string names;
    for (std::size_t i = 0; i < std::min(scalars_.size(), kNamed); ++i)
      names += (i > 0 ? ", " : "") + printable(scalars_[i]);
    if (scalars_.size() > kNamed) names += fmt::format(" and {} more", scalars_.size() - kNamed);
    notes_.push_back("single numbers are ignored: " + names);
  }

  MemoryBudget& budget_;
  std::vector<std::string>& notes_;
  std::vector<MatTable> tables_;
  std::vector<Leaf> leaves_;                  // in the current scope
  std::map<std::string, std::string> units_;  // by the name of the leaf
  std::vector<std::string> scalars_;
  std::vector<double> file_time_;
};

}  // namespace

std::vector<MatTable> tables_of(const std::vector<MatArray>& variables, MemoryBudget& budget,
                                std::vector<std::string>& notes) {
  return Finder(budget, notes).tables(variables);
}

}  // namespace quadtune::internal
