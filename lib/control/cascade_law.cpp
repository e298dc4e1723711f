// SPDX-License-Identifier: Apache-2.0
#include "quadtune/control/cascade_law.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <string_view>
#include <type_traits>

#include "quadtune/convention.hpp"
#include "quadtune/errors.hpp"

namespace quadtune {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::RowVectorXd;

/// Indices of a loop's signals: its set point (or -1 if an outer loop commands it), and its value
/// and rate in the 12 states of ned_convention().
struct LoopSignals {
  std::string_view name;
  Index set_point;
  Index value;
  Index rate;
};

constexpr std::array<LoopSignals, 6> kLoops = {{{"x", 0, 0, 6},
                                                {"y", 1, 1, 7},
                                                {"pitch", -1, 4, 10},
                                                {"roll", -1, 3, 9},
                                                {"yaw", 3, 5, 11},
                                                {"altitude", 2, 2, 8}}};

std::array<PidLoop, 6> in_order(const CascadeGains& gains) {
  std::array<PidLoop, 6> loops;
  for (const PidLoop& loop : gains.loops) {
    std::size_t k = 0;
    while (k < kLoops.size() && kLoops[k].name != loop.name) ++k;
    if (k == kLoops.size())
      throw InvalidInput(
          "cascade law",
          fmt::format("no loop '{}', expected x, y, pitch, roll, yaw or altitude", loop.name));
    if (!std::isfinite(loop.Kp) || !std::isfinite(loop.Ki) || !std::isfinite(loop.Kd))
      throw InvalidInput("cascade law", fmt::format("loop '{}' has gains {}, {}, {}, expected "
                                                    "finite numbers",
                                                    loop.name, loop.Kp, loop.Ki, loop.Kd));
    if (!(loop.rate_lead >= 0 && std::isfinite(loop.rate_lead)) ||
        !(loop.rate_filter >= 0 && std::isfinite(loop.rate_filter)))
      throw InvalidInput("cascade law",
                         fmt::format("loop '{}' has rate_lead {} s and rate_filter {} s, expected "
                                     "finite times of 0 or more",
                                     loop.name, loop.rate_lead, loop.rate_filter));
    loops[k] = loop;
  }
  return loops;
}

/// Expresses signals as rows over [integrals; low passes; inputs] until all loops are processed.
///
/// @param rate_of_integral  factor of Ki · error in the integral's equation: dt sampled, 1
///                          continuous
/// @param at_once           fraction of Ki · error that the integral adds in the same instant
/// @param dt                sampled period [s]; 0: continuous
template <class Lti>
Lti assemble(const CascadeGains& gains, double rate_of_integral, double at_once, double dt) {
  const std::array<PidLoop, 6> loops = in_order(gains);
  Index integrals = 0, low_passes = 0;
  for (const PidLoop& loop : loops) {
    integrals += loop.Ki != 0 ? 1 : 0;
    low_passes += loop.rate_lead != 0 ? 1 : 0;
  }
  const bool sampled = dt > 0;
  const Index inputs = kCascadeSetPoints + 12;
  const Index memory = integrals + low_passes, width = memory + inputs;
  const auto unit = [&](Index column) {
    RowVectorXd row = RowVectorXd::Zero(width);
    row(column) = 1;
    return row;
  };
  const auto state = [&](Index k) { return unit(memory + kCascadeSetPoints + k); };
  MatrixXd dynamics = MatrixXd::Zero(memory, width);
  Index next = 0, next_low_pass = integrals;
  std::array<RowVectorXd, 6> output;
  for (std::size_t k = 0; k < loops.size(); ++k) {
    const PidLoop& loop = loops[k];
    const LoopSignals& signals = kLoops[k];
    /// x commands pitch, y roll.
    RowVectorXd error = signals.set_point >= 0 ? unit(memory + signals.set_point)
                                               : output[signals.name == "pitch" ? 0 : 1];
    error -= state(signals.value);
    RowVectorXd rate = state(signals.rate);
    if (loop.rate_lead != 0) {
      // rate' = (rate - low pass)/(Tf + dt); the low pass follows with this slope.
      const RowVectorXd slope = (rate - unit(next_low_pass)) / (loop.rate_filter + dt);
      rate += loop.rate_lead * slope;
      dynamics.row(next_low_pass) = sampled ? RowVectorXd(unit(next_low_pass) + dt * slope) : slope;
      ++next_low_pass;
    }
    output[k] = (loop.Kp + loop.Ki * at_once) * error + loop.Kd * rate;
    if (loop.Ki == 0) continue;
    output[k] += unit(next);
    dynamics.row(next) = loop.Ki * rate_of_integral * error;
    if (sampled) dynamics(next, next) += 1;
    ++next;
  }
  MatrixXd wrench(4, width);
  wrench << -output[5], output[3], output[2], output[4];
  Lti law;
  law.A = dynamics.leftCols(memory);
  law.B = dynamics.rightCols(inputs);
  law.C = wrench.leftCols(memory);
  law.D = wrench.rightCols(inputs);
  for (const PidLoop& loop : loops)
    if (loop.Ki != 0) law.states.push_back({"int_" + loop.name, ""});
  for (const PidLoop& loop : loops)
    if (loop.rate_lead != 0) law.states.push_back({"rate_" + loop.name, ""});
  law.inputs = {{"x_sp", "m"}, {"y_sp", "m"}, {"z_sp", "m"}, {"yaw_sp", "rad"}};
  for (const Signal& signal : ned_convention().states) law.inputs.push_back(signal);
  law.outputs = ned_convention().wrench;
  return law;
}

template <class Lti>
void require_fit(const Lti& plant, const Lti& law, int set_points) {
  const Index outputs = plant.C.rows();
  if (law.D.cols() != set_points + outputs || law.D.rows() != plant.B.cols())
    throw InvalidInput(
        "closed loop",
        fmt::format("the law has {} inputs and {} outputs, expected {} set points, {} outputs of "
                    "the plant and {} inputs of the plant",
                    law.D.cols(), law.D.rows(), set_points, outputs, plant.B.cols()));
  if (plant.D.size() > 0 && !plant.D.isZero(0))
    throw InvalidInput(
        "closed loop",
        "the plant has direct feedthrough, expected D = 0 because otherwise the loop "
        "is algebraic");
  if constexpr (std::is_same_v<Lti, DiscreteLti>)
    if (plant.dt != law.dt)
      throw InvalidInput("closed loop",
                         fmt::format("the sample period of the plant is {} s and that of the law "
                                     "{} s, expected equal periods",
                                     plant.dt, law.dt));
}

template <class Lti>
Lti around(const Lti& plant, const Lti& law, int set_points, bool cut) {
  require_fit(plant, law, set_points);
  const Index np = plant.A.rows();
  const Index nl = law.A.rows();
  const Index ny = plant.C.rows();
  const MatrixXd D = law.D.rightCols(ny);
  const MatrixXd B = law.B.rightCols(ny);
  Lti loop;
  if constexpr (std::is_same_v<Lti, DiscreteLti>) loop.dt = plant.dt;
  loop.A = MatrixXd::Zero(np + nl, np + nl);
  loop.A.topLeftCorner(np, np) = plant.A;
  loop.A.bottomLeftCorner(nl, np) = B * plant.C;
  loop.A.bottomRightCorner(nl, nl) = law.A;
  loop.states = plant.states;
  loop.states.insert(loop.states.end(), law.states.begin(), law.states.end());
  if (loop.states.size() != static_cast<std::size_t>(np + nl)) loop.states.clear();
  if (cut) {
    loop.B = MatrixXd::Zero(np + nl, plant.B.cols());
    loop.B.topRows(np) = plant.B;
    loop.C = MatrixXd(law.C.rows(), np + nl);
    loop.C << -D * plant.C, -law.C;
    loop.D = MatrixXd::Zero(law.C.rows(), plant.B.cols());
    loop.inputs = plant.inputs;
    return loop;
  }
  loop.A.topLeftCorner(np, np) += plant.B * D * plant.C;
  loop.A.topRightCorner(np, nl) = plant.B * law.C;
  loop.B = MatrixXd(np + nl, set_points);
  loop.B << plant.B * law.D.leftCols(set_points), law.B.leftCols(set_points);
  loop.C = MatrixXd::Zero(ny, np + nl);
  loop.C.leftCols(np) = plant.C;
  loop.D = MatrixXd::Zero(ny, set_points);
  loop.outputs = plant.outputs;
  loop.inputs.assign(law.inputs.begin(),
                     law.inputs.begin() + (law.inputs.empty() ? 0 : set_points));
  return loop;
}

template <class Lti>
Lti with_states_as_outputs(Lti plant) {
  const Index nx = plant.A.rows();
  if (plant.C.size() == 0) plant.C = MatrixXd::Identity(nx, nx);
  return plant;
}

}  // namespace

DiscreteLti cascade_law(const CascadeGains& gains, PidMethod method) {
  if (!(gains.dt > 0) || !std::isfinite(gains.dt))
    throw InvalidInput("cascade law",
                       fmt::format("dt is {} s, expected a positive period", gains.dt));
  auto law = assemble<DiscreteLti>(gains, gains.dt, pid_quadrature<double>(method).now * gains.dt,
                                   gains.dt);
  law.dt = gains.dt;
  return law;
}

ContinuousLti cascade_law(const CascadeGains& gains) {
  for (const PidLoop& loop : gains.loops)
    if (loop.rate_lead > 0 && loop.rate_filter == 0)
      throw InvalidInput("cascade law",
                         fmt::format("loop '{}' differentiates the rate without a filter, expected "
                                     "rate_filter > 0 in continuous time",
                                     loop.name));
  return assemble<ContinuousLti>(gains, 1, 0, 0);
}

DiscreteLti cut_at_inputs(const DiscreteLti& plant, const DiscreteLti& law, int set_points) {
  return around(with_states_as_outputs(plant), law, set_points, true);
}
ContinuousLti cut_at_inputs(const ContinuousLti& plant, const ContinuousLti& law, int set_points) {
  return around(with_states_as_outputs(plant), law, set_points, true);
}
DiscreteLti closed_loop(const DiscreteLti& plant, const DiscreteLti& law, int set_points) {
  return around(with_states_as_outputs(plant), law, set_points, false);
}
ContinuousLti closed_loop(const ContinuousLti& plant, const ContinuousLti& law, int set_points) {
  return around(with_states_as_outputs(plant), law, set_points, false);
}

}  // namespace quadtune
