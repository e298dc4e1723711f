// SPDX-License-Identifier: Apache-2.0
#include "flight_arguments.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <optional>

#include "given_gains.hpp"
#include "number_arguments.hpp"
#include "print.hpp"
#include "program.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/internal/suggest.hpp"
#include "quadtune/internal/text_file.hpp"
#include "standard_lqr.hpp"

namespace quadtune::cli {
namespace {

constexpr char kCascadedPid[] = "cascaded-pid";
constexpr char kStateFeedback[] = "state-feedback";
/// Control period of laws that come with none [s].
constexpr double kUsualPeriod = 0.005;

/// What an option's word means, the option's mistake told as the command line's.
template <class Function>
auto word_of(const std::string& verb, const std::string& option, Function&& read) {
  try {
    return read(option);
  } catch (const InvalidInput& error) {
    throw UsageError(fmt::format("quadtune {}: {}", verb, error.what()), option);
  }
}

ChosenLaw published_cascade(const Vehicle& vehicle, const std::string& verb) {
  if (!vehicle.published_cascade)
    throw UsageError(fmt::format("quadtune {}: --gains published: {} has no published cascade, "
                                 "expected designed or a file",
                                 verb, vehicle.name),
                     "--gains");
  return {CascadeController{vehicle.published_cascade->gains},
          "cascaded PID, published: " + vehicle.published_cascade->source};
}

ChosenLaw designed_cascade(const FlightArguments& arguments, const Vehicle& vehicle) {
  ChosenLaw law;
  CascadeSpecification specification;
  specification.dt = vehicle.published_cascade ? vehicle.published_cascade->gains.dt : kUsualPeriod;
  const CascadeReport report = design_cascade(vehicle, specification, vehicle.name);
  law.margins = report.margins;
  law.position_bandwidth = position_bandwidth(report);
  CascadeController controller{report.cascade.gains};
  controller.back_calculation = kDesignedBackCalculation;
  law.controller = controller;
  law.words = fmt::format("cascaded PID, designed as by `quadtune pid {}`", arguments.vehicle);
  return law;
}

/// What is known by a word alone: --gains designed or published.
ChosenLaw law_of_word(const FlightArguments& arguments, const Vehicle& vehicle, bool cascade,
                      const std::string& verb) {
  const bool designed = arguments.gains == "designed";
  if (cascade)
    return designed ? designed_cascade(arguments, vehicle) : published_cascade(vehicle, verb);
  if (designed)
    return {feedback_controller(standard_gains(vehicle, verb), kUsualPeriod),
            "state feedback, LQR with weights by Bryson's rule",
            {}};
  throw UsageError(fmt::format("quadtune {}: --gains published is for cascaded-pid, expected "
                               "designed or a file of gains",
                               verb),
                   "--gains");
}

/// Whether the cascade of a file flies: what is asked for, or what there is. Of both the cascade of
/// a design, as in its missions, and the state feedback of an export.
bool flies_cascade(const GivenLaws& given, const FlightArguments& arguments) {
  const StoredLaws& laws = given.laws;
  if (arguments.controller.empty())
    return laws.cascade && (!laws.gains || given.design.has_value());
  const bool cascade = arguments.controller == kCascadedPid;
  if (cascade ? !laws.cascade : !laws.gains)
    throw InvalidInput(arguments.gains,
                       cascade ? "holds a state feedback and no PID cascade, expected one"
                               : "holds a PID cascade and no state feedback, expected one");
  return cascade;
}

ChosenLaw law_of_file(const FlightArguments& arguments, const Vehicle& vehicle) {
  const GivenLaws given = read_given_laws(arguments.gains);
  require_vehicle(given.laws, vehicle, arguments.gains);
  if (!flies_cascade(given, arguments))
    return {feedback_controller(*given.laws.gains, kUsualPeriod),
            "state feedback of " + arguments.gains,
            given.design ? given.design->margins : std::nullopt};
  const CascadeDesign& cascade = *given.laws.cascade;
  ChosenLaw law{cascade_controller(cascade, cascade.gains), "cascaded PID of " + arguments.gains};
  if (cascade.specification) {
    law.margins = given.design->cascade->margins;
    law.position_bandwidth = position_bandwidth(*given.design->cascade);
  }
  return law;
}

/// The estimator that a vehicle's sensors can feed.
std::string usual_estimator(const Sensors& sensors) {
  if (sensors.sonar && sensors.flow) return "mambo";
  return sensors.barometer && sensors.magnetometer ? "uquad" : "truth";
}

void require_estimator(const std::string& name, const std::string& verb) {
  static const std::vector<std::string> words = {"mambo", "mambo-original", "mambo-raw", "uquad",
                                                 "truth"};
  if (std::find(words.begin(), words.end(), name) == words.end())
    throw UsageError(fmt::format("quadtune {}: --estimator: no estimator '{}', expected {}{}", verb,
                                 internal::printable(name), fmt::join(words, ", "),
                                 internal::did_you_mean(name, words)),
                     "--estimator");
}

void set_estimator(const std::string& name, FlightSetup& setup, PlannedFlight& flight,
                   const std::string& verb) {
  const Sensors& sensors = setup.vehicle.sensors;
  const auto need = [&](bool present, const char* sensor) {
    if (!present)
      throw UsageError(fmt::format("quadtune {}: --estimator {}: the vehicle '{}' has no {}, "
                                   "expected an estimator that its sensors feed",
                                   verb, name, setup.vehicle.name, sensor),
                       "--estimator");
  };
  flight.estimator = name;
  // Variants of the Mambo's: without the calibration, without the filter.
  const bool original = name == "mambo-original", raw = name == "mambo-raw";
  setup.estimator = estimator_kind(original || raw ? "mambo" : name, "--estimator");
  if (raw) setup.mambo_estimator.position = MamboPosition::flow_velocity;
  if (setup.estimator == EstimatorKind::truth) return;
  need(sensors.accelerometer.has_value(), "accelerometer");
  need(sensors.gyroscope.has_value(), "gyroscope");
  if (setup.estimator == EstimatorKind::mambo) {
    need(sensors.sonar.has_value(), "sonar");
    if (!original) calibrate_flow(setup);
  } else {
    need(sensors.barometer.has_value(), "barometer");
    need(sensors.magnetometer.has_value(), "magnetometer");
    setup.uquad_filter = uquad_filter_in_si<double>();
    setup.uquad_filter.position = sensors.gps || sensors.vision;
  }
}

/// What options say that needs neither a vehicle nor a law.
struct FlightWords {
  bool real_sensors = true;
  FlowModel flow = FlowModel::full;
  Wind wind;
  Integrator solver = Integrator::bogacki_shampine_3;
  std::optional<PidMethod> integrator;
};

FlightWords words_of(const FlightArguments& arguments, const std::string& verb) {
  FlightWords words;
  if (!arguments.integrator.empty())
    words.integrator = word_of(verb, "--integrator", [&](const std::string& option) {
      return pid_method(arguments.integrator, option);
    });
  const std::string& sensors = arguments.sensors;
  if (!sensors.empty() && sensors != "real" && sensors != "ideal")
    throw UsageError(fmt::format("quadtune {}: --sensors is '{}', expected ideal or real{}", verb,
                                 internal::printable(sensors),
                                 internal::did_you_mean(sensors, {"ideal", "real"})),
                     "--sensors");
  words.real_sensors = sensors != "ideal";
  words.flow = word_of(verb, "--flow", [&](const std::string& option) {
    return flow_model(arguments.flow.empty() ? "full" : arguments.flow, option);
  });
  words.wind = word_of(verb, "--wind", [&](const std::string& option) {
    return wind_of_words(arguments.wind, option);
  });
  words.solver = word_of(verb, "--solver", [&](const std::string& option) {
    return integrator(arguments.solver, option);
  });
  if (!arguments.estimator.empty()) require_estimator(arguments.estimator, verb);
  return words;
}

/// The accelerometer of a multirotor shows its thrust, not the vertical: the filter of the attitude
/// forgets a tilt that lasts, and a loop of position slower than that forgetting swings up.
void slow_down_attitude_filter(const ChosenLaw& law, const FlightArguments& arguments,
                               PlannedFlight& flight) {
  constexpr double kLeastProduct = 0.5;  // of the loop's speed and the filter's time constant
  FlightSetup& setup = flight.setup;
  double& time_constant = setup.mambo_estimator.attitude_time_constant;
  if (setup.estimator != EstimatorKind::mambo || arguments.estimator == "mambo-original" ||
      !(law.position_bandwidth * time_constant < kLeastProduct && law.position_bandwidth > 0))
    return;
  time_constant = kLeastProduct / law.position_bandwidth;
  flight.notes.push_back(fmt::format(
      "the loops of x and y are as slow as {:.2g} rad/s: the attitude filter has a time "
      "constant of {:.2g} s instead of 1 s",
      law.position_bandwidth, time_constant));
}

/// Options that speak of an optical flow sensor need one.
void require_flow_sensor(const FlightArguments& arguments, const FlightSetup& setup,
                         const std::string& verb) {
  const auto refuse = [&](const char* option, const std::string& why) {
    throw UsageError(
        fmt::format("quadtune {}: {} came, expected none because {}", verb, option, why), option);
  };
  const std::string none =
      fmt::format("the vehicle '{}' has no optical flow sensor", setup.vehicle.name);
  const bool has_sensor = setup.vehicle.sensors.flow.has_value();
  if (!has_sensor && arguments.flow_rate) refuse("--flow-rate", none);
  if (!has_sensor && arguments.flow == "simplified") refuse("--flow simplified", none);
  if (arguments.flow_rate && setup.flow == FlowModel::off) refuse("--flow-rate", "the flow is off");
}

/// What validate() would refuse of numbers that the command line gave.
void require_sane_times(const FlightSetup& setup, const std::string& verb) {
  const auto refuse = [&](const char* option, double value, const std::string& expected) {
    throw UsageError(
        fmt::format("quadtune {}: {} is {}, expected {}", verb, option, number(value), expected),
        option);
  };
  const double dt = control_period(setup);
  if (!(dt > 0)) return;
  if (dt / setup.step > 1e6)
    refuse("--step", setup.step,
           fmt::format("at least a millionth of the control period, {} s", number(dt)));
  if (setup.duration / dt > 1e8)
    refuse("--duration", setup.duration, fmt::format("at most {} s", number(1e8 * dt)));
  if (setup.flow_rate > 10000) refuse("--flow-rate", setup.flow_rate, "at most 10000 Hz");
}

}  // namespace

std::string controller_kind(const std::string& word, const std::string& verb) {
  if (word.empty() || word == kCascadedPid || word == kStateFeedback) return word;
  if (word == "pid") return kCascadedPid;
  if (word == "lqr") return kStateFeedback;
  throw UsageError(
      fmt::format("quadtune {}: --controller is '{}', expected {} (or pid) or {} (or lqr){}", verb,
                  internal::printable(word), kCascadedPid, kStateFeedback,
                  internal::did_you_mean(word, {kCascadedPid, kStateFeedback})),
      "--controller");
}

ChosenLaw choose_law(FlightArguments arguments, const Vehicle& vehicle, const std::string& verb) {
  arguments.controller = controller_kind(arguments.controller, verb);
  if (arguments.gains.empty()) arguments.gains = "designed";
  if (arguments.gains == "designed" || arguments.gains == "published")
    return law_of_word(arguments, vehicle, arguments.controller != kStateFeedback, verb);
  return law_of_file(arguments, vehicle);
}

void keep_log(PlannedFlight& plan, const std::string& verb) {
  constexpr double kMostRows = 2e6;  // about 1.5 GB
  FlightSetup& setup = plan.setup;
  const double dt = control_period(setup);
  const double duration = duration_of(setup);
  if (duration / dt > kMostRows)
    throw UsageError(
        fmt::format("quadtune {}: --duration is {} s, expected at most {} s where every control "
                    "period is kept, because the record is held in memory",
                    verb, number(duration), number(kMostRows * dt)),
        "--duration");
  setup.log = true;
}

void add_flight_options(CLI::App& app, FlightArguments& arguments) {
  app.add_option("--mission", arguments.mission,
                 "a built-in mission or a mission file (docs/formats.md); hover")
      ->type_name("NAME");
  app.add_option(
         "--controller", arguments.controller,
         "cascaded-pid (or pid), state-feedback (or lqr); what --gains holds, or cascaded-pid")
      ->type_name("KIND");
  app.add_option(
         "--gains", arguments.gains,
         "designed (default), published, a design file, an export, or what lqr or pid wrote "
         "as JSON")
      ->type_name("WHICH");
  app.add_option("--integrator", arguments.integrator,
                 "of the PID: euler (default), backward-euler or tustin")
      ->type_name("NAME");
  app.add_option("--estimator", arguments.estimator,
                 "mambo, mambo-original, mambo-raw, uquad or truth; what the sensors can feed")
      ->type_name("NAME");
  app.add_option("--flow", arguments.flow, "optical flow: full (default), simplified or off")
      ->type_name("MODEL");
  add_positive(app, "--flow-rate", arguments.flow_rate, "of the optical flow [Hz]; the vehicle's")
      ->type_name("HZ");
  app.add_option("--sensors", arguments.sensors, "ideal, or real (default): as the vehicle's are")
      ->type_name("KIND");
  app.add_option("--wind", arguments.wind,
                 "calm (default), light, moderate, severe, or a list: north=3,gust_east=2")
      ->type_name("WIND");
  add_positive(app, "--duration", arguments.duration, "[s]; the mission's")->type_name("S");
  app.add_option("--solver", arguments.solver,
                 "euler, bogacki-shampine-3 (default) or runge-kutta-4")
      ->type_name("NAME");
  add_positive(app, "--step", arguments.step, "longest step of the solver [s]; 0.005")
      ->type_name("S");
  app.add_flag("--dynamic-environment", arguments.dynamic_environment,
               "air, gravity and magnetic field change with height");
}

FlightArguments as_the_model_project(FlightArguments arguments) {
  if (arguments.sensors.empty()) arguments.sensors = "ideal";
  if (arguments.gains.empty() &&
      controller_kind(arguments.controller, "compare") != kStateFeedback &&
      !arguments.vehicle.empty() && load_vehicle(arguments.vehicle).published_cascade)
    arguments.gains = "published";
  return arguments;
}

CascadeController cascade_controller(const CascadeDesign& design, const CascadeGains& gains) {
  CascadeController controller{gains};
  controller.method = design.method;
  controller.attitude_limit = design.attitude_limit;
  controller.integrator_limit = design.integrator_limit;
  controller.back_calculation = design.back_calculation;
  return controller;
}

double position_bandwidth(const CascadeReport& report) {
  double slower = 0;
  for (const CascadeAxisDesign& loop : report.cascade.loops) {
    if (loop.axis != CascadeAxis::x && loop.axis != CascadeAxis::y) continue;
    const double bandwidth = loop.design.evidence.bandwidth;
    slower = slower > 0 ? std::min(slower, bandwidth) : bandwidth;
  }
  return slower;
}

StateFeedbackController feedback_controller(const Gains& gains, double dt) {
  StateFeedbackController controller{gains, gains.dt > 0 ? gains.dt : dt, {}};
  if (gains.convention == "uquad") controller.guards = uquad_integral_guards();
  return controller;
}

void require_flight_words(const FlightArguments& arguments, const std::string& verb) {
  (void)controller_kind(arguments.controller, verb);
  (void)words_of(arguments, verb);
}

PlannedFlight plan_flight(const FlightArguments& arguments, const Vehicle& vehicle,
                          const Mission& mission, const ChosenLaw& law, const std::string& verb) {
  PlannedFlight flight;
  FlightSetup& setup = flight.setup;
  setup.vehicle = vehicle;
  setup.mission = mission;
  setup.controller = law.controller;
  flight.law = law.words;
  flight.margins = law.margins;
  const FlightWords words = words_of(arguments, verb);
  if (auto* cascade = std::get_if<CascadeController>(&setup.controller)) {
    cascade->method = words.integrator.value_or(cascade->method);
  } else if (words.integrator) {
    throw UsageError(fmt::format("quadtune {}: --integrator is for a cascaded PID, expected none "
                                 "because a state feedback sums its error once a sample",
                                 verb),
                     "--integrator");
  }
  setup.real_sensors = words.real_sensors;
  flight.sensors = words.real_sensors ? "real" : "ideal";
  if (setup.real_sensors && !vehicle.sensors_known)
    flight.notes.push_back(
        fmt::format("the file of '{}' has no [sensors]: typical ones of small vehicles are flown",
                    vehicle.name));
  setup.flow = words.flow;
  setup.flow_rate = arguments.flow_rate.value_or(0);
  setup.duration = arguments.duration.value_or(0);
  require_flow_sensor(arguments, setup, verb);
  const std::string estimator =
      arguments.estimator.empty() ? usual_estimator(vehicle.sensors) : arguments.estimator;
  set_estimator(estimator, setup, flight, verb);
  if (arguments.estimator.empty() && estimator == "truth")
    flight.notes.push_back(fmt::format(
        "the sensors of '{}' feed no estimator: the law has the true state", vehicle.name));
  slow_down_attitude_filter(law, arguments, flight);
  setup.environment.dynamic = arguments.dynamic_environment;
  setup.environment.wind = words.wind;
  flight.wind = arguments.wind;
  const Wind& wind = setup.environment.wind;
  const bool windy = !wind.mean.isZero(0) || !wind.gust.velocity.isZero(0) || wind.turbulence > 0;
  if (windy && vehicle.drag.cda.isZero(0) && vehicle.drag.linear.isZero(0))
    flight.notes.push_back(
        fmt::format("the file of '{}' has no drag_area_m2 and no drag_linear_N_s_per_m: the wind "
                    "does not move it",
                    vehicle.name));
  setup.integrator = words.solver;
  setup.step = arguments.step.value_or(setup.step);
  setup.seed = arguments.seed;
  require_sane_times(setup, verb);
  validate(setup);
  return flight;
}

PlannedFlight plan_flight(const FlightArguments& arguments, const std::string& verb) {
  if (arguments.vehicle.empty())
    throw UsageError(fmt::format("quadtune {}: expected a vehicle", verb), "V");
  require_flight_words(arguments, verb);
  const Vehicle vehicle = load_vehicle(arguments.vehicle);
  const Mission mission = load_mission(arguments.mission);
  return plan_flight(arguments, vehicle, mission, choose_law(arguments, vehicle, verb), verb);
}

}  // namespace quadtune::cli
