// SPDX-License-Identifier: Apache-2.0
#include "quadtune/convention_file.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "quadtune/errors.hpp"
#include "quadtune/internal/counted.hpp"
#include "quadtune/internal/joined.hpp"
#include "quadtune/internal/suggest.hpp"
#include "quadtune/internal/text_file.hpp"
#include "quadtune/internal/toml_reader.hpp"

namespace quadtune {
namespace {

using internal::TomlTable;

/// The signals of a flight code, and the signed permutation that computes them from those of `ned`.
struct Signals {
  std::vector<Signal> signals;
  Eigen::MatrixXd from_ned;
};

std::string trimmed(const std::string& text) {
  const std::size_t first = text.find_first_not_of(' ');
  return first == std::string::npos ? ""
                                    : text.substr(first, text.find_last_not_of(' ') - first + 1);
}

bool is_name(const std::string& name) {
  return !name.empty() && name.size() <= 32 &&
         name.find_first_not_of(
             "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_") ==
             std::string::npos;
}

// A list of "name = source" or "name = -source".
Signals read_signals(const TomlTable& file, const std::string& key,
                     const std::vector<Signal>& ned) {
  const std::vector<std::string> entries = file.texts(key),
                                 known = names_or_numbers(ned, std::ssize(ned));
  if (entries.size() != ned.size())
    throw InvalidInput(file.where(key),
                       fmt::format("{} has {}, expected {}, one for each of {}", key,
                                   internal::counted(entries.size(), "entry", "entries"),
                                   ned.size(), internal::joined(known, ", ")));
  Signals read;
  read.from_ned.setZero(std::ssize(ned), std::ssize(ned));
  for (std::size_t i = 0; i < entries.size(); ++i) {
    const std::string where = file.where(key, i);
    const std::size_t equals = entries[i].find('=');
    const std::string name = trimmed(entries[i].substr(0, equals));
    std::string source = equals == std::string::npos ? "" : trimmed(entries[i].substr(equals + 1));
    const bool negative = source.starts_with('-');
    if (negative) source = trimmed(source.substr(1));
    const auto refuse = [&](const std::string& problem) {
      throw InvalidInput(where,
                         fmt::format("{}: '{}' {}", key, internal::printable(entries[i]), problem));
    };
    if (equals == std::string::npos || !is_name(name))
      refuse(fmt::format(
          "is not a definition, expected 'NAME = {0}' or 'NAME = -{0}' with a name of at "
          "most 32 letters, digits and _",
          known[i]));
    const auto at = std::find(known.begin(), known.end(), source);
    if (at == known.end())
      refuse(fmt::format("does not name a signal of ned, expected one of {}{}",
                         internal::joined(known, ", "), internal::did_you_mean(source, known)));
    const Eigen::Index column = at - known.begin();
    if (!read.from_ned.col(column).isZero(0))
      refuse(fmt::format("uses {}, which is already used; expected each once", source));
    for (const Signal& earlier : read.signals)
      if (earlier.name == name)
        refuse("defines a name that is already defined, expected unique names");
    read.from_ned(static_cast<Eigen::Index>(i), column) = negative ? -1 : 1;
    read.signals.push_back({name, ned[static_cast<std::size_t>(column)].unit});
  }
  return read;
}

std::string list_text(const char* key, const std::vector<Signal>& signals,
                      const Eigen::Ref<const Eigen::MatrixXd>& from_ned,
                      const std::vector<Signal>& ned) {
  std::string text = fmt::format("{} = [", key);
  for (std::size_t i = 0; i < signals.size(); ++i) {
    Eigen::Index column = 0;
    const auto row = from_ned.row(static_cast<Eigen::Index>(i));
    row.cwiseAbs().maxCoeff(&column);
    text += fmt::format("{}\"{} = {}{}\"", i == 0 ? "" : ", ", signals[i].name,
                        row(column) < 0 ? "-" : "", ned[static_cast<std::size_t>(column)].name);
  }
  return text + "]\n";
}

}  // namespace

Convention parse_convention(const std::string& text, const std::string& origin) {
  const TomlTable file = TomlTable::parse(text, origin);
  file.allow({{"name"}, {"description"}, {"sign_law"}, {"states"}, {"wrench"}});
  Convention convention;
  convention.name = file.word("name");
  convention.description = file.text_or("description", "");
  if (file.has("sign_law"))
    convention.sign_law = sign_law(file.text("sign_law"), file.where("sign_law"));
  const Signals states = read_signals(file, "states", ned_convention().states);
  const Signals wrench = read_signals(file, "wrench", ned_convention().wrench);
  convention.states = states.signals;
  convention.from_ned = states.from_ned;
  convention.wrench = wrench.signals;
  convention.wrench_from_ned = wrench.from_ned;
  return convention;
}

std::string convention_text(const Convention& convention) {
  const Convention& ned = ned_convention();
  std::string description;
  for (const char c : convention.description) {
    if (c == '"' || c == '\\') description += '\\';
    description += c;
  }
  return fmt::format("name = \"{}\"\ndescription = \"{}\"\nsign_law = \"{}\"\n", convention.name,
                     description, to_string(convention.sign_law)) +
         list_text("states", convention.states, convention.from_ned, ned.states) +
         list_text("wrench", convention.wrench, convention.wrench_from_ned, ned.wrench);
}

const Convention& named_convention(const std::string& word, const std::string& where,
                                   const std::filesystem::path& folder) {
  if (!word.ends_with(".toml")) return convention(word, where);
  const std::string path = (folder / word).string();
  return add_convention(
      parse_convention(internal::read_text_file(path, internal::kTomlLimit), path), path);
}

}  // namespace quadtune
