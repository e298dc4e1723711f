// SPDX-License-Identifier: Apache-2.0
#include "quadtune/workbench/campaign/campaign_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <limits>

#include "quadtune/errors.hpp"
#include "quadtune/internal/suggest.hpp"
#include "quadtune/internal/text_file.hpp"
#include "quadtune/internal/toml_reader.hpp"
#include "quadtune/internal/uncertainty_reader.hpp"

namespace quadtune {
namespace {

using internal::Range;
using internal::TomlTable;

/// Whether a word must be a path rather than a name.
bool is_path(const std::string& word) {
  return word.find('/') != std::string::npos || word.ends_with(".toml") || word.ends_with(".json");
}

/// Resolves a word relative to the campaign's folder: a path there, or an unchanged name.
std::string beside(const std::filesystem::path& folder, const std::string& word) {
  std::error_code ignored;  // the reader of the path reports errors
  const bool path = is_path(word) || std::filesystem::is_regular_file(folder / word, ignored);
  return path ? (folder / word).string() : word;
}

/// The same for gains, which may be in a folder.
std::string gains_beside(const TomlTable& table, const std::filesystem::path& folder,
                         const std::string& word) {
  const std::vector<std::string> known = {"designed", "published"};
  if (std::find(known.begin(), known.end(), word) != known.end()) return word;
  std::error_code unreadable;  // the reader of the path reports this
  if (!std::filesystem::exists(folder / word, unreadable) && !unreadable)
    throw InvalidInput(table.where("gains"),
                       fmt::format("no gains '{}', expected designed, published, or a file or "
                                   "folder next to this file{}",
                                   internal::printable(word), internal::did_you_mean(word, known)));
  return (folder / word).string();
}

/// Whether a name is valid in a file (TomlTable::word()).
bool is_word(const std::string& name) {
  return !name.empty() && name.size() <= 64 && std::all_of(name.begin(), name.end(), [](char c) {
    return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '.' || c == '_' || c == '-';
  });
}

/// Rejects duplicate names, because the items could not be distinguished.
template <class Item>
void require_new_name(const std::vector<Item>& others, const std::string& name,
                      const std::string& where, const char* what) {
  for (const Item& other : others)
    if (other.name == name)
      throw InvalidInput(
          where, fmt::format("a second {} has the name '{}'; names must be distinct", what, name));
}

CampaignDesign read_design(const TomlTable& table, const std::filesystem::path& folder) {
  table.allow({{"name"}, {"gains"}, {"controller"}, {"integrator"}});
  CampaignDesign design;
  design.where = table.where();
  const std::string gains = table.text_or("gains", "designed");
  design.name =
      table.has("name") ? table.word("name") : std::filesystem::path(gains).stem().string();
  // The name is used for a file and as the value of a column.
  if (!is_word(design.name))
    throw InvalidInput(table.where(), fmt::format("no name of a design can be made from the gains "
                                                  "'{}'; add name = \"…\"",
                                                  internal::printable(gains)));
  design.gains = gains_beside(table, folder, gains);
  design.controller = table.text_or("controller", "");
  design.integrator = table.text_or("integrator", "");
  return design;
}

CampaignKeep read_keep(const TomlTable& table) {
  table.allow({{"failures"}, {"sample"}});
  CampaignKeep keep;
  constexpr int kMax = 1000;
  if (table.has("failures")) keep.failures = table.integer("failures", 0, kMax);
  if (table.has("sample")) keep.sample = table.integer("sample", 0, kMax);
  return keep;
}

}  // namespace

CampaignMission read_campaign_mission(const TomlTable& table, const std::filesystem::path& folder,
                                      const std::vector<internal::TomlKey>& more) {
  std::vector<internal::TomlKey> keys = {
      {"mission"},    {"estimator"},     {"sensors"}, {"flow"},      {"flow_rate", "Hz"},
      {"wind"},       {"duration", "s"}, {"solver"},  {"step", "s"}, {"dynamic_environment"},
      {"allocation"}, {"take_off"}};
  keys.insert(keys.end(), more.begin(), more.end());
  table.allow(keys);
  CampaignMission read;
  read.where = table.where();
  try {
    read.mission = load_mission(beside(folder, table.text("mission")));
  } catch (const InvalidInput& error) {
    if (error.where() == "mission") throw InvalidInput(table.where("mission"), error.what());
    throw;
  }
  FlightOptions& arguments = read.arguments;
  arguments.estimator = table.text_or("estimator", "");
  arguments.sensors = table.text_or("sensors", "");
  arguments.flow = table.text_or("flow", "");
  arguments.wind = table.text_or("wind", arguments.wind);
  arguments.allocation = table.text_or("allocation", "");
  arguments.take_off = table.text_or("take_off", "");
  arguments.solver = table.text_or("solver", arguments.solver);
  if (table.has("flow_rate_Hz"))
    arguments.flow_rate = table.number("flow_rate_Hz", Range::positive());
  if (table.has("duration_s")) arguments.duration = table.number("duration_s", Range::positive());
  if (table.has("step_s")) arguments.step = table.number("step_s", Range::positive());
  arguments.dynamic_environment =
      table.has("dynamic_environment") && table.truth("dynamic_environment");
  return read;
}

CampaignRequest read_campaign(const std::filesystem::path& path) {
  const TomlTable file = TomlTable::parse(
      internal::read_text_file(path.string(), internal::kTomlLimit), path.string());
  file.allow({{"name"},
              {"vehicle"},
              {"flights"},
              {"seed"},
              {"shards"},
              {"keep"},
              {"design"},
              {"mission"},
              {"vary"},
              {"correlation"}});
  const std::filesystem::path folder = path.parent_path();
  constexpr int kMax = std::numeric_limits<int>::max();
  CampaignRequest request;
  request.name = file.word("name");
  request.vehicle = beside(folder, file.text("vehicle"));
  request.vehicle_where = file.where("vehicle");
  request.flights = static_cast<std::uint32_t>(file.integer("flights", 1, kMax));
  if (file.has("seed")) request.seed = static_cast<std::uint64_t>(file.integer("seed", 0, kMax));
  if (file.has("shards")) {
    request.shards = static_cast<std::uint32_t>(file.integer("shards", 1, kMax));
    if (request.shards > request.flights)
      throw InvalidInput(file.where("shards"),
                         fmt::format("shards is {}, expected at most {}, the number of "
                                     "flights",
                                     request.shards, request.flights));
  }
  if (const auto keep = file.maybe_table("keep")) request.keep = read_keep(*keep);
  for (const TomlTable& table : file.tables("design")) {
    CampaignDesign design = read_design(table, folder);
    require_new_name(request.designs, design.name, table.where(), "design");
    request.designs.push_back(std::move(design));
  }
  if (request.designs.empty())
    request.designs.push_back({"designed", "designed", "", "", file.where()});
  std::vector<Mission> missions;
  for (const TomlTable& table : file.tables("mission")) {
    request.missions.push_back(read_campaign_mission(table, folder));
    require_new_name(missions, request.missions.back().mission.name, table.where(), "mission");
    missions.push_back(request.missions.back().mission);
  }
  if (missions.empty())
    throw InvalidInput(file.where(), "[[mission]] is missing; expected at least one");
  request.uncertainty = internal::read_uncertainty(file, folder);
  return request;
}

}  // namespace quadtune
