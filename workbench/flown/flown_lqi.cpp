// SPDX-License-Identifier: Apache-2.0
#include "quadtune/workbench/flown/flown_lqi.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>

#include "quadtune/errors.hpp"
#include "quadtune/internal/in_parallel.hpp"
#include "quadtune/workbench/design/standard_axes.hpp"

namespace quadtune {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// The delay of the rate loop in control periods: the delays of commands and gyroscope, and the
/// group delay of the gyroscope's response at low frequencies, 2 ζ/ω_n.
int late_periods(const Vehicle& vehicle, double dt) {
  double delay = vehicle.motor.delay + 0.5 * vehicle.motor.delay_jitter;
  if (const auto& gyroscope = vehicle.sensors.gyroscope) {
    delay += gyroscope->delay;
    if (gyroscope->natural_frequency > 0)
      delay += 2 * gyroscope->damping / gyroscope->natural_frequency;
  }
  return std::clamp(static_cast<int>(std::lround(delay / dt)), 0, kMaxPastCommands);
}

/// Sets couplings between independent groups of axes that result from rounding to zero.
/// @param size  typical size of the factor of each column
void drop_rounding(MatrixXd& K, const VectorXd& size) {
  constexpr double kRounding = 1e-9;
  for (Index i = 0; i < K.rows(); ++i) {
    const VectorXd share = K.row(i).cwiseAbs().transpose().cwiseProduct(size);
    for (Index j = 0; j < K.cols(); ++j)
      if (share(j) <= kRounding * share.maxCoeff()) K(i, j) = 0;
  }
}

/// @param usual  weights by Bryson's rule, which define the sizes of states, inputs and integrals
void drop_rounding(Gains& gains, const ActuatorLqiWeights& usual) {
  const VectorXd states = usual.Q.diagonal().cwiseSqrt().cwiseInverse();
  const VectorXd inputs = usual.R.diagonal().cwiseSqrt().cwiseInverse();
  drop_rounding(gains.K, states);
  drop_rounding(gains.K_int, usual.Q_integral.diagonal().cwiseSqrt().cwiseInverse());
  if (!gains.memory) return;
  drop_rounding(gains.memory->K_lag, inputs);
  if (gains.memory->past > 0)
    drop_rounding(gains.memory->K_past, inputs.replicate(gains.memory->past, 1));
}

class Softening {
 public:
  Softening(const Vehicle& vehicle, const FlownLqiOptions& options,
            const std::vector<FlownFamilyMember>& family, int past)
      : vehicle_(vehicle),
        options_(options),
        family_(family),
        model_(actuator_model(vehicle, InputKind::wrench)),
        usual_(lqi_weights(standard_axes(vehicle), options.integrals)),
        weights_(options.weights.value_or(usual_)),
        past_(past) {}

  /// Returns the first design that has its margins, or else the one with the largest share of them.
  /// @param lower  whether to lower the weights of positions instead of raising those of commands
  FlownLqi run(int steps, bool lower) {
    FlownLqi best;
    double max = -1;
    std::array<double, 4> factors{1, 1, 1, 1};
    for (int i = 0; i <= steps; ++i) {
      FlownLqi result;
      (lower ? result.lowered : result.softened) = factors;
      design(result);
      const std::array<double, 4> shares = judge(result);
      const double share = *std::min_element(shares.begin(), shares.end());
      result.met = share >= 1;
      result.share = share;
      if (share > max) {
        max = share;
        best = std::move(result);
      }
      if (best.met) break;
      for (std::size_t axis = 0; axis < shares.size(); ++axis)
        if (shares[axis] < 1) factors[axis] *= lower ? 4 : 2;
    }
    return best;
  }

 private:
  void design(FlownLqi& result) const {
    result.weights = weights_;
    for (std::size_t axis = 0; axis < result.softened.size(); ++axis) {
      const Index input = wrench_of(kFlownAxes[axis]);
      result.weights.R(input, input) *= result.softened[axis];
      const Index position = states_of(kFlownAxes[axis]).front();
      result.weights.Q(position, position) /= result.lowered[axis];
      const std::string& name = ned_convention().states[static_cast<std::size_t>(position)].name;
      for (std::size_t i = 0; i < options_.integrals.size(); ++i)
        if (options_.integrals[i] == name)
          result.weights.Q_integral(static_cast<Index>(i), static_cast<Index>(i)) /=
              result.lowered[axis];
    }
    ActuatorLqiOptions options;
    options.dt = options_.dt;
    options.past = past_;
    options.integrals = options_.integrals;
    result.lqi = actuator_lqi(vehicle_, model_, result.weights, options);
    if (!result.lqi.solved())
      throw NoSolution(fmt::format("{}: lqr: {}", vehicle_.name, result.lqi.riccati.culprit),
                       vehicle_.name);
    drop_rounding(result.lqi.gains, usual_);
  }

  /// @return  the share of the margins of one group's loop over the nominal members; 0 if it is
  ///          unstable for any member
  double share(const DiscreteLti& law, FlownAxis axis) const {
    double min = std::numeric_limits<double>::infinity();
    for (const FlownFamilyMember& member : family_) {
      const PeriodicLti loop = axis_loop(member.plant, axis, law);
      if (member.nominal) {
        min = std::min(min, share_of(loop_margins(loop), options_.margins));
      } else {
        const Eigen::VectorXcd poles = periodic_poles(closed(loop));
        if (poles.size() > 0 && !(std::abs(poles(0)) < 1)) min = 0;
      }
      if (!(min > 0)) return 0;
    }
    return min;
  }

  /// The gains that determine the command of one group.
  static VectorXd gains_of(const Gains& gains, FlownAxis axis) {
    const Index row = wrench_of(axis);
    std::vector<double> all;
    const auto add = [&](const MatrixXd& K) {
      for (Index j = 0; K.rows() > row && j < K.cols(); ++j) all.push_back(K(row, j));
    };
    add(gains.K);
    add(gains.K_int);
    if (gains.memory) {
      add(gains.memory->K_lag);
      add(gains.memory->K_past);
    }
    return Eigen::Map<const VectorXd>(all.data(), std::ssize(all));
  }

  /// @return  the share of each group; results for earlier gains are reused
  std::array<double, 4> judge(const FlownLqi& result) {
    const DiscreteLti law = flown_law(vehicle_, result.lqi.gains, options_.dt);
    std::array<double, 4> shares{};
    const auto one = [&](std::size_t axis) {
      const VectorXd gains = gains_of(result.lqi.gains, kFlownAxes[axis]);
      for (const Judged& before : judged_[axis])
        if ((gains - before.gains).norm() <= 1e-9 * gains.norm()) {
          shares[axis] = before.share;
          return;
        }
      shares[axis] = share(law, kFlownAxes[axis]);
      judged_[axis].push_back({gains, shares[axis]});
    };
    internal::in_parallel(shares.size(), internal::thread_count(0), [&] { return one; }, {});
    return shares;
  }

  struct Judged {
    VectorXd gains;
    double share;
  };

  const Vehicle& vehicle_;
  const FlownLqiOptions& options_;
  const std::vector<FlownFamilyMember>& family_;
  ActuatorModel model_;
  ActuatorLqiWeights usual_, weights_;
  int past_;
  std::array<std::vector<Judged>, 4> judged_;
};

double total(const FlownLqi& design) {
  double product = 1;
  for (const double factor : design.softened) product *= factor;
  for (const double factor : design.lowered) product *= factor;
  return product;
}

/// Whether `one` is the better design: it has its margins, and was softened less.
bool better(const FlownLqi& one, const FlownLqi& other) {
  if (one.met != other.met) return one.met;
  return one.met ? total(one) < total(other) : one.share > other.share;
}

/// Computes the margins of each group for each member.
void set_margins(FlownLqi& design, const Vehicle& vehicle, const FlownLqiOptions& options,
                 const std::vector<FlownFamilyMember>& family) {
  const DiscreteLti law = flown_law(vehicle, design.lqi.gains, options.dt);
  const auto one = [&](std::size_t axis) {
    design.margins[axis].clear();
    for (const FlownFamilyMember& member : family)
      design.margins[axis].push_back(loop_margins(axis_loop(member.plant, kFlownAxes[axis], law)));
  };
  internal::in_parallel(design.margins.size(), internal::thread_count(0), [&] { return one; }, {});
}

}  // namespace

double share_of(const LoopMargins& margins, const FlownMargins& asked) {
  if (!margins.stable) return 0;
  const double up = std::log(margins.gain_margin), down = -std::log(margins.gain_reduction);
  return std::min({margins.phase_margin / asked.phase, std::min(up, down) / std::log(asked.gain),
                   margins.disk.alpha / asked.disk});
}

PeriodicLti axis_loop(const FlownPlant& plant, FlownAxis axis, const DiscreteLti& law) {
  const std::vector<Index> row = {wrench_of(axis)};
  DiscreteLti part = law;
  part.B = law.B(Eigen::all, states_of(axis)).eval();
  part.C = law.C(row, Eigen::all).eval();
  part.D = law.D(row, states_of(axis)).eval();
  return loop_part(cut_at_inputs(axis_part(plant, axis), part));
}

FlownLqiOptions flown_lqi_options(const Vehicle& vehicle, const LqiDesign& design) {
  FlownLqiOptions options;
  options.dt = design.dt;
  options.integrals = design.integrals;
  options.past = design.past;
  if (!design.Q && !design.Q_integral && !design.R && !design.R_change) return options;
  ActuatorLqiWeights weights = lqi_weights(standard_axes(vehicle), options.integrals);
  if (design.Q) weights.Q = design.Q->asDiagonal();
  if (design.Q_integral) weights.Q_integral = design.Q_integral->asDiagonal();
  if (design.R) weights.R = design.R->asDiagonal();
  if (design.R_change) {
    weights.R_change = design.R_change->asDiagonal();
    options.min_past = 1;
  }
  options.weights = weights;
  return options;
}

FlownLqi flown_lqi(const Vehicle& vehicle, const FlownLqiOptions& options) {
  (void)standard_axes(vehicle);  // throws if the vehicle cannot hover
  const std::vector<FlownFamilyMember> family =
      flown_family(vehicle, InputKind::wrench, options.dt);
  // Usually the margins are largest if the law predicts by the delay of the rates; the estimator
  // may add delay.
  const int late = late_periods(vehicle, options.dt);
  FlownLqi best;
  std::vector<Softening> lengths;
  if (options.past)
    lengths.emplace_back(vehicle, options, family, *options.past);
  else
    for (const int more : {0, 1, 2, 4})
      lengths.emplace_back(vehicle, options, family,
                           std::clamp(late + more, options.min_past, kMaxPastCommands));
  const auto attempt = [&](int steps, bool lower) {
    for (Softening& length : lengths) {
      if (best.met && total(best) <= 1) return;
      FlownLqi other = length.run(steps, lower);
      if (better(other, best)) best = std::move(other);
    }
  };
  attempt(0, false);
  if (!options.weights) attempt(5, false);
  if (!options.weights && !best.met) attempt(3, true);
  set_margins(best, vehicle, options, family);
  best.family = family;
  for (std::size_t axis = 0; axis < best.softened.size(); ++axis)
    if (best.softened[axis] > 1)
      best.notes.push_back(fmt::format(
          "the weight of {} was multiplied by {:g} for the margins of the flown loop",
          ned_convention().wrench[static_cast<std::size_t>(wrench_of(kFlownAxes[axis]))].name,
          best.softened[axis]));
  for (std::size_t axis = 0; axis < best.lowered.size(); ++axis)
    if (best.lowered[axis] > 1)
      best.notes.push_back(
          fmt::format("the weights of {} and its integral were divided by {:g} for the margins of "
                      "the flown loop",
                      ned_convention()
                          .states[static_cast<std::size_t>(states_of(kFlownAxes[axis]).front())]
                          .name,
                      best.lowered[axis]));
  if (!best.met)
    best.notes.push_back(fmt::format(
        "not every channel has {:.0f} deg of phase margin, {:.1f} dB of gain margin and a disk "
        "margin of {:g}",
        options.margins.phase * 180 / std::numbers::pi, 20 * std::log10(options.margins.gain),
        options.margins.disk));
  return best;
}

}  // namespace quadtune
