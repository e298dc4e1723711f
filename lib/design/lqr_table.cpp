// SPDX-License-Identifier: Apache-2.0
#include "design/lqr_table.hpp"

#include <fmt/format.h>

#include "control/cascade_reader.hpp"
#include "design/table_entries.hpp"
#include "quadtune/convention_file.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/gains.hpp"
#include "quadtune/internal/enum_names.hpp"
#include "quadtune/internal/suggest.hpp"
#include "quadtune/matrix_checks.hpp"

namespace quadtune {

constexpr internal::EnumName<LqrMethod> kLqrMethods[] = {{LqrMethod::continuous, "continuous"},
                                                         {LqrMethod::discrete, "discrete"},
                                                         {LqrMethod::sampled, "sampled"}};

std::string to_string(LqrMethod method) { return internal::name_in(kLqrMethods, method); }

LqrMethod lqr_method(const std::string& name, const std::string& where) {
  return internal::require_in(kLqrMethods, name, "method", where);
}

namespace internal {
namespace {

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
  throw InvalidInput(
      table.where("states"),
      fmt::format("lqr.states is '{}', expected 'full', 'no-position' or a list of "
                  "{}{}",
                  printable(word), spaced(all), did_you_mean(word, {"full", "no-position"})));
}

/// Whether [lqr] with plant = "flown" requests a law that is a plain matrix.
bool is_matrix(const TomlTable& table) {
  const std::string word = table.text_or("structure", "dynamic");
  if (word != "matrix" && word != "dynamic")
    throw InvalidInput(table.where("structure"),
                       fmt::format("lqr.structure is '{}', expected 'dynamic' or 'matrix'{}",
                                   printable(word), did_you_mean(word, {"dynamic", "matrix"})));
  return word == "matrix";
}

// Resolves a registered name, or a file relative to the design's folder.
const Convention& read_convention(const TomlTable& table, const std::filesystem::path& folder) {
  return named_convention(table.text_or("convention", "ned"), table.where("convention"), folder);
}

}  // namespace

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
    return read_weights_of_each(table, key, std::ssize(names), what + spaced(names), range);
  };
  if (table.has("integral")) lqi.integrals = read_names(table, "integral", states);
  if (table.has("dt_s")) lqi.dt = table.number("dt_s", kControlPeriods);
  lqi.Q = weights("Q", states, "states: ", Range::not_negative());
  lqi.Q_integral = weights("Q_integral", lqi.integrals,
                           "integrals: ", lqi.matrix ? Range::positive() : Range::not_negative());
  lqi.R = weights("R", inputs, "inputs: ", Range::positive());
  lqi.R_change = weights("change", inputs, "inputs: ", Range::not_negative());
  if (table.has("past")) lqi.past = table.integer("past", lqi.R_change ? 1 : 0, kMaxPastCommands);
  return lqi;
}

bool on_flown_plant(const TomlTable& table) {
  const std::string plant = table.text_or("plant", "ideal");
  if (plant != "flown" && plant != "ideal")
    throw InvalidInput(table.where("plant"),
                       fmt::format("lqr.plant is '{}', expected 'flown' or 'ideal'{}",
                                   printable(plant), did_you_mean(plant, {"flown", "ideal"})));
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
                      "states: " + spaced(lqr.states), Range::not_negative());
  lqr.R = read_weight(table, "R", static_cast<Eigen::Index>(lqr.inputs.size()),
                      "inputs: " + spaced(lqr.inputs), Range::positive());
  if (table.has("integral")) lqr.integrals = read_names(table, "integral", lqr.states);
  const auto ni = static_cast<Eigen::Index>(lqr.integrals.size());
  if (ni == 0 && table.has("Q_integral"))
    throw InvalidInput(table.where("Q_integral"),
                       "lqr.Q_integral has no integrals to weight, expected "
                       "lqr.integral to list the integrated states");
  lqr.Q_integral = ni == 0
                       ? Eigen::MatrixXd(0, 0)
                       : read_weight(table, "Q_integral", ni, "integrals: " + spaced(lqr.integrals),
                                     Range::not_negative());
  lqr.method = lqr_method(table.text("method"), table.where("method"));
  if (lqr.method != LqrMethod::continuous || table.has("dt_s"))
    lqr.dt = table.number("dt_s", kControlPeriods);
  return lqr;
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
                    shape(published.K), nu, spaced(lqr->inputs), nx, spaced(lqr->states)));
  published.K_int = Eigen::MatrixXd(rows, 0);
  if (ni > 0 || table.has("K_int"))
    published.K_int = read_shaped(table, "K_int", rows, ni,
                                  "rows as published.K; integrals: " + spaced(lqr->integrals));
  return published;
}

}  // namespace internal
}  // namespace quadtune
