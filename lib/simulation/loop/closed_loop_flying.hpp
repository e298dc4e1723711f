// SPDX-License-Identifier: Apache-2.0
/// The control periods of a flight. docs/theory.md, "Simulated flight", describes the order of
/// computation.
#pragma once

#include "simulation/loop/closed_loop.hpp"
#include "simulation/loop/closed_loop_sensing.hpp"

namespace quadtune::internal {

template <int N, int R>
void ClosedLoop<N, R>::run(const std::function<bool()>& interrupted) {
  const double duration = duration_of(common_);
  const auto periods = static_cast<std::uint64_t>(std::llround(std::ceil(duration / dt_ - 1e-9)));
  for (std::uint64_t k = 0; k <= periods && any(alive_); ++k) {
    const double t = static_cast<double>(k) * dt_;
    if (k % 1024 == 0 && interrupted && interrupted()) throw Interrupted();
    if (next_event_ < common_.mission.events.size()) happen(t);
    set_environment(k, t);
    if (carried_) carry(t);
    sense(t);
    estimate(t);
    refer(t);
    command(k, t);
    metrics_.add(t, dt_, euler_state_now(), estimate_, reference_, saturated_, power_, alive_,
                 off_);
    for (std::size_t l = 0; l < recorders_.size(); ++l)
      if (lane(alive_, static_cast<int>(l)))
        recorders_[l].add(t, static_cast<int>(l), x_, plant_.rotor_speeds(x_), frame_, estimate_,
                          references_[l], wrench_, made_, speeds_, charge_, plant_.wind);
    for (int l = 0; l < N; ++l)
      if (lane(alive_, l)) results_[static_cast<std::size_t>(l)].end_time = t;
    watch(t);
    if (k == periods) break;
    advance(k, t);
    check_divergence(t + dt_);
  }
}

template <int N, int R>
StateVector<Pack<N>> ClosedLoop<N, R>::euler_state_now() const {
  using std::atan2, std::sqrt;
  StateVector<P> x;
  const Matrix3<P> M = rotation_of_quaternion(x_(3), x_(4), x_(5), x_(6));
  for (int i = 0; i < 3; ++i) {
    x(kPosition + i) = x_(i);
    x(kVelocity + i) = x_(kBodyVelocity + i);
    x(kRates + i) = x_(kBodyRates + i);
  }
  x(3) = atan2(M(2, 1), M(2, 2));
  x(4) = atan2(P(-M(2, 0)), P(sqrt(M(0, 0) * M(0, 0) + M(1, 0) * M(1, 0))));
  x(5) = atan2(M(1, 0), M(0, 0));
  return x;
}

template <int N, int R>
void ClosedLoop<N, R>::set_environment(std::uint64_t index, double t) {
  if (wind_.turbulent())
    plant_.wind = wind_.at(
        index, t, source_,
        rotation_of_quaternion(x_(3), x_(4), x_(5), x_(6)) * x_.template segment<3>(kBodyVelocity));
  else if (wind_.windy())
    plant_.wind = wind_.at(index, t, source_);
  if (!common_.environment.dynamic) return;
  P air = plant_.body().air_density, ratio = plant_.body().density_ratio;
  P gravity = plant_.body().gravity;
  for (int l = 0; l < N; ++l) {
    const auto k = static_cast<std::size_t>(l);
    const Vehicle& vehicle = flown_vehicle(*setups_[k]);
    const double height = std::clamp(-lane(x_(2), l) + atmospheres_[k].ground_height,
                                     kStandardAtmosphereFloor, kStandardAtmosphereCeiling);
    if (!std::isfinite(height)) continue;
    const double density = standard_atmosphere(height).density;
    const double fall = kEarthRadius / (kEarthRadius + height);
    set_lane(air, l, density);
    set_lane(ratio, l, density / vehicle.air_density);
    set_lane(gravity, l, vehicle.gravity * fall * fall);
    for (int i = 0; i < 3; ++i)
      set_lane(field_(i), l, setups_[k]->environment.magnetic_field(i) * fall * fall * fall);
  }
  plant_.set_air(air, ratio, gravity);
}

template <int N, int R>
void ClosedLoop<N, R>::carry(double t) {
  motion_ = carried_->at(t);
  const QuaternionState<double> x = quaternion_state<double>(motion_.state());
  for (int i = 0; i < kRotorSpeeds; ++i) x_(i) = P(x(i));
}

/// The state at an instant of the period that ends now, by cubic interpolation between its ends.
template <int N, int R>
typename ClosedLoop<N, R>::State ClosedLoop<N, R>::truth_at(double instant, double now) const {
  const double s = 1 + (instant - now) / dt_;
  if (!between_ || s >= 1 - 1e-9) return x_;
  const auto between = [](double at, double length, const State& x0, const State& slope0,
                          const State& x1, const State& slope1) {
    const double s2 = at * at, s3 = s2 * at;
    State x = x0 * (2 * s3 - 3 * s2 + 1) + slope0 * ((s3 - 2 * s2 + at) * length) +
              (x1 * (3 * s2 - 2 * s3) + slope1 * ((s3 - s2) * length));
    PlantOf::restore_norm(x);
    return x;
  };
  if (!pieces_.empty()) {
    const Piece& p = piece_at(instant);
    const double length = p.end - p.begin;
    return between((instant - p.begin) / length, length, p.x, p.slope, p.x_end, p.slope_end);
  }
  return between(s, dt_, x_before_, slope_before_, x_, State(plant_.derivative(x_)));
}

template <int N, int R>
void ClosedLoop<N, R>::estimate(double t) {
  const Mask<N> stands =
      logical_or(off_, Mask<N>(reference_.phase == FlightPhase::start_up || !between_));
  const bool may_stand = !common_.mission.start.in_air && !carried_;
  StateVector<P> truth = StateVector<P>::Zero();
  if (estimator_->needs_truth()) truth = euler_state_now();
  estimate_ =
      estimator_->update({t, frame_, speeds_, logical_and(stands, Mask<N>(may_stand)), truth});
}

template <int N, int R>
void ClosedLoop<N, R>::refer(double t) {
  const auto note = [&](std::size_t l, MissionEvent event) {
    if (event == MissionEvent::none || !lane(alive_, static_cast<int>(l))) return;
    results_[l].events.push_back({t, std::string(to_string(event)), ""});
    if (event == MissionEvent::abort) {
      Mask<N> one;
      set_lane(one, static_cast<int>(l), true);
      end_flight(one, t, FlightEnd::safety_exit, nullptr, "");
    }
  };
  const bool each_lane = runners_.size() > 1;
  for (std::size_t l = 0; l < N; ++l) {
    if (l == 0 || each_lane) {
      StateVector<double> believed;
      for (int i = 0; i < 12; ++i) believed(i) = lane(estimate_.x(i), static_cast<int>(l));
      references_[l] = runners_[l].at(t, believed);
    } else {
      references_[l] = references_[0];
    }
    note(l, runners_[each_lane ? l : 0].event());
  }
  // All lanes have the same phase; only the motor stop differs from vehicle to vehicle.
  FlightPhase phase = FlightPhase::off;
  Mask<N> off;
  for (int l = 0; l < N; ++l) {
    const Reference<double>& from = references_[static_cast<std::size_t>(l)];
    if (from.phase == FlightPhase::off)
      set_lane(off, l, true);
    else
      phase = from.phase;
    for (int i = 0; i < 3; ++i) {
      set_lane(reference_.position(i), l, from.position(i));
      set_lane(reference_.velocity(i), l, from.velocity(i));
    }
    set_lane(reference_.yaw, l, from.yaw);
    set_lane(reference_.roll, l, from.roll);
    set_lane(reference_.pitch, l, from.pitch);
  }
  reference_.track_position = references_[0].track_position;
  reference_.motors = references_[0].motors;
  reference_.phase = phase;
  off_ = logical_or(off_, off);
}

/// The thrusts that correspond to the commanded speeds, by the rotor curves of the vehicle model.
template <int N, int R>
RotorSpeeds<Pack<N>> ClosedLoop<N, R>::model_thrusts() const {
  RotorSpeeds<P> thrusts(speeds_.size());
  for (Eigen::Index i = 0; i < speeds_.size(); ++i) {
    const auto k = static_cast<std::size_t>(i);
    thrusts(i) = (allocation_.a2[k] * speeds_(i) + allocation_.a1[k]) * speeds_(i);
  }
  return thrusts;
}

/// The commanded speeds, converted to the law's kind of input.
template <int N, int R>
typename ClosedLoop<N, R>::Inputs ClosedLoop<N, R>::inputs_of_speeds() const {
  Inputs inputs = Inputs::Zero();
  const Eigen::Index rotors = speeds_.size();
  switch (input_kind_) {
    case InputKind::wrench:
      inputs.template head<4>() = wrench_of_thrusts(allocation_, model_thrusts());
      break;
    case InputKind::rotor_speed:
      inputs.head(rotors) = speeds_;
      break;
    case InputKind::rotor_thrust:
      inputs.head(rotors) = model_thrusts();
      break;
    case InputKind::command:
      motors_.commands_of_speeds(speeds_, inputs);
      break;
  }
  return inputs;
}

template <int N, int R>
void ClosedLoop<N, R>::command_by_cascade() {
  wrench_ = step(cascade_settings_, cascade_, estimate_, reference_);
  made_ = wrench_;
  if (common_.allocation == AllocationRule::prioritized) {
    const LimitedWrench<P> limited = prioritized(allocation_, limits_, wrench_);
    made_ = limited.wrench;
    speeds_ = speeds_of_wrench(allocation_, made_);
    motors_.limit(speeds_, saturated_);
    saturated_ = logical_or(saturated_, limited.limited);
  } else {
    speeds_ = speeds_of_wrench(allocation_, wrench_);
    motors_.limit(speeds_, saturated_);
    if (common_.log || cascade_settings_.conditional_integration)
      made_ = clipped(allocation_, limits_, wrench_).wrench;
  }
  on_realized(cascade_settings_, cascade_, wrench_, made_);
}

/// Updates gains and trims for this period; the trim accounts for the reference velocity as far as
/// the schedule covers it.
template <int N, int R>
void ClosedLoop<N, R>::follow_schedule(Reference<P>& reference) {
  for (int l = 0; l < N; ++l) {
    const auto k = static_cast<std::size_t>(l);
    Estimate<double> estimate;
    for (int i = 0; i < 12; ++i) estimate.x(i) = lane(estimate_.x(i), l);
    StateFeedbackSettings<double> now;
    schedules_[k].set(estimate, references_[k], now);
    const Vector3<double> left =
        references_[k].velocity - schedules_[k].trim_velocity(references_[k].yaw);
    for (int i = 0; i < 3; ++i) set_lane(reference.velocity(i), l, left(i));
    StateFeedbackSettings<P>& law = feedback_settings_;
    for (int j = 0; j < 12; ++j) set_lane(law.x0(j), l, now.x0(j));
    for (int i = 0; i < law.inputs; ++i) {
      set_lane(law.u0(i), l, now.u0(i));
      for (int j = 0; j < 12; ++j) set_lane(law.K(i, j), l, now.K(i, j));
      for (int j = 0; j < law.integrals; ++j) set_lane(law.K_int(i, j), l, now.K_int(i, j));
    }
  }
}

template <int N, int R>
typename ClosedLoop<N, R>::Inputs ClosedLoop<N, R>::feedback_inputs() {
  Reference<P> reference = reference_;
  if (!schedules_.empty()) follow_schedule(reference);
  return step(feedback_settings_, feedback_, estimate_, reference);
}

/// Commands of user-defined laws; if a law fails, its lane repeats the present command.
template <int N, int R>
typename ClosedLoop<N, R>::Inputs ClosedLoop<N, R>::own_inputs(double t) {
  Inputs u = inputs_of_speeds();
  for (int l = 0; l < N; ++l) {
    const auto k = static_cast<std::size_t>(l);
    if (!lane(alive_, l)) continue;
    Estimate<double> estimate;
    for (int i = 0; i < 12; ++i) estimate.x(i) = lane(estimate_.x(i), l);
    const Eigen::VectorXd asked = own_laws_[k]->command(estimate, references_[k]);
    const std::string fault = law_fault(*setups_[k], asked, inputs_);
    if (fault.empty()) {
      for (int i = 0; i < inputs_; ++i) set_lane(u(i), l, asked(i));
      continue;
    }
    results_[k].culprit = fault;
    Mask<N> one = false;
    set_lane(one, l, true);
    end_flight(one, t, FlightEnd::safety_exit, "law", fault);
  }
  return u;
}

/// Computes the rotor speeds, before limits, and the wrench from the law's command.
template <int N, int R>
void ClosedLoop<N, R>::make_speeds(const Inputs& u) {
  switch (input_kind_) {
    case InputKind::wrench:
      wrench_ = u.template head<4>();
      if (common_.allocation == AllocationRule::clipped)
        speeds_ = speeds_of_wrench(allocation_, wrench_);
      return;
    case InputKind::rotor_speed:
      for (Eigen::Index i = 0; i < speeds_.size(); ++i) speeds_(i) = max_of(u(i), P(0));
      break;
    case InputKind::rotor_thrust:
      for (Eigen::Index i = 0; i < speeds_.size(); ++i) {
        const auto k = static_cast<std::size_t>(i);
        speeds_(i) = speed_for_thrust(u(i), allocation_.a2[k], allocation_.a1[k]);
      }
      break;
    case InputKind::command:
      motors_.speeds_of_commands(u, speeds_);
      break;
  }
  const RotorLoads<P> loads = rotor_loads(plant_.body(), speeds_);
  wrench_ << -loads.force.z(), loads.torque;
}

/// AllocationRule::prioritized: computes the nearest feasible wrench and its speeds. Returns the
/// lanes in which it differs from the law's command.
template <int N, int R>
Mask<N> ClosedLoop<N, R>::make_feasible() {
  const bool by_rotor = input_kind_ != InputKind::wrench;
  Mask<N> limited = false;
  Eigen::Matrix<P, 4, 1> asked = wrench_;
  if (by_rotor) {
    const RotorSpeeds<P> thrusts = model_thrusts();
    asked = wrench_of_thrusts(allocation_, thrusts);
    for (Eigen::Index i = 0; i < thrusts.size(); ++i) {
      const auto k = static_cast<std::size_t>(i);
      limited =
          logical_or(limited, logical_or(thrusts(i) < limits_.min[k], thrusts(i) > limits_.max[k]));
    }
  }
  const LimitedWrench<P> feasible = prioritized(allocation_, limits_, asked);
  limited = logical_or(limited, feasible.limited);
  const RotorSpeeds<P> told = speeds_of_wrench(allocation_, feasible.wrench);
  for (int i = 0; i < 4; ++i) made_(i) = select(limited, feasible.wrench(i), wrench_(i));
  for (Eigen::Index i = 0; i < speeds_.size(); ++i)
    speeds_(i) = by_rotor ? P(select(limited, told(i), speeds_(i))) : told(i);
  return limited;
}

/// Computes the command of a state feedback or a user-defined law.
template <int N, int R>
void ClosedLoop<N, R>::command_by_inputs(double t) {
  const bool clips = common_.allocation == AllocationRule::clipped;
  const Inputs u = own_laws_.empty() ? feedback_inputs() : own_inputs(t);
  make_speeds(u);
  made_ = wrench_;
  Mask<N> limited = false;
  if (common_.allocation == AllocationRule::prioritized) limited = make_feasible();
  motors_.limit(speeds_, saturated_);
  if (clips) limited = saturated_;
  saturated_ = logical_or(saturated_, limited);
  if (!feedback_settings_.remembers && !feedback_settings_.conditional_integration &&
      own_laws_.empty() && !common_.log)
    return;
  const Inputs told = inputs_of_speeds();
  Inputs carried = u;
  for (int i = 0; i < inputs_; ++i) carried(i) = select(limited, told(i), u(i));
  if (clips)
    made_ = input_kind_ == InputKind::wrench ? Eigen::Matrix<P, 4, 1>(carried.template head<4>())
                                             : wrench_of_thrusts(allocation_, model_thrusts());
  report_to_law(u, carried);
}

/// Reports to the law the part of its command that the motors realize.
template <int N, int R>
void ClosedLoop<N, R>::report_to_law(const Inputs& asked, const Inputs& made) {
  if (own_laws_.empty()) {
    on_realized(feedback_settings_, feedback_, asked, made);
    return;
  }
  for (int l = 0; l < N; ++l) {
    const auto of_lane = [&](const Inputs& all) {
      return Eigen::VectorXd(all.head(inputs_).unaryExpr([l](const P& x) { return lane(x, l); }));
    };
    if (lane(alive_, l))
      own_laws_[static_cast<std::size_t>(l)]->on_realized(of_lane(asked), of_lane(made));
  }
}

template <int N, int R>
void ClosedLoop<N, R>::command(std::uint64_t index, double t) {
  saturated_ = false;
  const bool lawful =
      reference_.phase == FlightPhase::take_off || reference_.phase == FlightPhase::flying;
  if (lawful && std::holds_alternative<CascadeController>(common_.controller)) {
    command_by_cascade();
  } else if (lawful) {
    command_by_inputs(t);
  } else if (reference_.phase == FlightPhase::start_up) {
    const double share = common_.mission.start.start_up > 0
                             ? std::min(1.0, t / common_.mission.start.start_up)
                             : 1.0;
    motors_.start_up(share, index, speeds_);
  } else if (reference_.phase == FlightPhase::motors) {
    motors_.shares(reference_.motors, speeds_);
  } else {
    speeds_.setConstant(P(0));
  }
  if (!lawful) {
    made_ = wrench_of_thrusts(allocation_, model_thrusts());
    if (feedback_settings_.remembers || !own_laws_.empty()) {
      const Inputs told = inputs_of_speeds();
      report_to_law(told, told);
    }
  }
  for (int i = 0; i < 4; ++i) {
    wrench_(i) = select(off_, P(0), wrench_(i));
    made_(i) = select(off_, P(0), made_(i));
  }
  for (Eigen::Index i = 0; i < speeds_.size(); ++i) speeds_(i) = select(off_, P(0), speeds_(i));
  saturated_ = logical_and(saturated_, logical_not(off_));
  if (battery_) motors_.supply(*battery_, charge_, speeds_, saturated_);
  for (const int motor : stopped_) speeds_(motor) = P(0);
  power_ = 0;
  const RotorSpeeds<P> turning = plant_.rotor_speeds(x_);
  for (int i = 0; i < plant_.body().rotor_count; ++i) {
    const BasicRotor<P>& rotor = plant_.body().rotors[static_cast<std::size_t>(i)];
    const P w = R == 0 && !late_.active() ? speeds_(i) : turning(i);
    power_ += rotor_torque(rotor, w, plant_.body().density_ratio) * w;
  }
  power_ = max_of(power_, P(0));
  if (battery_) step(*battery_, charge_, power_, dt_);
}

template <int N, int R>
void ClosedLoop<N, R>::end_flight(const Mask<N>& lanes, double t, FlightEnd end, const char* name,
                                  const std::string& detail) {
  for (int l = 0; l < N; ++l) {
    if (!lane(lanes, l) || !lane(alive_, l)) continue;
    FlightResult& result = results_[static_cast<std::size_t>(l)];
    result.end = end;
    result.end_time = t;
    keep_final(l);
    if (name != nullptr) result.events.push_back({t, name, detail});
    set_lane(alive_, l, false);
  }
}

/// Checks the safety limits. Those that are meaningless on the ground are checked in flight only.
template <int N, int R>
void ClosedLoop<N, R>::watch(double t) {
  const SafetyLimits& safety = common_.safety;
  if (battery_) {
    const Mask<N> empty = charge_.voltage < P(battery_->cutoff_voltage);
    if (any(logical_and(empty, alive_)))
      end_flight(empty, t, FlightEnd::safety_exit, "battery", "the voltage fell below its cut-off");
    const Mask<N> spent = charge_.charge >= P(battery_->capacity);
    if (any(logical_and(spent, alive_)))
      end_flight(spent, t, FlightEnd::safety_exit, "battery", "its charge is spent");
  }
  const Mask<N> lost = logical_not(estimate_.finite);
  if (any(logical_and(lost, alive_))) {
    for (std::size_t l = 0; l < N; ++l)
      if (lane(logical_and(lost, alive_), static_cast<int>(l)))
        results_[l].culprit = estimator_->culprit(l);
    end_flight(lost, t, FlightEnd::safety_exit, "estimator", "the estimate is not finite");
  }
  const bool flies =
      reference_.phase == FlightPhase::flying || reference_.phase == FlightPhase::take_off;
  if (!flies || carried_) {
    flow_lost_time_ = 0;
    disagreement_time_ = 0;
    return;
  }
  using std::cos;
  const Mask<N> in_flight = logical_not(off_);
  const P force2 = frame_.specific_force.value.squaredNorm();
  const Mask<N> collided = logical_and(logical_and(in_flight, frame_.specific_force.fresh),
                                       force2 > P(safety.collision * safety.collision));
  if (any(logical_and(collided, alive_)))
    end_flight(collided, t, FlightEnd::safety_exit, "collision",
               fmt::format("the accelerometer read more than {} m/s²", safety.collision));
  const P upright = cos(estimate_.x(3)) * cos(estimate_.x(4));
  const Mask<N> tilted = logical_and(in_flight, upright < P(std::cos(safety.tilt)));
  if (any(logical_and(tilted, alive_)))
    end_flight(tilted, t, FlightEnd::safety_exit, "tilt",
               fmt::format("the estimated attitude is tilted by more than {} rad", safety.tilt));
  if (const auto* settings = estimator_->needs_flow();
      settings != nullptr && common_.flow != FlowModel::off) {
    const Mask<N> high = -estimate_.x(2) > P(settings->flow_min_height);
    const Mask<N> blind =
        logical_and(logical_and(in_flight, high), frame_.flow.age > settings->flow_timeout);
    flow_lost_time_ = select(blind, flow_lost_time_ + P(dt_), P(0));
    const Mask<N> too_long = flow_lost_time_ > P(safety.flow_lost_time);
    if (any(logical_and(too_long, alive_)))
      end_flight(too_long, t, FlightEnd::safety_exit, "flow-lost", "no optical flow arrived");
    const Mask<N> differs = logical_and(in_flight, estimate_.flow_disagrees);
    disagreement_time_ = select(differs, disagreement_time_ + P(dt_), P(0));
    const Mask<N> for_long = disagreement_time_ > P(safety.disagreement_time);
    if (any(logical_and(for_long, alive_)))
      end_flight(for_long, t, FlightEnd::safety_exit, "disagreement",
                 "optical flow and estimated velocity differ");
  }
}

template <int N, int R>
void ClosedLoop<N, R>::advance(std::uint64_t index, double t) {
  if (carried_) {
    between_ = true;
    return;
  }
  if (late_.active()) {
    if (phases_.present()) phases_.keep(plant_.rotor_speeds(x_));
    advance_late(index, t);
    if (phases_.present()) phases_.advance(plant_.rotor_speeds(x_), dt_);
    between_ = true;
    return;
  }
  tell(speeds_);
  x_before_ = x_;
  slope_before_ = plant_.derivative(x_);
  const double h = dt_ / substeps_;
  if (phases_.present()) phases_.keep(plant_.rotor_speeds(x_));
  for (int i = 0; i < substeps_; ++i) x_ = plant_.step(common_.integrator, x_, h);
  if (phases_.present()) phases_.advance(plant_.rotor_speeds(x_), dt_);
  between_ = true;
  for (int l = 0; l < N; ++l)
    if (lane(alive_, l))
      results_[static_cast<std::size_t>(l)].steps += static_cast<std::uint64_t>(substeps_);
}

template <int N, int R>
void ClosedLoop<N, R>::check_divergence(double t) {
  // Limits far beyond those of any flight: 1000 km, 1000 rad/s …
  static constexpr std::array<double, 4> kBounds = {1e6, 2, 1e4, 1e4};
  static constexpr std::array<int, 5> kParts = {0, 3, 7, 10, 13};
  Mask<N> good = true;
  for (std::size_t part = 0; part < 4; ++part)
    for (int i = kParts[part]; i < kParts[part + 1]; ++i)
      good = logical_and(good, abs_of(x_(i)) <= P(kBounds[part]));  // false for NaN
  if (all(logical_or(good, logical_not(alive_)))) return;
  static constexpr std::array<const char*, 13> kNames = {"px", "py", "pz", "qw", "qx", "qy", "qz",
                                                         "u",  "v",  "w",  "p",  "q",  "r"};
  for (int l = 0; l < N; ++l) {
    if (lane(good, l) || !lane(alive_, l)) continue;
    FlightResult& result = results_[static_cast<std::size_t>(l)];
    for (std::size_t part = 0; part < 4 && result.culprit.empty(); ++part)
      for (int i = kParts[part]; i < kParts[part + 1] && result.culprit.empty(); ++i)
        if (!(std::abs(lane(x_(i), l)) <= kBounds[part]))
          result.culprit = kNames[static_cast<std::size_t>(i)];
    Mask<N> one = false;
    set_lane(one, l, true);
    end_flight(one, t, FlightEnd::diverged, "diverged", "state " + result.culprit);
  }
}

template <int N, int R>
void ClosedLoop<N, R>::keep_final(int l) {
  const StateVector<P> x = euler_state_now();
  for (int i = 0; i < 12; ++i) {
    results_[static_cast<std::size_t>(l)].final_state(i) = lane(x(i), l);
    results_[static_cast<std::size_t>(l)].final_estimate(i) = lane(estimate_.x(i), l);
  }
}

template <int N, int R>
FlightResult ClosedLoop<N, R>::result(int l) {
  FlightResult& result = results_[static_cast<std::size_t>(l)];
  result.metrics = metrics_.values(l);
  // The duration is the end time, since there is one more sample than control periods.
  result.metrics.value[static_cast<std::size_t>(Metric::duration)] = result.end_time;
  if (lane(alive_, l)) keep_final(l);
  if (!recorders_.empty())
    result.log = recorders_[static_cast<std::size_t>(l)].table(result.events);
  return result;
}

template <int N, int R>
std::array<FlightResult, N> fly_together(const std::array<const FlightSetup*, N>& setups,
                                         const std::function<bool()>& interrupted) {
  const auto loop = std::make_unique<ClosedLoop<N, R>>(setups);
  loop->run(interrupted);
  std::array<FlightResult, N> results;
  for (std::size_t l = 0; l < N; ++l) results[l] = loop->result(static_cast<int>(l));
  return results;
}

}  // namespace quadtune::internal
