// SPDX-License-Identifier: Apache-2.0
// Reads filter model files; docs/formats.md describes the format.
#include "quadtune/estimation/filter_file.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "quadtune/errors.hpp"
#include "quadtune/estimation/inertial_filter.hpp"
#include "quadtune/estimation/rigid_body_filter.hpp"
#include "quadtune/internal/built_in.hpp"
#include "quadtune/internal/counted.hpp"
#include "quadtune/internal/joined.hpp"
#include "quadtune/internal/suggest.hpp"
#include "quadtune/internal/text_file.hpp"
#include "quadtune/internal/toml_reader.hpp"

namespace quadtune {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using internal::Range;
using internal::TomlTable;

/// Splits "vz [m/s]" into a name and a unit.
Signal signal_of(const std::string& text, const std::string& where) {
  const std::size_t open = text.find('[');
  std::string name = text.substr(0, open);
  while (name.ends_with(' ')) name.pop_back();
  const bool well_formed = open == std::string::npos || text.ends_with(']');
  if (name.empty() || !well_formed || name.find_first_of(" ,=") != std::string::npos)
    throw InvalidInput(
        where, fmt::format("'{}' is invalid, expected a name and, in brackets, its unit, as "
                           "in 'vz [m/s]'",
                           text));
  return {name, open == std::string::npos ? "" : text.substr(open + 1, text.size() - open - 2)};
}

/// The signals of a required key.
std::vector<Signal> signals_of(const TomlTable& table, const std::string& key) {
  std::vector<Signal> result;
  for (const std::string& text : table.texts(key))
    result.push_back(signal_of(text, table.where(key, result.size())));
  return result;
}

/// As signals_of(), for a key that may be absent.
std::vector<Signal> signals_if_any(const TomlTable& table, const std::string& key) {
  return table.has(key) ? signals_of(table, key) : std::vector<Signal>();
}

/// @param counted  what the rows and columns belong to, e.g. "states x inputs"
MatrixXd matrix_of(const TomlTable& table, const std::string& key, Index rows, Index cols,
                   const char* counted) {
  if (!table.has(key) && (rows == 0 || cols == 0)) return MatrixXd(rows, cols);
  MatrixXd result = table.matrix(key);
  if (result.rows() != rows || result.cols() != cols)
    throw InvalidInput(table.where(key),
                       fmt::format("{} is {}x{}, expected {}x{} ({})", key, result.rows(),
                                   result.cols(), rows, cols, counted));
  return result;
}

/// Rejects keys that are valid only for other dynamics.
void refuse_keys(const TomlTable& file, const std::vector<const char*>& keys,
                 const std::string& dynamics) {
  for (const char* key : keys)
    if (file.has(key))
      throw InvalidInput(file.where(key),
                         fmt::format("{} is given, expected no such key because the dynamics "
                                     "are '{}'",
                                     key, dynamics));
}

/// Reads one [[Q]] or [[sensors.R]] table: its entries and their parameters.
class TermReader {
 public:
  TermReader(FilterModel& model, CovarianceModel& covariance, std::string prefix,
             const std::vector<Signal>& entries)
      : model_(model), covariance_(covariance), prefix_(std::move(prefix)), entries_(entries) {}

  void read(const TomlTable& table) {
    table.allow({{"entries"},
                 {"kind"},
                 {"parameter"},
                 {"unit"},
                 {"variance"},
                 {"interval"},
                 {"covariance"},
                 {"prior_median"},
                 {"prior_deviation"}});
    const std::vector<int> chosen = chosen_entries(table);
    const std::string kind = table.text_or("kind", "separate");
    if (kind == "fixed") {
      add_fixed(table, chosen);
    } else if (kind == "full") {
      add_full(table, chosen);
    } else if (kind == "shared") {
      ScaledCovariance term{shape_of(chosen), 0};
      term.parameter = add_parameter(table, table.text_or("parameter", name_of(chosen)),
                                     table.number("variance", Range::positive()));
      covariance_.scaled.push_back(term);
    } else if (kind == "separate") {
      add_separate(table, chosen);
    } else {
      const std::vector<std::string> known = {"separate", "shared", "full", "fixed"};
      throw InvalidInput(
          table.where("kind"),
          fmt::format("kind in {} is '{}', expected '{}'{}", table.title(), kind,
                      internal::joined(known, "' or '"), internal::did_you_mean(kind, known)));
    }
  }

 private:
  std::vector<int> chosen_entries(const TomlTable& table) const {
    std::vector<int> chosen;
    if (!table.has("entries")) {
      chosen.reserve(entries_.size());
      for (std::size_t i = 0; i < entries_.size(); ++i) chosen.push_back(static_cast<int>(i));
      return chosen;
    }
    std::vector<std::string> known;
    known.reserve(entries_.size());
    for (const Signal& entry : entries_) known.push_back(entry.name);
    for (const std::string& name : table.texts("entries")) {
      const auto found = std::find(known.begin(), known.end(), name);
      if (found == known.end())
        throw InvalidInput(table.where("entries", chosen.size()),
                           fmt::format("'{}' in entries of {} is unknown, expected one of {}{}",
                                       name, table.title(), internal::joined(known, ", "),
                                       internal::did_you_mean(name, known)));
      chosen.push_back(static_cast<int>(found - known.begin()));
    }
    return chosen;
  }

  [[nodiscard]] std::string name_of(const std::vector<int>& chosen) const {
    std::vector<std::string> names;
    names.reserve(chosen.size());
    for (const int i : chosen) names.push_back(entries_[static_cast<std::size_t>(i)].name);
    return fmt::format("{}.{}", prefix_, internal::joined(names, "-"));
  }

  int add_parameter(const TomlTable& table, const std::string& name, double variance) {
    NoiseParameter parameter{name, table.text_or("unit", ""), true, variance};
    if (table.has("prior_median") || table.has("prior_deviation"))
      parameter.prior = NoisePrior{table.number("prior_median", Range::positive()),
                                   table.number("prior_deviation", Range::positive())};
    if (table.has("interval")) {
      const VectorXd ends = table.vector("interval", Range::positive());
      if (ends.size() != 2 || !(ends(0) < ends(1)))
        throw InvalidInput(table.where("interval"), "interval is not [low, high] with low < high");
      parameter.interval = {ends(0), ends(1)};
    }
    model_.parameters.push_back(parameter);
    return static_cast<int>(model_.parameters.size()) - 1;
  }

  /// The start of each selected entry.
  static VectorXd variances(const TomlTable& table, const std::vector<int>& chosen) {
    const auto count = static_cast<Index>(chosen.size());
    if (!table.is_list("variance"))
      return VectorXd::Constant(count, table.number("variance", Range::positive()));
    VectorXd values = table.vector("variance", Range::positive());
    if (values.size() != count)
      throw InvalidInput(
          table.where("variance"),
          fmt::format("variance in {} has {}, expected {} or one number", table.title(),
                      internal::counted(values.size(), "entry", "entries"), count));
    return values;
  }

  void add_separate(const TomlTable& table, const std::vector<int>& chosen) {
    const VectorXd starts = variances(table, chosen);
    if (table.has("parameter") && chosen.size() != 1)
      throw InvalidInput(
          table.where("parameter"),
          fmt::format("parameter in {} names one parameter for {}, expected kind = \"shared\", or "
                      "a table for each entry",
                      table.title(), internal::counted(chosen.size(), "entry", "entries")));
    for (std::size_t i = 0; i < chosen.size(); ++i) {
      ScaledCovariance term{shape_of({chosen[i]}), 0};
      term.parameter = add_parameter(table, table.text_or("parameter", name_of({chosen[i]})),
                                     starts(static_cast<Index>(i)));
      covariance_.scaled.push_back(term);
    }
  }

  [[nodiscard]] MatrixXd shape_of(const std::vector<int>& chosen) const {
    MatrixXd shape = MatrixXd::Zero(covariance_.size(), covariance_.size());
    for (const int i : chosen) shape(i, i) = 1;
    return shape;
  }

  [[nodiscard]] MatrixXd block_of(const TomlTable& table, const std::vector<int>& chosen) const {
    const auto n = static_cast<Index>(chosen.size());
    if (table.has("covariance"))
      return matrix_of(table, "covariance", n, n, "one row and column for each entry");
    return variances(table, chosen).asDiagonal();
  }

  void add_fixed(const TomlTable& table, const std::vector<int>& chosen) {
    const MatrixXd block = block_of(table, chosen);
    for (std::size_t i = 0; i < chosen.size(); ++i)
      for (std::size_t j = 0; j < chosen.size(); ++j)
        covariance_.fixed(chosen[i], chosen[j]) +=
            block(static_cast<Index>(i), static_cast<Index>(j));
  }

  void add_full(const TomlTable& table, const std::vector<int>& chosen) {
    const VectorXd starts = parameters_of_block(block_of(table, chosen));
    if (!starts.allFinite())
      throw InvalidInput(
          table.where("covariance"),
          fmt::format("covariance in {} is not positive definite, expected a matrix that "
                      "is",
                      table.title()));
    FullCovariance term{chosen, static_cast<int>(model_.parameters.size())};
    for (std::size_t i = 0, k = 0; i < chosen.size(); ++i) {
      for (std::size_t j = 0; j < i; ++j)
        model_.parameters.push_back(
            {fmt::format("{}:{}", name_of({chosen[i]}),
                         entries_[static_cast<std::size_t>(chosen[j])].name),
             "", false, starts(static_cast<Index>(k++))});
      (void)add_parameter(table, name_of({chosen[i]}), std::exp(starts(static_cast<Index>(k++))));
    }
    covariance_.full.push_back(term);
  }

  FilterModel& model_;
  CovarianceModel& covariance_;
  std::string prefix_;
  const std::vector<Signal>& entries_;
};

void read_sensor(const TomlTable& table, FilterModel& model) {
  table.allow({{"name"}, {"outputs"}, {"C"}, {"D"}, {"delay", "s"}, {"student"}, {"gate"}, {"R"}});
  FilterSensor sensor;
  if (model.gravity) refuse_keys(table, {"D"}, "inertial");
  if (model.vehicle.empty()) {
    sensor.name = table.word("name");
    sensor.outputs = signals_of(table, "outputs");
    const auto ny = static_cast<Index>(sensor.outputs.size());
    sensor.C =
        matrix_of(table, "C", ny, static_cast<Index>(model.states.size()), "outputs x states");
    if (table.has("D"))
      sensor.D =
          matrix_of(table, "D", ny, static_cast<Index>(model.inputs.size()), "outputs x inputs");
    sensor.R.fixed = MatrixXd::Zero(ny, ny);
  } else {
    refuse_keys(table, {"outputs", "C", "D"}, "rigid-body");
    sensor = rigid_body_sensor(table.word("name"), table.where("name"));
  }
  sensor.delay = table.number_or("delay_s", 0, Range::not_negative());
  sensor.student = table.number_or("student", 0, Range::not_negative());
  if (table.has("gate")) sensor.gate = table.number("gate", Range::positive());
  TermReader reader(model, sensor.R, "R", sensor.outputs);
  for (const TomlTable& term : table.tables("R")) reader.read(term);
  model.sensors.push_back(sensor);
}

void read_initial(const TomlTable& table, FilterModel& model) {
  table.allow({{"x"}, {"variance"}});
  const auto nx = static_cast<Index>(model.states.size());
  const auto sized = [&](const std::string& key, const Range& range) {
    VectorXd values = table.vector(key, range);
    if (values.size() != nx)
      throw InvalidInput(table.where(key),
                         fmt::format("{} in {} has {}, expected {}", key, table.title(),
                                     internal::counted(values.size(), "entry", "entries"), nx));
    return values;
  };
  if (table.has("x")) model.x0 = sized("x", Range::any());
  model.P0 = sized("variance", Range::not_negative()).asDiagonal();
  model.diffuse.assign(static_cast<std::size_t>(nx), false);
}

std::string dynamics_of(const TomlTable& file) {
  std::string dynamics = file.text_or("dynamics", "linear");
  const std::vector<std::string> known = {"linear", "inertial", "rigid-body"};
  if (std::find(known.begin(), known.end(), dynamics) == known.end())
    throw InvalidInput(
        file.where("dynamics"),
        fmt::format("dynamics is '{}', expected '{}'{}", dynamics,
                    internal::joined(known, "' or '"), internal::did_you_mean(dynamics, known)));
  return dynamics;
}

FilterModel read_inertial(const TomlTable& file) {
  const VectorXd gravity = file.vector("gravity_m_per_s2", Range::any());
  if (gravity.size() != 3 || gravity.isZero(0))
    throw InvalidInput(file.where("gravity_m_per_s2"),
                       "gravity is not a vector, expected three numbers in world axes, as in "
                       "[0, 0, -9.81] if z points up");
  return inertial_model(gravity);
}

FilterModel read_linear(const TomlTable& file) {
  FilterModel model;
  model.dt = file.has("period_s") ? file.number("period_s", Range::positive()) : 0;
  model.states = signals_of(file, "states");
  model.inputs = signals_if_any(file, "inputs");
  model.noises = signals_if_any(file, "noises");
  const auto nx = static_cast<Index>(model.states.size());
  const auto nw = static_cast<Index>(model.noises.size());
  model.A = matrix_of(file, "A", nx, nx, "states x states");
  model.B = matrix_of(file, "B", nx, static_cast<Index>(model.inputs.size()), "states x inputs");
  model.G = matrix_of(file, "G", nx, nw, "states x noises");
  model.Q.fixed = MatrixXd::Zero(nw, nw);
  model.x0 = VectorXd::Zero(nx);
  model.P0 = MatrixXd::Zero(nx, nx);
  model.diffuse.assign(static_cast<std::size_t>(nx), true);
  return model;
}

FilterModel read_dynamics(const TomlTable& file) {
  const std::string dynamics = dynamics_of(file);
  if (dynamics == "linear") {
    refuse_keys(file, {"gravity_m_per_s2", "vehicle"}, dynamics);
    return read_linear(file);
  }
  refuse_keys(file, {"period_s", "states", "inputs", "noises", "A", "B", "G"}, dynamics);
  if (dynamics == "inertial") {
    refuse_keys(file, {"vehicle"}, dynamics);
    return read_inertial(file);
  }
  refuse_keys(file, {"gravity_m_per_s2"}, dynamics);
  return rigid_body_model(file.text("vehicle"));
}

}  // namespace

FilterModel parse_filter_model(const std::string& text, const std::string& origin) {
  const TomlTable file = TomlTable::parse(text, origin);
  file.allow({{"name"},
              {"description"},
              {"verdict"},
              {"dynamics"},
              {"gravity", "m_per_s2"},
              {"vehicle"},
              {"period", "s"},
              {"states"},
              {"inputs"},
              {"noises"},
              {"A"},
              {"B"},
              {"G"},
              {"Q"},
              {"sensors"},
              {"initial"}});
  FilterModel model = read_dynamics(file);
  model.name = file.word("name");
  model.description = file.text_or("description", "");
  model.verdict = file.text_or("verdict", "");
  TermReader reader(model, model.Q, "Q", model.noises);
  for (const TomlTable& term : file.tables("Q")) reader.read(term);
  for (const TomlTable& sensor : file.tables("sensors")) read_sensor(sensor, model);
  if (const auto initial = file.maybe_table("initial")) read_initial(*initial, model);
  validate(model, origin);
  return model;
}

FilterModel load_filter_model(const std::string& name) {
  std::vector<std::string> known;
  for (const internal::BuiltInFile& file : internal::built_in_filter_files()) {
    if (file.name == name) return parse_filter_model(file.text, file.path);
    known.push_back(file.name);
  }
  if (!internal::looks_like_path(name))
    throw InvalidInput(
        "filter model",
        fmt::format("no model '{}', expected {} or a file{}", internal::printable(name),
                    internal::joined(known, ", "), internal::did_you_mean(name, known)));
  return parse_filter_model(internal::read_text_file(name, internal::kTomlLimit), name);
}

std::vector<FilterModelTitle> built_in_filter_models() {
  std::vector<FilterModelTitle> titles;
  for (const internal::BuiltInFile& file : internal::built_in_filter_files()) {
    const FilterModel model = parse_filter_model(file.text, file.path);
    titles.push_back({model.name, model.description});
  }
  return titles;
}

}  // namespace quadtune
