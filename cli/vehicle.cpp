// SPDX-License-Identifier: Apache-2.0
/// quadtune vehicle: lists and shows vehicles, checks a vehicle file, writes a new one.
#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <tuple>
#include <vector>

#include "program/command_line.hpp"
#include "program/program.hpp"
#include "program/refusal.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/internal/counted.hpp"
#include "quadtune/internal/json.hpp"
#include "quadtune/internal/suggest.hpp"
#include "quadtune/internal/text_file.hpp"
#include "quadtune/internal/words.hpp"
#include "quadtune/workbench/vehicle/new_vehicle.hpp"
#include "quadtune/workbench/vehicle/quantity.hpp"
#include "quadtune/workbench/vehicle/vehicle_check.hpp"
#include "report/vehicles/new_vehicle_report.hpp"
#include "report/vehicles/vehicle_report.hpp"

namespace quadtune::cli {
namespace {

/// The options of `vehicle new` in the words of the command line.
struct MeasuredWords {
  std::optional<std::string> mass, arm, propeller, max_thrust, max_speed, hover_speed, lag, inertia;
  std::optional<double> thrust_to_weight;
  std::uint64_t rotors = 4, blades = 2;
  std::string layout = "x", spin = "cw", sensors = "gps";
  bool brushed = false, ask = false, force = false;
};

struct Options {
  std::string action, vehicle;
  MeasuredWords measured;
};

/// Whether a vehicle file can have the name.
bool is_name(const std::string& word) {
  return !word.empty() && word.size() <= 64 && std::all_of(word.begin(), word.end(), [](char c) {
    return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '.' || c == '_' || c == '-';
  });
}

void require_action(const Options& options) {
  const std::string& action = options.action;
  if (action != "list" && action != "show" && action != "check" && action != "new")
    refuse(
        "ACTION", "{}; expected list, show V, check FILE or new NAME{}",
        action.empty() ? "no action is given" : "'" + internal::printable(action) + "' is unknown",
        internal::did_you_mean(action, {"list", "show", "check", "new"}));
  if (action == "list" && !options.vehicle.empty())
    refuse(options.vehicle, "unexpected argument '{}' after list", options.vehicle);
  if (action == "new" && !is_name(options.vehicle))
    refuse("V", "new needs a name for the vehicle: up to 64 letters, digits, '.', '_' and '-'{}",
           options.vehicle.empty()
               ? ""
               : "; '" + internal::printable(options.vehicle) + "' has other characters");
  const std::vector<std::string> built_in = built_in_vehicles();
  if (action == "new" &&
      std::find(built_in.begin(), built_in.end(), options.vehicle) != built_in.end())
    refuse("V",
           "'{}' is the name of a built-in vehicle; choose another, because exports identify the "
           "vehicle by its name",
           options.vehicle);
  if (action != "list" && options.vehicle.empty())
    refuse("V", "{} needs a built-in vehicle's name or a file", action);
}

/// A question of --ask, which is repeated until the answer is valid. An empty answer leaves the
/// option as it is.
void ask(Context& context, std::optional<std::string>& answer, QuantityUnit unit, const char* key,
         const std::string& question) {
  while (!answer) {
    context.err << question << ": " << std::flush;
    std::string line;
    if (!std::getline(context.in, line)) return;
    while (!line.empty() && (line.back() == ' ' || line.back() == '\r')) line.pop_back();
    if (line.empty()) return;
    try {
      (void)read_quantity(line, unit, key);
      answer = line;
    } catch (const OptionError& error) {
      context.err << error.what() << "\n";
    }
  }
}

void ask_all(MeasuredWords& words, Context& context) {
  context.err << "Give each number with its unit. Press Enter to leave an optional number to an "
                 "estimate.\n";
  ask(context, words.mass, QuantityUnit::mass, "mass", "Mass, ready to fly (e.g. 1240g)");
  ask(context, words.arm, QuantityUnit::length, "arm",
      "Distance from the centre to the axis of a rotor (e.g. 225mm)");
  ask(context, words.propeller, QuantityUnit::length, "propeller",
      "Diameter of a propeller (e.g. 9.4in)");
  ask(context, words.hover_speed, QuantityUnit::rotor_speed, "hover-speed",
      "Optional: rotor speed in hover (e.g. 5200rpm)");
  ask(context, words.max_thrust, QuantityUnit::force, "max-thrust",
      "Optional: largest thrust of one rotor (e.g. 760gf)");
}

std::optional<double> quantity(const std::optional<std::string>& word, QuantityUnit unit,
                               const char* key) {
  if (!word) return {};
  return read_quantity(*word, unit, key);
}

/// "0.011kgm2,0.011kgm2,0.02kgm2": about body x, y and z.
std::optional<Eigen::Vector3d> inertia_of(const std::optional<std::string>& word) {
  if (!word) return {};
  const std::vector<std::string> parts = internal::comma_separated(*word);
  if (parts.size() != 3)
    throw OptionError("inertia", fmt::format("inertia has {}, expected 3: about body x, y "
                                             "and z, each with a unit such as kgm2 or gcm2",
                                             internal::counted(parts.size(), "entry", "entries")));
  Eigen::Vector3d inertia;
  for (int i = 0; i < 3; ++i)
    inertia(i) =
        read_quantity(parts[static_cast<std::size_t>(i)], QuantityUnit::inertia, "inertia");
  return inertia;
}

/// One of two words.
bool is_first(const std::string& word, const char* first, const char* second, const char* key) {
  if (word != first && word != second)
    throw OptionError(key, fmt::format("{} is '{}', expected {} or {}", key,
                                       internal::printable(word), first, second));
  return word == first;
}

int small_count(std::uint64_t count) { return count > 1000 ? 1000 : static_cast<int>(count); }

MeasuredVehicle measured_vehicle(const Options& options) {
  const MeasuredWords& words = options.measured;
  MeasuredVehicle measured;
  measured.name = options.vehicle;
  measured.mass = *quantity(words.mass, QuantityUnit::mass, "mass");
  measured.arm = *quantity(words.arm, QuantityUnit::length, "arm");
  measured.propeller = *quantity(words.propeller, QuantityUnit::length, "propeller");
  measured.rotors = small_count(words.rotors);
  measured.blades = small_count(words.blades);
  measured.layout =
      is_first(words.layout, "x", "plus", "layout") ? FrameLayout::x : FrameLayout::plus;
  measured.first_spin =
      is_first(words.spin, "cw", "ccw", "spin") ? Spin::clockwise : Spin::counter_clockwise;
  measured.sensors =
      is_first(words.sensors, "gps", "flow", "sensors") ? SensorSet::gps : SensorSet::flow;
  measured.brushed = words.brushed;
  measured.max_thrust = quantity(words.max_thrust, QuantityUnit::force, "max-thrust");
  measured.thrust_to_weight = words.thrust_to_weight;
  measured.max_speed = quantity(words.max_speed, QuantityUnit::rotor_speed, "max-speed");
  measured.hover_speed = quantity(words.hover_speed, QuantityUnit::rotor_speed, "hover-speed");
  measured.motor_lag = quantity(words.lag, QuantityUnit::duration, "lag");
  measured.inertia = inertia_of(words.inertia);
  return measured;
}

void make_vehicle(Options& options, Context& context) {
  MeasuredWords& words = options.measured;
  if (words.ask) ask_all(words, context);
  for (const auto& [word, option, example] :
       {std::tuple{&words.mass, "--mass", "1240g"}, std::tuple{&words.arm, "--arm", "225mm"},
        std::tuple{&words.propeller, "--propeller", "9.4in"}})
    if (!*word && words.ask)
      refuse(option, "the answer for {} was empty, expected a number with its unit, such as {}",
             option, example);
    else if (!*word)
      refuse(option, "new needs {}, such as {} {}; --ask asks for each number in turn", option,
             option, example);
  const NewVehicle made = new_vehicle(measured_vehicle(options));
  context.notes("note: ", estimate_notes(made));
  for (const Implausibility& figure : find_implausible_values(made.vehicle))
    context.note("warning: " + to_string(figure));
  context.print([&] { return new_vehicle_json(made); }, [&] { return made.text; });
}

/// A vehicle file is edited by hand after it was written, so it is not replaced.
void require_new_file(const CommandLine& line) {
  const Option* const output = line.find("-o");
  if (output == nullptr || !output->was_given()) return;
  const std::string& file = output->values().back();
  std::error_code ignored;
  if (std::filesystem::is_regular_file(file, ignored))
    throw FileError(
        file,
        "exists, and may have been edited; expected the name of a new file, or --force to "
        "replace it");
}

void run_vehicle(const CommandLine& line, Options& options, Context& context) {
  require_action(options);
  if (options.action == "new") {
    if (!options.measured.force) require_new_file(line);
    return make_vehicle(options, context);
  }
  line.refuse_given({"--mass", "--arm", "--propeller", "--rotors", "--layout", "--spin", "--blades",
                     "--max-thrust", "--thrust-to-weight", "--max-speed", "--hover-speed", "--lag",
                     "--inertia", "--sensors", "--brushed", "--ask", "--force"},
                    "belongs to vehicle new");
  if (options.action == "list") {
    const std::vector<std::string> names = built_in_vehicles();
    context.print(
        [&] {
          return internal::Json{{"vehicles", names}};
        },
        [&] { return vehicle_list(names); });
  } else if (options.action == "show") {
    const Vehicle vehicle = load_vehicle(options.vehicle);
    context.print([&] { return to_json(vehicle); }, [&] { return to_text(vehicle); });
  } else {
    const VehicleCheck check = check_vehicle(options.vehicle);
    context.print([&] { return to_json(check.vehicle); },
                  [&] { return to_text(check, options.vehicle); });
  }
}

void add_options(CommandLine& line, Options& options) {
  MeasuredWords& words = options.measured;
  line.add_option("ACTION", options.action, "list, show, check or new");
  line.add_option("V", options.vehicle,
                  "a built-in vehicle's name or a vehicle file; with new: a name");
  line.add_option("--mass M", words.mass, "with new: mass ready to fly, with its unit (1240g)");
  line.add_option("--arm L", words.arm, "with new: from the centre to a rotor's axis (225mm)");
  line.add_option("--propeller D", words.propeller, "with new: diameter of a propeller (9.4in)");
  line.add_count("--rotors N", words.rotors, 1, "with new: 4 (default), 6 or 8, evenly spaced");
  line.add_option("--layout NAME", words.layout,
                  "with new: x (default, two rotors in front) or plus (one in front)");
  line.add_option("--spin NAME", words.spin,
                  "with new: cw (default) or ccw, of the front left rotor of x, the front one of "
                  "plus; the others alternate");
  line.add_count("--blades N", words.blades, 1,
                 "with new: number of blades of a propeller (default 2)");
  line.add_option("--max-thrust F", words.max_thrust,
                  "with new: thrust of one rotor at full command (760gf)");
  line.add_positive(
      "--thrust-to-weight N", words.thrust_to_weight,
      "with new: thrust of all rotors at full command over the weight, instead of --max-thrust");
  line.add_option("--max-speed W", words.max_speed,
                  "with new: rotor speed at full command (9800rpm)");
  line.add_option("--hover-speed W", words.hover_speed,
                  "with new: mean rotor speed in hover (5200rpm)");
  line.add_option("--lag T", words.lag, "with new: time constant of the motors (40ms)");
  line.add_option("--inertia LIST", words.inertia,
                  "with new: about body x, y and z (0.011kgm2,0.011kgm2,0.02kgm2)");
  line.add_option("--sensors NAME", words.sensors,
                  "with new: typical sensors to list: gps (default) or flow");
  line.add_flag("--brushed", words.brushed, "with new: brushed motors, as in toys");
  line.add_flag("--ask", words.ask,
                "with new: ask for mass, arm, propeller, hover speed and thrust");
  line.add_flag("--force", words.force, "with new: replace an existing file");
}

}  // namespace

Verb vehicle_verb() {
  return {"vehicle", "list | show V | check FILE | new NAME --mass M --arm L --propeller D",
          "list, show or check vehicles, or write a file for a new one",
          "quadtune vehicle show mambo", with_options(add_options, run_vehicle)};
}

}  // namespace quadtune::cli
