// SPDX-License-Identifier: Apache-2.0
// Reads design files, whose format is documented in docs/formats.md.
#include "quadtune/design.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <numbers>

#include "control/cascade_reader.hpp"
#include "quadtune/convention_file.hpp"
#include "quadtune/design/export_target.hpp"
#include "quadtune/design/flight_code_words.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/estimation/filter_file.hpp"
#include "quadtune/estimation/tuned_noise.hpp"
#include "quadtune/estimation/uquad_filter.hpp"
#include "quadtune/gains.hpp"
#include "quadtune/internal/counted.hpp"
#include "quadtune/internal/enum_names.hpp"
#include "quadtune/internal/joined.hpp"
#include "quadtune/internal/suggest.hpp"
#include "quadtune/internal/text_file.hpp"
#include "quadtune/internal/toml_reader.hpp"
#include "quadtune/matrix_checks.hpp"

namespace quadtune {
namespace {

using internal::Range;
using internal::TomlKey;
using internal::TomlTable;

std::string joined(const std::vector<std::string>& words) {
  return fmt::format("{}", internal::joined(words, " "));
}

// The name of a key in messages, e.g. "lqr.Q".
std::string dotted(const TomlTable& table, const std::string& key) {
  const std::string& title = table.title();
  if (title.empty()) return key;
  if (title.rfind("[[", 0) == 0) return key + " in " + title;
  return title.substr(1, title.size() - 2) + "." + key;
}

/// Weights, one number for each of the names.
Eigen::VectorXd read_weights_of_each(const TomlTable& table, const std::string& key,
                                     Eigen::Index size, const std::string& names,
                                     const Range& range) {
  const std::string name = dotted(table, key);
  if (table.is_list_of_lists(key))
    throw InvalidInput(table.where(key),
                       fmt::format("{} is a matrix, expected {} numbers ({}), because the weights "
                                   "on the flown plant are diagonal",
                                   name, size, names));
  Eigen::VectorXd weights = table.vector(key, range);
  if (weights.size() != size)
    throw InvalidInput(
        table.where(key),
        fmt::format("{} has {}, expected {} ({})", name,
                    internal::counted(weights.size(), "entry", "entries"), size, names));
  return weights;
}

// A symmetric matrix with one row per name; a list gives its diagonal, a list of lists the full
// matrix.
// @param names  names of the rows for messages: "inputs: w1 w2 w3 w4".
Eigen::MatrixXd read_weight(const TomlTable& table, const std::string& key, Eigen::Index size,
                            const std::string& names, const Range& range) {
  const std::string name = dotted(table, key);
  if (table.is_list_of_lists(key)) {
    Eigen::MatrixXd M = table.matrix(key);
    if (M.rows() != size || M.cols() != size)
      throw InvalidInput(table.where(key), fmt::format("{} is {}x{}, expected {}x{} ({})", name,
                                                       M.rows(), M.cols(), size, size, names));
    require_symmetric(M, table.where(key), name);
    return M;
  }
  return read_weights_of_each(table, key, size, names, range).asDiagonal();
}

Eigen::MatrixXd read_shaped(const TomlTable& table, const std::string& key, Eigen::Index rows,
                            Eigen::Index cols, const std::string& why) {
  Eigen::MatrixXd M = table.matrix(key);
  require_shape(M, rows, cols, table.where(key), dotted(table, key), why);
  return M;
}

// A list of known, unique names.
std::vector<std::string> read_names(const TomlTable& table, const std::string& key,
                                    const std::vector<std::string>& known) {
  std::vector<std::string> words = table.texts(key);
  for (std::size_t i = 0; i < words.size(); ++i) {
    if (std::find(known.begin(), known.end(), words[i]) == known.end())
      throw InvalidInput(table.where(key),
                         fmt::format("{} has '{}', expected names from {}{}", dotted(table, key),
                                     internal::printable(words[i]), joined(known),
                                     internal::did_you_mean(words[i], known)));
    if (std::find(words.begin(), words.begin() + static_cast<std::ptrdiff_t>(i), words[i]) !=
        words.begin() + static_cast<std::ptrdiff_t>(i))
      throw InvalidInput(table.where(key), fmt::format("{} lists '{}' twice, expected it once",
                                                       dotted(table, key), words[i]));
  }
  return words;
}

// All states except horizontal position and velocity, which need a position sensor.
std::vector<std::string> states_without_position(const Convention& convention) {
  std::vector<std::string> kept;
  for (Eigen::Index i = 0; i < 12; ++i) {
    Eigen::Index source = 0;
    convention.from_ned.row(i).cwiseAbs().maxCoeff(&source);
    const std::string& name = ned_convention().states[static_cast<std::size_t>(source)].name;
    if (name != "px" && name != "py" && name != "u" && name != "v")
      kept.push_back(convention.states[static_cast<std::size_t>(i)].name);
  }
  return kept;
}

// Parses "full", "no-position" or a list of names.
std::vector<std::string> read_states(const TomlTable& table, const Convention& convention) {
  std::vector<std::string> all = names_or_numbers(convention.states, std::ssize(convention.states));
  if (!table.has("states")) return all;
  if (!table.is_text("states")) {
    std::vector<std::string> states = read_names(table, "states", all);
    if (!states.empty()) return states;
    throw InvalidInput(table.where("states"), "lqr.states is empty, expected at least one state");
  }
  const std::string word = table.text("states");
  if (word == "full") return all;
  if (word == "no-position") return states_without_position(convention);
  throw InvalidInput(table.where("states"),
                     fmt::format("lqr.states is '{}', expected 'full', 'no-position' or a list of "
                                 "{}{}",
                                 internal::printable(word), joined(all),
                                 internal::did_you_mean(word, {"full", "no-position"})));
}

/// Whether [lqr] with plant = "flown" requests a law that is a plain matrix.
bool is_matrix(const TomlTable& table) {
  const std::string word = table.text_or("structure", "dynamic");
  if (word != "matrix" && word != "dynamic")
    throw InvalidInput(table.where("structure"),
                       fmt::format("lqr.structure is '{}', expected 'dynamic' or 'matrix'{}",
                                   internal::printable(word),
                                   internal::did_you_mean(word, {"dynamic", "matrix"})));
  return word == "matrix";
}

// Resolves a registered name, or a file relative to the design's folder.
const Convention& read_convention(const TomlTable& table, const std::filesystem::path& folder) {
  return named_convention(table.text_or("convention", "ned"), table.where("convention"), folder);
}

// Reads [lqr] with plant = "flown".
LqiDesign read_lqi(const TomlTable& table, const std::filesystem::path& folder) {
  LqiDesign lqi;
  if (is_matrix(table)) {
    table.allow({{"plant"},
                 {"structure"},
                 {"convention"},
                 {"inputs"},
                 {"Q"},
                 {"R"},
                 {"Q_integral"},
                 {"dt", "s"}});
    MatrixConvention words;
    words.convention = read_convention(table, folder).name;
    if (table.has("inputs"))
      words.input_kind = input_kind(table.text("inputs"), table.where("inputs"));
    lqi.matrix = words;
  } else {
    table.allow({{"plant"},
                 {"structure"},
                 {"Q"},
                 {"R"},
                 {"change"},
                 {"integral"},
                 {"Q_integral"},
                 {"past"},
                 {"dt", "s"}});
  }
  const std::vector<std::string> states =
      names_or_numbers(ned_convention().states, std::ssize(ned_convention().states));
  const std::vector<std::string> inputs =
      names_or_numbers(ned_convention().wrench, std::ssize(ned_convention().wrench));
  const auto weights = [&](const char* key, const std::vector<std::string>& names, const char* what,
                           const Range& range) -> std::optional<Eigen::VectorXd> {
    if (!table.has(key)) return std::nullopt;
    return read_weights_of_each(table, key, std::ssize(names), what + joined(names), range);
  };
  if (table.has("integral")) lqi.integrals = read_names(table, "integral", states);
  if (table.has("dt_s")) lqi.dt = table.number("dt_s", internal::kControlPeriods);
  lqi.Q = weights("Q", states, "states: ", Range::not_negative());
  lqi.Q_integral = weights("Q_integral", lqi.integrals,
                           "integrals: ", lqi.matrix ? Range::positive() : Range::not_negative());
  lqi.R = weights("R", inputs, "inputs: ", Range::positive());
  lqi.R_change = weights("change", inputs, "inputs: ", Range::not_negative());
  if (table.has("past")) lqi.past = table.integer("past", lqi.R_change ? 1 : 0, kMaxPastCommands);
  return lqi;
}

/// Whether the plant of [lqr] is "flown" and not "ideal".
bool on_flown_plant(const TomlTable& table) {
  const std::string plant = table.text_or("plant", "ideal");
  if (plant != "flown" && plant != "ideal")
    throw InvalidInput(
        table.where("plant"),
        fmt::format("lqr.plant is '{}', expected 'flown' or 'ideal'{}", internal::printable(plant),
                    internal::did_you_mean(plant, {"flown", "ideal"})));
  return plant == "flown";
}

LqrDesign read_lqr(const TomlTable& table, const Vehicle& vehicle,
                   const std::filesystem::path& folder) {
  table.allow({{"plant"},
               {"convention"},
               {"inputs"},
               {"states"},
               {"Q"},
               {"R"},
               {"integral"},
               {"Q_integral"},
               {"method"},
               {"dt", "s"}});
  LqrDesign lqr;
  const Convention& words = read_convention(table, folder);
  lqr.convention = words.name;
  lqr.input_kind = input_kind(table.text("inputs"), table.where("inputs"));
  const std::vector<Signal> inputs = input_signals(
      words, lqr.input_kind, static_cast<int>(vehicle.rotors.size()), vehicle.motor.unit);
  lqr.inputs = names_or_numbers(inputs, std::ssize(inputs));
  lqr.states = read_states(table, words);
  lqr.Q = read_weight(table, "Q", static_cast<Eigen::Index>(lqr.states.size()),
                      "states: " + joined(lqr.states), Range::not_negative());
  lqr.R = read_weight(table, "R", static_cast<Eigen::Index>(lqr.inputs.size()),
                      "inputs: " + joined(lqr.inputs), Range::positive());
  if (table.has("integral")) lqr.integrals = read_names(table, "integral", lqr.states);
  const auto ni = static_cast<Eigen::Index>(lqr.integrals.size());
  if (ni == 0 && table.has("Q_integral"))
    throw InvalidInput(table.where("Q_integral"),
                       "lqr.Q_integral has no integrals to weight, expected "
                       "lqr.integral to list the integrated states");
  lqr.Q_integral = ni == 0
                       ? Eigen::MatrixXd(0, 0)
                       : read_weight(table, "Q_integral", ni, "integrals: " + joined(lqr.integrals),
                                     Range::not_negative());
  lqr.method = lqr_method(table.text("method"), table.where("method"));
  if (lqr.method != LqrMethod::continuous || table.has("dt_s"))
    lqr.dt = table.number("dt_s", internal::kControlPeriods);
  return lqr;
}

std::vector<Signal> read_signals(const TomlTable& table, const std::string& key) {
  std::vector<Signal> signals;
  for (const TomlTable& signal : table.tables(key)) {
    signal.allow({{"name"}, {"unit"}});
    signals.push_back({signal.text("name"), signal.text_or("unit", "")});
  }
  return signals;
}

/// Reads Q and R from a tuned model, whose path is relative to the design's folder.
void read_tuned(const TomlTable& table, const std::filesystem::path& folder, KalmanDesign& kalman) {
  for (const char* key : {"Q", "R"})
    if (table.has(key))
      throw InvalidInput(table.where(key),
                         fmt::format("{} and tuned are both in {}, expected only one "
                                     "of them because tuned provides Q and R",
                                     key, table.title()));
  kalman.tuned = table.text("tuned");
  const std::string path = (folder / kalman.tuned).string();
  kalman.tuned_text = internal::read_text_file(path, internal::kTomlLimit);
  const FilterModel model = parse_filter_model(kalman.tuned_text, path);
  kalman.tuned_verdict = model.verdict;
  const NoisePerStep noise = noise_per_step(model, kalman.model, kalman.G, table.where("tuned"));
  kalman.Q = noise.Q;
  kalman.R = noise.R;
}

KalmanDesign read_kalman(const TomlTable& table, const std::filesystem::path& folder) {
  table.allow({{"name"},
               {"dt", "s"},
               {"states"},
               {"inputs"},
               {"measurements"},
               {"A"},
               {"B"},
               {"C"},
               {"G"},
               {"Q"},
               {"R"},
               {"N"},
               {"tuned"}});
  KalmanDesign kalman;
  kalman.name = table.word("name");
  DiscreteLti& model = kalman.model;
  model.dt = table.number("dt_s", Range::positive());
  model.states = read_signals(table, "states");
  model.inputs = read_signals(table, "inputs");
  model.outputs = read_signals(table, "measurements");
  const auto nx = static_cast<Eigen::Index>(model.states.size());
  const auto nu = static_cast<Eigen::Index>(model.inputs.size());
  const auto ny = static_cast<Eigen::Index>(model.outputs.size());
  for (const char* key : {"states", "measurements"})
    if (!table.has(key) || table.tables(key).empty())
      throw InvalidInput(table.where(key), fmt::format("{} has no {}, expected at least one {{ "
                                                       "name, unit }}",
                                                       table.title(), key));
  const std::string states = "states: " + names(model.states);
  const std::string measurements = "measurements: " + names(model.outputs);
  model.A = read_shaped(table, "A", nx, nx, states);
  model.B = nu == 0 && !table.has("B")
                ? Eigen::MatrixXd(nx, 0)
                : read_shaped(table, "B", nx, nu, states + "; inputs: " + names(model.inputs));
  model.C = read_shaped(table, "C", ny, nx, measurements + "; " + states);
  model.D = Eigen::MatrixXd::Zero(ny, nu);
  kalman.G = table.matrix("G");
  const Eigen::Index nw = kalman.G.cols();
  require_shape(kalman.G, nx, nw, table.where("G"), dotted(table, "G"), states);
  if (table.has("tuned")) {
    read_tuned(table, folder, kalman);
  } else {
    kalman.Q = read_weight(table, "Q", nw, "columns of G", Range::not_negative());
    kalman.R = read_weight(table, "R", ny, measurements, Range::positive());
  }
  kalman.N = table.has("N") ? read_shaped(table, "N", nw, ny, "columns of G by measurements")
                            : Eigen::MatrixXd(Eigen::MatrixXd::Zero(nw, ny));
  return kalman;
}

EstimatorDesign read_estimator(const TomlTable& table, const std::filesystem::path& folder,
                               const Vehicle& vehicle) {
  table.allow({{"tuned"}});
  EstimatorDesign estimator;
  estimator.tuned = table.text("tuned");
  const std::string path = (folder / estimator.tuned).string();
  estimator.tuned_text = internal::read_text_file(path, internal::kTomlLimit);
  estimator.model = parse_filter_model(estimator.tuned_text, path);
  UquadFilterSettings<double> tried;
  copy_noise(estimator.model, table.where("tuned"), tried);
  const std::string of = load_vehicle(estimator.model.vehicle).name;
  if (of != vehicle.name)
    throw InvalidInput(table.where("tuned"),
                       fmt::format("the tuned model '{}' is for the vehicle '{}', expected '{}'",
                                   estimator.model.name, of, vehicle.name));
  return estimator;
}

CascadeDesign read_cascade(const TomlTable& table) {
  std::vector<TomlKey> keys = internal::cascade_gain_keys();
  keys.insert(keys.end(), {{"design"},
                           {"integrator"},
                           {"attitude_limit", "rad"},
                           {"integrator_limit"},
                           {"back_calculation", "per_s"},
                           {"takeoff_time", "s"},
                           {"velocity_feed_forward"},
                           {"conditional_integration"}});
  table.allow(keys);
  CascadeDesign cascade;
  const auto wanted = table.maybe_table("design");
  if (wanted) {
    for (const std::string& name : cascade_axis_names())
      if (table.has(name))
        throw InvalidInput(table.where(name),
                           fmt::format("[cascade] has gains of {} in addition to [cascade.design], "
                                       "expected only one of them",
                                       name));
    cascade.gains.dt = table.number("dt_s", internal::kControlPeriods);
    const CascadeSpecification asked =
        internal::read_cascade_specification(*wanted, cascade.gains.dt);
    if (wanted->has("rate_lead_s")) {
      if (wanted->keys().size() > 1)
        throw InvalidInput(
            wanted->where("rate_lead_s"),
            "rate_lead_s requires a design on the flown plant, expected no other key in "
            "[cascade.design], because the others are for a design loop by loop");
      cascade.rate_lead =
          wanted->number("rate_lead_s", {0, Range::Bound::closed, kMaxLag, Range::Bound::closed});
    } else if (!wanted->keys().empty()) {
      cascade.specification = asked;
      cascade.method = asked.method;
    }
    if (table.has("integrator"))
      throw InvalidInput(
          table.where("integrator"),
          "[cascade] has an integrator in addition to [cascade.design]; move it there");
  } else {
    cascade.gains = internal::read_cascade_gains(table);
    if (table.has("integrator"))
      cascade.method = pid_method(table.text("integrator"), table.where("integrator"));
  }
  cascade.attitude_limit =
      table.number_or("attitude_limit_rad", cascade.attitude_limit,
                      {0, Range::Bound::open, std::numbers::pi, Range::Bound::closed});
  cascade.integrator_limit =
      table.number_or("integrator_limit", cascade.integrator_limit, Range::positive());
  cascade.back_calculation = table.number_or("back_calculation_per_s", 0, Range::not_negative());
  cascade.takeoff_time = table.number_or("takeoff_time_s", 0, Range::not_negative());
  // Gains that are designed here are flown by the same law that the design assumes.
  const auto truth = [&](const char* key) {
    return table.has(key) ? table.truth(key) : wanted.has_value();
  };
  cascade.velocity_feed_forward = truth("velocity_feed_forward");
  cascade.conditional_integration = truth("conditional_integration");
  return cascade;
}

FlightCondition read_trim(const TomlTable& table) {
  FlightCondition condition;
  condition.kind = flight_kind(table.text("at"), table.where("at"));
  const bool moves = condition.kind == FlightKind::line || condition.kind == FlightKind::circle;
  std::vector<TomlKey> keys = {{"at"}, {"yaw", "rad"}};
  if (moves) keys.push_back({"speed", "m_per_s"});
  if (condition.kind != FlightKind::hover) keys.push_back({"climb", "m_per_s"});
  if (condition.kind == FlightKind::circle) keys.push_back({"radius", "m"});
  if (condition.kind == FlightKind::spin) keys.push_back({"yaw_rate", "rad_per_s"});
  table.allow(keys);
  condition.yaw = table.number_or("yaw_rad", 0);
  condition.speed = table.number_or("speed_m_per_s", 0, Range::not_negative());
  condition.climb = table.number_or("climb_m_per_s", 0);
  if (condition.kind == FlightKind::circle) {
    condition.speed = table.number("speed_m_per_s", Range::positive());
    condition.radius = table.number("radius_m");
    if (condition.radius == 0)
      throw InvalidInput(table.where("radius_m"),
                         "trim.radius_m is 0, expected a positive radius (right "
                         "turn) or a negative one (left turn)");
  }
  if (condition.kind == FlightKind::spin) {
    condition.yaw_rate = table.number("yaw_rate_rad_per_s");
    if (condition.yaw_rate == 0)
      throw InvalidInput(table.where("yaw_rate_rad_per_s"),
                         "trim.yaw_rate_rad_per_s is 0, expected a positive rate (right turn) or a "
                         "negative one (left turn)");
  }
  return condition;
}

std::vector<ExportRequest> read_exports(const TomlTable& file, const Design& design) {
  std::vector<ExportRequest> exports;
  for (const TomlTable& table : file.tables("export")) {
    table.allow({{"to"},
                 {"name"},
                 {"precision"},
                 {"law"},
                 {"adapter"},
                 {"firmware"},
                 {"setup"},
                 {"filter_noise"}});
    ExportRequest request{table.text("to")};
    const std::string where = table.where("to");
    const ExportTarget& target = export_target(request.to, where);
    for (const ExportRequest& earlier : exports)
      if (earlier.to == request.to)
        throw InvalidInput(where,
                           "export to '" + request.to + "' is requested twice, expected once");
    const bool matrix = design.lqi && design.lqi->matrix;
    if (target.is_firmware && !design.cascade)
      throw InvalidInput(where, fmt::format("export to '{}' has no gains to write, expected a "
                                            "[cascade] table, because this firmware cannot fly "
                                            "state feedback",
                                            request.to));
    if (!target.takes_memory && !target.is_firmware && design.lqi && !matrix)
      throw InvalidInput(where, fmt::format("export to '{}' cannot hold the past commands and "
                                            "lags of a law with lqr.plant 'flown', expected json, "
                                            "or lqr.structure 'matrix'",
                                            request.to));
    if (target.needs_gains && !design.lqr && !matrix)
      throw InvalidInput(where, fmt::format("export to '{}' has no gains to write, expected an "
                                            "[lqr] table",
                                            request.to));
    for (const char* key : {"name", "precision", "law", "adapter"})
      if (request.to != "c" && !table.text_or(key, "").empty())
        throw InvalidInput(table.where(key),
                           fmt::format("export.{} applies only to an export to 'c', "
                                       "expected no such key for '{}'",
                                       key, request.to));
    for (const char* key : {"firmware", "setup", "filter_noise"})
      if (!target.is_firmware && table.has(key))
        throw InvalidInput(table.where(key),
                           fmt::format("export.{} applies only to firmware parameters, expected "
                                       "no such key for '{}'",
                                       key, request.to));
    request.firmware = {table.text_or("firmware", ""), table.text_or("setup", ""),
                        table.has("filter_noise") && table.truth("filter_noise")};
    request.flight_code.name = table.text_or("name", "");
    request.flight_code.double_precision =
        is_double_precision(table.text_or("precision", "float"), table.where("precision"));
    request.flight_code.law = table.text_or("law", "");
    if (!request.flight_code.name.empty())
      require_flight_code_name(request.flight_code.name, table.where("name"));
    if (!request.flight_code.law.empty())
      require_flight_code_law(request.flight_code.law, table.where("law"));
    request.flight_code.adapter = table.text_or("adapter", "");
    if (!request.flight_code.adapter.empty())
      require_flight_code_adapter(request.flight_code.adapter, table.where("adapter"));
    exports.push_back(request);
  }
  return exports;
}

PublishedGains read_published(const TomlTable& table, const std::optional<LqrDesign>& lqr) {
  table.allow({{"source"}, {"note"}, {"K"}, {"K_int"}});
  if (!lqr)
    throw InvalidInput(table.where(),
                       "[published] has no gains to be compared with, expected an "
                       "[lqr] table for the ideal plant");
  PublishedGains published;
  published.source = table.text("source");
  published.note = table.text_or("note", "");
  published.K = table.matrix("K");
  const auto nx = static_cast<Eigen::Index>(lqr->states.size());
  const auto nu = static_cast<Eigen::Index>(lqr->inputs.size());
  const auto ni = static_cast<Eigen::Index>(lqr->integrals.size());
  const Eigen::Index rows = published.K.rows();
  if (rows > nu || published.K.cols() != nx)
    throw InvalidInput(
        table.where("K"),
        fmt::format("published.K is {}, expected up to {} rows (inputs: {}) of {} "
                    "(states: {})",
                    shape(published.K), nu, joined(lqr->inputs), nx, joined(lqr->states)));
  published.K_int = Eigen::MatrixXd(rows, 0);
  if (ni > 0 || table.has("K_int"))
    published.K_int = read_shaped(table, "K_int", rows, ni,
                                  "rows as published.K; integrals: " + joined(lqr->integrals));
  return published;
}

Vehicle read_vehicle(const TomlTable& file, const std::filesystem::path& folder) {
  const std::string word = file.text("vehicle");
  const std::vector<std::string> known = built_in_vehicles();
  if (std::find(known.begin(), known.end(), word) != known.end()) return load_vehicle(word);
  const std::filesystem::path path = folder / word;
  std::error_code ignored;
  if (std::filesystem::exists(path, ignored)) {
    // A word without a slash could be interpreted as a built-in name.
    return load_vehicle(path.has_parent_path() ? path.string() : "./" + path.string());
  }
  throw InvalidInput(file.where("vehicle"),
                     fmt::format("no vehicle '{}' and no such file, expected {} or a vehicle file "
                                 "in the design's folder{}",
                                 internal::printable(word), internal::joined(known, ", "),
                                 internal::did_you_mean(word, known)));
}

}  // namespace

constexpr internal::EnumName<LqrMethod> kLqrMethods[] = {{LqrMethod::continuous, "continuous"},
                                                         {LqrMethod::discrete, "discrete"},
                                                         {LqrMethod::sampled, "sampled"}};

std::string to_string(LqrMethod method) { return internal::name_in(kLqrMethods, method); }

LqrMethod lqr_method(const std::string& name, const std::string& where) {
  return internal::require_in(kLqrMethods, name, "method", where);
}

namespace {

MissionRequest read_mission_request(const TomlTable& table, const Design& design,
                                    const std::filesystem::path& folder) {
  table.allow({{"name"}, {"controller"}, {"estimator"}, {"sensors"}, {"flow"}, {"wind"}});
  MissionRequest request;
  request.where = table.where();
  request.mission = table.text("name");
  if (request.mission.ends_with(".toml") && !folder.empty())
    request.mission = (folder / request.mission).string();
  request.controller =
      table.text_or("controller", design.cascade ? "cascaded-pid" : "state-feedback");
  const std::vector<std::string> known = {"cascaded-pid", "state-feedback"};
  if (request.controller != known[0] && request.controller != known[1])
    throw InvalidInput(table.where("controller"),
                       fmt::format("controller in {} is '{}', expected cascaded-pid or "
                                   "state-feedback{}",
                                   table.title(), internal::printable(request.controller),
                                   internal::did_you_mean(request.controller, known)));
  const bool cascade = request.controller == known[0];
  if (cascade ? !design.cascade : !has_feedback(design))
    throw InvalidInput(
        table.where("controller"),
        fmt::format("{} flies {}, but the file has no {}, expected the law that the "
                    "mission tests",
                    table.title(), request.controller, cascade ? "[cascade]" : "[lqr]"));
  request.estimator = table.text_or("estimator", "");
  request.sensors = table.text_or("sensors", request.sensors);
  request.flow = table.text_or("flow", request.flow);
  request.wind = table.text_or("wind", request.wind);
  return request;
}

}  // namespace

Design parse_design(const std::string& text, const std::string& origin,
                    const std::filesystem::path& folder) {
  const TomlTable file = TomlTable::parse(text, origin);
  file.allow({{"name"},
              {"description"},
              {"vehicle"},
              {"trim"},
              {"lqr"},
              {"kalman"},
              {"estimator"},
              {"cascade"},
              {"mission"},
              {"export"},
              {"published"}});
  Design design;
  design.text = text;
  design.name = file.word("name");
  design.description = file.text_or("description", "");
  design.vehicle = read_vehicle(file, folder);
  if (const auto table = file.maybe_table("trim")) design.condition = read_trim(*table);
  if (const auto table = file.maybe_table("lqr")) {
    if (!on_flown_plant(*table))
      design.lqr = read_lqr(*table, design.vehicle, folder);
    else if (design.condition.kind != FlightKind::hover)
      throw InvalidInput(
          table->where("plant"),
          fmt::format("lqr.plant is 'flown' in a design whose trim is a {}, expected "
                      "a hover",
                      to_string(design.condition.kind)));
    else if (design.condition.yaw != 0)
      throw InvalidInput(
          table->where("plant"),
          fmt::format("lqr.plant is 'flown' in a design whose trim has the yaw {} rad, expected 0 "
                      "because the flown plant hovers with the nose to the north",
                      design.condition.yaw));
    else
      design.lqi = read_lqi(*table, folder);
  }
  for (const TomlTable& table : file.tables("kalman")) {
    design.kalman.push_back(read_kalman(table, folder));
    for (std::size_t i = 0; i + 1 < design.kalman.size(); ++i)
      if (design.kalman[i].name == design.kalman.back().name)
        throw InvalidInput(table.where("name"),
                           fmt::format("filter '{}' is defined twice, expected "
                                       "unique names",
                                       design.kalman[i].name));
  }
  if (const auto table = file.maybe_table("estimator"))
    design.estimator = read_estimator(*table, folder, design.vehicle);
  if (const auto table = file.maybe_table("cascade")) design.cascade = read_cascade(*table);
  if (!has_feedback(design) && design.kalman.empty() && !design.cascade)
    throw InvalidInput(file.where(),
                       "the file requests no design, expected [lqr], [[kalman]] or "
                       "[cascade]");
  if (const auto table = file.maybe_table("published"))
    design.published = read_published(*table, design.lqr);
  for (const TomlTable& table : file.tables("mission"))
    design.missions.push_back(read_mission_request(table, design, folder));
  design.exports = read_exports(file, design);
  return design;
}

Design load_design(const std::filesystem::path& path) {
  Design design = parse_design(internal::read_text_file(path.string(), internal::kTomlLimit),
                               path.string(), path.parent_path());
  design.file = path;
  return design;
}

}  // namespace quadtune
