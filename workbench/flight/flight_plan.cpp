// SPDX-License-Identifier: Apache-2.0
#include "quadtune/workbench/flight/flight_plan.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "quadtune/errors.hpp"
#include "quadtune/internal/joined.hpp"
#include "quadtune/internal/suggest.hpp"
#include "quadtune/internal/text_file.hpp"
#include "quadtune/linearize/trim.hpp"
#include "quadtune/loop_limits.hpp"
#include "quadtune/simulation/uquad_flight.hpp"
#include "quadtune/workbench/firmware/firmware_law.hpp"
#include "quadtune/workbench/flight/sensor_words.hpp"
#include "quadtune/workbench/flown/flown_check.hpp"
#include "quadtune/workbench/flown/flying_loop.hpp"

namespace quadtune {
namespace {

/// Formats a number for messages.
std::string number(double value) { return fmt::format("{:.6g}", value); }

/// Interprets the word of an option; an invalid word throws OptionError for this option.
template <class Function>
auto word_of(const std::string& option, Function&& read) {
  try {
    return read(option);
  } catch (const InvalidInput& error) {
    throw OptionError(option, error.what());
  }
}

/// The default estimator for a vehicle's sensors. The general filter has no model of the simplified
/// flow.
std::string usual_estimator(Sensors sensors, FlowModel flow) {
  if (!sensors.accelerometer || !sensors.gyroscope) return "truth";
  if (flow == FlowModel::off) sensors.flow.reset();
  const bool modelled = flow != FlowModel::simplified || !sensors.flow;
  if (modelled && general_filter_lacks(sensors).empty()) return "general";
  if (sensors.sonar && sensors.flow) return "mambo";
  return sensors.barometer && sensors.magnetometer ? "uquad" : "truth";
}

void require_estimator(const std::string& name) {
  static const std::vector<std::string> words = {"mambo", "mambo-original", "mambo-raw",
                                                 "uquad", "general",        "truth"};
  if (std::find(words.begin(), words.end(), name) == words.end())
    throw OptionError(
        "estimator",
        fmt::format("estimator: no estimator '{}', expected {}{}", internal::printable(name),
                    internal::joined(words, ", "), internal::did_you_mean(name, words)));
}

void set_estimator(const std::string& name, FlightSetup& setup, PlannedFlight& flight) {
  const Sensors& sensors = setup.vehicle.sensors;
  const auto need = [&](bool present, const char* sensor) {
    if (!present)
      throw OptionError("estimator",
                        fmt::format("estimator {}: the vehicle '{}' has no {}, expected an "
                                    "estimator that its sensors support",
                                    name, setup.vehicle.name, sensor));
  };
  flight.estimator = name;
  // Variants of the Mambo's estimator: without the calibration, without the filter.
  const bool original = name == "mambo-original", raw = name == "mambo-raw";
  setup.estimator = estimator_kind(original || raw ? "mambo" : name, "estimator");
  if (raw) setup.mambo_estimator.position = MamboPosition::flow_velocity;
  if (setup.estimator == EstimatorKind::truth) return;
  if (setup.estimator == EstimatorKind::general) {
    Sensors flown = sensors;
    if (setup.flow == FlowModel::off) flown.flow.reset();
    const std::string lacks = general_filter_lacks(flown);
    if (!lacks.empty())
      throw OptionError("estimator",
                        fmt::format("estimator general: the vehicle '{}' has {}; expected an "
                                    "estimator that its sensors support",
                                    setup.vehicle.name, lacks));
    if (flown.flow && setup.flow == FlowModel::simplified)
      throw OptionError("estimator",
                        "estimator general: a flight has the flow simplified, which this filter "
                        "does not model; expected another estimator or the flow full");
    return;
  }
  need(sensors.accelerometer.has_value(), "accelerometer");
  need(sensors.gyroscope.has_value(), "gyroscope");
  if (setup.estimator == EstimatorKind::mambo) {
    need(sensors.sonar.has_value(), "sonar");
    if (!original) calibrate_flow(setup);
  } else {
    need(sensors.barometer.has_value(), "barometer");
    need(sensors.magnetometer.has_value(), "magnetometer");
    setup.uquad_filter = uquad_filter_for(sensors);
  }
}

/// The meaning of options that depend neither on a vehicle nor on a law.
struct FlightWords {
  bool real_sensors = true;
  FlowModel flow = FlowModel::full;
  Wind wind;
  Integrator solver = Integrator::bogacki_shampine_3;
  AllocationRule allocation = AllocationRule::prioritized;
  std::optional<PidMethod> integrator;
};

FlightWords words_of(const FlightOptions& options) {
  FlightWords words;
  if (!options.integrator.empty())
    words.integrator = word_of(
        "integrator", [&](const std::string& key) { return pid_method(options.integrator, key); });
  const std::string& sensors = options.sensors;
  if (!sensors.empty() && sensors != "real" && sensors != "ideal")
    throw OptionError("sensors", fmt::format("sensors is '{}', expected ideal or real{}",
                                             internal::printable(sensors),
                                             internal::did_you_mean(sensors, {"ideal", "real"})));
  words.real_sensors = sensors != "ideal";
  words.flow = word_of("flow", [&](const std::string& key) {
    return flow_model(options.flow.empty() ? "full" : options.flow, key);
  });
  words.wind =
      word_of("wind", [&](const std::string& key) { return parse_wind(options.wind, key); });
  words.solver =
      word_of("solver", [&](const std::string& key) { return integrator(options.solver, key); });
  if (!options.allocation.empty())
    words.allocation = word_of("allocation", [&](const std::string& key) {
      return allocation_rule(options.allocation, key);
    });
  const std::string& take_off = options.take_off;
  if (!take_off.empty() && take_off != "climb" && take_off != "thrust")
    throw OptionError(
        "take-off",
        fmt::format("take-off is '{}', expected climb or thrust{}", internal::printable(take_off),
                    internal::did_you_mean(take_off, {"climb", "thrust"})));
  if (!options.estimator.empty()) require_estimator(options.estimator);
  return words;
}

/// The accelerometer of a multirotor measures its thrust, not the vertical: the attitude filter
/// forgets a persistent tilt, and a position loop that is slower than this becomes unstable.
void slow_down_attitude_filter(const ChosenLaw& law, const FlightOptions& options,
                               PlannedFlight& flight) {
  constexpr double kMinProduct = 0.5;  // of the loop's bandwidth and the filter's time constant
  FlightSetup& setup = flight.setup;
  double& time_constant = setup.mambo_estimator.attitude_time_constant;
  if (setup.estimator != EstimatorKind::mambo || options.estimator == "mambo-original" ||
      !(law.position_bandwidth * time_constant < kMinProduct && law.position_bandwidth > 0))
    return;
  time_constant = kMinProduct / law.position_bandwidth;
  flight.notes.push_back(fmt::format(
      "the loops of x and y have a bandwidth of only {:.2g} rad/s: the attitude filter gets a time "
      "constant of {:.2g} s instead of 1 s",
      law.position_bandwidth, time_constant));
}

/// Rejects options about optical flow if there is no such sensor.
void require_flow_sensor(const FlightOptions& options, const FlightSetup& setup) {
  const auto refuse = [&](const char* option, const std::string& why) {
    throw OptionError(option, fmt::format("{} cannot be set, because {}", option, why));
  };
  const std::string none =
      fmt::format("the vehicle '{}' has no optical flow sensor", setup.vehicle.name);
  const bool has_sensor = setup.vehicle.sensors.flow.has_value();
  if (!has_sensor && options.flow_rate) refuse("flow-rate", none);
  if (!has_sensor && options.flow == "simplified") refuse("flow simplified", none);
  if (options.flow_rate && setup.flow == FlowModel::off) refuse("flow-rate", "the flow is off");
}

/// Rejects numbers of the options, and periods of the gains, that validate() would reject.
void require_sane_times(const FlightOptions& options, const FlightSetup& setup) {
  const auto refuse = [&](const char* option, double value, const std::string& expected) {
    throw OptionError(option,
                      fmt::format("{} is {}, expected {}", option, number(value), expected));
  };
  const double dt = control_period(setup);
  if (!(dt > 0)) return;
  if (!options.gains.empty() && !(dt >= kMinControlPeriod && dt <= kMaxControlPeriod))
    throw InvalidInput(options.gains,
                       fmt::format("the control period of the law is {} s, expected {} to {} s",
                                   number(dt), kMinControlPeriod, kMaxControlPeriod));
  if (dt / setup.step > 1e6)
    refuse("step", setup.step,
           fmt::format("at least a millionth of the control period, {} s", number(dt)));
  if (setup.duration / dt > 1e8)
    refuse("duration", setup.duration, fmt::format("at most {} s", number(1e8 * dt)));
  if (setup.flow_rate > 10000) refuse("flow-rate", setup.flow_rate, "at most 10000 Hz");
}

/// Notes the drifts if the sensors do not observe the horizontal velocity.
void note_drifts(PlannedFlight& flight) {
  const std::string lacks = general_filter_lacks(flight.setup.vehicle.sensors);
  if (lacks.empty()) return;
  const double duration = duration_of(flight.setup);
  flight.notes.push_back(
      fmt::format("{}: the estimates of position and horizontal velocity drift, by {:.1f} m rms in "
                  "{} s; the law "
                  "controls only attitude, heading and height",
                  lacks, flight.bound->horizontal_end, number(duration)));
}

/// Notes a limit of the settling time that no reference of the flight can meet.
void note_short_flight(PlannedFlight& flight) {
  const Mission& mission = flight.setup.mission;
  const double duration = duration_of(flight.setup);
  const bool limited =
      std::any_of(mission.limits.begin(), mission.limits.end(),
                  [](const Limit& limit) { return limit.metric == Metric::settling_time; });
  if (limited && duration < mission.settling.window)
    flight.notes.push_back(fmt::format(
        "every flight fails the limit of the settling time, which requires a constant reference "
        "for {} s; the flight lasts {} s",
        number(mission.settling.window), number(duration)));
}

/// Notes parts of the wind that do not act on this flight.
void note_unused_wind(PlannedFlight& flight) {
  const Wind& wind = flight.setup.environment.wind;
  const bool gust = !wind.gust.velocity.isZero(0);
  const double duration = duration_of(flight.setup);
  if (gust && wind.gust.start >= duration)
    flight.notes.push_back(
        fmt::format("the gust begins at {} s, after the flight, which ends at "
                    "{} s",
                    number(wind.gust.start), number(duration)));
  const Gust usual;
  if (!gust && (wind.gust.start != usual.start || wind.gust.length != usual.length))
    flight.notes.emplace_back(
        "gust_at and gust_length of the wind have no effect without gust_north, gust_east or "
        "gust_down");
  if (wind.turbulence == 0 && wind.turbulence_height != Wind().turbulence_height)
    flight.notes.emplace_back("turbulence_height of the wind has no effect without turbulence");
}

/// Notes a state feedback whose gains hold at another yaw than that at which the mission begins:
/// position and velocity are in world axes.
void note_other_yaw(const std::optional<double>& yaw, PlannedFlight& flight) {
  constexpr double kApart = 0.3;  // about half of the usual phase margins [rad]
  const double start = flight.setup.mission.start.yaw;
  if (!yaw || std::abs(std::remainder(start - *yaw, 2 * std::numbers::pi)) <= kApart) return;
  flight.notes.push_back(
      fmt::format("the gains are for the yaw {} rad, and the mission begins at the yaw {} rad: a "
                  "state feedback of position in world axes is not valid there",
                  number(*yaw), number(start)));
}

/// Notes that a flight program for these gains has another estimator, with which `verify` and
/// `certify` analyse its exports.
void note_other_estimator(const FlightOptions& options, PlannedFlight& flight) {
  const auto* feedback = std::get_if<StateFeedbackController>(&flight.setup.controller);
  if (feedback == nullptr || !options.estimator.empty()) return;
  const std::string& convention = feedback->gains.convention;
  const std::string program = estimator_of_program(flight.setup.vehicle, convention);
  if (!program.empty() && program != flight.estimator)
    flight.notes.push_back(fmt::format(
        "the flight uses the estimator {}; the estimator of the flight program {} is {}",
        flight.estimator, convention, program));
}

/// Sets up the estimator of an autopilot, which a general filter approximates.
void put_on_board(const FlightOptions& options, FlightSetup& setup, PlannedFlight& flight) {
  const bool truth = setup.estimator == EstimatorKind::truth;
  if (!options.estimator.empty() && !truth && options.estimator != "general")
    throw OptionError("estimator",
                      fmt::format("estimator is {}, expected general or truth with the loops of an "
                                  "autopilot, whose own estimator is a filter of that kind",
                                  options.estimator));
  if (!truth && setup.estimator != EstimatorKind::general) set_estimator("general", setup, flight);
  fly_on_board(setup);
}

/// Sets up the estimator: that of the options, of the law's file, or one that the sensors allow.
void choose_estimator(const FlightOptions& options, const FlightWords& words, const ChosenLaw& law,
                      PlannedFlight& flight) {
  FlightSetup& setup = flight.setup;
  const Vehicle& vehicle = setup.vehicle;
  const bool of_law = options.estimator.empty() && law.estimator && words.flow == FlowModel::full;
  const std::string estimator = of_law ? law.estimator->name
                                : options.estimator.empty()
                                    ? usual_estimator(vehicle.sensors, words.flow)
                                    : options.estimator;
  try {
    set_estimator(estimator, setup, flight);
  } catch (const OptionError& error) {
    if (!of_law) throw;
    throw InvalidInput(law.words, error.what());
  }
  if (law.estimator && estimator == law.estimator->name) take_numbers(*law.estimator, setup);
  if (law.on_board) put_on_board(options, setup, flight);
  if (options.estimator.empty() && estimator == "truth") {
    const std::string why = why_no_estimator(vehicle);
    if (setup.real_sensors && !why.empty())
      throw InvalidInput(place_of(vehicle), why +
                                                "; expected such a sensor; 'quadtune fly "
                                                "--estimator truth' flies with the true state");
    flight.notes.push_back(fmt::format(
        "the sensors of '{}' do not suffice for any estimator: the law uses the true state",
        vehicle.name));
  }
}

}  // namespace

std::string why_no_estimator(const Vehicle& vehicle) {
  if (usual_estimator(vehicle.sensors, FlowModel::full) != "truth") return "";
  return "the sensors do not suffice for any estimator: " + general_filter_lacks(vehicle.sensors);
}

std::optional<StoredEstimator> stored_estimator(const Vehicle& vehicle, const std::string& name,
                                                double dt) {
  StoredEstimator estimator{name.empty() ? usual_estimator(vehicle.sensors, FlowModel::full)
                                         : name};
  // Files contain neither true states nor the variants of the Mambo's estimator.
  if (estimator.name == "truth" || estimator.name == "mambo-raw" ||
      estimator.name == "mambo-original")
    return {};
  if (estimator.name == "general") {
    estimator.general =
        general_filter_settings(vehicle.sensors, dt, vehicle.gravity, Environment().magnetic_field);
    try {
      validate(*estimator.general, "estimator general");
    } catch (const InvalidInput&) {
      return {};  // the control period is too short for this suite
    }
  }
  return estimator;
}

void keep_log(PlannedFlight& plan) {
  constexpr double kMaxRows = 2e6;  // about 1.5 GB
  FlightSetup& setup = plan.setup;
  const double dt = control_period(setup);
  const double duration = duration_of(setup);
  if (duration / dt > kMaxRows)
    throw OptionError("duration",
                      fmt::format("duration is {} s, expected at most {} s if every control "
                                  "period is logged, because the log is kept in memory",
                                  number(duration), number(kMaxRows * dt)));
  setup.log = true;
}

FlightOptions as_the_model_project(FlightOptions options) {
  if (options.sensors.empty()) options.sensors = "ideal";
  if (options.allocation.empty()) options.allocation = "clipped";
  if (options.take_off.empty()) options.take_off = "thrust";
  if (options.estimator.empty() && !options.vehicle.empty()) {
    const Sensors sensors = load_vehicle(options.vehicle).sensors;
    if (sensors.sonar && sensors.flow) options.estimator = "mambo";
  }
  if (options.gains.empty() && controller_kind(options.controller) != kStateFeedback &&
      !options.vehicle.empty() && load_vehicle(options.vehicle).published_cascade)
    options.gains = "published";
  return options;
}

void require_flight_words(const FlightOptions& options) {
  (void)controller_kind(options.controller);
  (void)words_of(options);
}

PlannedFlight plan_flight(const FlightOptions& options, const Vehicle& vehicle,
                          const Mission& mission, const ChosenLaw& law) {
  PlannedFlight flight;
  FlightSetup& setup = flight.setup;
  flight.options = options;
  // The computation of a law shows that the vehicle can hover; a law from a file does not.
  if (const TrimResult hover = trim(vehicle, FlightCondition{}); !hover.solved())
    throw NoSolution(fmt::format("{}: no hover trim: {}", place_of(vehicle), hover.culprit),
                     place_of(vehicle));
  setup.vehicle = vehicle;
  setup.mission = options.take_off == "thrust" ? with_thrust_take_off(mission) : mission;
  if (options.take_off == "climb") setup.mission.start.take_off_by = TakeOff::climb;
  setup.controller = law.controller;
  flight.law = law.words;
  flight.margins = law.margins;
  const FlightWords words = words_of(options);
  if (auto* cascade = std::get_if<CascadeController>(&setup.controller)) {
    cascade->method = words.integrator.value_or(cascade->method);
  } else if (words.integrator) {
    throw OptionError("integrator",
                      law.on_board ? "integrator does not apply to the law of an autopilot, "
                                     "which integrates by Euler's rule"
                                   : "integrator does not apply to a state feedback, which "
                                     "sums its error once per sample; expected a cascaded PID");
  }
  setup.allocation = words.allocation;
  setup.real_sensors = words.real_sensors;
  flight.sensors = words.real_sensors ? "real" : "ideal";
  if (setup.real_sensors && !vehicle.sensors_known)
    flight.notes.push_back(fmt::format("the file of '{}' has no [sensors]; assumed: {}",
                                       vehicle.name, describe(vehicle.sensors)));
  setup.flow = words.flow;
  setup.flow_rate = options.flow_rate.value_or(0);
  setup.duration = options.duration.value_or(0);
  require_flow_sensor(options, setup);
  choose_estimator(options, words, law, flight);
  slow_down_attitude_filter(law, options, flight);
  setup.environment.dynamic = options.dynamic_environment;
  setup.environment.wind = words.wind;
  flight.wind = options.wind;
  const Wind& wind = setup.environment.wind;
  const bool windy = !wind.mean.isZero(0) || !wind.gust.velocity.isZero(0) || wind.turbulence > 0;
  if (windy && !has_aerodynamics(vehicle))
    flight.notes.push_back(
        fmt::format("the file of '{}' has no drag, such as drag_area_m2: the wind does not "
                    "move the vehicle",
                    vehicle.name));
  setup.integrator = words.solver;
  setup.step = options.step.value_or(setup.step);
  setup.seed = options.seed;
  require_sane_times(options, setup);
  validate(setup);
  flight.bound = mission_bound(setup);
  if (flight.bound) flight.widened = widen_limits(*flight.bound, setup.mission);
  if (flight.bound && setup.real_sensors) note_drifts(flight);
  note_short_flight(flight);
  if (const auto* feedback = std::get_if<StateFeedbackController>(&setup.controller);
      feedback != nullptr && !feedback->schedule)
    note_other_yaw(yaw_of(feedback->gains), flight);
  return flight;
}

PlannedFlight plan_flight(const FlightOptions& options, const Vehicle& vehicle,
                          const std::string& who) {
  require_flight_words(options);
  const Mission mission = load_mission(options.mission);
  PlannedFlight flight = plan_flight(options, vehicle, mission, choose_law(options, vehicle, who));
  note_unused_wind(flight);
  note_other_estimator(options, flight);
  return flight;
}

PlannedFlight plan_flight(const FlightOptions& options, const std::string& who) {
  if (options.vehicle.empty())
    throw OptionError("vehicle", "vehicle is missing, expected a built-in vehicle or a file");
  require_flight_words(options);  // before any file is read
  return plan_flight(options, load_vehicle(options.vehicle), who);
}

}  // namespace quadtune
