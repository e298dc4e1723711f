// SPDX-License-Identifier: Apache-2.0
#include "flown/flown_estimator.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "flown/on_board_jets.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/estimation/general_filter.hpp"
#include "quadtune/estimation/mambo_estimator.hpp"
#include "quadtune/estimation/uquad_filter.hpp"
#include "quadtune/internal/in_parallel.hpp"
#include "quadtune/model/rigid_body.hpp"

namespace quadtune::internal {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr int kEstimatorWidth = 8;  ///< derivatives computed at once
using EstimatorJet = ceres::Jet<double, kEstimatorWidth>;

template <class T>
SensorFrame<T> sensor_frame(const HoverFrame& at, const Eigen::Matrix<T, Eigen::Dynamic, 1>& v) {
  SensorFrame<T> frame;
  const auto vector = [&](Reading reading, auto& sample) {
    const auto i = static_cast<std::size_t>(reading);
    for (int k = 0; k < kReadingSize[i]; ++k) sample.value(k) = v(kReadingFirst[i] + k);
    sample.fresh = at.fresh[i];
    sample.age = T(at.age[i]);
  };
  const auto scalar = [&](Reading reading, auto& sample) {
    const auto i = static_cast<std::size_t>(reading);
    sample.value = v(kReadingFirst[i]);
    sample.fresh = at.fresh[i];
    sample.age = T(at.age[i]);
  };
  vector(Reading::specific_force, frame.specific_force);
  vector(Reading::rates, frame.rates);
  vector(Reading::magnetic_field, frame.magnetic_field);
  scalar(Reading::pressure, frame.pressure);
  scalar(Reading::sonar, frame.sonar);
  vector(Reading::flow, frame.flow);
  vector(Reading::gps_position, frame.gps_position);
  vector(Reading::gps_velocity, frame.gps_velocity);
  vector(Reading::vision, frame.vision);
  return frame;
}

/// Calls f for each number in the state of a Mambo's estimator that depends on the motion of the
/// vehicle. The covariances do not, to first order, while the innovations are 0.
/// @param periods  MamboEstimatorSettings::aligned_periods
template <class T, class Function>
void each_number(int periods, MamboEstimatorState<T>& state, const Function& f) {
  const auto all = [&](const char* name, auto& vector, double scale) {
    for (Index i = 0; i < vector.size(); ++i) f(name, i, vector(i), scale);
  };
  all("filter attitude", state.attitude.angles, 0.1);
  all("newest rate", state.attitude.gyro, 1.0);
  all("gyro bias", state.attitude.gyro_bias, 0.01);
  all("newest force", state.force, 1.0);
  all("filter height", state.altitude.x, 0.3);
  all("filter velocity", state.velocity.x, 0.3);
  all("filter position", state.position, 0.3);
  all("flow position", state.flow_position, 0.3);
  all("newest flow", state.flow, 0.3);
  f("newest echo", 0, state.echo_height, 0.3);
  for (int j = 0; j < periods; ++j) {
    FlowMoment<T>& moment = state.moments[static_cast<std::size_t>(j)];
    all("earlier rate", moment.rates, 1.0);
    all("earlier flow", moment.flow, 0.3);
  }
}

template <class T, class Function>
void each_number(int, UquadFilterState<T>& state, const Function& f) {
  static constexpr std::array<const char*, 5> kNames = {
      "filter position", "filter attitude", "filter velocity", "filter rates", "filter force bias"};
  static constexpr std::array<double, 5> kScales = {0.3, 0.1, 0.3, 1, 0.1};
  for (Index i = 0; i < kUquadStates; ++i)
    f(kNames[static_cast<std::size_t>(i / 3)], i % 3, state.kalman.x(i),
      kScales[static_cast<std::size_t>(i / 3)]);
  f("newest tilt", 0, state.tilt.roll, 0.1);
  f("newest tilt", 1, state.tilt.pitch, 0.1);
  f("force excess", 0, state.force_excess, 0.1);
}

/// Which stored samples of the general filter affect later steps.
struct GeneralParts {
  int readings;  ///< stored periods of gyroscope and accelerometer
  int queue;     ///< stored periods of samples that are waiting for the horizon
  bool flow, range, pressure, field, gps, vision;
};

template <class T, class Function>
void each_number(const GeneralParts& parts, GeneralFilterState<T>& state, const Function& f) {
  const auto all = [&](const char* name, auto& vector, double scale) {
    for (Index i = 0; i < vector.size(); ++i) f(name, i, vector(i), scale);
  };
  all("filter position", state.motion.position, 0.3);
  all("filter velocity", state.motion.velocity, 0.3);
  for (Index i = 0; i < 3; ++i) f("filter attitude", i, state.motion.attitude(1 + i), 0.05);
  all("gyro bias", state.gyro_bias, 0.01);
  // In hover no sensor can distinguish a horizontal bias of the accelerometer from a tilt: the sum
  // of both is a constant of the motion that no law can change. The linear model therefore treats
  // the horizontal biases as constants.
  f("force bias", 2, state.force_bias(2), 0.1);
  if (parts.pressure) f("barometer offset", 0, state.pressure_height, 0.3);
  for (int j = 0; j < parts.readings; ++j) {
    all("earlier rate", state.readings[j].rates, 1.0);
    all("earlier force", state.readings[j].force, 1.0);
  }
  for (int j = 0; j < parts.queue; ++j) {
    if (parts.flow) all("waiting flow", state.flow[j].value, 0.3);
    if (parts.range) f("waiting range", 0, state.range[j].value, 0.3);
    if (parts.pressure) f("waiting pressure", 0, state.pressure[j].value, 3.0);
    if (parts.field) all("waiting field", state.field[j].value, 3.0);
    if (parts.gps) {
      all("waiting position", state.gps_position[j].value, 0.3);
      all("waiting velocity", state.gps_velocity[j].value, 0.3);
    }
    if (parts.vision) all("waiting image", state.vision[j].value, 0.3);
  }
}

MamboEstimatorState<EstimatorJet> as_jets(const MamboEstimatorState<double>& from) {
  MamboEstimatorState<EstimatorJet> to;
  to.attitude.angles = from.attitude.angles.cast<EstimatorJet>();
  to.attitude.gyro_bias = from.attitude.gyro_bias.cast<EstimatorJet>();
  to.attitude.gyro = from.attitude.gyro.cast<EstimatorJet>();
  to.force = from.force.cast<EstimatorJet>();
  to.force_bias = from.force_bias.cast<EstimatorJet>();
  to.altitude = {from.altitude.x.cast<EstimatorJet>(), from.altitude.P.cast<EstimatorJet>()};
  to.velocity = {from.velocity.x.cast<EstimatorJet>(), from.velocity.P.cast<EstimatorJet>()};
  to.position = from.position.cast<EstimatorJet>();
  to.flow_position = from.flow_position.cast<EstimatorJet>();
  to.position_variance = EstimatorJet(from.position_variance);
  to.echo_height = EstimatorJet(from.echo_height);
  to.rejected_time = EstimatorJet(from.rejected_time);
  to.flow = from.flow.cast<EstimatorJet>();
  to.flow_age = EstimatorJet(from.flow_age);
  to.flow_seen = from.flow_seen;
  for (std::size_t j = 0; j < from.moments.size(); ++j)
    to.moments[j] = {from.moments[j].rates.cast<EstimatorJet>(),
                     from.moments[j].flow.cast<EstimatorJet>(), EstimatorJet(from.moments[j].age),
                     from.moments[j].came};
  to.periods = from.periods;
  return to;
}

UquadFilterState<EstimatorJet> as_jets(const UquadFilterState<double>& from) {
  UquadFilterState<EstimatorJet> to;
  to.kalman = {from.kalman.x.cast<EstimatorJet>(), from.kalman.P.cast<EstimatorJet>()};
  to.gyro_offset = from.gyro_offset.cast<EstimatorJet>();
  to.pressure_zero = EstimatorJet(from.pressure_zero);
  to.start_z = EstimatorJet(from.start_z);
  to.field_norm = EstimatorJet(from.field_norm);
  to.tilt = {EstimatorJet(from.tilt.roll), EstimatorJet(from.tilt.pitch)};
  to.force_excess = EstimatorJet(from.force_excess);
  to.gps_age = EstimatorJet(from.gps_age);
  to.periods = from.periods;
  return to;
}

template <class To, class From>
void as_jets(const From& from, To& to) {
  to.newest = from.newest;
  for (std::size_t j = 0; j < from.values.size(); ++j) {
    using Value = std::decay_t<decltype(from.values[j].value)>;
    if constexpr (std::is_same_v<Value, double>)
      to.values[j].value = EstimatorJet(from.values[j].value);
    else
      to.values[j].value = from.values[j].value.template cast<EstimatorJet>();
    to.values[j].age = EstimatorJet(from.values[j].age);
    to.values[j].came = from.values[j].came;
  }
}

GeneralFilterState<EstimatorJet> as_jets(const GeneralFilterState<double>& from) {
  GeneralFilterState<EstimatorJet> to;
  to.motion = {from.motion.position.cast<EstimatorJet>(), from.motion.velocity.cast<EstimatorJet>(),
               from.motion.attitude.cast<EstimatorJet>()};
  to.gyro_bias = from.gyro_bias.cast<EstimatorJet>();
  to.force_bias = from.force_bias.cast<EstimatorJet>();
  to.pressure_height = EstimatorJet(from.pressure_height);
  for (std::size_t i = 0; i < from.P.entries.size(); ++i)
    to.P.entries[i] = EstimatorJet(from.P.entries[i]);
  to.yaw = EstimatorJet(from.yaw);
  to.readings.newest = from.readings.newest;
  for (std::size_t j = 0; j < from.readings.values.size(); ++j)
    to.readings.values[j] = {from.readings.values[j].rates.cast<EstimatorJet>(),
                             from.readings.values[j].force.cast<EstimatorJet>()};
  as_jets(from.flow, to.flow);
  as_jets(from.range, to.range);
  as_jets(from.pressure, to.pressure);
  as_jets(from.field, to.field);
  as_jets(from.gps_position, to.gps_position);
  as_jets(from.gps_velocity, to.gps_velocity);
  as_jets(from.vision, to.vision);
  for (std::size_t i = 0; i < from.rejections.size(); ++i)
    to.rejections[i] = {EstimatorJet(from.rejections[i].time),
                        EstimatorJet(from.rejections[i].count)};
  return to;
}

/// A common interface to the estimators, for doubles and jets.
class Mambo {
 public:
  template <class T>
  using State = MamboEstimatorState<T>;

  Mambo(const FlightSetup& setup, double dt) {
    MamboEstimatorSettings<double> settings = setup.mambo_estimator;
    settings.dt = dt;
    settings.gravity = setup.vehicle.gravity;
    settings.calibration_time = 0;
    validate(settings, "estimator");
    settings_ = settings;
    jets_ = mambo_estimator_cast<EstimatorJet>(settings);
  }

  [[nodiscard]] State<double> start(const StateVector<double>& x) const {
    return mambo_estimator_start(settings_, x);
  }
  template <class T>
  Estimate<T> step(State<T>& state, const SensorFrame<T>& frame, const RotorSpeeds<T>&) const {
    if constexpr (std::is_same_v<T, double>)
      return quadtune::step(settings_, state, frame);
    else
      return quadtune::step(jets_, state, frame);
  }
  [[nodiscard]] int kept() const { return settings_.aligned_periods; }
  /// Whether covariance() must converge before the gains are those of a long flight.
  static constexpr bool kSettles = true;
  [[nodiscard]] static VectorXd covariance(const State<double>& state) {
    VectorXd all(8);
    all << state.altitude.P.reshaped(), state.velocity.P.reshaped();
    return all;
  }

 private:
  MamboEstimatorSettings<double> settings_;
  MamboEstimatorSettings<EstimatorJet> jets_;
};

class Uquad {
 public:
  template <class T>
  using State = UquadFilterState<T>;

  Uquad(const FlightSetup& setup, double dt) : body_(setup.vehicle) {
    UquadFilterSettings<double> settings = setup.uquad_filter;
    settings.dt = dt;
    settings.calibration_time = 0;
    const Eigen::Vector3d& field = setup.environment.magnetic_field;
    if (settings.field_norm == 0) settings.field_norm = field.norm();
    settings.declination = std::atan2(field.y(), field.x());
    const Sensors sensors = sensors_of(setup);
    if (sensors.barometer) settings.reference_pressure = sensors.barometer->ground_pressure;
    validate(settings, "estimator");
    settings_ = settings;
    jets_ = uquad_filter_cast<EstimatorJet>(settings);
  }

  [[nodiscard]] State<double> start(const StateVector<double>& x) const {
    return uquad_filter_start(settings_, x);
  }
  template <class T>
  Estimate<T> step(State<T>& state, const SensorFrame<T>& frame,
                   const RotorSpeeds<T>& speeds) const {
    if constexpr (std::is_same_v<T, double>)
      return quadtune::step(settings_, state, frame, body_, speeds, false);
    else
      return quadtune::step(jets_, state, frame, body_, speeds, false);
  }
  [[nodiscard]] static int kept() { return 0; }
  static constexpr bool kSettles = true;
  [[nodiscard]] static VectorXd covariance(const State<double>& state) {
    return state.kalman.P.reshaped();
  }

 private:
  RigidBody body_;
  UquadFilterSettings<double> settings_;
  UquadFilterSettings<EstimatorJet> jets_;
};

class General {
 public:
  template <class T>
  using State = GeneralFilterState<T>;

  /// @param oldest  maximum age of a sample that is used, on its arrival [s]
  General(const FlightSetup& setup, double dt, double oldest)
      : settings_(general_filter_settings(setup)) {
    settings_.dt = dt;
    validate(settings_, "estimator");
    const int horizon = horizon_periods(settings_);
    // A period needs the readings of up to two periods before the horizon. A sample that is older
    // than the horizon is propagated and needs the readings of the periods in between.
    const double before = std::max(0.0, oldest - horizon * dt);
    const int carried =
        std::min(kMaxHistoryPeriods, static_cast<int>(std::ceil(before / dt - 1e-9)));
    const double fresher = std::min(settings_.gyroscope.lag, settings_.accelerometer.lag);
    parts_ = {.readings = horizon - static_cast<int>(std::floor(fresher / dt + 1e-9)) + 1 + carried,
              .queue = horizon,
              .flow = settings_.flow.has_value(),
              .range = settings_.range.has_value(),
              .pressure = settings_.pressure.has_value(),
              .field = settings_.heading.has_value(),
              .gps = settings_.gps_position.has_value(),
              .vision = settings_.vision.has_value()};
  }

  [[nodiscard]] State<double> start(const StateVector<double>& x) const {
    State<double> state = general_filter_start(settings_, x);
    return state;
  }
  template <class T>
  Estimate<T> step(State<T>& state, const SensorFrame<T>& frame, const RotorSpeeds<T>&) const {
    return quadtune::step(settings_, state, frame, false);
  }
  [[nodiscard]] const GeneralParts& kept() const { return parts_; }
  [[nodiscard]] static VectorXd covariance(const State<double>& state) {
    return Eigen::Map<const VectorXd>(state.P.entries.data(), std::ssize(state.P.entries));
  }
  /// Variances of biases decrease for minutes, and those of unobserved states grow without bound.
  /// The gains are therefore taken at the end of the maximum duration; later ones differ little.
  static constexpr bool kSettles = false;

 private:
  GeneralFilterSettings settings_;
  GeneralParts parts_{};
};

template <class Estimator>
class Linearizing {
 public:
  Linearizing(const Estimator& estimator, const VectorXd& values, const VectorXd& speeds)
      : estimator_(estimator), values_(values), speeds_(speeds) {}

  LinearEstimator run(const StateVector<double>& x,
                      const std::function<HoverFrame(std::size_t)>& frame, std::size_t N,
                      double dt) {
    constexpr double kMax = 100;  // [s]
    constexpr double kSettled = 1e-9;
    auto state = estimator_.start(x);
    LinearEstimator result;
    each_number(
        estimator_.kept(), state, [&](const char* name, Index i, const double&, double scale) {
          static constexpr std::array<const char*, 3> kAxes = {" x", " y", " z"};
          result.states.push_back({name + std::string(kAxes[static_cast<std::size_t>(i)]), ""});
          result.scale.conservativeResize(std::ssize(result.states));
          result.scale(std::ssize(result.states) - 1) = scale;
        });
    // Advance by whole periods of the clocks until the covariances no longer change.
    const auto rounds =
        static_cast<std::size_t>(std::max(2.0, std::ceil(kMax / (dt * static_cast<double>(N)))));
    std::size_t k = N;  // a whole number of periods of the clocks
    VectorXd before;
    result.settled = false;
    for (std::size_t round = 0; round < rounds && !result.settled; ++round) {
      for (const std::size_t end = k + N; k < end; ++k) advance(state, frame(k));
      const VectorXd now = Estimator::covariance(state);
      // Compare each entry relative to its own size; an unbounded variance does not matter then.
      result.settled =
          Estimator::kSettles && round > 0 &&
          ((now - before).array().abs() <= kSettled * (now.array().abs() + 1e-30)).all();
      before = now;
    }
    if (!Estimator::kSettles) result.settled = true;
    result.first = k;
    std::vector<typename Estimator::template State<double>> states;
    for (std::size_t i = 0; i < N; ++i) {
      states.push_back(state);
      advance(state, frame(k + i));
    }
    result.steps.resize(N);
    const auto one = [&](std::size_t i) {
      result.steps[i] = slopes(states[i], frame(k + i), std::ssize(result.states));
    };
    in_parallel(N, thread_count(0), [&] { return one; }, {});
    return result;
  }

 private:
  void advance(typename Estimator::template State<double>& state, const HoverFrame& frame) const {
    (void)estimator_.step(state, sensor_frame<double>(frame, values_),
                          RotorSpeeds<double>(speeds_));
  }

  EstimatorStep slopes(const typename Estimator::template State<double>& at,
                       const HoverFrame& frame, Index states) const {
    const Index width = states + kFrameSize + speeds_.size();
    MatrixXd all = MatrixXd::Zero(states + 12, width);
    for (Index first = 0; first < width; first += kEstimatorWidth) {
      auto state = as_jets(at);
      Index column = 0;
      const auto seed = [&](EstimatorJet& number) {
        if (column >= first && column < first + kEstimatorWidth)
          number.v(static_cast<int>(column - first)) = 1;
        ++column;
      };
      each_number(estimator_.kept(), state,
                  [&](const char*, Index, EstimatorJet& number, double) { seed(number); });
      Eigen::Matrix<EstimatorJet, Eigen::Dynamic, 1> values = values_.cast<EstimatorJet>();
      for (Index i = 0; i < kFrameSize; ++i) seed(values(i));
      RotorSpeeds<EstimatorJet> speeds = speeds_.cast<EstimatorJet>();
      for (Index i = 0; i < speeds.size(); ++i) seed(speeds(i));
      const Estimate<EstimatorJet> estimate =
          estimator_.step(state, sensor_frame<EstimatorJet>(frame, values), speeds);
      const Index count = std::min<Index>(kEstimatorWidth, width - first);
      Index row = 0;
      const auto take = [&](const EstimatorJet& number) {
        all.row(row++).segment(first, count) = number.v.head(count).transpose();
      };
      each_number(estimator_.kept(), state,
                  [&](const char*, Index, const EstimatorJet& number, double) { take(number); });
      for (int i = 0; i < 12; ++i) take(estimate.x(i));
    }
    return {all.leftCols(states), all.middleCols(states, kFrameSize),
            all.rightCols(speeds_.size())};
  }

  const Estimator& estimator_;
  VectorXd values_, speeds_;
};

}  // namespace

bool reads(const FlightSetup& setup, Reading reading) {
  switch (setup.estimator) {
    case EstimatorKind::truth:
      return false;
    case EstimatorKind::mambo:
      return reading == Reading::specific_force || reading == Reading::rates ||
             reading == Reading::sonar || reading == Reading::flow || reading == Reading::vision;
    case EstimatorKind::general:
    case EstimatorKind::own:
      return true;
    case EstimatorKind::uquad:
      break;
  }
  const bool of_position = reading == Reading::gps_position || reading == Reading::gps_velocity ||
                           reading == Reading::vision;
  return reading != Reading::sonar && reading != Reading::flow &&
         (setup.uquad_filter.position || !of_position);
}

LinearEstimator linear_estimator(const FlightSetup& setup, double dt, const VectorXd& values,
                                 const StateVector<double>& x, const VectorXd& speeds,
                                 const std::function<HoverFrame(std::size_t)>& frame,
                                 std::size_t N) {
  if (setup.estimator == EstimatorKind::own)
    throw InvalidInput("flown loop",
                       fmt::format("the estimator '{}' has no linear model, expected one of the "
                                   "built-in estimators",
                                   setup.own_estimator.name));
  if (setup.estimator == EstimatorKind::uquad) {
    const Uquad uquad(setup, dt);
    return Linearizing<Uquad>(uquad, values, speeds).run(x, frame, N, dt);
  }
  if (setup.estimator == EstimatorKind::general) {
    double oldest = 0;
    const auto consider = [&](const std::optional<SensorFaults>& faults) {
      if (!faults) return;
      const double response =
          faults->natural_frequency > 0 ? 2 * faults->damping / faults->natural_frequency : 0;
      oldest = std::max(oldest, faults->delay + response + dt);
    };
    const Sensors sensors = sensors_of(setup);
    consider(sensors.magnetometer);
    consider(sensors.vision);
    if (sensors.barometer) consider(sensors.barometer->faults);
    if (sensors.sonar) consider(sensors.sonar->faults);
    if (sensors.flow) consider(sensors.flow->faults);
    if (sensors.gps) consider(sensors.gps->position);
    const General general(setup, dt, oldest);
    // The filter corrects the scale factors, so its input are readings that contain them.
    VectorXd read = values;
    const auto scale = [&](Reading reading, const SensorFaults& faults) {
      const auto i = static_cast<std::size_t>(reading);
      for (Index axis = 0; axis < kReadingSize[i]; ++axis)
        read(kReadingFirst[i] + axis) *= faults.scale(axis);
    };
    if (sensors.accelerometer) scale(Reading::specific_force, *sensors.accelerometer);
    if (sensors.gyroscope) scale(Reading::rates, *sensors.gyroscope);
    if (sensors.magnetometer) scale(Reading::magnetic_field, *sensors.magnetometer);
    if (sensors.barometer) scale(Reading::pressure, sensors.barometer->faults);
    if (sensors.sonar) scale(Reading::sonar, sensors.sonar->faults);
    if (sensors.flow) scale(Reading::flow, sensors.flow->faults);
    if (sensors.gps) scale(Reading::gps_position, sensors.gps->position);
    if (sensors.vision) scale(Reading::vision, *sensors.vision);
    return Linearizing<General>(general, read, speeds).run(x, frame, N, dt);
  }
  const Mambo mambo(setup, dt);
  return Linearizing<Mambo>(mambo, values, speeds).run(x, frame, N, dt);
}

}  // namespace quadtune::internal
