// SPDX-License-Identifier: Apache-2.0
#include "quadtune/tuning/uncertain_vehicle.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "gains/hover_slopes.hpp"
#include "quadtune/control/cascade_law.hpp"
#include "quadtune/control/state_feedback_law.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/internal/border.hpp"
#include "quadtune/linearize/linearize.hpp"
#include "quadtune/synthesis/flown_plant.hpp"

namespace quadtune {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using internal::HoverSlopes;
using internal::SlopeBounds;

constexpr const char* kHoverWhere = "uncertain hover";

// A ratio below this share of its nominal value is not realistic.
constexpr double kMinRatio = 0.05;
constexpr double kMaxScale = 100;

// Indices of the parameters.
enum Place : Index { kMass, kInertiaX, kInertiaY, kInertiaZ, kThrust };

constexpr Index kFirstRate = 9;  // p among the 12 states
constexpr Index kDownSpeed = 8;  // w
constexpr int kWrench = 4;

[[noreturn]] void refuse(const std::string& came, const std::string& expected) {
  throw InvalidInput(kHoverWhere, came + ", expected " + expected);
}

void require_ratio(const char* name, const UncertainRange& range) {
  if (!(range.low > 0) || !(range.low <= 1) || !(range.high >= 1) || !std::isfinite(range.high))
    refuse(fmt::format("{} is {} … {}", name, range.low, range.high),
           "a range of positive ratios that contains 1, the value in the file");
}

void require_uncertainty(const VehicleUncertainty& u) {
  require_ratio("mass", u.mass);
  require_ratio("inertia", u.inertia);
  require_ratio("thrust", u.thrust);
  if (!(u.delay.low >= 0) || !(u.delay.low <= u.delay.high) || !std::isfinite(u.delay.high))
    refuse(fmt::format("delay is {} … {} s", u.delay.low, u.delay.high),
           "finite seconds with 0 <= low <= high");
  const bool none = u.lag.low == 0 && u.lag.high == 0;
  if (!none && (!(u.lag.low > 0) || !(u.lag.low <= u.lag.high) || !std::isfinite(u.lag.high)))
    refuse(fmt::format("lag is {} … {} s", u.lag.low, u.lag.high),
           "finite seconds with 0 < low <= high, or 0 for no lag");
}

/// The hover of a vehicle in which roll, pitch, yaw and height are decoupled.
void require_plain_hover(const Vehicle& vehicle, const TrimResult& trim) {
  if (!trim.solved()) refuse(trim.culprit, "a vehicle that can hover");
  const Rotor& first = vehicle.rotors.front();
  for (const Rotor& rotor : vehicle.rotors)
    if (rotor.thrust_a2 != first.thrust_a2 || rotor.thrust_a1 != first.thrust_a1 ||
        rotor.torque_d2 != first.torque_d2 || rotor.torque_d1 != first.torque_d1)
      refuse("the rotors have different curves",
             "equal curves, because one ratio of thrust scales them all");
  if (!(first.thrust_a2 > 0) || !(first.torque_d2 >= 0))
    refuse("the thrust curve has no quadratic term", "a curve with a2 > 0 and d2 >= 0");
  if ((trim.u.array() - trim.u.mean()).abs().maxCoeff() > 1e-9 * trim.u.mean())
    refuse("the rotors hover at different speeds",
           "equal speeds, because their slopes must scale equally");
  double momentum = 0;
  for (const Rotor& rotor : vehicle.rotors) momentum += spin_sign(rotor.spin) * rotor.inertia;
  if (std::abs(momentum) > 1e-12 * first.inertia)
    refuse("the angular momentum of the rotors is not balanced",
           "a balanced one, because it couples roll and pitch otherwise");
  MatrixXd products = vehicle.inertia;
  products.diagonal().setZero();
  if (products.cwiseAbs().maxCoeff() > 0)
    refuse("the inertia matrix has off-diagonal entries",
           "principal axes, because each moment has its own ratio");
}

/// A of the 12 states of ned_convention() at a level hover, without the effect of the wrench.
MatrixXd hover_dynamics(const Vehicle& vehicle, double yaw) {
  MatrixXd A = MatrixXd::Zero(12, 12);
  const double c = std::cos(yaw);
  const double s = std::sin(yaw);
  A(0, 6) = c;  // position' = Rz(yaw) velocity
  A(0, 7) = -s;
  A(1, 6) = s;
  A(1, 7) = c;
  A(2, 8) = 1;
  for (Index i = 0; i < 3; ++i) A(3 + i, 9 + i) = 1;  // attitude' = rates
  A(6, 4) = -vehicle.gravity;                         // nose up slows down
  A(7, 3) = vehicle.gravity;
  return A;
}

/// The law about the hover, in terms of the 12 states and the wrench.
struct HoverLaw {
  DiscreteLti law;             ///< inputs: the kept states; outputs: T, τx, τy, τz
  std::vector<Index> kept;     ///< of the 12 states
  std::vector<Signal> states;  ///< with the names of the law
  InputKind kind = InputKind::wrench;
  double yaw = 0;  ///< [rad]
};

/// Derivative of the wrench with respect to the inputs of the law at the nominal hover.
MatrixXd wrench_of_inputs(const Vehicle& vehicle, const FlightCondition& hover, InputKind kind) {
  if (kind == InputKind::wrench) return MatrixXd::Identity(kWrench, kWrench);
  const MatrixXd B = linearize(vehicle, hover, {"ned", kind, {}}).plant.B;
  MatrixXd M(kWrench, B.cols());
  M.row(0) = -vehicle.mass * B.row(kDownSpeed);
  for (Index i = 0; i < 3; ++i) M.row(1 + i) = vehicle.inertia(i, i) * B.row(kFirstRate + i);
  return M;
}

void require_hover_set_point(const StateVector<double>& x0) {
  StateVector<double> moved = x0;
  moved.head<3>().setZero();
  moved(5) = 0;
  if (moved.cwiseAbs().maxCoeff() > 1e-8)
    refuse("the gains are for a moving or tilted flight condition",
           "a hover, because elsewhere the trim's tilt follows from mass and thrust");
}

HoverLaw law_of(const Vehicle& vehicle, const Gains& gains) {
  if (!(gains.dt > 0))
    refuse("the gains have no sample period", "a positive period, because the loop is sampled");
  const StateFeedbackSettings<double> ned = state_feedback_settings(vehicle, gains, gains.dt, {});
  require_hover_set_point(ned.x0);
  HoverLaw hover;
  hover.kind = gains.input_kind;
  hover.yaw = ned.x0(5);
  const Convention& words = convention(gains.convention, kHoverWhere);
  for (Index i = 0; i < 12; ++i)
    for (std::size_t row = 0; row < words.states.size(); ++row) {
      if (words.from_ned(static_cast<Index>(row), i) == 0) continue;
      const auto has = [&](const Signal& state) { return state.name == words.states[row].name; };
      if (std::none_of(gains.states.begin(), gains.states.end(), has)) continue;
      hover.kept.push_back(i);
      hover.states.push_back(words.states[row]);
    }
  FlightCondition condition;
  condition.yaw = hover.yaw;
  const MatrixXd M = wrench_of_inputs(vehicle, condition, gains.input_kind);
  // A law with memory is closed as it runs on board: integrals are advanced before they are used.
  if (gains.memory) {
    const DiscreteLti law = flown_law(vehicle, gains, gains.dt);
    hover.law.dt = gains.dt;
    hover.law.A = law.A;
    hover.law.B = law.B(Eigen::all, hover.kept);
    hover.law.C = M * law.C;
    hover.law.D = M * law.D(Eigen::all, hover.kept);
    return hover;
  }
  // A law without memory is closed in the same way as in `verify`: u = -K x + K_int i, i⁺ = i - dt
  // x of the integrated states.
  const auto nx = static_cast<Index>(hover.kept.size());
  hover.law.dt = gains.dt;
  hover.law.A = MatrixXd::Identity(ned.integrals, ned.integrals);
  hover.law.B = MatrixXd::Zero(ned.integrals, nx);
  for (int j = 0; j < ned.integrals; ++j)
    for (Index i = 0; i < nx; ++i)
      if (hover.kept[static_cast<std::size_t>(i)] == ned.integrated[static_cast<std::size_t>(j)])
        hover.law.B(j, i) = -gains.dt;
  hover.law.C = M * ned.K_int.topLeftCorner(ned.inputs, ned.integrals);
  hover.law.D = -M * ned.K.topRows(ned.inputs)(Eigen::all, hover.kept);
  return hover;
}

HoverLaw law_of(const CascadeGains& cascade, PidMethod method) {
  const DiscreteLti whole = cascade_law(cascade, method);
  HoverLaw hover;
  hover.law = whole;
  hover.law.B = whole.B.rightCols(12);
  hover.law.D = whole.D.rightCols(12);
  for (Index i = 0; i < 12; ++i) hover.kept.push_back(i);
  hover.states = ned_convention().states;
  return hover;
}

/// The loop family: the indices of the factors, and their values as functions of the parameters.
class HoverFamily {
 public:
  HoverFamily(const Vehicle& vehicle, HoverLaw law, const VehicleUncertainty& uncertainty)
      : vehicle_(vehicle),
        law_(std::move(law)),
        uncertainty_(uncertainty),
        has_lag_(uncertainty.lag.high > 0),
        lag_moves_(uncertainty.lag.high > uncertainty.lag.low),
        has_drag_(vehicle.drag.linear.cwiseAbs().maxCoeff() > 0) {
    lag_ = nominal_lag();
  }

  LoopFamily make() const {
    LoopFamily family;
    family.parameters = parameters();
    family.loop = loop();
    const HoverSlopes slopes(vehicle_, law_.kind);
    const Numbers numbers{slopes, has_drag_, lag_moves_, lag_};
    family.at = [numbers](const VectorXd& p) { return numbers.at(p); };
    family.over = [numbers](const VectorXd& low, const VectorXd& high) {
      return numbers.over(low, high);
    };
    limit_scale(family);
    return family;
  }

 private:
  /// Factors of the loop from the parameters; copied into the functions.
  struct Numbers {
    HoverSlopes slopes;
    bool has_drag;
    bool lag_moves;
    double lag;

    [[nodiscard]] LoopPoint at(const VectorXd& p) const {
      const internal::Slopes slope = slopes.at(p(kMass), p(kThrust));
      std::vector<double> numbers = {slope.thrust / p(kMass), slope.thrust / p(kInertiaX),
                                     slope.thrust / p(kInertiaY), slope.torque / p(kInertiaZ)};
      if (has_drag) numbers.push_back(1 / p(kMass));
      if (lag_moves) numbers.push_back(lag / p(kThrust + 1));
      return {Eigen::Map<VectorXd>(numbers.data(), std::ssize(numbers)), p(p.size() - 1)};
    }

    [[nodiscard]] LoopBox over(const VectorXd& low, const VectorXd& high) const {
      const SlopeBounds slope = slopes.over(low(kMass), high(kMass), low(kThrust), high(kThrust));
      std::vector<UncertainRange> bounds = {
          slope.thrust_over_mass,
          {slope.thrust.low / high(kInertiaX), slope.thrust.high / low(kInertiaX)},
          {slope.thrust.low / high(kInertiaY), slope.thrust.high / low(kInertiaY)},
          {slope.torque.low / high(kInertiaZ), slope.torque.high / low(kInertiaZ)}};
      if (has_drag) bounds.push_back({1 / high(kMass), 1 / low(kMass)});
      if (lag_moves) bounds.push_back({lag / high(kThrust + 1), lag / low(kThrust + 1)});
      LoopBox box{VectorXd(std::ssize(bounds)), VectorXd(std::ssize(bounds)), low(low.size() - 1),
                  high(high.size() - 1)};
      for (std::size_t i = 0; i < bounds.size(); ++i) {
        box.low(static_cast<Index>(i)) = bounds[i].low * (1 - 1e-14);  // rounded outwards
        box.high(static_cast<Index>(i)) = bounds[i].high * (1 + 1e-14);
      }
      return box;
    }
  };

  /// The value of the vehicle if the range contains it, otherwise the middle.
  [[nodiscard]] double nominal_lag() const {
    const double own = slower_lag(vehicle_.rotors.front());
    const bool inside = uncertainty_.lag.low <= own && own <= uncertainty_.lag.high;
    return inside ? own : 0.5 * (uncertainty_.lag.low + uncertainty_.lag.high);
  }

  [[nodiscard]] std::vector<UncertainParameter> parameters() const {
    const VehicleUncertainty& u = uncertainty_;
    std::vector<UncertainParameter> all = {{"mass", "", u.mass.low, 1, u.mass.high}};
    for (const char* axis : {"inertia x", "inertia y", "inertia z"})
      all.push_back({axis, "", u.inertia.low, 1, u.inertia.high});
    all.push_back({"thrust", "", u.thrust.low, 1, u.thrust.high});
    all.push_back({"lag", "s", u.lag.low, lag_, u.lag.high});
    all.push_back({"delay", "s", u.delay.low, u.delay.low, u.delay.high});
    return all;
  }

  /// Wrench to accelerations: rows of the 12 states, one column for each of T, τx, τy, τz.
  [[nodiscard]] std::vector<MatrixXd> wrench_columns() const {
    std::vector<MatrixXd> columns(kWrench, MatrixXd::Zero(12, kWrench));
    columns[0](kDownSpeed, 0) = -1 / vehicle_.mass;
    for (Index i = 0; i < 3; ++i)
      columns[static_cast<std::size_t>(1 + i)](kFirstRate + i, 1 + i) = 1 / vehicle_.inertia(i, i);
    return columns;
  }

  [[nodiscard]] UncertainLoop loop() const {
    static constexpr const char* kNames[] = {"thrust over mass", "roll torque over inertia",
                                             "pitch torque over inertia",
                                             "yaw torque over inertia"};
    const auto nx = static_cast<Index>(law_.kept.size());
    const Index n = nx + (has_lag_ ? kWrench : 0);
    UncertainLoop loop;
    loop.plant.A = MatrixXd::Zero(n, n);
    loop.plant.A.topLeftCorner(nx, nx) = hover_dynamics(vehicle_, law_.yaw)(law_.kept, law_.kept);
    loop.plant.B = MatrixXd::Zero(n, kWrench);
    loop.plant.states = law_.states;
    const std::vector<MatrixXd> columns = wrench_columns();
    for (int j = 0; j < kWrench; ++j) {
      PlantTerm term{kNames[j], {}, {}};
      MatrixXd& M = has_lag_ ? term.A : term.B;
      M = MatrixXd::Zero(n, has_lag_ ? n : kWrench);
      M.block(0, has_lag_ ? nx : 0, nx, kWrench) =
          columns[static_cast<std::size_t>(j)](law_.kept, Eigen::all);
      loop.terms.push_back(std::move(term));
    }
    if (has_drag_) loop.terms.push_back(drag_term(n));
    if (has_lag_) add_lag(loop);
    loop.law = law_.law;
    const Index ni = loop.law.A.rows();
    loop.law.B.conservativeResizeLike(MatrixXd::Zero(ni, n));
    loop.law.D.conservativeResizeLike(MatrixXd::Zero(kWrench, n));
    return loop;
  }

  [[nodiscard]] PlantTerm drag_term(Index n) const {
    MatrixXd A = MatrixXd::Zero(12, 12);
    for (Index i = 0; i < 3; ++i) A(6 + i, 6 + i) = -vehicle_.drag.linear(i) / vehicle_.mass;
    PlantTerm term{"drag over mass", MatrixXd::Zero(n, n), {}};
    const auto nx = static_cast<Index>(law_.kept.size());
    term.A.topLeftCorner(nx, nx) = A(law_.kept, law_.kept);
    return term;
  }

  /// The acting wrench follows the commanded one: if all rotors have the same lag, so has each
  /// component.
  void add_lag(UncertainLoop& loop) const {
    const Index n = loop.plant.A.rows();
    PlantTerm term{"inverse lag", MatrixXd::Zero(n, n), MatrixXd::Zero(n, kWrench)};
    term.A.bottomRightCorner(kWrench, kWrench).diagonal().setConstant(-1 / lag_);
    term.B.bottomRows(kWrench).diagonal().setConstant(1 / lag_);
    for (const Signal& input : ned_convention().wrench)
      loop.plant.states.push_back({input.name + " acting", input.unit});
    if (lag_moves_) {
      loop.terms.push_back(std::move(term));
    } else {
      loop.plant.A += term.A;
      loop.plant.B += term.B;
    }
  }

  void limit_scale(LoopFamily& family) const {
    family.max_scale = kMaxScale;
    family.max_scale_reason = "the search is limited to this";
    const auto limit = [&](double scale, const std::string& why) {
      if (!(scale < family.max_scale)) return;
      family.max_scale = scale;
      family.max_scale_reason = why;
    };
    for (const UncertainParameter& p : family.parameters)
      if (p.name != "delay" && p.low < p.nominal)
        limit((1 - kMinRatio) * p.nominal / (p.nominal - p.low),
              fmt::format("{} is then {:g} of nominal", p.name, kMinRatio));
    const UncertainParameter& delay = family.parameters.back();
    if (delay.high > delay.low)
      limit((0.999 * kMaxDelayPeriods * law_.law.dt - delay.low) / (delay.high - delay.low),
            fmt::format("the delay is then {} periods", kMaxDelayPeriods));
    limit_by_hover(family);
  }

  /// The heaviest vehicle on the weakest rotors, and the lightest on the strongest.
  void limit_by_hover(LoopFamily& family) const {
    const auto why_not = [&](double scale) {
      const ParameterBox box = scaled_box(family, scale);
      const std::string heavy = cannot_hover(vehicle_, box.high(kMass), box.low(kThrust));
      return heavy.empty() ? cannot_hover(vehicle_, box.low(kMass), box.high(kThrust)) : heavy;
    };
    if (why_not(family.max_scale).empty()) return;
    const auto [low, high] = internal::border([&](double scale) { return why_not(scale).empty(); },
                                              0.0, family.max_scale, 1e-12);
    family.max_scale = std::max(low, 1e-9);
    family.max_scale_reason = why_not(high);
  }

  const Vehicle& vehicle_;
  HoverLaw law_;
  VehicleUncertainty uncertainty_;
  bool has_lag_;
  bool lag_moves_;
  bool has_drag_;
  double lag_ = 0;  // [s]
};

LoopFamily family_of(const Vehicle& vehicle, HoverLaw law, const VehicleUncertainty& uncertainty) {
  require_uncertainty(uncertainty);
  return HoverFamily(vehicle, std::move(law), uncertainty).make();
}

}  // namespace

std::string cannot_hover(const Vehicle& vehicle, double mass, double thrust) {
  Vehicle other = vehicle;
  other.mass *= mass;
  for (Rotor& rotor : other.rotors) {
    rotor.thrust_a2 *= thrust;
    rotor.thrust_a1 *= thrust;
    rotor.torque_d2 *= thrust;
    rotor.torque_d1 *= thrust;
  }
  const TrimResult found = trim(other, FlightCondition{});
  if (found.solved()) return "";
  return fmt::format("with {:.4g} times the mass and {:.4g} times the thrust, {}", mass, thrust,
                     found.culprit);
}

LoopFamily uncertain_hover(const Vehicle& vehicle, const Gains& gains,
                           const VehicleUncertainty& uncertainty) {
  require_plain_hover(vehicle, trim(vehicle, FlightCondition{}));
  return family_of(vehicle, law_of(vehicle, gains), uncertainty);
}

LoopFamily uncertain_hover(const Vehicle& vehicle, const CascadeGains& cascade, PidMethod method,
                           const VehicleUncertainty& uncertainty) {
  require_plain_hover(vehicle, trim(vehicle, FlightCondition{}));
  return family_of(vehicle, law_of(cascade, method), uncertainty);
}

}  // namespace quadtune
