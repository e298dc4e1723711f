// SPDX-License-Identifier: Apache-2.0
/// From setups to a loop that can be flown: numbers that differ from flight to flight into lanes.
#pragma once

#include "quadtune/simulation/packed_body.hpp"
#include "simulation/loop/closed_loop.hpp"
#include "simulation/loop/closed_loop_upsets.hpp"

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
  P reach = 0;  // the feet stand where the rotors are
  for (std::size_t i = 0; i < static_cast<std::size_t>(body.rotor_count); ++i) {
    const Vector3<P>& hub = body.rotors[i].position;
    reach = greater(reach, greater(magnitude(hub(0)), magnitude(hub(1))));
  }
  plant_ = PlantOf(body, ground_contact(body.mass, lesser(body.J(0, 0), body.J(1, 1)), reach));
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
    sonar_least_ = number([](const Sensors& s) { return s.sonar->least_range; });
    sonar_greatest_ = number([](const Sensors& s) { return s.sonar->greatest_range; });
    sonar_cosine_ = number([](const Sensors& s) { return std::cos(s.sonar->greatest_tilt); });
  }
  if (first.flow) {
    flow_.emplace(faults([](const Sensors& s) { return s.flow->faults; }), kFlowStream);
    const auto square_of_tangent = [](double angle) { return std::tan(angle) * std::tan(angle); };
    flow_a2_ = number([&](const Sensors& s) { return square_of_tangent(s.flow->half_field_x); });
    flow_b2_ = number([&](const Sensors& s) { return square_of_tangent(s.flow->half_field_y); });
    flow_least_height_ = number([](const Sensors& s) { return s.flow->least_height; });
    flow_greatest_height_ = number([](const Sensors& s) { return s.flow->greatest_height; });
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
  // Several laws of one structure, number by number.
  if (std::holds_alternative<CascadeController>(common_.controller)) {
    const auto settings = each<CascadedPidSettings<double>>(setups_, [](const FlightSetup& s) {
      const auto& c = std::get<CascadeController>(s.controller);
      return cascaded_pid_settings(s.vehicle, c.gains, c.method, c.attitude_limit,
                                   c.integrator_limit, c.back_calculation);
    });
    const auto gather = [&](P& target, auto&& number) {
      for (int l = 0; l < N; ++l)
        set_lane(target, l, number(settings[static_cast<std::size_t>(l)]));
    };
    for (std::size_t i = 0; i < kCascadeAxes; ++i) {
      const PidSettings<double>& first = settings[0].loops[i];
      PidSettings<P>& loop = cascade_settings_.loops[i];
      loop.method = first.method;
      loop.derivative = first.derivative;
      using Number = double PidSettings<double>::*;
      using Packed = P PidSettings<P>::*;
      const std::pair<Packed, Number> numbers[] = {
          {&PidSettings<P>::dt, &PidSettings<double>::dt},
          {&PidSettings<P>::Kp, &PidSettings<double>::Kp},
          {&PidSettings<P>::Ki, &PidSettings<double>::Ki},
          {&PidSettings<P>::Kd, &PidSettings<double>::Kd},
          {&PidSettings<P>::Tf, &PidSettings<double>::Tf},
          {&PidSettings<P>::b, &PidSettings<double>::b},
          {&PidSettings<P>::c, &PidSettings<double>::c},
          {&PidSettings<P>::output_min, &PidSettings<double>::output_min},
          {&PidSettings<P>::output_max, &PidSettings<double>::output_max},
          {&PidSettings<P>::integral_min, &PidSettings<double>::integral_min},
          {&PidSettings<P>::integral_max, &PidSettings<double>::integral_max},
          {&PidSettings<P>::back_calculation, &PidSettings<double>::back_calculation}};
      for (const auto& entry : numbers)
        gather(loop.*entry.first, [&](const auto& s) { return s.loops[i].*entry.second; });
    }
    gather(cascade_settings_.attitude_limit, [](const auto& s) { return s.attitude_limit; });
    gather(cascade_settings_.weight, [](const auto& s) { return s.weight; });
    gather(cascade_settings_.take_off_thrust, [](const auto& s) { return s.take_off_thrust; });
    gather(cascade_settings_.greatest_thrust, [](const auto& s) { return s.greatest_thrust; });
    const auto& controller = std::get<CascadeController>(common_.controller);
    cascade_settings_.velocity_feed_forward = controller.velocity_feed_forward;
    cascade_settings_.conditional_integration = controller.conditional_integration;
  } else if (const auto* own = std::get_if<OwnController>(&common_.controller)) {
    input_kind_ = own->input_kind;
    inputs_ = input_kind_ == InputKind::wrench ? 4 : plant_.body().rotor_count;
    for (const FlightSetup* setup : setups_) {
      const auto& controller = std::get<OwnController>(setup->controller);
      own_laws_.push_back(controller.make(setup->vehicle));
      if (!own_laws_.back())
        throw InvalidInput("law " + controller.name, "make() returned nothing, expected a law");
    }
  } else {
    const auto settings = each<StateFeedbackSettings<double>>(setups_, [](const FlightSetup& s) {
      const auto& c = std::get<StateFeedbackController>(s.controller);
      return state_feedback_settings(s.vehicle, c.gains, c.dt, c.guards);
    });
    const auto gather = [&](P& target, auto&& number) {
      for (int l = 0; l < N; ++l)
        set_lane(target, l, number(settings[static_cast<std::size_t>(l)]));
    };
    StateFeedbackSettings<P>& law = feedback_settings_;
    input_kind_ = law.input_kind = settings[0].input_kind;
    inputs_ = law.inputs = settings[0].inputs;
    law.integrals = settings[0].integrals;
    law.integrated = settings[0].integrated;
    for (int i = 0; i < law.inputs; ++i) {
      gather(law.u0(i), [&](const auto& s) { return s.u0(i); });
      for (int j = 0; j < 12; ++j) gather(law.K(i, j), [&](const auto& s) { return s.K(i, j); });
      for (int j = 0; j < law.integrals; ++j)
        gather(law.K_int(i, j), [&](const auto& s) { return s.K_int(i, j); });
    }
    for (int j = 0; j < 12; ++j) gather(law.x0(j), [&](const auto& s) { return s.x0(j); });
    law.axes = settings[0].axes;
    law.conditional_integration = settings[0].conditional_integration;
    gather(law.position_error_limit, [](const auto& s) { return s.position_error_limit; });
    law.remembers = settings[0].remembers;
    law.past = settings[0].past;
    law.K_past.resize(kMaxRotors, settings[0].K_past.cols());
    for (int i = 0; i < law.inputs; ++i) {
      gather(law.lag_share(i), [&](const auto& s) { return s.lag_share(i); });
      for (int j = 0; j < law.inputs; ++j)
        gather(law.K_lag(i, j), [&](const auto& s) { return s.K_lag(i, j); });
      for (Eigen::Index j = 0; j < law.K_past.cols(); ++j)
        gather(law.K_past(i, j), [&](const auto& s) { return s.K_past(i, j); });
    }
    for (std::size_t j = 0; j < static_cast<std::size_t>(law.integrals); ++j) {
      gather(law.guards[j].dt, [&](const auto& s) { return s.guards[j].dt; });
      gather(law.guards[j].error_limit, [&](const auto& s) { return s.guards[j].error_limit; });
      gather(law.guards[j].increment_limit,
             [&](const auto& s) { return s.guards[j].increment_limit; });
      gather(law.guards[j].integral_limit,
             [&](const auto& s) { return s.guards[j].integral_limit; });
    }
    for (const FlightSetup* setup : setups_) {
      const auto& c = std::get<StateFeedbackController>(setup->controller);
      if (c.schedule) schedules_.emplace_back(setup->vehicle, c.schedule, c.dt);
    }
  }
  const auto allocations =
      each<Allocation<double>>(setups_, [](const FlightSetup& s) { return allocation(s.vehicle); });
  const auto gather = [&](P& target, auto&& number) {
    for (int l = 0; l < N; ++l)
      set_lane(target, l, number(allocations[static_cast<std::size_t>(l)]));
  };
  allocation_.rotors = allocations[0].rotors;
  allocation_.thrust0.setZero(allocation_.rotors);
  for (int i = 0; i < allocation_.rotors; ++i) {
    const auto k = static_cast<std::size_t>(i);
    gather(allocation_.thrust0(i), [&](const auto& a) { return a.thrust0(i); });
    gather(allocation_.a2[k], [&](const auto& a) { return a.a2[k]; });
    gather(allocation_.a1[k], [&](const auto& a) { return a.a1[k]; });
    for (int j = 0; j < 4; ++j) {
      gather(allocation_.P(i, j), [&](const auto& a) { return a.P(i, j); });
      gather(allocation_.M(j, i), [&](const auto& a) { return a.M(j, i); });
    }
  }
  const auto limits = each<ThrustLimits<double>>(
      setups_, [](const FlightSetup& s) { return thrust_limits(s.vehicle); });
  const auto limit = [&](P& target, auto&& number) {
    for (int l = 0; l < N; ++l) set_lane(target, l, number(limits[static_cast<std::size_t>(l)]));
  };
  for (std::size_t k = 0; k < static_cast<std::size_t>(allocation_.rotors); ++k) {
    limit(limits_.least[k], [&](const auto& of) { return of.least[k]; });
    limit(limits_.greatest[k], [&](const auto& of) { return of.greatest[k]; });
  }
  limit(limits_.floor, [](const auto& of) { return of.floor; });
  for (int j = 0; j < 4; ++j)
    gather(allocation_.wrench0(j), [&](const auto& a) { return a.wrench0(j); });
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
      // At rest on its feet.
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
