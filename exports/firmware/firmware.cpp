// SPDX-License-Identifier: Apache-2.0
#include "quadtune/exports/firmware.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

#include "quadtune/errors.hpp"
#include "quadtune/internal/enum_names.hpp"
#include "quadtune/internal/joined.hpp"
#include "quadtune/internal/text_file.hpp"

namespace quadtune {
namespace {

constexpr internal::EnumName<FirmwareKind> kKinds[] = {{FirmwareKind::px4, "px4"},
                                                       {FirmwareKind::ardupilot, "ardupilot"},
                                                       {FirmwareKind::betaflight, "betaflight"},
                                                       {FirmwareKind::crazyflie, "crazyflie"}};

struct Versions {
  std::vector<std::string> known;  // newest first
  std::string usual;
};

Versions versions_of(FirmwareKind kind) {
  switch (kind) {
    case FirmwareKind::px4:
      return {{"1.17", "1.16", "1.15", "1.14"}, "1.16"};  // 1.17: only an alpha release was read
    case FirmwareKind::ardupilot:
      return {{"4.7", "4.6", "4.5", "4.4"}, "4.6"};  // 4.7 got its names late in its development
    case FirmwareKind::betaflight:
      return {{"2026.6", "2025.12", "4.5"}, "2026.6"};
    case FirmwareKind::crazyflie:
      return {{"2026.08", "2025.12.1", "2025.12", "2025.09", "2023.11"}, "2026.08"};
  }
  return {};
}

using Number = std::array<int, 3>;

std::optional<Number> number_of(const std::string& version) {
  Number number{};
  const char* at = version.data();
  const char* end = at + version.size();
  for (int& part : number) {
    const auto [rest, error] = std::from_chars(at, end, part);
    if (error != std::errc() || part < 0) return {};
    if (rest == end) return number;
    if (*rest != '.') return {};
    at = rest + 1;
  }
  return {};
}

std::string version_of(FirmwareKind kind, const std::string& asked, const std::string& where) {
  const Versions versions = versions_of(kind);
  if (asked.empty()) return versions.usual;
  const std::optional<Number> number = number_of(asked);
  if (number)
    for (const std::string& known : versions.known)
      if (*number_of(known) <= *number) return known;
  throw InvalidInput(
      where, fmt::format("{} has no version '{}', expected one of {} or a later version{}",
                         to_string(kind), internal::printable(asked),
                         internal::joined(versions.known, ", "),
                         number ? ", because the parameters of older versions are unknown" : ""));
}

}  // namespace

std::string to_string(FirmwareKind kind) { return internal::name_in(kKinds, kind); }

FirmwareKind firmware_kind(const std::string& name, const std::string& where) {
  return internal::require_in(kKinds, name, "firmware", where);
}

std::vector<std::string> firmware_versions(FirmwareKind kind) { return versions_of(kind).known; }

std::vector<std::string> firmware_setups(FirmwareKind kind) {
  if (kind != FirmwareKind::crazyflie) return {};
  return {"standard", "legacy", "thrust-kit", "brushless"};
}

Firmware firmware(FirmwareKind kind, const FirmwareOptions& options, const std::string& where) {
  Firmware result{kind, version_of(kind, options.version, where), options.setup};
  const std::vector<std::string> setups = firmware_setups(kind);
  if (setups.empty() && !options.setup.empty())
    throw InvalidInput(where, fmt::format("set-up '{}' does not apply to {}, but only to a "
                                          "Crazyflie, whose firmware scales thrust by its "
                                          "propellers",
                                          internal::printable(options.setup), to_string(kind)));
  if (setups.empty()) return result;
  if (result.setup.empty()) result.setup = setups.front();
  if (std::find(setups.begin(), setups.end(), result.setup) == setups.end())
    internal::refuse_name(result.setup, "set-up", setups, where);
  return result;
}

Firmware firmware_of_options(FirmwareKind kind, const FirmwareOptions& options) {
  const auto read = [kind](const char* option, const FirmwareOptions& read_options) {
    try {
      return firmware(kind, read_options, option);
    } catch (const InvalidInput& error) {
      throw OptionError(option, error.what());
    }
  };
  FirmwareOptions version = options;
  version.setup.clear();
  (void)read("firmware", version);
  return read("setup", options);  // the version is valid
}

std::string parameter_file_name(FirmwareKind kind) {
  switch (kind) {
    case FirmwareKind::px4:
      return "px4.params";
    case FirmwareKind::ardupilot:
      return "ardupilot.param";
    case FirmwareKind::betaflight:
      return "betaflight.txt";
    case FirmwareKind::crazyflie:
      return "crazyflie.yaml";
  }
  return {};
}

double filter_noise(double density, double step) { return density / std::sqrt(step); }

}  // namespace quadtune
