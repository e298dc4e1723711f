// SPDX-License-Identifier: Apache-2.0
/// A simulated flight: vehicle, mission, law, estimator, sensors and weather in; what happened out.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "quadtune/cascade.hpp"
#include "quadtune/control/limited_allocation.hpp"
#include "quadtune/control/state_feedback_law.hpp"
#include "quadtune/estimation/general_filter_settings.hpp"
#include "quadtune/estimation/mambo_estimator.hpp"
#include "quadtune/estimation/uquad_filter.hpp"
#include "quadtune/gains.hpp"
#include "quadtune/logs/log_table.hpp"
#include "quadtune/model/environment.hpp"
#include "quadtune/model/vehicle.hpp"
#include "quadtune/simulation/flight_estimator.hpp"
#include "quadtune/simulation/flight_law.hpp"
#include "quadtune/simulation/integrators.hpp"
#include "quadtune/simulation/mission.hpp"

namespace quadtune {

struct GainSchedule;

/// The cascade of PID loops with its limits.
struct CascadeController {
  CascadeGains gains;
  PidMethod method = PidMethod::forward_euler;  ///< of the integrals
  double attitude_limit = 3;                    ///< of the references [rad]
  double integrator_limit = 2;                  ///< of |∫error| [error · s]
  double back_calculation = 0.001;              ///< [1/s]
  bool velocity_feed_forward = false;           ///< CascadedPidSettings::velocity_feed_forward
  bool conditional_integration = false;         ///< CascadedPidSettings::conditional_integration
};

/// State feedback, sampled at `dt`.
struct StateFeedbackController {
  Gains gains;
  double dt = 0;  ///< control period [s], > 0; that of the gains if they have one
  std::vector<IntegralGuard> guards;  ///< by state; none: the integral is not limited
  /// Where there is one, ScheduledFeedback takes K, K_int, x0 and u0 from it in every period;
  /// `gains` are those with which the flight begins and by which its loop is judged.
  std::shared_ptr<const GainSchedule> schedule = nullptr;
};

using Controller = std::variant<CascadeController, StateFeedbackController, OwnController>;

/// Where the law takes the state from.
enum class EstimatorKind {
  mambo,    ///< MamboEstimatorSettings
  uquad,    ///< UquadFilterSettings
  general,  ///< GeneralFilterSettings, made from the vehicle's sensors
  truth,    ///< the true state, to see what estimation costs
  own,      ///< FlightSetup::own_estimator
};
/// "mambo", "uquad", "general", "truth", and back; "own", which is not read back.
[[nodiscard]] std::string to_string(EstimatorKind kind);
[[nodiscard]] EstimatorKind estimator_kind(const std::string& name, const std::string& where);

/// What the optical flow sensor shows.
enum class FlowModel {
  full,        ///< the motion field averaged over the image
  simplified,  ///< the model package's own formula
  off,         ///< no sensor
};
/// "full", "simplified", "off", and back.
[[nodiscard]] std::string to_string(FlowModel model);
[[nodiscard]] FlowModel flow_model(const std::string& name, const std::string& where);

/// When a flight program gives up. Each stops the motors; the flight has failed.
struct SafetyLimits {
  double tilt = 1.2;             ///< of the believed attitude [rad]
  double collision = 60;         ///< of the accelerometer's reading [m/s²]
  double flow_lost_time = 1;     ///< without optical flow, where the estimator needs it [s]
  double disagreement_time = 1;  ///< of optical flow and estimated velocity [s]

  friend bool operator==(const SafetyLimits&, const SafetyLimits&) = default;
};

/// Everything that decides a flight: two flights of one setup have the same bytes, if laws and
/// estimators of the user's own keep to what they are given.
struct FlightSetup {
  Vehicle vehicle;               ///< as law and estimator believe it to be
  std::optional<Vehicle> flown;  ///< as it truly is, with its sensors; none: as believed
  Mission mission;
  Controller controller;
  AllocationRule allocation = AllocationRule::clipped;  ///< of commands beyond the motors
  EstimatorKind estimator = EstimatorKind::mambo;
  MamboEstimatorSettings<double> mambo_estimator;  ///< dt and gravity are set by fly()
  UquadFilterSettings<double> uquad_filter;        ///< likewise
  GeneralFilterNoise general_noise;  ///< what the general filter assumes beyond the sensors' file
  /// Numbers of the general filter in place of those that follow from the sensors' file. Its dt and
  /// start are set by fly(). Only with real_sensors.
  std::optional<GeneralFilterSettings> general_filter;
  OwnEstimator own_estimator;  ///< of EstimatorKind::own
  bool real_sensors = true;    ///< false: they say what is true, at the vehicle's rates, at once
  FlowModel flow = FlowModel::full;
  double flow_rate = 0;  ///< [Hz]; 0: the vehicle's
  Environment environment;
  SafetyLimits safety;
  Integrator integrator = Integrator::bogacki_shampine_3;
  double step = 0.005;     ///< longest of the integrator [s]; the control period has a whole number
  double duration = 0;     ///< [s]; 0: the mission's
  std::uint64_t seed = 1;  ///< of everything random
  std::uint32_t flight = 0;  ///< which of the flights with that seed
  bool log = false;          ///< whether to keep FlightResult::log
};

/// The true vehicle of a setup.
[[nodiscard]] inline const Vehicle& flown_vehicle(const FlightSetup& setup) {
  return setup.flown ? *setup.flown : setup.vehicle;
}
/// The sensors that a setup flies with: its true vehicle's, made ideal or cut down as it says.
[[nodiscard]] Sensors sensors_of(const FlightSetup& setup);

/// The control period of a setup's law, and how long it flies [s].
[[nodiscard]] double control_period(const FlightSetup& setup);
[[nodiscard]] double duration_of(const FlightSetup& setup);

/// Settings of the general filter for a setup: the sensors of the vehicle as it is believed, the
/// control period of its law, and start deviations for a start on the ground or in the air.
/// @throws InvalidInput  if its sensors cannot feed the filter; the message names what is missing
[[nodiscard]] GeneralFilterSettings general_filter_settings(const FlightSetup& setup);

/// How a flight ended.
enum class FlightEnd {
  completed,    ///< the mission's time was flown
  safety_exit,  ///< the flight program gave up; the last event says why
  diverged,     ///< a state left every range that means anything
};
/// "completed", "safety exit", "diverged".
[[nodiscard]] std::string to_string(FlightEnd end);

/// What happened.
struct FlightResult {
  FlightEnd end = FlightEnd::completed;
  double end_time = 0;  ///< [s]
  /// Of a flight that diverged: the state at fault. Of a safety exit by a law or an estimator of
  /// the user's own: which, and the entry at fault. Otherwise empty.
  std::string culprit;
  MetricValues metrics;
  std::vector<LogEvent> events;
  StateVector<double> final_state = StateVector<double>::Zero();     ///< true
  StateVector<double> final_estimate = StateVector<double>::Zero();  ///< believed
  std::uint64_t steps = 0;                                           ///< of the integrator
  LogTable log;  ///< a row each control period; empty unless asked for
};

/// Makes the Mambo's estimator right for the optical flow that flies: the sensor's scale undone,
/// the body's own turning taken out of the image, that of the image's own instant where the
/// gyroscope or the image is late. The law, whose period counts, comes first. Without optical flow
/// it changes nothing.
void calibrate_flow(FlightSetup& setup);

/// Checks that a setup can be flown.
/// @throws InvalidInput  naming the part and what is wrong.
void validate(const FlightSetup& setup);

/// One flight.
/// @param interrupted  asked now and then; true ends the flight with Interrupted
/// @throws InvalidInput  as validate()
[[nodiscard]] FlightResult fly(const FlightSetup& setup,
                               const std::function<bool()>& interrupted = {});

/// Many flights, several at once in one processor's vectors where they differ in numbers only. Each
/// result has the bytes that fly() gives.
/// @param threads      to use, 0: one for each processor; the result does not depend on it
/// @param interrupted  asked now and then; true ends the work with Interrupted
/// @throws InvalidInput  as validate(), saying which flight
[[nodiscard]] std::vector<FlightResult> fly_all(std::span<const FlightSetup> setups,
                                                std::size_t threads = 0,
                                                const std::function<bool()>& interrupted = {});

}  // namespace quadtune
