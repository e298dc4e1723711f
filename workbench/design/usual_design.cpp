// SPDX-License-Identifier: Apache-2.0
#include "quadtune/workbench/design/usual_design.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <vector>

#include "firmware/turn_parts.hpp"
#include "quadtune/design/export_target.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/workbench/design/chosen_law.hpp"
#include "quadtune/workbench/files/file_kind.hpp"

namespace quadtune {
namespace {

/// A basic string of TOML.
std::string quoted(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') out += '\\';
    out += c;
  }
  return out + '"';
}

/// @return  `name`
/// @throws OptionError  if no export of a cascade has this name, or it is in `all` twice
const std::string& checked_export(const std::string& name, const std::vector<std::string>& all) {
  const auto refuse = [&](const std::string& why) {
    throw OptionError("to", fmt::format("to: {}", why));
  };
  try {
    if (export_target(name, "").needs_gains)
      refuse(
          fmt::format("'{}' holds the gains of a state feedback, expected json, mat, c or "
                      "a firmware, because a design without a design file is a cascade",
                      name));
  } catch (const OptionError&) {
    throw;
  } catch (const InvalidInput& error) {
    refuse(error.what());
  }
  if (std::count(all.begin(), all.end(), name) > 1)
    refuse(fmt::format("'{}' is requested twice, expected once", name));
  return name;
}

/// The line of the lead of the rate for a vehicle with slow motors. A firmware has a lead of its own,
/// or none.
std::string lead_of(const Vehicle& vehicle, const std::vector<std::string>& to) {
  const bool for_firmware = std::any_of(to.begin(), to.end(), [](const std::string& name) {
    return export_target(name, "").is_firmware;
  });
  if (!internal::has_slow_motors(vehicle) || for_firmware || !usually_on_flown_plant(vehicle))
    return "";
  return fmt::format("rate_lead_s = {:.3g}\n", internal::usual_rate_lead(vehicle));
}

}  // namespace

Design usual_design(const std::string& vehicle, const std::vector<std::string>& to) {
  const Vehicle loaded = load_vehicle(vehicle);
  const std::string& name = loaded.name;
  std::string exports;
  for (const std::string& one : to.empty() ? std::vector<std::string>{"json", "c"} : to)
    exports += "\n[[export]]\nto = " + quoted(checked_export(one, to)) + "\n";
  const std::filesystem::path path = vehicle;
  return parse_design(
      fmt::format("name = \"{}-flight\"\n"
                  "description = \"PID cascade of {}, designed on the flown plant\"\n"
                  "vehicle = {}\n\n[cascade]\ndt_s = 0.005\n\n[cascade.design]\n{}\n"
                  "[[mission]]\nname = \"hover\"\n\n[[mission]]\nname = \"step-north\"\n\n"
                  "[[mission]]\nname = \"take-off-and-land\"\n{}",
                  name, name, quoted(path.filename().string()), lead_of(loaded, to), exports),
      "the usual design of " + vehicle, path.parent_path());
}

bool names_vehicle(const std::string& word) {
  if (file_kind(word) == FileKind::vehicle) return true;
  const std::vector<std::string> known = built_in_vehicles();
  std::error_code ignored;
  return std::find(known.begin(), known.end(), word) != known.end() &&
         !std::filesystem::exists(word, ignored);
}

}  // namespace quadtune
