// SPDX-License-Identifier: Apache-2.0
// Exports of a cascade as parameters of a firmware, together with gains.json, and their checks.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <sstream>

#include "built_in_exporters.hpp"
#include "export_text.hpp"
#include "firmware/firmware_parts.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/exports/export.hpp"
#include "quadtune/exports/firmware.hpp"
#include "quadtune/exports/manifest.hpp"
#include "quadtune/exports/read_gains.hpp"
#include "quadtune/internal/text_file.hpp"
#include "quadtune/version.hpp"

namespace quadtune {
namespace {

namespace fs = std::filesystem;

constexpr char kMark[] = "# quadtune: ";
constexpr char kNote[] = "# Note: ";

void require_cascade(const ExportContent& content, FirmwareKind kind) {
  if (content.cascade && !content.cascade->gains.loops.empty()) return;
  throw InvalidInput(to_string(kind),
                     content.gains
                         ? "the law is a state feedback, expected a PID cascade, because the "
                           "firmware cannot represent a gain matrix"
                         : "there is no law to write, expected a PID cascade");
}

std::string name_of(FirmwareKind kind) {
  switch (kind) {
    case FirmwareKind::px4:
      return "PX4";
    case FirmwareKind::ardupilot:
      return "ArduPilot Copter";
    case FirmwareKind::betaflight:
      return "Betaflight";
    case FirmwareKind::crazyflie:
      return "Crazyflie firmware";
  }
  return {};
}

std::vector<std::string> header_of(const Firmware& firmware, const ExportContent& content,
                                   const std::vector<std::string>& notes) {
  std::vector<std::string> header = {
      fmt::format("quadtune: {} {}{}{}", to_string(firmware.kind), firmware.version,
                  firmware.setup.empty() ? "" : " ", firmware.setup),
      fmt::format("{} {}: PID cascade of {}, written by quadtune {}", name_of(firmware.kind),
                  firmware.version, content.vehicle.name, kVersion),
      "Compare the order, the places and the senses of the rotors with the vehicle before it "
      "flies.",
      "Parameters that are not listed keep what the board has; the design assumes their defaults."};
  for (const std::string& note : notes) header.push_back(std::string(kNote + 2) + note);
  return header;
}

/// The noise parameters; empty if they were not requested.
FirmwareParameters noises_of(const Firmware& target, const ExportContent& content) {
  if (!content.firmware.filter_noise) return {};
  if (!content.estimator || !content.estimator->general)
    throw InvalidInput(
        to_string(target.kind),
        "noise of the estimator was asked for, but the design has no general filter, "
        "expected an estimator for sensors that the flight code can use");
  return noise_parameters(target, *content.estimator->general);
}

std::vector<FileContent> firmware_files(const ExportContent& content, FirmwareKind kind) {
  require_cascade(content, kind);
  const Firmware target = firmware(kind, content.firmware, to_string(kind));
  FirmwareParameters parameters =
      firmware_parameters(target, content.vehicle, content.cascade->gains);
  for (Parameter& noise : noises_of(target, content).values)
    parameters.values.push_back(std::move(noise));
  return {{parameter_file_name(kind),
           parameter_text(target, parameters.values,
                          header_of(target, content, content.firmware_notes))},
          {kGainsJsonName, gains_json_text(content)}};
}

/// The cascade as the board will fly it: with rounded and shared gains.
ExportContent fitted(ExportContent content, FirmwareKind kind) {
  require_cascade(content, kind);
  const Firmware target = firmware(kind, content.firmware, to_string(kind));
  CascadeGains& gains = content.cascade->gains;
  const FirmwareParameters parameters = firmware_parameters(target, content.vehicle, gains);
  gains = cascade_of(firmware_loops(target, content.vehicle, parameters.values), gains, gains.dt);
  // A cascade that was already fitted is not rounded again.
  if (content.firmware_notes.empty()) {
    content.firmware_notes = parameters.notes;
    for (std::string& note : noises_of(target, content).notes)
      content.firmware_notes.push_back(std::move(note));
  }
  content.cascade->specification.reset();
  content.gains.reset();
  content.plant.reset();
  content.Q.resize(0, 0);
  content.R.resize(0, 0);
  content.evidence = {};
  content.filters.clear();
  content.uquad_filter.reset();
  return content;
}

/// The notes in a parameter file describe the rounding of a cascade that is in no file; they are
/// copied unchanged.
std::vector<std::string> notes_of(const std::string& text) {
  std::vector<std::string> notes;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);)
    if (line.starts_with(kNote)) notes.push_back(line.substr(sizeof(kNote) - 1));
  return notes;
}

std::vector<FileContent> written_again(const fs::path& directory, const Manifest& manifest,
                                       const Vehicle& vehicle, FirmwareKind kind) {
  std::vector<FileContent> files =
      exports::json_exporter().written_again(directory, manifest, vehicle);
  if (!manifest.cascade) return files;
  const fs::path path = directory / parameter_file_name(kind);
  const std::string text = exports::export_text(path);
  ExportContent content;
  content.vehicle = vehicle;
  content.cascade = manifest.cascade;
  content.estimator = read_laws(directory).estimator;
  content.firmware = written_options(kind, text, path.string());
  content.firmware_notes = notes_of(text);
  files.push_back(firmware_files(content, kind).front());
  return files;
}

Exporter firmware_exporter(FirmwareKind kind) {
  // The parameters do not describe the vehicle: the laws are read from gains.json.
  Exporter exporter = exports::json_exporter();
  exporter.target = export_target(to_string(kind), "exporter");
  exporter.gain_files = {parameter_file_name(kind)};
  exporter.files = [kind](const ExportContent& content) { return firmware_files(content, kind); };
  exporter.fit = [kind](ExportContent content) { return fitted(std::move(content), kind); };
  exporter.read = [kind, laws = exporter.read](const fs::path& directory,
                                               const Manifest& manifest) {
    StoredLaws stored = laws(directory, manifest);
    const fs::path path = directory / parameter_file_name(kind);
    const std::string text = exports::export_text(path);
    const FirmwareOptions options = written_options(kind, text, path.string());
    const Firmware target = firmware(kind, options, path.string());
    stored.parameters = {target, parse_parameters(target, text, path.string()).values};
    return stored;
  };
  exporter.read_plain = {};
  exporter.weights_difference = {};
  exporter.written_again = [kind](const fs::path& directory, const Manifest& manifest,
                                  const Vehicle& vehicle) {
    return written_again(directory, manifest, vehicle, kind);
  };
  return exporter;
}

VerifyCheck compare(const CascadeGains& read, const CascadeGains& meant, const std::string& file) {
  // A float has a relative precision of 6e-8.
  constexpr double kTolerance = 1e-6;
  for (std::size_t i = 0; i < read.loops.size() && i < meant.loops.size(); ++i) {
    const PidLoop &a = read.loops[i], &b = meant.loops[i];
    const auto differ = [&](double p, double q) {
      return !(std::abs(p - q) <= kTolerance * std::max(std::abs(p), std::abs(q)));
    };
    if (differ(a.Kp, b.Kp) || differ(a.Ki, b.Ki) || differ(a.Kd, b.Kd))
      return {"parameters fly the manifest's cascade", false,
              fmt::format("{}: {} gives Kp {:.6g}, Ki {:.6g}, Kd {:.6g}, the manifest has {:.6g}, "
                          "{:.6g}, {:.6g}",
                          file, a.name, a.Kp, a.Ki, a.Kd, b.Kp, b.Ki, b.Kd)};
    if (differ(a.rate_lead, b.rate_lead))
      return {"parameters fly the manifest's cascade", false,
              fmt::format("{}: {} gives the rate a lead of {:.6g} s, the manifest has {:.6g} s",
                          file, a.name, a.rate_lead, b.rate_lead)};
  }
  return {"parameters fly the manifest's cascade", true,
          fmt::format("{}: Kp, Ki and Kd of every loop that the firmware has, to {:g}", file,
                      kTolerance)};
}

}  // namespace

std::optional<Firmware> firmware_of_text(FirmwareKind kind, const std::string& text,
                                         const std::string& origin) {
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) {
    if (kind == FirmwareKind::betaflight && line.starts_with("# Betaflight /")) {
      // "# Betaflight / STM32F405 (S405) 4.5.1 …"
      std::istringstream board(
          line.substr(line.find(')') == std::string::npos ? line.size() : line.find(')') + 1));
      FirmwareOptions options;
      if (board >> options.version) return firmware(kind, options, origin);
    }
    if (!line.starts_with(kMark)) continue;
    std::istringstream words(line.substr(sizeof(kMark) - 1));
    std::string name;
    FirmwareOptions options;
    words >> name >> options.version >> options.setup;
    if (name != to_string(kind))
      throw InvalidInput(origin, fmt::format("was written for '{}', expected parameters of {}",
                                             internal::printable(name), to_string(kind)));
    return firmware(kind, options, origin);
  }
  return {};
}

FirmwareOptions written_options(FirmwareKind kind, const std::string& text,
                                const std::string& origin) {
  const std::optional<Firmware> target = firmware_of_text(kind, text, origin);
  if (!target) throw InvalidInput(origin, "does not name its firmware");
  const std::vector<Parameter> values = parse_parameters(*target, text, origin).values;
  return {target->version, target->setup,
          std::any_of(values.begin(), values.end(),
                      [](const Parameter& one) { return is_noise_parameter(one.name); })};
}

std::vector<VerifyCheck> firmware_checks(const fs::path& directory, const Vehicle& vehicle) {
  constexpr char kName[] = "parameters fly the manifest's cascade";
  try {
    const Manifest manifest = read_manifest(directory);
    const FirmwareKind kind = firmware_kind(to_string(manifest.kind), kManifestName);
    const fs::path path = directory / parameter_file_name(kind);
    const std::string text = exports::export_text(path);
    const std::optional<Firmware> target = firmware_of_text(kind, text, path.string());
    if (!target)
      return {{kName, false, fmt::format("{} does not name its firmware", path.string())}};
    if (!manifest.cascade) return {{kName, false, "the manifest has no cascade"}};
    const ParameterFile file = parse_parameters(*target, text, path.string());
    const CascadeGains read = cascade_of(firmware_loops(*target, vehicle, file.values),
                                         manifest.cascade->gains, manifest.cascade->gains.dt);
    return {compare(read, manifest.cascade->gains, parameter_file_name(kind))};
  } catch (const InvalidInput& error) {
    return {{kName, false, error.what()}};
  } catch (const FileError& error) {
    return {{kName, false, error.what()}};
  } catch (const NoSolution& error) {
    return {{kName, false, error.what()}};
  }
}

namespace exports {

std::vector<Exporter> firmware_exporters() {
  return {firmware_exporter(FirmwareKind::px4), firmware_exporter(FirmwareKind::ardupilot),
          firmware_exporter(FirmwareKind::betaflight), firmware_exporter(FirmwareKind::crazyflie)};
}

}  // namespace exports
}  // namespace quadtune
