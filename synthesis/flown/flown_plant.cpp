// SPDX-License-Identifier: Apache-2.0
#include "quadtune/synthesis/flown_plant.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <initializer_list>
#include <map>
#include <numeric>
#include <optional>

#include "flown/flown_body.hpp"
#include "flown/flown_estimator.hpp"
#include "flown/flown_noise.hpp"
#include "quadtune/discretize/matrix_exponential.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/estimation/general_filter_settings.hpp"
#include "quadtune/internal/in_parallel.hpp"
#include "quadtune/model/rigid_body.hpp"
#include "quadtune/simulation/sensor_channel.hpp"

namespace quadtune {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using internal::EstimatorStep;
using internal::FlownBody;
using internal::HoverFrame;
using internal::kFrameSize;
using internal::kReadingFirst;
using internal::kReadings;
using internal::kReadingSize;
using internal::LinearEstimator;
using internal::Reading;

constexpr const char* kPlantWhere = "flown plant";
constexpr std::size_t kMaxRound = 1000;  ///< [control periods]
/// If a clock does not repeat with the others within kMaxRound, its samples per control period
/// are rounded to a multiple of 1/kRounding.
constexpr double kRounding = 1000;
constexpr double kSlack = SampleClock::kSlack;

constexpr std::array<const char*, kReadings> kReadingNames = {
    "accelerometer", "gyroscope", "magnetometer", "barometer", "sonar",
    "flow",          "GPS",       "GPS velocity", "vision"};

/// Clock and dynamics of one sensor, and the indices of its states.
struct Channel {
  Reading reading{};
  double rate = 0;   ///< [Hz]
  double delay = 0;  ///< [s]
  Eigen::Vector3d scale = Eigen::Vector3d::Ones();
  std::optional<SampledResponse> response;
  Index response_at = 0;  ///< y, y' and the last true value of each axis
  Index pending_at = 0;   ///< delayed samples, the oldest first
  Index slots = 0;        ///< number of delayed samples
  internal::ReadingNoise noise;
  Index drift_at = 0;  ///< states of the random walk, then of the correlated error, of each axis
  Index white_at = 0;  ///< columns of w: first sample of a control period, then the next
  Index slow_at = 0;   ///< columns of w: random walk, then correlated error

  [[nodiscard]] Index size() const { return kReadingSize[static_cast<std::size_t>(reading)]; }
  [[nodiscard]] Index first() const { return kReadingFirst[static_cast<std::size_t>(reading)]; }
  /// Index of the newest sample taken by the time t; arrived(): index of the newest that has
  /// arrived.
  [[nodiscard]] long taken(double t) const {
    return static_cast<long>(std::floor((t + kSlack) * rate));
  }
  [[nodiscard]] long arrived(double t) const {
    return static_cast<long>(std::floor((t - delay + kSlack) * rate));
  }
};

std::optional<SensorFaults> faults_of(const Sensors& sensors, Reading reading) {
  switch (reading) {
    case Reading::specific_force:
      return sensors.accelerometer;
    case Reading::rates:
      return sensors.gyroscope;
    case Reading::magnetic_field:
      return sensors.magnetometer;
    case Reading::pressure:
      return sensors.barometer ? std::optional(sensors.barometer->faults) : std::nullopt;
    case Reading::sonar:
      return sensors.sonar ? std::optional(sensors.sonar->faults) : std::nullopt;
    case Reading::flow:
      return sensors.flow ? std::optional(sensors.flow->faults) : std::nullopt;
    case Reading::gps_position:
      return sensors.gps ? std::optional(sensors.gps->position) : std::nullopt;
    case Reading::gps_velocity: {
      if (!sensors.gps) return std::nullopt;
      SensorFaults faults;
      faults.rate = sensors.gps->position.rate;
      faults.delay = sensors.gps->position.delay;
      return faults;
    }
    case Reading::vision:
      break;
  }
  return sensors.vision;
}

/// The period of a clock in control periods: the smallest q with integer q·r, 0 if there is none.
std::size_t round_of(double samples_per_period) {
  for (std::size_t q = 1; q <= kMaxRound; ++q) {
    const double turns = static_cast<double>(q) * samples_per_period;
    if (std::abs(turns - std::round(turns)) < 1e-9 * std::max(1.0, turns) && turns > 0.5) return q;
  }
  return 0;
}

/// Caches e^(Ah) and ∫ e^(Aτ) dτ B for each h. Since times contain rounding errors, h is rounded to
/// 2^-46 s, so that a result depends on h only and not on the order of the calls.
class Holds {
 public:
  /// @param exact  times h that are not rounded
  Holds(const MatrixXd& A, const MatrixXd& B, std::initializer_list<double> exact) : A_(A), B_(B) {
    for (const double h : exact) keep(key_of(h), h);
  }

  struct Hold {
    MatrixXd Phi, Gamma;
  };
  const Hold& over(double h) {
    const long long key = key_of(h);
    const auto found = kept_.find(key);
    if (found != kept_.end()) return found->second;
    return keep(key, std::ldexp(static_cast<double>(key), -kBits));
  }

 private:
  static constexpr int kBits = 46;
  static long long key_of(double h) { return std::llround(std::ldexp(h, kBits)); }

  const Hold& keep(long long key, double h) {
    const Index nx = A_.rows(), nu = B_.cols();
    MatrixXd M = MatrixXd::Zero(nx + nu, nx + nu);
    M.topLeftCorner(nx, nx) = A_ * h;
    M.topRightCorner(nx, nu) = B_ * h;
    const ExponentialResult E = matrix_exponential(M);
    return kept_.emplace(key, Hold{E.E.topLeftCorner(nx, nx), E.E.topRightCorner(nx, nu)})
        .first->second;
  }

  const MatrixXd &A_, &B_;
  std::map<long long, Hold> kept_;
};

class Assembly {
 public:
  Assembly(const FlightSetup& setup, const FlownPlantOptions& options)
      : options_(options), body_(internal::flown_body(setup, options.inputs, options.height)) {
    if (options.separate_axes && options.inputs == InputKind::wrench)
      internal::separate_axes(body_);
    note_omissions(flown_vehicle(setup));
    add_channels(setup);
    if (setup.estimator != EstimatorKind::truth)
      estimator_ = internal::linear_estimator(
          setup, options.dt, body_.readings, body_.x, body_.speeds,
          [this](std::size_t k) { return frame(k); }, period_);
    // Long after the start, when all samples from the start have arrived.
    first_ = estimator_.steps.empty() ? period_ * (1 + 50 / period_) : estimator_.first;
    lay_out();
  }

  FlownPlant make() {
    FlownPlant result;
    result.plant.dt = options_.dt;
    result.plant.inputs = body_.inputs;
    result.plant.outputs = ned_convention().states;
    result.plant.states = states_;
    result.plant.A.resize(period_);
    result.plant.B.resize(period_);
    if (options_.noise) result.noise.resize(period_);
    const auto make_worker = [&] {
      return [&, holds = Holds(body_.A, body_.B, {options_.dt, part_, options_.dt - part_})](
                 std::size_t k) mutable {
        MatrixXd rows = step(first_ + k, holds);
        drop_rounding(rows);
        result.plant.A[k] = rows.leftCols(nz_);
        result.plant.B[k] = rows.middleCols(nz_, nu_);
        if (options_.noise) result.noise[k] = rows.rightCols(nw_);
      };
    };
    internal::in_parallel(period_, internal::thread_count(0), make_worker, {});
    result.plant.C = MatrixXd::Zero(12, nz_);
    result.plant.C.middleCols(believed_at_, 12).setIdentity();
    std::vector<Index> kept;
    PeriodicLti loop = loop_part(result.plant, &kept);
    for (const Index i : {0, 1, 2, 5})
      if (std::find(kept.begin(), kept.end(), i) == kept.end())
        result.drifts.push_back(body_.states[static_cast<std::size_t>(i)]);
    if (options_.noise) {
      result.scale = scale_;
      result.noise_start = noise_start();
    } else {
      result.plant = std::move(loop);
      result.scale = scale_(kept);
    }
    result.notes = notes_;
    if (!estimator_.settled)
      result.notes.emplace_back(
          "the estimator's covariances still change after 100 s of hover; the values at 100 s are "
          "used");
    return result;
  }

 private:
  [[nodiscard]] double time(std::size_t k) const { return static_cast<double>(k) * options_.dt; }

  void note_omissions(const Vehicle& vehicle) {
    const auto any = [&](auto&& has) {
      return std::any_of(vehicle.rotors.begin(), vehicle.rotors.end(), has);
    };
    if (any([](const Rotor& rotor) { return rotor.lag != lag_down(rotor); }))
      notes_.emplace_back(
          "the rotors spin up and down with different lags; the model uses the slower one for "
          "both directions");
    if (vehicle.motor.delay_jitter > 0)
      notes_.push_back(fmt::format(
          "the jitter of the commands of up to {:.6g} s is modeled by its mean, {:.6g} s",
          vehicle.motor.delay_jitter, 0.5 * vehicle.motor.delay_jitter));
    const auto effect = [&](const Rotor& rotor) {
      return rotor.ground_effect ? ground_effect(rotor.radius, options_.height) - 1 : 0;
    };
    double max = 0;
    for (const Rotor& rotor : vehicle.rotors) max = std::max(max, effect(rotor));
    constexpr double kMatters = 1e-3;
    if (max > kMatters)
      notes_.push_back(fmt::format(
          "the model omits the ground effect; at a height of {:.6g} m it adds {:.2g} % of "
          "thrust",
          options_.height, 100 * max));
  }

  void add_channels(const FlightSetup& setup) {
    const Sensors sensors = sensors_of(setup);
    for (std::size_t i = 0; i < kReadings; ++i) {
      const auto reading = static_cast<Reading>(i);
      if (!internal::reads(setup, reading)) continue;
      const std::optional<SensorFaults> faults = faults_of(sensors, reading);
      if (!faults || std::isnan(body_.readings(kReadingFirst[i]))) continue;
      if (faults->delay > kMaxDelayPeriods * options_.dt * (1 + 1e-9))
        throw InvalidInput(
            kPlantWhere,
            fmt::format("the {} has a delay of {} s, expected at most {} "
                        "control periods of {} s",
                        kReadingNames[i], faults->delay, kMaxDelayPeriods, options_.dt));
      Channel channel;
      channel.reading = reading;
      channel.rate = faults->rate;
      channel.delay = faults->delay;
      channel.scale = faults->scale;
      if (options_.noise)
        channel.noise = internal::reading_noise(sensors, reading, options_.height);
      if (faults->natural_frequency > 0)
        channel.response =
            sampled_response(faults->natural_frequency, faults->damping, 1 / faults->rate);
      channels_.push_back(channel);
    }
    for (Channel& channel : channels_) {
      const double samples = channel.rate * options_.dt;
      std::size_t round = round_of(samples);
      if (round == 0 || std::lcm(period_, round) > kMaxRound) {
        const double parts = std::max(1.0, std::round(samples * kRounding));
        channel.rate = parts / (kRounding * options_.dt);
        notes_.push_back(fmt::format(
            "the {} samples every {:.6g} s; the model uses {:.6g} s so that the clocks repeat",
            kReadingNames[static_cast<std::size_t>(channel.reading)], options_.dt / samples,
            1 / channel.rate));
        round = round_of(channel.rate * options_.dt);
      }
      period_ = std::lcm(period_, round);
    }
  }

  /// The new samples of the estimator in control period k.
  [[nodiscard]] HoverFrame frame(std::size_t k) const {
    HoverFrame at;
    for (const Channel& channel : channels_) {
      const auto i = static_cast<std::size_t>(channel.reading);
      const long newest = channel.arrived(time(k));
      at.fresh[i] = newest >= 0 && (k == 0 || newest > channel.arrived(time(k - 1)));
      at.age[i] = time(k) - static_cast<double>(newest) / channel.rate;
    }
    return at;
  }

  void lay_out() {
    nu_ = body_.commands.cols();
    const auto add = [&](const std::string& name, double scale) {
      states_.push_back({name, ""});
      scales_.push_back(scale);
    };
    for (std::size_t i = 0; i < body_.states.size(); ++i) {
      static constexpr std::array<double, 12> kScales = {0.3, 0.3, 0.3, 0.1, 0.1, 0.1,
                                                         0.3, 0.3, 0.3, 1,   1,   1};
      add(body_.states[i].name, i < 12 ? kScales[i] : 0.05 * body_.speeds.maxCoeff());
    }
    history_at_ = std::ssize(states_);
    const double late = options_.command_delay / options_.dt;
    whole_ = static_cast<Index>(std::floor(late + 1e-9));
    part_ = std::max(0.0, late - static_cast<double>(whole_)) * options_.dt;
    if (part_ < 1e-9 * options_.dt) part_ = 0;
    history_ = whole_ + (part_ > 0 ? 1 : 0);
    for (Index j = 0; j < history_; ++j)
      for (const Signal& input : body_.inputs) add(fmt::format("{}[k-{}]", input.name, j + 1), 1);
    for (Channel& channel : channels_) {
      const std::string name = kReadingNames[static_cast<std::size_t>(channel.reading)];
      channel.response_at = std::ssize(states_);
      if (channel.response)
        for (Index axis = 0; axis < channel.size(); ++axis)
          for (const char* part : {"", " slope", " before"}) add(name + part, 1);
      channel.pending_at = std::ssize(states_);
      for (std::size_t k = first_; k <= first_ + period_; ++k)
        channel.slots =
            std::max<Index>(channel.slots, channel.taken(time(k)) - channel.arrived(time(k)));
      for (Index i = 0; i < channel.slots * channel.size(); ++i) add(name + " on its way", 1);
      channel.drift_at = std::ssize(states_);
      channel.white_at = nw_;
      if (!options_.noise) continue;
      long max = 0;
      for (std::size_t k = first_; k < first_ + period_; ++k)
        max = std::max(max, channel.taken(time(k + 1)) - channel.taken(time(k)));
      channel.slow_at = channel.white_at + max * channel.size();
      nw_ = channel.slow_at + 2 * channel.size();
      for (const char* error : {" random walk", " correlated error"})
        for (Index axis = 0; axis < channel.size(); ++axis) add(name + error, 1);
    }
    estimator_at_ = std::ssize(states_);
    for (std::size_t i = 0; i < estimator_.states.size(); ++i)
      add(estimator_.states[i].name, estimator_.scale(static_cast<Index>(i)));
    believed_at_ = std::ssize(states_);
    for (std::size_t i = 0; i < 12; ++i) add("estimated " + body_.states[i].name, scales_[i]);
    nz_ = std::ssize(states_);
    scale_ = Eigen::Map<const VectorXd>(scales_.data(), nz_);
  }

  /// Number of columns over (z, u, w).
  [[nodiscard]] Index width() const { return nz_ + nu_ + nw_; }

  /// The stationary variances of the sensor errors in z; 0 for all other states.
  [[nodiscard]] VectorXd noise_start() const {
    VectorXd variance = VectorXd::Zero(nz_);
    for (const Channel& channel : channels_)
      variance.segment(channel.drift_at + channel.size(), channel.size()) =
          channel.noise.correlated.head(channel.size()).cwiseAbs2();
    return variance;
  }

  /// Adds the noise of a sample to its true value.
  /// @param i  index of the sample among those taken in the control period
  void add_noise(const Channel& channel, Index i, MatrixXd& sample) const {
    if (!options_.noise) return;
    for (Index axis = 0; axis < channel.size(); ++axis) {
      sample(axis, channel.drift_at + axis) += 1;
      sample(axis, channel.drift_at + channel.size() + axis) += 1;
      sample(axis, nz_ + nu_ + channel.white_at + i * channel.size() + axis) +=
          channel.noise.white(axis);
    }
  }

  void add_drifts(const Channel& channel, MatrixXd& next) const {
    if (!options_.noise) return;
    const internal::ReadingNoise& noise = channel.noise;
    const double decay = noise.correlation > 0 ? std::exp(-options_.dt / noise.correlation) : 0;
    for (Index axis = 0; axis < channel.size(); ++axis) {
      const Index walk = channel.drift_at + axis, correlated = walk + channel.size();
      const Index w = nz_ + nu_ + channel.slow_at + axis;
      next(walk, walk) = 1;
      next(walk, w) = noise.walk(axis) * std::sqrt(options_.dt);
      next(correlated, correlated) = decay;
      next(correlated, w + channel.size()) = noise.correlated(axis) * std::sqrt(1 - decay * decay);
    }
  }

  /// The input from the law j periods ago, as rows over (z, u, w).
  [[nodiscard]] MatrixXd input(Index j) const {
    MatrixXd rows = MatrixXd::Zero(nu_, width());
    if (j == 0)
      rows.middleCols(nz_, nu_).setIdentity();
    else
      rows.middleCols(history_at_ + (j - 1) * nu_, nu_).setIdentity();
    return rows;
  }

  /// One control period from step k to k + 1: rows of z[k+1] over (z[k], u[k], w[k]).
  [[nodiscard]] MatrixXd step(std::size_t k, Holds& holds) const {
    MatrixXd next = MatrixXd::Zero(nz_, width());
    const MatrixXd late = body_.commands * input(part_ > 0 ? whole_ + 1 : whole_);
    const MatrixXd prompt = body_.commands * input(whole_);
    const Index nx = body_.A.rows();
    const auto state_at = [&](double h) -> MatrixXd {
      MatrixXd rows = MatrixXd::Zero(nx, width());
      const bool first_part = h <= part_;
      rows.leftCols(nx) = holds.over(h).Phi;
      if (first_part) {
        rows += holds.over(h).Gamma * late;
      } else {
        if (part_ > 0) rows += holds.over(h - part_).Phi * holds.over(part_).Gamma * late;
        rows += holds.over(h - part_).Gamma * prompt;
      }
      return rows;
    };
    next.topRows(nx) = state_at(options_.dt);
    for (Index j = 0; j < history_; ++j) next.middleRows(history_at_ + j * nu_, nu_) = input(j);
    MatrixXd readings = MatrixXd::Zero(kFrameSize, width());
    for (const Channel& channel : channels_) {
      std::vector<MatrixXd> samples = pending(channel, k);
      MatrixXd response = MatrixXd::Zero(3 * channel.size(), width());
      for (Index i = 0; channel.response && i < response.rows(); ++i)
        response(i, channel.response_at + i) = 1;
      for (long n = channel.taken(time(k)) + 1; n <= channel.taken(time(k + 1)); ++n) {
        const double h =
            std::clamp(static_cast<double>(n) / channel.rate - time(k), 0.0, options_.dt);
        MatrixXd truth =
            body_.C.middleRows(channel.first(), channel.size()) * state_at(h) +
            body_.D.middleRows(channel.first(), channel.size()) * (h <= part_ ? late : prompt);
        if (channel.response) respond(*channel.response, truth, response);
        for (Index axis = 0; axis < channel.size(); ++axis) truth.row(axis) *= channel.scale(axis);
        add_noise(channel, n - channel.taken(time(k)) - 1, truth);
        samples.push_back(std::move(truth));
      }
      if (channel.response) next.middleRows(channel.response_at, response.rows()) = response;
      add_drifts(channel, next);
      const long left = channel.taken(time(k + 1)) - channel.arrived(time(k + 1));
      const std::size_t gone = samples.size() - static_cast<std::size_t>(left);
      if (gone > 0) readings.middleRows(channel.first(), channel.size()) = samples[gone - 1];
      for (std::size_t i = gone; i < samples.size(); ++i)
        next.middleRows(channel.pending_at + static_cast<Index>(i - gone) * channel.size(),
                        channel.size()) = samples[i];
    }
    if (estimator_.steps.empty()) {
      next.middleRows(believed_at_, 12) = next.topRows(12);
      return next;
    }
    const EstimatorStep& slopes = estimator_.steps[(k + 1) % period_];
    MatrixXd rows = slopes.from_frame * readings + slopes.from_speeds * body_.commands * input(0);
    rows.middleCols(estimator_at_, slopes.from_state.cols()) += slopes.from_state;
    next.middleRows(estimator_at_, rows.rows()) = rows;
    return next;
  }

  /// Sets entries that are only rounding errors to 0, so that decoupled axes are exactly decoupled.
  void drop_rounding(MatrixXd& rows) const {
    constexpr double kRoundingOnly = 1e-13;
    VectorXd size(width());
    size.head(nz_) = scale_;
    // The magnitude of an input, now or earlier, is that which changes some state by its typical
    // magnitude.
    const auto typical = [&](Index j) {
      return 1 / rows.col(j).cwiseAbs().cwiseQuotient(scale_).maxCoeff();
    };
    for (Index j = nz_; j < width(); ++j) size(j) = typical(j);
    for (Index j = history_at_; j < history_at_ + history_ * nu_; ++j)
      size(j) = std::min(size(j), typical(j));
    for (Index j = 0; j < rows.cols(); ++j)
      for (Index i = 0; i < rows.rows(); ++i)
        if (std::abs(rows(i, j)) * size(j) <= kRoundingOnly * scale_(i)) rows(i, j) = 0;
  }

  /// The samples that have not arrived at step k, the oldest first.
  [[nodiscard]] std::vector<MatrixXd> pending(const Channel& channel, std::size_t k) const {
    const long count = channel.taken(time(k)) - channel.arrived(time(k));
    std::vector<MatrixXd> all;
    for (long i = 0; i < count; ++i) {
      MatrixXd rows = MatrixXd::Zero(channel.size(), width());
      rows.middleCols(channel.pending_at + i * channel.size(), channel.size()).setIdentity();
      all.push_back(std::move(rows));
    }
    return all;
  }

  /// @param truth  in: the true value, out: the output of the sensor's response
  static void respond(const SampledResponse& r, MatrixXd& truth, MatrixXd& state) {
    for (Index axis = 0; axis < truth.rows(); ++axis) {
      const Eigen::RowVectorXd now = truth.row(axis);
      const MatrixXd old = state.middleRows(3 * axis, 3);
      for (int i = 0; i < 2; ++i)
        state.row(3 * axis + i) =
            r.A(i, 0) * old.row(0) + r.A(i, 1) * old.row(1) + r.b0(i) * old.row(2) + r.b1(i) * now;
      state.row(3 * axis + 2) = now;
      truth.row(axis) = state.row(3 * axis);
    }
  }

  FlownPlantOptions options_;
  FlownBody body_;
  std::vector<Channel> channels_;
  std::size_t period_ = 1;
  std::size_t first_ = 0;
  LinearEstimator estimator_;
  std::vector<std::string> notes_;
  std::vector<Signal> states_;
  std::vector<double> scales_;
  VectorXd scale_;
  Index nz_ = 0, nu_ = 0, nw_ = 0;
  Index history_at_ = 0, history_ = 0, whole_ = 0, estimator_at_ = 0, believed_at_ = 0;
  double part_ = 0;  ///< fraction of a control period in the command delay [s]
};

void require(bool good, const std::string& came, const std::string& expected) {
  if (!good) throw InvalidInput(kPlantWhere, came + ", expected " + expected);
}

}  // namespace

namespace {

/// Whether satellite fixes are too slow to matter in addition to optical flow. With a clock of 1
/// Hz, the matrices of the plant would repeat only after 200 control periods of 5 ms.
bool flies_by_flow(const FlightSetup& setup, double height) {
  constexpr double kSlow = 5;  // [Hz]
  Sensors sensors = sensors_of(setup);
  if (setup.estimator != EstimatorKind::general || !sensors.flow || !sensors.gps ||
      !(sensors.gps->position.rate < kSlow))
    return false;
  sensors.gps.reset();
  return general_filter_lacks(sensors).empty() && height >= sensors.flow->min_height &&
         height <= sensors.flow->max_height;
}

}  // namespace

FlownPlant flown_plant(const FlightSetup& setup, const FlownPlantOptions& options) {
  require(options.dt > 0 && std::isfinite(options.dt),
          fmt::format("the control period is {} s", options.dt), "a positive number");
  require(options.height > 0 && std::isfinite(options.height),
          fmt::format("the height is {} m", options.height), "a positive number");
  const auto short_enough = [&](double delay) {
    return delay >= 0 && delay <= kMaxDelayPeriods * options.dt * (1 + 1e-9);
  };
  const std::string allowed =
      fmt::format("0 to {} control periods of {} s", kMaxDelayPeriods, options.dt);
  require(short_enough(options.command_delay),
          fmt::format("the command delay is {} s", options.command_delay), allowed);
  const MotorCommand& motor = flown_vehicle(setup).motor;
  const double own = motor.delay + 0.5 * motor.delay_jitter;
  FlownPlantOptions with_own = options;
  with_own.command_delay += own;
  require(short_enough(with_own.command_delay),
          fmt::format("the command delay is {} s with the vehicle's own {} s",
                      with_own.command_delay, own),
          allowed);
  if (!flies_by_flow(setup, options.height)) return Assembly(setup, with_own).make();
  FlightSetup by_flow = setup;
  by_flow.vehicle.sensors.gps.reset();
  if (by_flow.flown) by_flow.flown->sensors.gps.reset();
  FlownPlant result = Assembly(by_flow, with_own).make();
  result.notes.emplace_back(
      "the model has no GPS, because its rate is below 5 Hz: the optical flow holds the position, "
      "and the GPS would change it only over many seconds");
  return result;
}

}  // namespace quadtune
