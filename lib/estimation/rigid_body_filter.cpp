// SPDX-License-Identifier: Apache-2.0
#include "quadtune/estimation/rigid_body_filter.hpp"

#include <fmt/format.h>

#include <cmath>
#include <limits>

#include "estimation/extended_run.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/estimation/uquad_filter.hpp"
#include "quadtune/internal/joined.hpp"
#include "quadtune/internal/suggest.hpp"
#include "quadtune/model/vehicle.hpp"

namespace quadtune {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using internal::ExtendedMatrix;
using internal::ExtendedVector;

/// Maximum Euler step [s]: the uquad's control period.
constexpr double kMaxBodyStep = 0.01;
/// Variances of the initial state, by kind.
constexpr double kPlaceDeviation = 1, kAngleDeviation = 0.1, kSpeedDeviation = 1,
                 kRateDeviation = 0.1, kOffsetDeviation = 0.1;

/// Quantity that an output measures.
enum class Seen { angle, force, rate, height, place, speed };

struct KnownSensor {
  const char* name;
  std::vector<Signal> outputs;
  Seen seen;
  int first;  ///< state of the first output
};

const std::vector<KnownSensor>& known_sensors() {
  static const std::vector<KnownSensor> known = {
      {"tilt", {{"roll", "rad"}, {"pitch", "rad"}}, Seen::angle, kAttitude},
      {"yaw", {{"yaw", "rad"}}, Seen::angle, kAttitude + 2},
      {"force", {{"fx", "m/s2"}, {"fy", "m/s2"}, {"fz", "m/s2"}}, Seen::force, kForceBias},
      {"rates", {{"p", "rad/s"}, {"q", "rad/s"}, {"r", "rad/s"}}, Seen::rate, kRates},
      {"height", {{"height", "m"}}, Seen::height, kPosition + 2},
      {"position", {{"x", "m"}, {"y", "m"}, {"z", "m"}}, Seen::place, kPosition},
      {"velocity", {{"vx", "m/s"}, {"vy", "m/s"}, {"vz", "m/s"}}, Seen::speed, kVelocity},
      {"vision", {{"vision_x", "m"}, {"vision_y", "m"}, {"vision_z", "m"}}, Seen::place, kPosition},
  };
  return known;
}

const KnownSensor* find_sensor(const std::string& name) {
  for (const KnownSensor& sensor : known_sensors())
    if (sensor.name == name) return &sensor;
  return nullptr;
}

/// One row of the measurement: its kind and its first state.
struct Row {
  Seen seen;
  int state;
};

std::vector<Row> rows_of(const FilterModel& model) {
  std::vector<Row> rows;
  for (const FilterSensor& sensor : model.sensors) {
    const KnownSensor* known = find_sensor(sensor.name);
    if (known == nullptr || known->outputs.size() != sensor.outputs.size())
      (void)rigid_body_sensor(sensor.name, "filter model");
    for (int i = 0; i < static_cast<int>(sensor.outputs.size()); ++i)
      rows.push_back({known->seen, known->first + i});
  }
  return rows;
}

class RigidBodyMotion {
 public:
  RigidBodyMotion(const RigidBody& body, std::vector<Row> rows)
      : body_(&body), rows_(std::move(rows)) {}

  void move(double h, const Eigen::Ref<const VectorXd>& speeds, ExtendedVector& x) {
    h_ = h;
    loads_ = rotor_loads(*body_, speeds);
    const StateVector<double> state = x.head<12>();
    A_ = state_jacobian(*body_, state, loads_);
    x.head<12>() += state_derivative(*body_, state, loads_) * h;
  }
  void advance(ExtendedMatrix& M) const { uquad_filter_internal::advance_rows(A_, h_, M); }
  void add_noise(const MatrixXd& shape, ExtendedMatrix& N) const { N += h_ * shape; }

  void observe(const ExtendedVector& x, MatrixXd& C, VectorXd& expected) const {
    const StateVector<double> state = x.head<12>();
    const Vector3<double> v = state.segment<3>(kVelocity);
    const StateJacobian<double> A = state_jacobian(*body_, state, loads_);
    const Vector3<double> speed = A.position_velocity * v;
    const Vector3<double> felt = (loads_.force + drag_force(*body_, v)) / body_->mass;
    for (Index i = 0; i < expected.size(); ++i) {
      const Row& row = rows_[static_cast<std::size_t>(i)];
      const int axis = row.state % 3;
      switch (row.seen) {
        case Seen::angle:
        case Seen::rate:
        case Seen::place:
          C(i, row.state) = 1;
          expected(i) = x(row.state);
          break;
        case Seen::height:
          C(i, row.state) = -1;
          expected(i) = -x(row.state);
          break;
        case Seen::force:
          C(i, kVelocity + axis) = -(body_->air_density * body_->cda(axis) * std::abs(v(axis)) +
                                     body_->linear_drag(axis)) /
                                   body_->mass;
          C(i, row.state) = 1;
          expected(i) = felt(axis) + x(row.state);
          break;
        case Seen::speed:
          C.block<1, 3>(i, kAttitude) = A.position_attitude.row(axis);
          C.block<1, 3>(i, kVelocity) = A.position_velocity.row(axis);
          expected(i) = speed(axis);
          break;
      }
    }
  }

  [[nodiscard]] double difference(Index i, double y, double expected) const {
    const double e = y - expected;
    return rows_[static_cast<std::size_t>(i)].seen == Seen::angle ? wrap_angle(e) : e;
  }
  static void absorb(ExtendedVector&) {}
  /// True angles in the turn nearest to that of the state.
  static void relate(const FilterRecord& record, Index k, const ExtendedVector& x,
                     FilterRecord& into) {
    for (Index i = kAttitude; i < kAttitude + 3; ++i)
      into.truth(i, k) = x(i) + wrap_angle(record.truth(i, k) - x(i));
  }

  void hold(const Eigen::Ref<const VectorXd>& speeds) { loads_ = rotor_loads(*body_, speeds); }

 private:
  const RigidBody* body_;
  std::vector<Row> rows_;
  double h_ = 0;
  RotorLoads<double> loads_;
  StateJacobian<double> A_;
};

/// Initial angles and positions from the first samples of their sensors.
ExtendedVector first_guess(const FilterModel& model, const FilterRecord& measured,
                           const std::vector<Row>& rows) {
  ExtendedVector x = model.x0;
  for (Index i = 0; i < measured.y.rows(); ++i) {
    const Row& row = rows[static_cast<std::size_t>(i)];
    if (row.seen != Seen::angle && row.seen != Seen::height && row.seen != Seen::place) continue;
    for (Index k = 0; k < measured.samples(); ++k) {
      if (std::isnan(measured.y(i, k))) continue;
      x(row.state) = row.seen == Seen::height ? -measured.y(i, k) : measured.y(i, k);
      break;
    }
  }
  return x;
}

}  // namespace

FilterModel rigid_body_model(const std::string& vehicle) {
  const std::size_t rotors = load_vehicle(vehicle).rotors.size();
  FilterModel model;
  model.vehicle = vehicle;
  model.states = {{"px", "m"},    {"py", "m"},    {"pz", "m"},    {"roll", "rad"}, {"pitch", "rad"},
                  {"yaw", "rad"}, {"u", "m/s"},   {"v", "m/s"},   {"w", "m/s"},    {"p", "rad/s"},
                  {"q", "rad/s"}, {"r", "rad/s"}, {"bx", "m/s2"}, {"by", "m/s2"},  {"bz", "m/s2"}};
  model.noises = model.states;
  for (Signal& noise : model.noises) noise.unit.clear();
  for (std::size_t i = 1; i <= rotors; ++i)
    model.inputs.push_back({fmt::format("speed_{}", i), "rad/s"});
  model.A = MatrixXd::Zero(kUquadStates, kUquadStates);
  model.B = MatrixXd::Zero(kUquadStates, static_cast<Index>(rotors));
  model.G = MatrixXd::Identity(kUquadStates, kUquadStates);
  model.Q.fixed = MatrixXd::Zero(kUquadStates, kUquadStates);
  model.x0 = VectorXd::Zero(kUquadStates);
  model.P0 = uquad_variances<double>(kPlaceDeviation, kAngleDeviation, kSpeedDeviation,
                                     kRateDeviation, kOffsetDeviation)
                 .asDiagonal();
  model.diffuse.assign(kUquadStates, false);
  return model;
}

FilterSensor rigid_body_sensor(const std::string& name, const std::string& where) {
  const KnownSensor* known = find_sensor(name);
  if (known == nullptr) {
    std::vector<std::string> names;
    for (const KnownSensor& sensor : known_sensors()) names.emplace_back(sensor.name);
    throw InvalidInput(
        where, fmt::format("no sensor '{}', expected one of {}{}", name,
                           internal::joined(names, ", "), internal::did_you_mean(name, names)));
  }
  FilterSensor sensor;
  sensor.name = name;
  sensor.outputs = known->outputs;
  const auto ny = static_cast<Index>(known->outputs.size());
  sensor.C = MatrixXd::Zero(ny, kUquadStates);
  for (Index i = 0; i < ny; ++i)
    sensor.C(i, known->first + i) = known->seen == Seen::height ? -1 : 1;
  sensor.R.fixed = MatrixXd::Zero(ny, ny);
  return sensor;
}

namespace {

class RigidBodyFilter final : public internal::ExtendedFilter {
 public:
  RigidBodyFilter(FilterModel model, const std::vector<FilterRecord>& records)
      : ExtendedFilter(std::move(model), records, false, kMaxBodyStep),
        body_(load_vehicle(model_.vehicle)),
        rows_(rows_of(model_)) {
    for (const FilterRecord& measured : measurements())
      start_.push_back(first_guess(model_, measured, rows_));
  }

 private:
  bool run(std::size_t record, const Eigen::Ref<const VectorXd>& theta,
           const std::function<bool()>& stop, FilterRecord& into,
           double& failed_at) const override {
    const internal::DrivenRecord& driven = driven_[record];
    RigidBodyMotion motion(body_, rows_);
    motion.hold(driven.drive.u.col(0));
    internal::ExtendedRun<RigidBodyMotion> run(model_, driven, theta, motion, stop);
    run.x = start_[record];
    const bool done = run.run(std::numeric_limits<double>::infinity(), &into);
    failed_at = run.failed_at;
    return done;
  }

  RigidBody body_;
  std::vector<Row> rows_;
  std::vector<ExtendedVector> start_;
};

}  // namespace

std::unique_ptr<NonlinearFilter> internal::rigid_body_filter(
    FilterModel model, const std::vector<FilterRecord>& records) {
  return std::make_unique<RigidBodyFilter>(std::move(model), records);
}

}  // namespace quadtune
