// SPDX-License-Identifier: Apache-2.0
/// Vehicle, sensors, estimator, law and motors in one loop, for N simultaneous flights that differ
/// in numbers only. Constructed in closed_loop_making.hpp, simulated in closed_loop_flying.hpp.
#pragma once

#include <fmt/format.h>

#include <array>
#include <memory>
#include <optional>
#include <vector>

#include "quadtune/control/allocation.hpp"
#include "quadtune/control/cascaded_pid.hpp"
#include "quadtune/control/limited_allocation.hpp"
#include "quadtune/control/scheduled_feedback.hpp"
#include "quadtune/control/state_feedback_law.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/simulation/air.hpp"
#include "quadtune/simulation/carried_motion.hpp"
#include "quadtune/simulation/flight.hpp"
#include "quadtune/simulation/flight_metrics.hpp"
#include "quadtune/simulation/mission_runner.hpp"
#include "quadtune/simulation/plant.hpp"
#include "quadtune/simulation/sensor_channel.hpp"
#include "simulation/flight_recorder.hpp"
#include "simulation/loop/closed_loop_parts.hpp"
#include "simulation/loop/command_delay.hpp"
#include "simulation/loop/estimator_slot.hpp"
#include "simulation/loop/motor_stage.hpp"
#include "simulation/loop/packed_laws.hpp"
#include "simulation/loop/rotor_vibration.hpp"

namespace quadtune::internal {

/// Streams of random numbers, four per sensor.
enum Stream : std::uint32_t {
  kAccelerometerStream = 0,
  kGyroscopeStream = 4,
  kMagnetometerStream = 8,
  kBarometerStream = 12,
  kSonarStream = 16,
  kFlowStream = 20,
  kGpsPositionStream = 24,
  kGpsVelocityStream = 28,
  kWindStream = 32,
  kVisionStream = 48,
  kCommandStream = 64,
  kVibrationStream = 80,  ///< one per rotor
};

/// @tparam R  as Plant's N
template <int N, int R>
class ClosedLoop {
 public:
  using P = Pack<N>;
  using PlantOf = Plant<P, R>;
  using State = typename PlantOf::State;
  using Lanes = std::array<const FlightSetup*, N>;
  using Inputs = Eigen::Matrix<P, kMaxRotors, 1>;  ///< of a law, in its InputKind

  explicit ClosedLoop(const Lanes& setups);

  void run(const std::function<bool()>& interrupted);
  [[nodiscard]] FlightResult result(int of_lane);

 private:
  template <class Function>
  [[nodiscard]] static P pack(const Lanes& setups, Function&& number) {
    P result = 0;
    for (int l = 0; l < N; ++l) set_lane(result, l, number(*setups[static_cast<std::size_t>(l)]));
    return result;
  }
  template <class Value, class Function>
  [[nodiscard]] static std::array<Value, N> each(const Lanes& setups, Function&& value) {
    std::array<Value, N> result;
    for (std::size_t l = 0; l < N; ++l) result[l] = value(*setups[l]);
    return result;
  }

  void make_plant();
  void make_sensors();
  void make_law();
  void make_upsets();
  void start();

  void happen(double t);
  void set_environment(std::uint64_t index, double t);
  void carry(double t);
  [[nodiscard]] State truth_at(double instant, double now) const;
  [[nodiscard]] State true_state(double instant, double now) const;
  [[nodiscard]] static Matrix3<P> rotation_of(const State& x) {
    return rotation_of_quaternion(x(3), x(4), x(5), x(6));
  }
  void sense(double now);
  void sense_inertial(double now);
  void sense_field_and_pressure(double now);
  void sense_ground(double now);
  void sense_position(double now);
  void estimate(double t);
  void refer(double t);
  void command(std::uint64_t index, double t);
  void command_by_cascade();
  void command_by_inputs(double t);
  [[nodiscard]] Inputs feedback_inputs();
  [[nodiscard]] Inputs own_inputs(double t);
  void make_speeds(const Inputs& u);
  [[nodiscard]] Mask<N> make_feasible();
  void report_to_law(const Inputs& asked, const Inputs& made);
  void follow_schedule(Reference<P>& reference);
  [[nodiscard]] Inputs inputs_of_speeds() const;
  [[nodiscard]] RotorSpeeds<P> model_thrusts() const;
  void watch(double t);
  void tell(RotorSpeeds<P> speeds);
  void advance(std::uint64_t index, double t);
  void advance_late(std::uint64_t index, double t);
  void check_divergence(double t);
  void end_flight(const Mask<N>& lanes, double t, FlightEnd end, const char* name,
                  const std::string& detail);
  void keep_final(int l);
  [[nodiscard]] StateVector<P> euler_state_now() const;

  Lanes setups_;
  const FlightSetup& common_;  ///< the first lane, for everything that is equal in all lanes
  double dt_;
  int substeps_;
  RandomSource<N> source_;
  PlantOf plant_;
  State x_, x_before_, slope_before_;
  bool between_ = false;  ///< whether x_before_ and slope_before_ are those of the previous period

  /// A part of the last control period during which the command is constant.
  struct Piece {
    double begin = 0, end = 0;  ///< [s]
    RotorSpeeds<P> speeds;
    State x, slope, x_end, slope_end;
  };
  [[nodiscard]] const Piece& piece_at(double instant) const;
  [[nodiscard]] Vector3<P> felt_at(double instant, const State& x);
  [[nodiscard]] Vector3<P> shake_at(const RotorVibration<N>& shake, double instant, double now,
                                    const State& x) const;
  CommandDelay<N> late_;
  std::vector<Piece> pieces_;  ///< of the last control period; empty if commands have no delay
  std::size_t next_event_ = 0;
  std::vector<int> stopped_;  ///< failed motors, numbered from 0
  RotorPhases<N> phases_;
  RotorVibration<N> accelerometer_shake_, gyroscope_shake_;
  Vector3<P> g_sensitivity_ = Vector3<P>::Zero();
  bool g_sensitive_ = false;

  std::optional<CarriedMotion> carried_;
  Motion motion_;

  WindModel<N> wind_;
  Vector3<P> field_;
  P ground_height_ = 0;
  std::array<Atmosphere, N> atmospheres_;

  std::optional<SensorChannel<N, 3>> accelerometer_, gyroscope_, magnetometer_, gps_position_,
      gps_velocity_, vision_;
  std::optional<SensorChannel<N, 1>> barometer_, sonar_;
  std::optional<SensorChannel<N, 2>> flow_;
  std::array<Sensors, N> sensors_;
  P sonar_min_, sonar_max_, sonar_cosine_, ground_pressure_, pressure_fall_;
  bool linear_pressure_ = false;
  P flow_a2_, flow_b2_, flow_min_height_, flow_max_height_, flow_growth_, flow_gain_;
  bool flow_grows_ = false;  ///< whether its noise increases with height
  SensorFrame<P> frame_;

  std::optional<EstimatorSlot<N>> estimator_;
  Estimate<P> estimate_;

  /// One for all lanes, or one per lane if they depend on the estimate
  std::vector<MissionRunner> runners_;
  std::array<Reference<double>, N> references_;
  Reference<P> reference_;

  CascadedPidSettings<P> cascade_settings_;
  CascadedPidState<P> cascade_;
  StateFeedbackSettings<P> feedback_settings_;
  StateFeedbackState<P> feedback_;
  std::vector<ScheduledFeedback> schedules_;          ///< one per lane, or empty
  std::vector<std::unique_ptr<FlightLaw>> own_laws_;  ///< one per lane, or empty
  InputKind input_kind_ = InputKind::wrench;          ///< of a state feedback or a user-defined law
  int inputs_ = 4;                                    ///< their number
  Allocation<P> allocation_;
  ThrustLimits<P> limits_;
  MotorStage<N> motors_;
  RotorSpeeds<P> speeds_;                                           ///< commanded [rad/s]
  Eigen::Matrix<P, 4, 1> wrench_ = Eigen::Matrix<P, 4, 1>::Zero();  ///< requested by the law
  /// Corresponding to the commanded speeds
  Eigen::Matrix<P, 4, 1> made_ = Eigen::Matrix<P, 4, 1>::Zero();
  Mask<N> saturated_, off_;
  std::optional<Battery> battery_;
  BatteryState<P> charge_;
  P power_ = 0;

  P flow_lost_time_ = 0, disagreement_time_ = 0;
  Mask<N> alive_{true};
  std::array<FlightResult, N> results_;
  FlightMetrics<P> metrics_;
  std::vector<FlightRecorder> recorders_;  ///< one per logged lane, otherwise empty
  std::array<MissionEvent, N> last_event_{};
};

}  // namespace quadtune::internal
