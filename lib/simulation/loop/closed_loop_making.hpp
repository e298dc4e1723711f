// SPDX-License-Identifier: Apache-2.0
/// Constructs a loop from setups: numbers that differ between the flights become lanes.
#pragma once

#include "quadtune/simulation/packed_body.hpp"
#include "simulation/loop/closed_loop.hpp"
#include "simulation/loop/closed_loop_upsets.hpp"
#include "simulation/loop/packed_laws.hpp"

namespace quadtune::internal {

template <int N, int R>
ClosedLoop<N, R>::ClosedLoop(const Lanes& setups)
    : setups_(setups),
      common_(*setups[0]),
      dt_(control_period(common_)),
      substeps_(std::max(1, static_cast<int>(std::ceil(dt_ / common_.step - 1e-9)))),
      metrics_(common_.mission.settling) {
  source_.seed = common_.seed;
  for (std::size_t l = 0; l < N; ++l) source_.flight[l] = setups[l]->flight;
  make_plant();
  make_sensors();
  make_law();
  make_upsets();
  start();
}

template <int N, int R>
void ClosedLoop<N, R>::make_plant() {
  const BasicRigidBody<P> body = packed_body<N>(
      each<RigidBody>(setups_, [](const FlightSetup& s) { return RigidBody(flown_vehicle(s)); }));
  P reach = 0;  // the feet are below the rotors
  for (std::size_t i = 0; i < static_cast<std::size_t>(body.rotor_count); ++i) {
    const Vector3<P>& hub = body.rotors[i].position;
    reach = max_of(reach, max_of(abs_of(hub(0)), abs_of(hub(1))));
  }
  plant_ = PlantOf(body, ground_contact(body.mass, min_of(body.J(0, 0), body.J(1, 1)), reach));
  motors_ = MotorStage<N>(
      each<const Vehicle*>(setups_, [](const FlightSetup& s) { return &flown_vehicle(s); }));
  battery_ = flown_vehicle(common_).battery;
  if (battery_) charge_ = full_battery<P>(*battery_);
  wind_ = WindModel<N>(each<Wind>(setups_, [](const FlightSetup& s) { return s.environment.wind; }),
                       dt_, kWindStream);
  plant_.windy = wind_.windy();
  for (int i = 0; i < 3; ++i)
    field_(i) =
        pack(setups_, [&](const FlightSetup& s) { return s.environment.magnetic_field(i); });
  ground_height_ = pack(setups_, [](const FlightSetup& s) { return s.environment.ground_height; });
  for (std::size_t l = 0; l < N; ++l) {
    atmospheres_[l].model =
        common_.environment.dynamic ? AtmosphereModel::standard : AtmosphereModel::still;
    atmospheres_[l].ground_height = setups_[l]->environment.ground_height;
  }
  if (const auto* carried = std::get_if<Carried>(&common_.mission.kind)) carried_.emplace(*carried);
}

template <int N, int R>
void ClosedLoop<N, R>::make_sensors() {
  sensors_ = each<Sensors>(setups_, [](const FlightSetup& s) { return sensors_of(s); });
  const Sensors& first = sensors_[0];
  const auto faults = [&](auto&& member) {
    std::array<SensorFaults, N> result;
    for (std::size_t l = 0; l < N; ++l) result[l] = member(sensors_[l]);
    return result;
  };
  const auto number = [&](auto&& member) {
    P result = 0;
    for (int l = 0; l < N; ++l) set_lane(result, l, member(sensors_[static_cast<std::size_t>(l)]));
    return result;
  };
  if (first.accelerometer)
    accelerometer_.emplace(faults([](const Sensors& s) { return *s.accelerometer; }),
                           kAccelerometerStream);
  if (first.gyroscope)
    gyroscope_.emplace(faults([](const Sensors& s) { return *s.gyroscope; }), kGyroscopeStream);
  if (first.magnetometer)
    magnetometer_.emplace(faults([](const Sensors& s) { return *s.magnetometer; }),
                          kMagnetometerStream);
  if (first.barometer) {
    barometer_.emplace(faults([](const Sensors& s) { return s.barometer->faults; }),
                       kBarometerStream);
    ground_pressure_ = number([](const Sensors& s) { return s.barometer->ground_pressure; });
    pressure_fall_ = number([](const Sensors& s) { return s.barometer->fall; });
    linear_pressure_ = std::isfinite(first.barometer->fall);
  }
  if (first.sonar) {
    sonar_.emplace(faults([](const Sensors& s) { return s.sonar->faults; }), kSonarStream);
    sonar_min_ = number([](const Sensors& s) { return s.sonar->min_range; });
    sonar_max_ = number([](const Sensors& s) { return s.sonar->max_range; });
    sonar_cosine_ = number([](const Sensors& s) { return std::cos(s.sonar->max_tilt); });
  }
  if (first.flow) {
    flow_.emplace(faults([](const Sensors& s) { return s.flow->faults; }), kFlowStream);
    const auto square_of_tangent = [](double angle) { return std::tan(angle) * std::tan(angle); };
    flow_a2_ = number([&](const Sensors& s) { return square_of_tangent(s.flow->half_field_x); });
    flow_b2_ = number([&](const Sensors& s) { return square_of_tangent(s.flow->half_field_y); });
    flow_min_height_ = number([](const Sensors& s) { return s.flow->min_height; });
    flow_max_height_ = number([](const Sensors& s) { return s.flow->max_height; });
    flow_growth_ = number([](const Sensors& s) { return s.flow->noise_per_height; });
    flow_grows_ = any(flow_growth_ > P(0));
    flow_gain_ = number([](const Sensors& s) { return s.flow->simplified_rate_gain; });
  }
  if (first.gps) {
    gps_position_.emplace(faults([](const Sensors& s) { return s.gps->position; }),
                          kGpsPositionStream);
    gps_velocity_.emplace(faults([](const Sensors& s) {
                            SensorFaults velocity;
                            velocity.rate = s.gps->position.rate;
                            velocity.delay = s.gps->position.delay;
                            velocity.dropout = s.gps->position.dropout;
                            velocity.noise = s.gps->velocity_noise;
                            return velocity;
                          }),
                          kGpsVelocityStream);
  }
  if (first.vision)
    vision_.emplace(faults([](const Sensors& s) { return *s.vision; }), kVisionStream);
}

template <int N, int R>
void ClosedLoop<N, R>::make_law() {
  if (std::holds_alternative<CascadeController>(common_.controller)) {
    cascade_settings_ = packed_cascade<N>(setups_);
  } else if (const auto* own = std::get_if<OwnController>(&common_.controller)) {
    input_kind_ = own->input_kind;
    inputs_ = input_kind_ == InputKind::wrench ? 4 : plant_.body().rotor_count;
    for (const FlightSetup* setup : setups_) {
      const auto& controller = std::get<OwnController>(setup->controller);
      own_laws_.push_back(controller.make(setup->vehicle));
      if (!own_laws_.back())
        throw InvalidInput("law " + controller.name, "make() returned null, expected a law");
    }
  } else {
    feedback_settings_ = packed_feedback<N>(setups_);
    input_kind_ = feedback_settings_.input_kind;
    inputs_ = feedback_settings_.inputs;
    for (const FlightSetup* setup : setups_) {
      const auto& c = std::get<StateFeedbackController>(setup->controller);
      if (c.schedule) schedules_.emplace_back(setup->vehicle, c.schedule, c.dt);
    }
  }
  allocation_ = packed_allocation<N>(setups_);
  limits_ = packed_limits<N>(setups_, allocation_.rotors);
}

template <int N, int R>
void ClosedLoop<N, R>::start() {
  const Mission& mission = common_.mission;
  runners_.assign(1, MissionRunner(mission));
  if (runners_[0].depends_on_estimate()) runners_.assign(N, runners_[0]);
  const int rotors = plant_.body().rotor_count;
  if constexpr (R == Eigen::Dynamic) x_.resize(kRotorSpeeds + rotors);
  x_.setConstant(P(0));
  speeds_ = RotorSpeeds<P>::Constant(rotors, P(0));
  if (carried_) {
    carry(0);
  } else {
    for (int i = 0; i < 3; ++i) x_(i) = P(mission.start.position(i));
    const Eigen::Quaterniond q = quaternion_of_euler(0.0, 0.0, mission.start.yaw);
    x_(3) = P(q.w());
    x_(6) = P(q.z());
    if (mission.start.in_air) {
      for (int i = 0; i < rotors; ++i)
        speeds_(i) =
            speed_for_thrust(allocation_.thrust0(i), allocation_.a2[static_cast<std::size_t>(i)],
                             allocation_.a1[static_cast<std::size_t>(i)]);
    } else {
      // Equilibrium on its feet.
      x_(2) = plant_.body().mass * plant_.body().gravity / (P(4) * plant_.ground.stiffness) -
              plant_.ground.leg_height;
    }
    plant_.command(speeds_, x_);
    if constexpr (R != 0) x_.segment(kRotorSpeeds, rotors) = speeds_;
  }
  const StateVector<P> believed = euler_state_now();
  estimator_.emplace(EstimatorSetup<N>{setups_, sensors_, dt_,
                                       mission.start.in_air || carried_.has_value(), believed});
  estimate_.x = believed;
  if (common_.log)
    for (int l = 0; l < N; ++l)
      recorders_.emplace_back(*setups_[static_cast<std::size_t>(l)],
                              sensors_[static_cast<std::size_t>(l)], rotors,
                              static_cast<std::size_t>(duration_of(common_) / dt_) + 2);
}

}  // namespace quadtune::internal
