// SPDX-License-Identifier: Apache-2.0
#include "quadtune/simulation/flight.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <tuple>

#include "quadtune/control/allocation.hpp"
#include "quadtune/control/cascaded_pid.hpp"
#include "quadtune/control/scheduled_feedback.hpp"
#include "quadtune/control/state_feedback_law.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/internal/enum_names.hpp"
#include "quadtune/internal/in_parallel.hpp"
#include "quadtune/internal/joined.hpp"
#include "quadtune/internal/suggest.hpp"
#include "quadtune/internal/text_file.hpp"
#include "quadtune/loop_limits.hpp"
#include "quadtune/model/mixer.hpp"
#include "quadtune/simulation/air.hpp"
#include "quadtune/simulation/pack.hpp"
#include "simulation/loop/closed_loop_parts.hpp"

namespace quadtune {
namespace {

// Number of flights that are simulated at once. If the build has variants of this library for AVX2
// and AVX-512 (cmake/Variants.cmake), only these variants contain the code for packs of flights.
#if defined(QUADTUNE_ONE_AT_A_TIME)
constexpr int kLanes = 1;
#else
constexpr int kLanes = kPackLanes;
#endif

int lagging_rotors(const FlightSetup& setup) {
  const std::vector<Rotor>& rotors = flown_vehicle(setup).rotors;
  const bool lags =
      std::any_of(rotors.begin(), rotors.end(), [](const Rotor& r) { return slower_lag(r) > 0; });
  return lags ? static_cast<int>(rotors.size()) : 0;
}

template <int N>
std::array<FlightResult, N> fly_lanes(const std::array<const FlightSetup*, N>& setups,
                                      const std::function<bool()>& interrupted) {
  switch (lagging_rotors(*setups[0])) {
    case 0:
      return internal::fly_together<N, 0>(setups, interrupted);
    case 4:
      return internal::fly_together<N, 4>(setups, interrupted);
    default:
      break;
  }
  // Packs exist for the common cases only: no motor lag, or four rotors with lag.
  if constexpr (N == 1) return internal::fly_together<1, Eigen::Dynamic>(setups, interrupted);
  throw InvalidInput("flight", "there is no pack for this number of rotors");
}

bool has_pack(const FlightSetup& setup) {
  const int rotors = lagging_rotors(setup);
  return rotors == 0 || rotors == 4;
}

/// User-defined laws and estimators cannot be compared, so such flights are simulated one by one.
bool has_own_part(const FlightSetup& setup) {
  return setup.estimator == EstimatorKind::own ||
         std::holds_alternative<OwnController>(setup.controller);
}

}  // namespace

constexpr internal::EnumName<EstimatorKind> kEstimatorKinds[] = {
    {EstimatorKind::mambo, "mambo"},
    {EstimatorKind::uquad, "uquad"},
    {EstimatorKind::general, "general"},
    {EstimatorKind::truth, "truth"}};

std::string to_string(EstimatorKind kind) {
  return kind == EstimatorKind::own ? "own" : internal::name_in(kEstimatorKinds, kind);
}

EstimatorKind estimator_kind(const std::string& name, const std::string& where) {
  return internal::require_in(kEstimatorKinds, name, "estimator", where);
}

constexpr internal::EnumName<FlowModel> kFlowModels[] = {
    {FlowModel::full, "full"}, {FlowModel::simplified, "simplified"}, {FlowModel::off, "off"}};

std::string to_string(FlowModel model) { return internal::name_in(kFlowModels, model); }

FlowModel flow_model(const std::string& name, const std::string& where) {
  return internal::require_in(kFlowModels, name, "flow model", where);
}

constexpr internal::EnumName<FlightEnd> kFlightEnds[] = {{FlightEnd::completed, "completed"},
                                                         {FlightEnd::safety_exit, "safety exit"},
                                                         {FlightEnd::diverged, "diverged"}};

std::string to_string(FlightEnd end) { return internal::name_in(kFlightEnds, end); }

double control_period(const FlightSetup& setup) {
  if (const auto* cascade = std::get_if<CascadeController>(&setup.controller))
    return cascade->gains.dt;
  if (const auto* own = std::get_if<OwnController>(&setup.controller)) return own->dt;
  return std::get<StateFeedbackController>(setup.controller).dt;
}

double duration_of(const FlightSetup& setup) {
  return setup.duration > 0 ? setup.duration : setup.mission.duration;
}

namespace {

Sensors sensors_of(const FlightSetup& setup, const Vehicle& vehicle) {
  Sensors sensors = vehicle.sensors;
  if (!setup.real_sensors) sensors = ideal(sensors);
  if (setup.flow == FlowModel::off) sensors.flow.reset();
  if (sensors.flow && setup.flow_rate > 0) sensors.flow->faults.rate = setup.flow_rate;
  return sensors;
}

}  // namespace

Sensors sensors_of(const FlightSetup& setup) { return sensors_of(setup, flown_vehicle(setup)); }

GeneralFilterSettings general_filter_settings(const FlightSetup& setup) {
  const Sensors sensors = sensors_of(setup, setup.vehicle);
  const std::string lacks = general_filter_lacks(sensors);
  if (!lacks.empty())
    throw InvalidInput("estimator general",
                       fmt::format("the vehicle '{}' has {}", setup.vehicle.name, lacks));
  if (sensors.flow && setup.flow == FlowModel::simplified)
    throw InvalidInput("estimator general",
                       "the flow is simplified, expected full because the filter has the model of "
                       "the averaged motion field");
  GeneralFilterSettings settings =
      setup.general_filter && setup.real_sensors
          ? *setup.general_filter
          : general_filter_settings(sensors, control_period(setup), setup.vehicle.gravity,
                                    setup.environment.magnetic_field, setup.general_noise);
  settings.dt = control_period(setup);
  if (setup.mission.start.in_air || std::holds_alternative<Carried>(setup.mission.kind)) {
    // The biases were estimated before the flight.
    settings.start.gyro_bias = 5e-4;
    settings.start.force_bias = 0.02;
    settings.start.pressure_height = 0.05;
  }
  return settings;
}

namespace internal {

std::string law_fault(const FlightSetup& setup, const Eigen::VectorXd& inputs, int expected) {
  const auto& law = std::get<OwnController>(setup.controller);
  if (inputs.size() != expected)
    return fmt::format("law '{}': {} inputs, expected {}", law.name, inputs.size(), expected);
  const auto bad = std::find_if(inputs.begin(), inputs.end(),
                                [](double input) { return !std::isfinite(input); });
  if (bad == inputs.end()) return "";
  const std::vector<Signal> signals = input_signals(ned_convention(), law.input_kind, expected, "");
  return fmt::format("law '{}': {} is {}", law.name,
                     signals[static_cast<std::size_t>(bad - inputs.begin())].name, *bad);
}

bool same_structure(const FlightSetup& a, const FlightSetup& b) {
  if (has_own_part(a) || has_own_part(b)) return false;
  const auto clock = [](const SensorFaults& f) { return std::pair(f.rate, f.delay); };
  const auto clocks = [&](const Sensors& s) {
    std::vector<std::pair<double, double>> all(8, {0, 0});
    if (s.accelerometer) all[0] = clock(*s.accelerometer);
    if (s.gyroscope) all[1] = clock(*s.gyroscope);
    if (s.magnetometer) all[2] = clock(*s.magnetometer);
    if (s.barometer) all[3] = clock(s.barometer->faults);
    if (s.sonar) all[4] = clock(s.sonar->faults);
    if (s.flow) all[5] = clock(s.flow->faults);
    if (s.gps) all[6] = clock(s.gps->position);
    if (s.vision) all[7] = clock(*s.vision);
    return all;
  };
  const auto law = [](const FlightSetup& s) {
    if (const auto* c = std::get_if<CascadeController>(&s.controller))
      return std::tuple(0, static_cast<int>(c->method), c->velocity_feed_forward,
                        c->conditional_integration, std::vector<std::string>{});
    const auto& feedback = std::get<StateFeedbackController>(s.controller);
    const Gains& gains = feedback.gains;
    std::vector<std::string> integrated{gains.convention};
    for (const Signal& signal : gains.integrals) integrated.push_back(signal.name);
    integrated.push_back(
        fmt::format("{} {}", to_string(gains.axes), gains.memory ? gains.memory->past : -1));
    return std::tuple(1, static_cast<int>(gains.input_kind), false,
                      gains.limits.conditional_integration, integrated);
  };
  const auto schedule = [](const FlightSetup& s) -> const GainSchedule* {
    const auto* feedback = std::get_if<StateFeedbackController>(&s.controller);
    return feedback ? feedback->schedule.get() : nullptr;
  };
  // The properties that a pack takes from its first flight must be equal in all flights.
  const auto believed = [](const Vehicle& v) {
    return std::tie(v.mass, v.inertia, v.gravity, v.air_density, v.drag.cda, v.drag.linear);
  };
  const auto rotor = [](const Rotor& r) {
    return std::tie(r.position, r.spin, r.thrust_a2, r.thrust_a1, r.torque_d2, r.torque_d1,
                    r.inertia);
  };
  // Motor range that the law assumes.
  const auto same_motors = [](const Vehicle& v, const Vehicle& w) {
    return min_speed(v) == min_speed(w) && max_speed(v) == max_speed(w);
  };
  const bool same_rotors =
      std::equal(a.vehicle.rotors.begin(), a.vehicle.rotors.end(), b.vehicle.rotors.begin(),
                 b.vehicle.rotors.end(), [&](const Rotor& r, const Rotor& s) {
                   return rotor(r) == rotor(s) && r.lag == s.lag && lag_down(r) == lag_down(s);
                 });
  // Jitter differs from lane to lane, so flights with jitter are simulated one by one.
  const auto late = [](const FlightSetup& s) { return flown_vehicle(s).motor.delay; };
  const auto jitters = [](const FlightSetup& s) { return flown_vehicle(s).motor.delay_jitter > 0; };
  const auto air = [](const FlightSetup& s) {
    const std::optional<BarometerSensor>& barometer = flown_vehicle(s).sensors.barometer;
    return barometer ? std::pair(std::isfinite(barometer->fall), barometer->ground_pressure)
                     : std::pair(false, 0.0);
  };
  return a.mission == b.mission && law(a) == law(b) && schedule(a) == schedule(b) &&
         control_period(a) == control_period(b) && late(a) == late(b) && !jitters(a) &&
         !jitters(b) && same_rotors && believed(a.vehicle) == believed(b.vehicle) &&
         air(a) == air(b) && flown_vehicle(a).gravity == flown_vehicle(b).gravity &&
         duration_of(a) == duration_of(b) && a.allocation == b.allocation &&
         a.estimator == b.estimator && a.mambo_estimator == b.mambo_estimator &&
         a.uquad_filter == b.uquad_filter &&
         (a.estimator != EstimatorKind::general ||
          general_filter_settings(a) == general_filter_settings(b)) &&
         a.real_sensors == b.real_sensors && a.flow == b.flow &&
         clocks(sensors_of(a)) == clocks(sensors_of(b)) &&
         a.environment.dynamic == b.environment.dynamic && a.integrator == b.integrator &&
         a.environment.magnetic_field == b.environment.magnetic_field && a.step == b.step &&
         same_motors(a.vehicle, b.vehicle) && a.seed == b.seed &&
         flown_vehicle(a).rotors.size() == flown_vehicle(b).rotors.size() &&
         lagging_rotors(a) == lagging_rotors(b) &&
         flown_vehicle(a).motor.law == flown_vehicle(b).motor.law &&
         flown_vehicle(a).battery == flown_vehicle(b).battery && a.safety == b.safety &&
         a.log == b.log;
}

}  // namespace internal

void calibrate_flow(FlightSetup& setup) {
  const Sensors& sensors = flown_vehicle(setup).sensors;
  if (!sensors.flow) return;
  const auto of_image = [](double half_field) { return 1 + std::pow(std::tan(half_field), 2) / 3; };
  MamboEstimatorSettings<double>& estimator = setup.mambo_estimator;
  estimator.flow_scale = setup.real_sensors ? 1 / sensors.flow->faults.scale.head<2>().mean() : 1;
  estimator.flow_compensation_x = of_image(sensors.flow->half_field_x);
  estimator.flow_compensation_y = of_image(sensors.flow->half_field_y);
  estimator.gyro_lag = 0;
  estimator.aligned_periods = 0;
  if (!setup.real_sensors || !sensors.gyroscope) return;
  const SensorFaults& gyro = *sensors.gyroscope;
  const double dt = control_period(setup), flow_delay = sensors.flow->faults.delay;
  // A second-order response delays signals that are slower than it by 2 ζ/ω.
  const double response =
      gyro.natural_frequency > 0 ? 2 * gyro.damping / gyro.natural_frequency : 0;
  // An image that would have to wait longer than flows are stored is used when it leaves the
  // buffer.
  estimator.gyro_lag = std::min(gyro.delay + response, flow_delay + (kMaxAlignedPeriods - 2) * dt);
  estimator.aligned_periods = flow_alignment_periods(estimator.gyro_lag, flow_delay, dt);
}

void validate(const FlightSetup& setup) {
  const double dt = control_period(setup);
  if (!(dt >= kMinControlPeriod && dt <= kMaxControlPeriod))
    throw InvalidInput("flight", fmt::format("dt is {} s, expected a control period of {} to {} s",
                                             dt, kMinControlPeriod, kMaxControlPeriod));
  if (!(setup.step > 0 && dt / setup.step <= 1e6) || !std::isfinite(setup.step))
    throw InvalidInput("flight", fmt::format("the step is {} s, expected more than 0 and at least "
                                             "a millionth of the control period, {} s",
                                             setup.step, dt));
  const double duration = duration_of(setup);
  if (!(duration > 0 && duration / dt <= 1e8))
    throw InvalidInput("flight", fmt::format("the duration is {} s, expected more than 0 and at "
                                             "most 1e8 control periods",
                                             duration));
  if (setup.flow_rate != 0 && !(setup.flow_rate > 0 && setup.flow_rate <= 10000))
    throw InvalidInput(
        "flight", fmt::format("the flow rate is {} Hz, expected 0 to 10000 Hz", setup.flow_rate));
  require_motors(setup.mission, static_cast<int>(setup.vehicle.rotors.size()), "flight");
  if (setup.flown && setup.flown->rotors.size() != setup.vehicle.rotors.size())
    throw InvalidInput(
        "flight", fmt::format("the true vehicle has {} rotors and the vehicle model {}, expected "
                              "equal numbers",
                              setup.flown->rotors.size(), setup.vehicle.rotors.size()));
  require_possible(setup.mission.events, flown_vehicle(setup),
                   "mission '" + setup.mission.name + "'");
  const MotorCommand& motor = flown_vehicle(setup).motor;
  if (!(motor.delay >= 0) || !(motor.delay_jitter >= 0) ||
      !(motor.delay + motor.delay_jitter <= kMaxDelayPeriods * dt * (1 + 1e-9)))
    throw InvalidInput("flight",
                       fmt::format("the command delay is {} s and its jitter {} s, "
                                   "expected a sum of 0 to {} control periods of {} s",
                                   motor.delay, motor.delay_jitter, kMaxDelayPeriods, dt));
  (void)dryden_numbers(setup.environment.wind);
  // These settings are computed again in the thread of the flight; report mistakes before that.
  validate(setup.mission, "mission '" + setup.mission.name + "'");
  (void)RigidBody(setup.vehicle);
  (void)RigidBody(flown_vehicle(setup));
  (void)allocation(setup.vehicle);
  if (setup.estimator == EstimatorKind::general)
    validate(general_filter_settings(setup), "estimator general");
  if (setup.estimator == EstimatorKind::own && !setup.own_estimator.make)
    throw InvalidInput("flight",
                       "own_estimator.make is empty, expected a function that creates the "
                       "estimator");
  if (const auto* own = std::get_if<OwnController>(&setup.controller)) {
    if (!own->make)
      throw InvalidInput("flight", fmt::format("make of the law '{}' is empty, expected a function "
                                               "that creates the law",
                                               own->name));
  } else if (const auto* cascade = std::get_if<CascadeController>(&setup.controller)) {
    (void)cascaded_pid_settings(setup.vehicle, cascade->gains, cascade->method,
                                cascade->attitude_limit, cascade->integrator_limit,
                                cascade->back_calculation);
  } else {
    const auto& feedback = std::get<StateFeedbackController>(setup.controller);
    (void)state_feedback_settings(setup.vehicle, feedback.gains, feedback.dt, feedback.guards);
    if (feedback.schedule) {
      const ScheduledFeedback scheduled(setup.vehicle, feedback.schedule, feedback.dt);
      const Gains hover = hover_gains(*feedback.schedule);
      const auto kind = [](const Gains& g) {
        return std::tuple(g.convention, g.input_kind, names(g.states), names(g.inputs),
                          names(g.integrals));
      };
      if (kind(hover) != kind(feedback.gains))
        throw InvalidInput("flight",
                           "the gains and their schedule have different states, inputs, integrals "
                           "or conventions, expected equal ones, as returned by hover_gains()");
    }
  }
}

FlightResult fly(const FlightSetup& setup, const std::function<bool()>& interrupted) {
  validate(setup);
  return std::move(fly_lanes<1>({&setup}, interrupted)[0]);
}

std::vector<FlightResult> fly_all(std::span<const FlightSetup> setups, std::size_t threads,
                                  const std::function<bool()>& interrupted) {
  for (std::size_t i = 0; i < setups.size(); ++i) {
    try {
      validate(setups[i]);
    } catch (const InvalidInput& error) {
      throw InvalidInput(fmt::format("flight {}", i), error.what());
    }
  }
  // Divide the flights into packs. The division does not depend on the number of threads.
  std::vector<std::size_t> begins;
  for (std::size_t begin = 0; begin < setups.size();) {
    begins.push_back(begin);
    std::size_t end = begin + 1;
    while (end < setups.size() && end < begin + kLanes && has_pack(setups[begin]) &&
           internal::same_structure(setups[begin], setups[end]))
      ++end;
    begin = end;
  }
  begins.push_back(setups.size());
  std::vector<FlightResult> results(setups.size());
  const auto fly_run = [&](std::size_t part) {
    const std::size_t begin = begins[part], end = begins[part + 1];
    if (end - begin == 1) {
      results[begin] = std::move(fly_lanes<1>({&setups[begin]}, interrupted)[0]);
      return;
    }
    // Unused lanes repeat the first flight.
    std::array<const FlightSetup*, kLanes> lanes;
    lanes.fill(&setups[begin]);
    for (std::size_t i = begin; i < end; ++i) lanes[i - begin] = &setups[i];
    auto together = fly_lanes<kLanes>(lanes, interrupted);
    for (std::size_t i = begin; i < end; ++i) results[i] = std::move(together[i - begin]);
  };
  internal::in_parallel(
      begins.size() - 1, internal::thread_count(threads), [&] { return fly_run; }, interrupted);
  return results;
}

}  // namespace quadtune
