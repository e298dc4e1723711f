// SPDX-License-Identifier: Apache-2.0
/// quadtune import: the parameters of a firmware, as gains of a vehicle.
#include <fmt/format.h>

#include <optional>

#include "program/command_line.hpp"
#include "program/program.hpp"
#include "program/refusal.hpp"
#include "quadtune/exports/firmware.hpp"
#include "quadtune/internal/json.hpp"
#include "quadtune/internal/text_file.hpp"
#include "quadtune/loop_limits.hpp"
#include "quadtune/workbench/firmware/firmware_import.hpp"
#include "report/loops/loops.hpp"

namespace quadtune::cli {
namespace {

/// Maximum size of a parameter file [bytes]. A dump of all parameters has some ten thousand lines.
constexpr std::size_t kLargestFile = std::size_t{16} << 20;

struct Options {
  std::string firmware, file, vehicle;
  FirmwareOptions version;
  std::optional<double> dt;
  bool defaults = false;
};

void require_complete(const Options& options) {
  if (options.defaults && !options.file.empty())
    refuse("--defaults", "both --defaults and the file {} were given, expected only one of the two",
           options.file);
  if (options.firmware.empty())
    refuse("FIRMWARE", "FIRMWARE is missing, expected the name of a firmware");
  if (options.vehicle.empty()) refuse("--vehicle", "--vehicle is missing, expected the vehicle");
  if (options.file.empty() && !options.defaults)
    refuse("FILE", "FILE is missing, expected a file of parameters, or --defaults");
}

/// The firmware that the file names. The options may repeat it but must not contradict it.
Firmware agreed(const Firmware& asked, const Firmware& written, const Options& options) {
  if ((!options.version.version.empty() && asked.version != written.version) ||
      (!options.version.setup.empty() && asked.setup != written.setup))
    refuse(options.version.version.empty() ? "--setup" : "--firmware",
           "the file was written for version {}{}{}; expected the same version and set-up, or "
           "neither option",
           written.version, written.setup.empty() ? "" : " with set-up ", written.setup);
  return written;
}

void run_import(const Options& options, Context& context) {
  require_complete(options);
  const FirmwareKind kind = firmware_kind(options.firmware, "FIRMWARE");
  Firmware target = firmware_of_options(kind, options.version);
  std::optional<ParameterFile> file;
  if (!options.defaults) {
    const std::string text = internal::read_text_file(options.file, kLargestFile);
    const std::optional<Firmware> written = firmware_of_text(kind, text, options.file);
    if (written) target = agreed(target, *written, options);
    if (!written && options.version.version.empty())
      context.note(
          fmt::format("note: the file does not state its version; {} is assumed", target.version));
    file = parse_parameters(target, text, options.file);
  }
  if (options.dt && !(*options.dt >= kMinControlPeriod && *options.dt <= kMaxControlPeriod))
    refuse("--dt", "--dt is {} s, expected {} to {} s", *options.dt, kMinControlPeriod,
           kMaxControlPeriod);
  const Vehicle vehicle = load_vehicle(options.vehicle);
  const FirmwareImport import =
      import_parameters(target, vehicle, file, options.dt.value_or(kFirmwarePeriod));
  context.notes("note: ", import.notes);
  context.print([&] { return report::to_json(import); }, [&] { return report::to_text(import); });
}

void add_options(CommandLine& line, Options& options) {
  line.add_option("FIRMWARE", options.firmware, "px4, ardupilot, betaflight or crazyflie");
  line.add_option("FILE", options.file,
                  "parameter file of the firmware, a complete dump or a few lines");
  line.add_option("--vehicle V", options.vehicle, "a built-in vehicle's name or a vehicle file");
  line.add_flag("--defaults", options.defaults,
                "use the defaults of the firmware instead of a file");
  line.add_option("--firmware VERSION", options.version.version,
                  "version, e.g. 1.15 of px4; default: that of a file that quadtune wrote, or px4 "
                  "1.16, ardupilot 4.6, betaflight 2026.6, crazyflie 2026.08");
  line.add_option("--setup NAME", options.version.setup,
                  "propellers of a Crazyflie: standard (default), legacy, thrust-kit or brushless");
  line.add_positive("--dt T", options.dt, "control period of the cascade [s]; default 0.004");
}

}  // namespace

Verb import_verb() {
  return {"import", "FIRMWARE FILE|--defaults --vehicle V [-o FILE]",
          "read a firmware's parameters: margins, and gains that `fly` accepts",
          "quadtune import px4 --defaults --vehicle vehicles/quad-450.toml",
          with_options(add_options, run_import)};
}

}  // namespace quadtune::cli
