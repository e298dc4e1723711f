// SPDX-License-Identifier: Apache-2.0
#include "logs/mat/mat_tables.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <map>
#include <optional>
#include <string_view>

#include "logs/clock_unit.hpp"
#include "logs/formats/unicode.hpp"
#include "logs/log_titles.hpp"
#include "quadtune/internal/text_file.hpp"

namespace quadtune::internal {
namespace {

constexpr std::size_t kMostColumns = 10000;    // of a matrix that is a log
constexpr std::string_view kUnits = "units.";  // the struct of units in the project's own logs

// A matrix of real numbers as rows of channels.
struct Matrix {
  const matvar_t* variable = nullptr;
  std::size_t rows = 0;
  std::size_t columns = 0;
  bool rows_last = false;  // the rows are along the last dimension: neighbours are of one row
};

struct Leaf {
  std::string name;
  Matrix matrix;
};

std::size_t bytes_of(matio_classes kind) {
  switch (kind) {
    case MAT_C_DOUBLE:
    case MAT_C_INT64:
    case MAT_C_UINT64:
      return 8;
    case MAT_C_SINGLE:
    case MAT_C_INT32:
    case MAT_C_UINT32:
      return 4;
    case MAT_C_INT16:
    case MAT_C_UINT16:
      return 2;
    case MAT_C_INT8:
    case MAT_C_UINT8:
      return 1;
    default:
      return 0;
  }
}

bool is_scalar_struct(const matvar_t* variable) {
  if (variable == nullptr || variable->class_type != MAT_C_STRUCT || variable->rank != 2 ||
      variable->dims == nullptr)
    return false;
  return variable->dims[0] == 1 && variable->dims[1] == 1;
}

// matio takes no pointers to constants where it only looks.
matvar_t* mutable_of(const matvar_t* variable) { return const_cast<matvar_t*>(variable); }

std::vector<std::string> fields_of(const matvar_t* variable) {
  const unsigned count = Mat_VarGetNumberOfFields(mutable_of(variable));
  char* const* const names = Mat_VarGetStructFieldnames(variable);
  std::vector<std::string> fields;
  for (unsigned i = 0; names != nullptr && i < count; ++i) fields.emplace_back(names[i]);
  return fields;
}

const matvar_t* field_of(const matvar_t* variable, const char* name, std::size_t index = 0) {
  return Mat_VarGetStructFieldByName(mutable_of(variable), name, index);
}

// Real numbers with all of their data.
bool is_numeric(const matvar_t* variable) {
  return variable != nullptr && bytes_of(variable->class_type) > 0 && variable->isComplex == 0 &&
         variable->rank >= 2 && variable->dims != nullptr;
}

std::size_t entries_of(const matvar_t* variable) {
  std::size_t entries = 1;
  for (int i = 0; i < variable->rank; ++i) entries *= variable->dims[i];
  return entries;
}

std::optional<Matrix> matrix_of(const matvar_t* variable) {
  if (!is_numeric(variable) || variable->rank > 3) return std::nullopt;
  const std::size_t entries = entries_of(variable);
  if (entries == 0 || variable->data == nullptr ||
      variable->nbytes != entries * bytes_of(variable->class_type))
    return std::nullopt;
  const std::size_t first = variable->dims[0];
  if (variable->rank == 3)
    return Matrix{variable, variable->dims[2], entries / variable->dims[2], true};
  if (first == 1) return Matrix{variable, variable->dims[1], 1, true};
  return Matrix{variable, first, entries / first, false};
}

template <typename Number>
double number_at(const void* data, std::size_t index) {
  Number value;
  std::memcpy(&value, static_cast<const char*>(data) + index * sizeof value, sizeof value);
  return static_cast<double>(value);
}

double entry(const matvar_t* variable, std::size_t index) {
  switch (variable->class_type) {
    case MAT_C_DOUBLE:
      return number_at<double>(variable->data, index);
    case MAT_C_SINGLE:
      return number_at<float>(variable->data, index);
    case MAT_C_INT64:
      return number_at<std::int64_t>(variable->data, index);
    case MAT_C_UINT64:
      return number_at<std::uint64_t>(variable->data, index);
    case MAT_C_INT32:
      return number_at<std::int32_t>(variable->data, index);
    case MAT_C_UINT32:
      return number_at<std::uint32_t>(variable->data, index);
    case MAT_C_INT16:
      return number_at<std::int16_t>(variable->data, index);
    case MAT_C_UINT16:
      return number_at<std::uint16_t>(variable->data, index);
    case MAT_C_INT8:
      return number_at<std::int8_t>(variable->data, index);
    default:
      return number_at<std::uint8_t>(variable->data, index);
  }
}

std::vector<double> column_of(const Matrix& matrix, std::size_t column) {
  std::vector<double> values(matrix.rows);
  for (std::size_t i = 0; i < matrix.rows; ++i)
    values[i] = entry(matrix.variable,
                      matrix.rows_last ? i * matrix.columns + column : column * matrix.rows + i);
  return values;
}

// A text of letters that are ASCII; "" for anything else.
std::string text_of(const matvar_t* variable) {
  if (variable == nullptr || variable->class_type != MAT_C_CHAR || variable->data == nullptr ||
      variable->rank != 2 || variable->dims == nullptr)
    return "";
  const std::size_t letters = entries_of(variable);
  if (letters == 0 || letters > 1000 || variable->nbytes % letters != 0) return "";
  const std::size_t width = variable->nbytes / letters;
  const auto* const bytes = static_cast<const char*>(variable->data);
  if (width == 2) {
    std::u16string units(letters, u'\0');
    std::memcpy(units.data(), bytes, variable->nbytes);
    return utf8_of(units).value_or("");
  }
  return width == 1 ? std::string(bytes, letters) : "";
}

// What a vector called like a clock is; none where it is not.
std::optional<LogTitle> clock_title(const Leaf& leaf) {
  if (leaf.matrix.columns != 1 || leaf.matrix.rows < 2) return std::nullopt;
  const std::size_t dot = leaf.name.rfind('.');
  const std::string name = dot == std::string::npos ? leaf.name : leaf.name.substr(dot + 1);
  if (name == "tout" || name == "rt_tout") return LogTitle{name, "s", 1, false};
  const LogTitle title = title_of(name);
  return title.ticks > 0 ? std::optional(title) : std::nullopt;
}

void add_columns(const std::string& name, const std::string& unit, const Matrix& matrix,
                 MatTable& table) {
  for (std::size_t i = 0; i < matrix.columns; ++i) {
    table.group.channels.push_back(
        {matrix.columns == 1 ? name : fmt::format("{}[{}]", name, i + 1), unit});
    table.columns.push_back(column_of(matrix, i));
  }
}

class Finder {
 public:
  explicit Finder(std::vector<std::string>& notes) : notes_(notes) {}

  std::vector<MatTable> tables(const std::vector<MatVariable>& variables) {
    for (const MatVariable& variable : variables)
      if (!is_scalar_struct(variable.get()))
        gather(variable.get(), variable->name == nullptr ? "" : variable->name, "");
    make_tables("");
    for (const MatVariable& variable : variables) {
      if (!is_scalar_struct(variable.get())) continue;
      const std::string name = variable->name == nullptr ? "" : variable->name;
      if (is_simulink(variable.get()))
        add_simulink(variable.get(), name);
      else
        gather_fields(variable.get(), "", name);
      make_tables(is_own(variable.get()) ? "" : name);
    }
    report_scalars();
    return std::move(tables_);
  }

 private:
  static bool is_simulink(const matvar_t* variable) {
    const matvar_t* const signals = field_of(variable, "signals");
    return is_numeric(field_of(variable, "time")) && signals != nullptr &&
           signals->class_type == MAT_C_STRUCT && signals->rank == 2 && signals->dims != nullptr;
  }

  // A flight log of the project itself, whose channels are called as in its CSV.
  static bool is_own(const matvar_t* variable) {
    return text_of(field_of(variable, "format")) == kMatFormat;
  }

  void gather_fields(const matvar_t* variable, const std::string& prefix,
                     const std::string& scope) {
    const bool own = prefix.empty() && is_own(variable);
    for (const std::string& field : fields_of(variable)) {
      if (own && (field == "about" || field == "about_keys" || field == "columns" ||
                  field == "events" || field == "format_version"))
        continue;
      const matvar_t* const value = field_of(variable, field.c_str());
      if (!is_scalar_struct(value))
        gather(value, prefix + field, scope);
      else if (is_simulink(value))
        add_simulink(value, fmt::format("{}.{}{}", scope, prefix, field));
      else
        gather_fields(value, fmt::format("{}{}.", prefix, field), scope);
    }
  }

  // A variable or field that is no struct.
  void gather(const matvar_t* value, const std::string& name, const std::string& scope) {
    if (const std::string text = text_of(value); !text.empty()) {
      if (name.starts_with(kUnits)) units_[name.substr(kUnits.size())] = text;
      return;
    }
    const std::optional<Matrix> matrix = matrix_of(value);
    const std::string full = scope.empty() ? name : scope + '.' + name;
    if (!matrix)
      note(full, what_is(value));
    else if (matrix->columns > kMostColumns)
      note(full,
           fmt::format("has {} columns, expected at most {},", matrix->columns, kMostColumns));
    else if (matrix->rows * matrix->columns == 1)
      scalars_.push_back(full);
    else
      leaves_.push_back({name, *matrix});
  }

  static std::string what_is(const matvar_t* value) {
    if (value == nullptr) return "";
    switch (value->class_type) {
      case MAT_C_CHAR:
        return "";
      case MAT_C_CELL:
        return "is a cell array";
      case MAT_C_STRUCT:
        return "is an array of structs";
      case MAT_C_SPARSE:
        return "is a sparse matrix";
      case MAT_C_OBJECT:
      case MAT_C_OPAQUE:
        return "is an object: save a timeseries as a struct";
      default:
        break;
    }
    if (value->isComplex != 0) return "is complex";
    if (is_numeric(value) && entries_of(value) == 0) return "";
    return "is no vector or matrix of numbers";
  }

  void note(const std::string& name, const std::string& what) {
    if (!what.empty())
      notes_.push_back(fmt::format("'{}' {} and is passed over", printable(name), what));
  }

  // The clock of the gathered leaves, the one that lies least deep.
  const Leaf* clock() const {
    const Leaf* best = nullptr;
    const auto depth = [](const Leaf& leaf) {
      return std::count(leaf.name.begin(), leaf.name.end(), '.');
    };
    for (const Leaf& leaf : leaves_)
      if (clock_title(leaf) && (best == nullptr || depth(leaf) < depth(*best))) best = &leaf;
    return best;
  }

  // The times of a clock [s]; none, with a note, where its unit is not stated and ambiguous.
  std::vector<double> times_of(const Leaf& leaf, const std::string& scope) {
    std::vector<double> time = column_of(leaf.matrix, 0);
    const LogTitle title = clock_title(leaf).value_or(LogTitle{});
    const ClockSample sample = sample_of_clock(time);
    const std::string name = printable(scope.empty() ? leaf.name : scope + '.' + leaf.name);
    double ticks = title.ticks;
    if (!title.guessed) {
      if (is_no_time(sample, ticks)) {
        notes_.push_back(
            fmt::format("'{}' is no clock, because it is stated in {}, by which its "
                        "values, such as {:.6g}, come after the year 2286",
                        name, name_of_ticks(ticks), sample.time));
        ticks = 0;
      }
    } else {
      const ClockUnit unit = unit_of_clock(sample);
      ticks = unit.ticks;
      if (ticks == 0)
        notes_.push_back(
            fmt::format("'{}' states no unit and is no clock, because {}: call it {}_{}", name,
                        unit.reason, printable(leaf.name), unit.unit));
      else if (ticks != 1 || sample.step >= kSlowStep)
        notes_.push_back(fmt::format(
            "the clock '{}' states no unit and {}{}", name, unit.reason,
            sample.step > 0 ? fmt::format(", samples being {:.4g} s apart", sample.step / ticks)
                            : ""));
    }
    if (ticks == 0) return {};
    for (double& t : time) t /= ticks;
    return time;
  }

  // The gathered leaves as a group for each number of rows, in the order in which they come.
  void make_tables(const std::string& scope) {
    const Leaf* own_clock = clock();
    const std::vector<double> own_time =
        own_clock == nullptr ? std::vector<double>{} : times_of(*own_clock, scope);
    if (own_time.empty()) own_clock = nullptr;
    std::vector<std::size_t> lengths;
    for (const Leaf& leaf : leaves_)
      if (&leaf != own_clock &&
          std::find(lengths.begin(), lengths.end(), leaf.matrix.rows) == lengths.end())
        lengths.push_back(leaf.matrix.rows);
    for (const std::size_t rows : lengths) {
      MatTable table;
      table.group.name = lengths.size() == 1 ? scope
                         : scope.empty()     ? fmt::format("rows{}", rows)
                                             : fmt::format("{}.rows{}", scope, rows);
      for (const Leaf& leaf : leaves_) {
        if (&leaf == own_clock || leaf.matrix.rows != rows) continue;
        const auto unit = units_.find(leaf.name);
        add_columns(leaf.name, unit == units_.end() ? title_of(leaf.name).unit : unit->second,
                    leaf.matrix, table);
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

  void take_file_clock(std::size_t rows, MatTable& table) const {
    if (file_time_.size() == rows) table.time = file_time_;
  }

  void add_simulink(const matvar_t* variable, const std::string& name) {
    const std::optional<Matrix> clock = matrix_of(field_of(variable, "time"));
    const matvar_t* const signals = field_of(variable, "signals");
    const std::size_t count = entries_of(signals);
    std::map<std::size_t, MatTable> by_rows;
    for (std::size_t i = 0; i < count; ++i) {
      const std::string label = label_of(signals, i, count);
      const std::optional<Matrix> values = matrix_of(field_of(signals, "values", i));
      if (!values || values->columns > kMostColumns) {
        note(fmt::format("{}.{}", name, label),
             "has no values that are numbers, or too many a row,");
        continue;
      }
      add_columns(label, "", *values, by_rows[values->rows]);
    }
    for (auto& [rows, table] : by_rows) {
      table.group.name = by_rows.size() == 1 ? name : fmt::format("{}.rows{}", name, rows);
      if (clock && clock->columns == 1 && clock->rows == rows)
        table.time = column_of(*clock, 0);
      else
        take_file_clock(rows, table);
      finish(std::move(table));
    }
  }

  // What Simulink calls a signal, or else its place.
  static std::string label_of(const matvar_t* signals, std::size_t i, std::size_t count) {
    std::string label = text_of(field_of(signals, "label", i));
    if (!label.empty()) return label;
    return count == 1 ? "values" : fmt::format("values_{}", i + 1);
  }

  // Rows whose time was never set.
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
    notes_.push_back(fmt::format(
        "{} of {} rows of '{}' are at time 0, which was never set, and are left out: the others "
        "are at {:.6g} s and about",
        time.size() - table.time.size(), time.size(), printable(table.group.name), sample.time));
  }

  void finish(MatTable table) {
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
    notes_.push_back("single numbers are passed over: " + names);
  }

  std::vector<std::string>& notes_;
  std::vector<MatTable> tables_;
  std::vector<Leaf> leaves_;                  // of the scope that is gathered
  std::map<std::string, std::string> units_;  // by the names of leaves
  std::vector<std::string> scalars_;
  std::vector<double> file_time_;
};

}  // namespace

std::vector<MatTable> tables_of(const std::vector<MatVariable>& variables,
                                std::vector<std::string>& notes) {
  return Finder(notes).tables(variables);
}

}  // namespace quadtune::internal
