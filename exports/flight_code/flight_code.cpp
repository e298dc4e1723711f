// SPDX-License-Identifier: Apache-2.0
#include "quadtune/exports/flight_code.hpp"

#include <fmt/format.h>

#include <cctype>

#include "export_text.hpp"
#include "flight_code/adapters.hpp"
#include "flight_code/flight_recording.hpp"
#include "flight_code/kalman_module.hpp"
#include "flight_code/parameters.hpp"
#include "flight_code/program_settings.hpp"
#include "flight_code/schedule_program.hpp"
#include "flight_code/source_text.hpp"
#include "json/to_json.hpp"
#include "quadtune/design/flight_code_words.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/exports/export.hpp"
#include "quadtune/internal/joined.hpp"
#include "quadtune/internal/json.hpp"

namespace quadtune {
namespace exports {
namespace {

constexpr char kFlightCodeFormat[] = "quadtune-flight-code";
constexpr int kFlightCodeVersion = 1;

std::string name_of(const ExportContent& content) {
  const std::string& asked = content.flight_code.name;
  std::string name = asked.empty() ? flight_code_name(content.vehicle.name) : asked;
  require_flight_code_name(
      name, asked.empty() ? "flight code is named after the vehicle unless --name is given"
                          : "flight code");
  return name;
}

std::string sensors_in_words(const ProgramSettings& program) {
  if (program.mambo) return "specific_force, rates, range, flow, vision";
  if (program.uquad)
    return std::string("specific_force, rates, magnetic_field, pressure") +
           (program.uquad->filter.position ? ", gps_position, gps_velocity, vision" : "");
  const GeneralFilterSettings& s = *program.general;
  std::vector<std::string> words = {"specific_force", "rates"};
  const auto add = [&](bool present, const char* word) {
    if (present) words.emplace_back(word);
  };
  add(s.heading.has_value(), "magnetic_field");
  add(s.pressure.has_value(), "pressure");
  add(s.range.has_value(), "range");
  add(s.flow.has_value(), "flow");
  add(s.gps_position.has_value(), "gps_position");
  add(s.gps_velocity.has_value(), "gps_velocity");
  add(s.vision.has_value(), "vision");
  return internal::joined(words, ", ");
}

std::string estimator_in_words(const ProgramSettings& s) {
  if (!s.has_estimator()) return "none; the caller provides the estimate";
  const std::string sensors = sensors_in_words(s);
  if (s.general) return "the general filter, an error-state Kalman filter of " + sensors;
  const auto calibrated = [](double time) {
    return fmt::format("; the vehicle must be stationary for {} s after the start", time);
  };
  if (s.mambo) return "that of the Mambo, from " + sensors + calibrated(s.mambo->calibration_time);
  return "the filter of the uquad, an extended Kalman filter of " + sensors +
         " and the rotors' speeds, by the vehicle's own equations of motion" +
         calibrated(s.uquad->filter.calibration_time);
}

std::string command_in_words(const ProgramSettings& s) {
  const MotorCommand& motor = s.motor;
  std::vector<std::string> negative;
  for (int i = 0; i < s.allocation.rotors; ++i)
    if (s.direction[static_cast<std::size_t>(i)] < 0) negative.push_back(fmt::format("{}", i + 1));
  const std::string signs = negative.empty() ? ""
                                             : fmt::format("; negative for motors {}",
                                                           internal::joined(negative, " and "));
  const bool squared = motor.law == CommandLaw::speed_squared;
  const std::string step =
      motor.quantum > 0 ? fmt::format(", steps of {}", motor.quantum) : std::string();
  return fmt::format(
      "{} {}, {} to {}{}{}", squared ? "proportional to the square of the speed" : "the speed",
      motor.unit == "count" ? "in counts" : "in rad/s", motor.min, motor.max, step, signs);
}

std::string input_in_words(InputKind kind) {
  switch (kind) {
    case InputKind::wrench:
      return "thrust along body -z [N], torques about body x, y, z [N m]";
    case InputKind::rotor_speed:
      return "speeds of the rotors [rad/s]";
    case InputKind::rotor_thrust:
      return "thrusts of the rotors [N]";
    case InputKind::command:
      break;
  }
  return "commands of the motors, without their signs";
}

const char* input_feature(InputKind kind) {
  switch (kind) {
    case InputKind::wrench:
      return "WRENCH_INPUTS";
    case InputKind::rotor_speed:
      return "SPEED_INPUTS";
    case InputKind::rotor_thrust:
      return "THRUST_INPUTS";
    case InputKind::command:
      break;
  }
  return "COMMAND_INPUTS";
}

SourceChoices choices_of(const ProgramSettings& s, const ExportContent& content,
                         const std::string& name) {
  SourceChoices c;
  c.name = name;
  c.double_precision = content.flight_code.double_precision;
  const auto feature = [&](bool has, const char* word) {
    if (has) c.features.insert(word);
  };
  feature(c.double_precision, "DOUBLE");
  feature(s.has_estimator(), "ESTIMATOR");
  feature(s.general.has_value(), "GENERAL");
  feature(s.mambo.has_value(), "MAMBO");
  feature(s.uquad.has_value(), "UQUAD");
  feature(s.general || s.uquad, "LOGARITHM");
  if (s.mambo && s.mambo->aligned_periods > 0) {
    feature(true, "ALIGNED_FLOW");
    c.sizes["MOMENTS"] = s.mambo->aligned_periods;
  }
  feature(s.cascade(), "CASCADE");
  feature(s.rate_lead(), "RATE_LEAD");
  feature(s.motor.law == CommandLaw::speed_squared, "SQUARED_COMMANDS");
  feature(s.motor.quantum > 0, "QUANTUM");
  c.sizes["ROTORS"] = s.allocation.rotors;
  const bool squared = s.motor.law == CommandLaw::speed_squared;
  c.words["DESCRIPTION"] = fmt::format("{}{} for the vehicle '{}'",
                                       s.cascade() ? "a cascade of PID loops" : "a state feedback",
                                       s.general ? " with the general filter"
                                       : s.mambo ? " with the estimator of the Mambo"
                                       : s.uquad ? " with the filter of the uquad"
                                                 : "",
                                       in_comment(content.vehicle.name));
  c.words["DT"] = fmt::format("{}", s.dt);
  c.period = c_number(s.dt, c.double_precision, "dt");
  c.words["COMMAND"] = command_in_words(s);
  c.words["GAIN"] = squared ? "square of the speed over the command [rad^2/s^2]"
                            : "speed over the command [rad/s]";
  c.words["TAKE_OFF"] = s.cascade() ? "constant thrust, attitude and heading held"
                                    : "as in flight: the law is the same";
  if (s.has_estimator()) c.words["SENSORS"] = sensors_in_words(s);
  if (s.cascade()) return c;
  const StateFeedbackSettings<double>& law = s.feedback();
  feature(true, input_feature(law.input_kind));
  feature(law.input_kind != InputKind::wrench, "ROTOR_INPUTS");
  feature(law.integrals > 0, "INTEGRALS");
  feature(law.remembers, "MEMORY");
  feature(law.past > 0, "PAST");
  feature(law.integrals == 0 && !law.remembers, "STATELESS_LAW");
  c.sizes["INPUTS"] = law.inputs;
  c.sizes["INTEGRALS"] = law.integrals;
  c.sizes["PAST"] = law.past;
  c.words["INPUT"] = input_in_words(law.input_kind);
  c.words["INPUT_UNIT"] = "inputs at hover: " + input_in_words(law.input_kind);
  return c;
}

struct ProgramFile {
  std::string from;    ///< in source/
  std::string suffix;  ///< of the exported file, after the name
};

std::vector<ProgramFile> sources_of(const ProgramSettings& s, bool double_precision) {
  std::vector<ProgramFile> files = {
      {"program.h", ".h"},
      {"state.h", "_state.h"},
      {"internal.h", "_internal.h"},
      {"arithmetic.h", "_arithmetic.h"},
      {"maths.h", "_maths.h"},
      {"program.c", ".c"},
      {"motors.c", "_motors.c"},
      {s.cascade() ? "cascade.c" : "feedback.c", "_law.c"},
      {"rotations.c", "_rotations.c"},
      {double_precision ? "functions_double.c" : "functions_float.c", "_functions.c"}};
  if (s.general) files.push_back({"estimator.c", "_estimator.c"});
  if (s.mambo) files.push_back({"mambo_estimator.c", "_estimator.c"});
  if (s.uquad) files.push_back({"uquad_estimator.c", "_estimator.c"});
  return files;
}

std::string recorded_header(const ProgramSettings& s) {
  return fmt::format(
      "# A recorded flight: one line a control period of {} s. Numbers of a line:\n"
      "# {}\n"
      "# phase (0 idle, 1 take-off, 2 flying), whether position is tracked, position, velocity, "
      "roll,\n"
      "# pitch and yaw of the reference, {} idle commands;\n"
      "# then what the program gives: {} commands, position, roll, pitch, yaw, body velocity, "
      "rates,\n"
      "# whether the wrench was limited, whether the estimate is finite.\n"
      "# start: position, body velocity, rates, roll, pitch, yaw, biases of gyroscope and\n"
      "# accelerometer, offset of the barometer's height.\n",
      s.dt,
      s.has_estimator()
          ? "whether it stands; 0, or 1, age and values of: specific force, rates, magnetic "
            "field,\n# pressure, range, flow, GPS position, GPS velocity, vision;"
          : "position, roll, pitch, yaw, body velocity, rates of the estimate;",
      s.allocation.rotors, s.allocation.rotors);
}

FileContent options_file(const ExportContent& content, const std::string& name) {
  internal::Json json;
  json["format"] = kFlightCodeFormat;
  json["format_version"] = kFlightCodeVersion;
  json["name"] = name;
  json["precision"] = content.flight_code.double_precision ? "double" : "float";
  json["law"] = content.flight_code.law;
  if (!content.flight_code.adapter.empty()) json["adapter"] = content.flight_code.adapter;
  return {kFlightCodeName, internal::readable(json) + "\n"};
}

std::string readme(const ProgramSettings& s, const ExportContent& content, const std::string& name,
                   const std::vector<std::string>& sources);

}  // namespace
}  // namespace exports

std::string flight_code_name(const std::string& name) {
  std::string result;
  for (const char c : name) {
    const auto u = static_cast<unsigned char>(c);
    result += std::isalnum(u) != 0 && u < 128 ? static_cast<char>(std::tolower(u)) : '_';
  }
  if (result.empty() || std::isalpha(static_cast<unsigned char>(result[0])) == 0)
    result = "vehicle_" + result;
  if (result.size() > kMaxFlightCodeName) result.resize(kMaxFlightCodeName);
  return result;
}

std::vector<FileContent> flight_code_files(const ExportContent& content) {
  using namespace exports;
  if (content.schedule) {
    std::vector<FileContent> files = schedule_program_files(content);
    files.push_back(options_file(content, schedule_program_name(content)));
    return files;
  }
  const std::string& adapter = content.flight_code.adapter;
  const std::string name = name_of(content);
  const FlightSetup setup = recorded_setup(content);
  const ProgramSettings settings = program_settings(setup);
  require_adapter(content, settings.dt);
  const bool double_precision = content.flight_code.double_precision;
  SourceChoices choices = choices_of(settings, content, name);
  choose_kalman(content.filters, choices);
  std::vector<FileContent> files;
  std::vector<std::string> sources, headers, objects;
  const auto add = [&](const std::string& file, const std::string& text) {
    files.push_back({file, program_source(text, choices)});
  };
  const auto add_to_program = [&](const std::string& file, const std::string& text) {
    if (file.ends_with(".c")) {
      sources.push_back(file);
      objects.push_back(file.substr(0, file.size() - 2) + ".o");
    }
    if (file.ends_with(".h")) headers.push_back(file);
    add(file, text);
  };
  for (const ProgramFile& file : sources_of(settings, double_precision))
    add_to_program(name + file.suffix, source_text(file.from));
  if (!content.filters.empty())
    for (const char* kind : {".h", ".c"})
      add_to_program(name + "_kalman" + kind, source_text(std::string("kalman") + kind));
  add_to_program(name + "_parameters.c",
                 parameters_text(settings, content.filters, double_precision));
  choices.words["OBJECTS"] = internal::joined(objects, " ");
  choices.words["HEADERS"] = internal::joined(headers, " ");
  choices.words["RECORDING"] = kRecordedFlight;
  for (const char* file : {"replay.c", "replay_lines.h"}) add(file, source_text(file));
  add("Makefile", source_text("Makefile"));
  choices.words["STEPS"] = fmt::format("{:.0f}", settings.dt * 1000);
  choices.words["PX4_SOURCES"] = internal::joined(sources, "\n\t\t");
  for (const AdapterFile& file : adapter_files(adapter))
    add(file.to, adapter_text(file.from, content, name, settings.dt));
  const RecordedFlight recorded = record_flight(
      setup, settings, template_program(settings, double_precision), double_precision);
  files.push_back({kRecordedFlight, recorded_header(settings) + recorded.text});
  if (!content.filters.empty())
    files.push_back({"filters.txt", kalman_recording(content.filters, double_precision)});
  files.push_back({"README.md", readme(settings, content, name, sources)});
  files.push_back(options_file(content, name));
  files.push_back({kGainsJsonName, gains_json_text(content)});
  return files;
}

bool holds_schedule(const std::filesystem::path& directory) {
  const auto has = [&](const char* name) {
    std::error_code unknown;
    return std::filesystem::exists(directory / name, unknown);
  };
  return has(kScheduleJsonName) && has(kFlightCodeName) && !has(kGainsJsonName);
}

FlightCodeOptions read_flight_code_options(const std::filesystem::path& directory) {
  using internal::Json;
  const std::filesystem::path path = directory / kFlightCodeName;
  const std::string origin = path.string();
  const Json json = exports::parse_json(exports::export_text(path), origin,
                                        exports::kFlightCodeFormat, exports::kFlightCodeVersion);
  const auto word = [&](const char* key) {
    return internal::string_from_json(internal::member(json, key, origin), origin + ": " + key);
  };
  FlightCodeOptions options = {
      word("name"), is_double_precision(word("precision"), origin + ": precision"), word("law")};
  if (json.contains("adapter")) {
    options.adapter = word("adapter");
    require_flight_code_adapter(options.adapter, origin + ": adapter");
  }
  return options;
}

namespace exports {
namespace {

std::string page_of_adapter(const ExportContent& content, const std::vector<std::string>& sources) {
  std::vector<std::string> objects;
  objects.reserve(sources.size());
  for (const std::string& source : sources)
    objects.push_back(source.substr(0, source.size() - 2) + ".o");
  const std::string page = replaced(adapter_page(content.flight_code.adapter), "@SOURCES@",
                                    internal::joined(sources, " "));
  return replaced(replaced(page, "@OBJECTS_ON_BOARD@", internal::joined(objects, " ")), "@NAME@",
                  name_of(content));
}

std::string readme(const ProgramSettings& s, const ExportContent& content, const std::string& name,
                   const std::vector<std::string>& sources) {
  const std::string law =
      s.cascade() ? "a cascade of PID loops: position to attitude, attitude to torques, height to "
                    "thrust"
                  : fmt::format("a state feedback u = u0 + K (sp - x){}{}{}, u: {}",
                                s.feedback().integrals > 0 ? " + K_int x_int" : "",
                                s.feedback().remembers ? " - K_lag (a - u0)" : "",
                                s.feedback().past > 0 ? " - K_past (past commands - u0)" : "",
                                input_in_words(s.feedback().input_kind));
  return fmt::format(
      "# Flight program {0} for the vehicle '{1}'\n\n"
      "C99, `{2}`, one call in each control period of {3} s; no heap, no input or output, no "
      "recursion.\n\n"
      "- Estimator: {4}.\n"
      "- Law: {5}.\n"
      "- Allocation: the nearest wrench that the rotors can produce; yaw torque is reduced "
      "first, then thrust,\n  roll and pitch torque last.\n"
      "- Commands: {6}.\n{10}\n"
      "[{0}.h]({0}.h) has the entry points, with units and axes:\n\n"
      "```c\n"
      "static {0}_state_t state;\n"
      "{0}_initialize(&state, &start);\n"
      "for (;;) {{                      /* every {3} s */\n"
      "  {7}\n"
      "  send(output.command);\n"
      "}}\n"
      "```\n\n"
      "`make test` needs only a C compiler. It replays [flight.txt](flight.txt), a simulated "
      "flight, and compares\nevery command and every estimate bit by bit with what quadtune's own "
      "law and filter compute. For a board compile\n\n"
      "    {8}\n\n"
      "with `-std=c99 -ffp-contract=off`. If the compiler contracts products and sums, results "
      "differ in the last bits.\n`-ffast-math` is not allowed; with it, the program does not "
      "compile.\n\n"
      "`make misra` checks with cppcheck for violations of MISRA C:2012. The Makefile lists the "
      "deviations.\n\n{9}"
      "The program does not arm, monitor the battery or abort a flight: a supervisor must stop the "
      "motors if the vehicle\ntilts too far, or if `estimate.finite` is false.\n",
      name, in_comment(content.vehicle.name),
      content.flight_code.double_precision ? "double" : "float", s.dt, estimator_in_words(s), law,
      command_in_words(s),
      s.has_estimator() ? name + "_step(&state, &sensors, &reference, &output);"
                        : name + "_control(&state, &estimate, &reference, &output);",
      internal::joined(sources, " "), page_of_adapter(content, sources),
      content.filters.empty()
          ? ""
          : fmt::format("- Steady Kalman filters of the design, for an estimate of your own: "
                        "[{0}_kalman.h]({0}_kalman.h).\n  `make test` replays "
                        "[filters.txt](filters.txt) as well.\n",
                        name));
}

}  // namespace
}  // namespace exports
}  // namespace quadtune
