// SPDX-License-Identifier: Apache-2.0
#include "quadtune/model/mixer.hpp"

#include <fmt/format.h>

#include <Eigen/LU>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>

#include "quadtune/errors.hpp"
#include "quadtune/internal/enum_names.hpp"
#include "quadtune/matrix_checks.hpp"

namespace quadtune {
namespace {

/// Lower bound of the search as a fraction of the speed range.
constexpr double kTolerance = 1e-12;  // on MixResult::residual
constexpr double kFloor = 1e-6;
constexpr int kMaxSteps = 50;  // total number of Newton steps; five are typical
constexpr const char* kAxes[] = {"T", "tau_x", "tau_y", "tau_z"};
constexpr const char* kUnits[] = {"N", "N m", "N m", "N m"};

// The wrench of one rotor with thrust `thrust` and drag torque `torque`: [T, -y T, x T, -s Q].
Eigen::Vector4d rotor_wrench(const Rotor& rotor, double thrust, double torque) {
  return {thrust, -rotor.position.y() * thrust, rotor.position.x() * thrust,
          -spin_sign(rotor.spin) * torque};
}

using Matrix4Xd = Eigen::Matrix<double, 4, Eigen::Dynamic>;

Matrix4Xd columns(const Vehicle& vehicle, const auto& column_of) {
  Matrix4Xd M(4, static_cast<Eigen::Index>(vehicle.rotors.size()));
  for (Eigen::Index i = 0; i < M.cols(); ++i)
    M.col(i) = column_of(vehicle.rotors[static_cast<std::size_t>(i)], i);
  return M;
}

void require_speeds(const Vehicle& vehicle, const Eigen::VectorXd& w, const std::string& where) {
  require_shape(w, static_cast<Eigen::Index>(vehicle.rotors.size()), 1, where, "w",
                "one speed per rotor");
  require_finite(w, where, "w");
}

// Newton's method on wrench_of_speeds() within the speed limits.
class SpeedSearch {
 public:
  SpeedSearch(const Vehicle& vehicle, const Eigen::Vector4d& target, double density_ratio)
      : vehicle_(vehicle),
        target_(target),
        density_ratio_(density_ratio),
        low_(min_speed(vehicle)),
        high_(max_speed(vehicle)),
        free_(vehicle.rotors.size(), true) {
    // Newtons or newton metres per unit of the residual.
    const double thrust = max_thrust(vehicle, density_ratio);
    double arm = 0;
    double drag = 0;
    for (const Rotor& rotor : vehicle.rotors) {
      arm = std::max(arm, rotor.position.head<2>().norm());
      drag += rotor_torque(rotor, high_, density_ratio);
    }
    scale_ << thrust, arm > 0 ? arm * thrust : thrust, arm > 0 ? arm * thrust : thrust,
        drag > 0 ? drag : thrust;
  }

  MixResult run() {
    start();
    // One pass for each rotor that may have to be fixed at a limit.
    for (std::size_t held = 0; held <= vehicle_.rotors.size(); ++held) {
      newton();
      if (!hold_beyond_limits()) break;
    }
    return finish();
  }

 private:
  Eigen::Index count() const { return static_cast<Eigen::Index>(vehicle_.rotors.size()); }

  // Equal thrusts, as in hover, with nonzero speeds, so that the curves have a slope.
  void start() {
    w_.resize(count());
    const double share = std::max(target_(0), 0.0) / density_ratio_ / static_cast<double>(count());
    for (Eigen::Index i = 0; i < count(); ++i)
      w_(i) = std::clamp(rotor_speed_for_thrust(rotor(i), share), low_, high_);
    if (error(w_).norm() <= kTolerance) return;
    for (Eigen::Index i = 0; i < count(); ++i) w_(i) = std::max(w_(i), above_turn(i, 0.05));
  }

  // Speed at fraction `share` between the turning point of the thrust curve and the maximum speed.
  double above_turn(Eigen::Index i, double share) const {
    const double turn = std::max(0.0, -rotor(i).thrust_a1 / (2 * rotor(i).thrust_a2));
    return turn + share * std::max(0.0, high_ - turn);
  }

  const Rotor& rotor(Eigen::Index i) const { return vehicle_.rotors[static_cast<std::size_t>(i)]; }

  Eigen::VectorXd error(const Eigen::VectorXd& w) const {
    return (target_ - wrench_of_speeds(vehicle_, w, density_ratio_)).cwiseQuotient(scale_);
  }

  // Least-norm Newton steps of the free rotors, halved until the error decreases. Speeds may exceed
  // the limits here, but not fall below the turning point of their thrust curve.
  void newton() {
    double residual = error(w_).norm();
    while (residual > kTolerance && steps_ < kMaxSteps) {
      ++steps_;
      Eigen::MatrixXd J =
          scale_.cwiseInverse().asDiagonal() * wrench_jacobian(vehicle_, w_, density_ratio_);
      for (Eigen::Index i = 0; i < count(); ++i)
        if (!free_[static_cast<std::size_t>(i)]) J.col(i).setZero();
      const Eigen::VectorXd step = J.completeOrthogonalDecomposition().solve(error(w_));
      if (!step.allFinite()) return;
      double length = 1;
      Eigen::VectorXd next = stepped(step, length);
      while (length > 1e-6 && !(error(next).norm() < residual)) {
        length /= 2;
        next = stepped(step, length);
      }
      const double now = error(next).norm();
      if (!(now < residual)) return;  // at the minimum of the error, or at rounding
      const bool stalled = now > 0.999999 * residual;
      w_ = next;
      residual = now;
      if (stalled) return;
    }
  }

  Eigen::VectorXd stepped(const Eigen::VectorXd& step, double length) const {
    Eigen::VectorXd next = w_ + length * step;
    for (Eigen::Index i = 0; i < count(); ++i)
      if (free_[static_cast<std::size_t>(i)]) next(i) = std::max(next(i), above_turn(i, kFloor));
    return next;
  }

  // Fixes every free rotor that is beyond a limit at that limit. Returns false if there was none.
  bool hold_beyond_limits() {
    bool any = false;
    for (Eigen::Index i = 0; i < count(); ++i) {
      const double slack = 1e-9 * high_;
      if (!free_[static_cast<std::size_t>(i)]) continue;
      // A rotor at the lower bound of stepped() would need less thrust than it produces at any
      // speed.
      const double min = std::max(low_ - slack, above_turn(i, 1.001 * kFloor));
      if (w_(i) <= high_ + slack && w_(i) >= min) continue;
      free_[static_cast<std::size_t>(i)] = false;
      any = true;
    }
    w_ = w_.cwiseMax(low_).cwiseMin(high_);
    return any;
  }

  MixResult finish() {
    w_ = w_.cwiseMax(low_).cwiseMin(high_);
    MixResult result;
    result.w = w_;
    result.wrench = wrench_of_speeds(vehicle_, w_, density_ratio_);
    result.missing = target_ - result.wrench;
    result.residual = error(w_).norm();
    result.iterations = steps_;
    if (result.residual <= 10 * kTolerance) {
      result.status = MixStatus::solved;
      return result;
    }
    const bool held = std::any_of(free_.begin(), free_.end(), [](bool free) { return !free; });
    result.status = held ? MixStatus::saturated : MixStatus::infeasible;
    result.culprit =
        held ? rotors_at_limits() : std::string("the layout cannot produce this wrench");
    result.culprit += missing_in_words(result.missing);
    return result;
  }

  std::string rotors_at_limits() const {
    std::string words;
    for (Eigen::Index i = 0; i < count(); ++i) {
      if (free_[static_cast<std::size_t>(i)]) continue;
      const bool top = w_(i) >= high_;
      words +=
          fmt::format("{}rotor {} is at its {} speed of {:.6g} rad/s", words.empty() ? "" : ", ",
                      i + 1, top ? "maximum" : "minimum", top ? high_ : low_);
    }
    return words;
  }

  std::string missing_in_words(const Eigen::Vector4d& missing) const {
    std::string words;
    for (int axis = 0; axis < 4; ++axis)
      if (std::abs(missing(axis)) > 1e-9 * scale_(axis))
        words += fmt::format("{}{:.6g} {} of {}", words.empty() ? "; missing " : ", ",
                             missing(axis), kUnits[axis], kAxes[axis]);
    return words;
  }

  const Vehicle& vehicle_;
  Eigen::Vector4d target_;
  double density_ratio_;
  double low_;
  double high_;
  Eigen::Vector4d scale_;
  std::vector<bool> free_;
  Eigen::VectorXd w_;
  int steps_ = 0;
};

}  // namespace

Eigen::Vector4d wrench_authority(const Vehicle& vehicle, const Eigen::VectorXd& w) {
  const Eigen::MatrixXd J = wrench_jacobian(vehicle, w);
  const Eigen::MatrixXd speeds = J.completeOrthogonalDecomposition().pseudoInverse();
  const double slowest = speed_of_command(vehicle.motor, vehicle.motor.min);
  const double fastest = speed_of_command(vehicle.motor, vehicle.motor.max);
  Eigen::Vector4d authority = Eigen::Vector4d::Zero();
  for (Eigen::Index i = 0; i < 4; ++i) {
    const Eigen::VectorXd change = speeds.col(i).cwiseAbs();
    double max = std::numeric_limits<double>::infinity();
    for (Eigen::Index k = 0; k < w.size(); ++k)
      if (change(k) > 0)
        max = std::min(max, std::max(0.0, std::min(fastest - w(k), w(k) - slowest)) / change(k));
    if (std::isfinite(max)) authority(i) = max;
  }
  return authority;
}

Eigen::MatrixXd wrench_jacobian(const Vehicle& vehicle, const Eigen::VectorXd& w,
                                double density_ratio) {
  require_speeds(vehicle, w, "wrench_jacobian");
  return columns(vehicle, [&](const Rotor& rotor, Eigen::Index i) -> Eigen::Vector4d {
    // dT/dw = 2 a2 w + a1, dQ/dw = 2 d2 w + d1.
    return density_ratio * rotor_wrench(rotor, 2 * rotor.thrust_a2 * w(i) + rotor.thrust_a1,
                                        2 * rotor.torque_d2 * w(i) + rotor.torque_d1);
  });
}

Eigen::MatrixXd mixer_matrix(const Vehicle& vehicle) {
  return columns(vehicle, [&](const Rotor& rotor, Eigen::Index i) {
    if (rotor.thrust_a1 != 0 || rotor.torque_d1 != 0)
      throw InvalidInput(
          "mixer_matrix",
          fmt::format("rotor {} of '{}' has a thrust or torque with a linear term "
                      "in speed, expected pure squares because only they give a matrix",
                      i + 1, vehicle.name));
    return rotor_wrench(rotor, rotor.thrust_a2, rotor.torque_d2);
  });
}

Eigen::MatrixXd allocation_matrix(const Vehicle& vehicle) {
  return columns(vehicle, [&](const Rotor& rotor, Eigen::Index i) {
    // Q = c T at every speed: d2 / a2 = d1 / a1.
    const double difference = rotor.torque_d2 * rotor.thrust_a1 - rotor.torque_d1 * rotor.thrust_a2;
    const double size =
        std::abs(rotor.torque_d2 * rotor.thrust_a1) + std::abs(rotor.torque_d1 * rotor.thrust_a2);
    if (std::abs(difference) > 1e-12 * size)
      throw InvalidInput("allocation_matrix",
                         fmt::format("drag torque of rotor {} of '{}' is not proportional to its "
                                     "thrust, expected the same ratio at all speeds",
                                     i + 1, vehicle.name));
    return rotor_wrench(rotor, 1, rotor.torque_d2 / rotor.thrust_a2);
  });
}

constexpr internal::EnumName<MixStatus> kMixStatuses[] = {{MixStatus::solved, "solved"},
                                                          {MixStatus::saturated, "saturated"},
                                                          {MixStatus::infeasible, "infeasible"}};

std::string to_string(MixStatus status) { return internal::name_in(kMixStatuses, status); }

MixResult speeds_for_wrench(const Vehicle& vehicle, const Eigen::Vector4d& wrench,
                            double density_ratio) {
  require_finite(wrench, "speeds_for_wrench", "wrench");
  if (!(density_ratio > 0) || !std::isfinite(density_ratio))
    throw InvalidInput("speeds_for_wrench",
                       fmt::format("density ratio is {}, expected more than 0", density_ratio));
  if (vehicle.rotors.empty())
    throw InvalidInput("speeds_for_wrench", "vehicle has no rotors, expected at least one");
  return SpeedSearch(vehicle, wrench, density_ratio).run();
}

double min_speed(const Vehicle& vehicle) {
  return speed_of_command(vehicle.motor, vehicle.motor.min);
}

double max_speed(const Vehicle& vehicle) {
  return speed_of_command(vehicle.motor, vehicle.motor.max);
}

double max_thrust(const Vehicle& vehicle, double density_ratio) {
  double total = 0;
  for (const Rotor& rotor : vehicle.rotors)
    total += rotor_thrust(rotor, max_speed(vehicle), density_ratio);
  return total;
}

double thrust_to_weight(const Vehicle& vehicle) {
  return max_thrust(vehicle) / (vehicle.mass * vehicle.gravity);
}

double altitude_thrust_limit(const Vehicle& vehicle) {
  return vehicle.altitude_thrust_fraction * max_thrust(vehicle);
}

double command_per_thrust(const Vehicle& vehicle) {
  const std::string where = "command_per_thrust";
  if (vehicle.motor.law != CommandLaw::speed_squared)
    throw InvalidInput(where,
                       fmt::format("motor commands of '{}' are speeds, expected squared speeds, "
                                   "which are proportional to thrust",
                                   vehicle.name));
  if (vehicle.rotors.empty())
    throw InvalidInput(where, "vehicle has no rotors, expected at least one");
  const Rotor& first = vehicle.rotors.front();
  for (const Rotor& rotor : vehicle.rotors)
    if (rotor.thrust_a1 != 0 || rotor.thrust_a2 != first.thrust_a2)
      throw InvalidInput(where, fmt::format("rotors of '{}' differ or have a linear thrust term, "
                                            "expected T = a2 w2 with the same a2 for all",
                                            vehicle.name));
  return 1 / (first.thrust_a2 * vehicle.motor.gain);  // T = a2 w², w² = gain command
}

ThrustMixer thrust_mixer(const Vehicle& vehicle) {
  if (vehicle.rotors.size() != 4)
    throw InvalidInput("thrust_mixer", fmt::format("'{}' has {} rotors, expected 4", vehicle.name,
                                                   vehicle.rotors.size()));
  const Eigen::Matrix4d M = allocation_matrix(vehicle);
  ThrustMixer mixer;
  // Thrusts t = -T act along +z: the force is their sum, and the torques change sign; yaw, pitch,
  // roll.
  mixer.Ts2Q << M.row(0), -M.row(3), -M.row(2), -M.row(1);
  const Eigen::FullPivLU<Eigen::Matrix4d> lu(mixer.Ts2Q);
  if (!lu.isInvertible())
    throw InvalidInput("thrust_mixer",
                       fmt::format("rotors of '{}' control only {} of thrust, yaw, pitch and roll "
                                   "independently, expected all 4",
                                   vehicle.name, lu.rank()));
  mixer.Q2Ts = lu.inverse();
  return mixer;
}

}  // namespace quadtune
