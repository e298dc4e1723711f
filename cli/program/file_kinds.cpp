// SPDX-License-Identifier: Apache-2.0
#include "program/file_kinds.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <optional>

#include "program/command_line.hpp"
#include "program/program.hpp"
#include "quadtune/internal/joined.hpp"
#include "quadtune/workbench/files/file_kind.hpp"

namespace quadtune::cli {
namespace {

using Words = std::vector<std::string>;

Words with(Words some, const Words& more) {
  some.insert(some.end(), more.begin(), more.end());
  return some;
}

/// The commands that read a kind of file, with the option unless it is a positional argument.
Words takers_of(FileKind kind) {
  static const Words laws = {
      "fly --gains", "compare", "compare --gains",  "margins --gains",
      "diff",        "export",  "tune pid --gains", "tune lqr --match-gains"};
  static const std::map<FileKind, Words> takers = {
      {FileKind::export_folder, with({"verify", "certify"}, laws)},
      {FileKind::gains, laws},
      {FileKind::design, with({"design", "verify --design"}, laws)},
      {FileKind::vehicle,
       {"vehicle", "design", "linearize", "lqr", "lqg", "pid", "margins", "discretize", "fly",
        "compare", "tune pid", "tune lqr", "import --vehicle", "export --vehicle",
        "verify --vehicle", "certify --vehicle", "export"}},
      {FileKind::mission,
       {"fly --mission", "compare --mission", "tune pid --mission", "tune lqr --mission"}},
      {FileKind::campaign, {"campaign run", "campaign init"}},
      {FileKind::campaign_folder,
       {"campaign work", "campaign status", "campaign merge", "campaign replay", "campaign run",
        "campaign init"}},
      {FileKind::requirements, {"tune pid --requirements", "tune lqr --requirements"}},
      {FileKind::filter_model, {"tune kalman --model"}},
      {FileKind::schedule, {"fly --gains", "compare", "compare --gains", "export"}},
      {FileKind::log, {"log", "tune kalman --log", "calibrate imu --log", "allan --log"}},
      {FileKind::calibration, {"calibrate imu --base"}}};
  const auto found = takers.find(kind);
  return found == takers.end() ? Words{} : found->second;
}

/// Whether a word is an option of the command that is followed by a value.
bool takes_value(const std::string& verb, const std::string& word) {
  if (!word.starts_with("-")) return false;
  if (word == "-o") return true;
  for (const CommonOption& common : kCommonOptions)
    if (word == common.name) return *common.type != '\0';
  for (const Verb& known : verbs()) {
    if (known.name != verb) continue;
    CommandLine line(known.name, known.usage);
    (void)known.define(line);
    const Option* const option = line.find(word);
    return option != nullptr && option->takes_value();
  }
  return false;
}

/// "fly --gains" for the argument at `at`; "fly" if it is positional.
std::string place_of(const std::vector<std::string>& args, std::size_t at) {
  std::string place = args[0];
  if (const std::vector<std::string> kinds = kinds_of(args[0]);
      args.size() > 1 && std::find(kinds.begin(), kinds.end(), args[1]) != kinds.end())
    place += " " + args[1];
  const std::size_t equals = args[at].find('=');
  if (args[at].starts_with("--") && equals != std::string::npos)
    return place + " " + args[at].substr(0, equals);
  return at > 0 && takes_value(place, args[at - 1]) ? place + " " + args[at - 1] : place;
}

}  // namespace

std::string who_takes(const std::vector<std::string>& args, const std::string& where) {
  const auto names = [&](const std::string& file) {
    return where == file || where.starts_with(file + ":");
  };
  for (std::size_t i = 1; i < args.size(); ++i) {
    const std::size_t equals = args[i].starts_with("--") ? args[i].find('=') : std::string::npos;
    const std::string file = equals == std::string::npos ? args[i] : args[i].substr(equals + 1);
    if (file.empty() || !names(file)) continue;
    // The kind of a file that would be written is not the problem.
    if (place_of(args, i).ends_with(" -o")) return "";
    const std::optional<FileKind> kind = file_kind(file);
    if (!kind) return "";
    const Words takers = takers_of(*kind);
    const std::string place = place_of(args, i);
    // The same file may be given twice, once in the right place.
    if (std::find(takers.begin(), takers.end(), place) != takers.end()) continue;
    if (takers.empty())
      return fmt::format("; this is {}, and no command reads it", to_string(*kind));
    constexpr std::ptrdiff_t kShown = 4;
    const Words shown(takers.begin(), takers.begin() + std::min(std::ssize(takers), kShown));
    const std::string more = std::ssize(takers) > kShown
                                 ? fmt::format(" and {} more", std::ssize(takers) - kShown)
                                 : std::string();
    return fmt::format("; this is {}, which is for quadtune {}{}", to_string(*kind),
                       internal::joined(shown, ", "), more);
  }
  return "";
}

}  // namespace quadtune::cli
