// SPDX-License-Identifier: Apache-2.0
#include "quadtune/synthesis/flown_axis.hpp"

#include <fmt/format.h>

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <cstddef>

#include "quadtune/errors.hpp"
#include "quadtune/internal/enum_names.hpp"

namespace quadtune {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr const char* kWhere = "flown axis";

}  // namespace

constexpr internal::EnumName<FlownAxis> kFlownAxisNames[] = {{FlownAxis::north, "north"},
                                                             {FlownAxis::east, "east"},
                                                             {FlownAxis::altitude, "altitude"},
                                                             {FlownAxis::yaw, "yaw"}};

std::string to_string(FlownAxis axis) { return internal::name_in(kFlownAxisNames, axis); }

const std::vector<Index>& states_of(FlownAxis axis) {
  static const std::array<std::vector<Index>, 4> kStates = {
      {{0, 6, 4, 10}, {1, 7, 3, 9}, {2, 8}, {5, 11}}};
  return kStates[static_cast<std::size_t>(axis)];
}

Index wrench_of(FlownAxis axis) {
  static constexpr std::array<Index, 4> kInputs = {2, 1, 0, 3};
  return kInputs[static_cast<std::size_t>(axis)];
}

PeriodicLti axis_part(const FlownPlant& plant, FlownAxis axis) {
  if (plant.plant.inputs != ned_convention().wrench || plant.plant.C.rows() != 12)
    throw InvalidInput(kWhere,
                       "the inputs or outputs of the plant are wrong, expected the wrench "
                       "and the estimates of the 12 states");
  const Index input = wrench_of(axis);
  const std::vector<Index>& outputs = states_of(axis);
  PeriodicLti part = plant.plant;
  for (MatrixXd& B : part.B) B = B.col(input).eval();
  part.C = part.C(outputs, Eigen::all).eval();
  part.inputs = {plant.plant.inputs[static_cast<std::size_t>(input)]};
  part.outputs.clear();
  for (const Index i : outputs)
    part.outputs.push_back(plant.plant.outputs[static_cast<std::size_t>(i)]);
  return loop_part(part);
}

PeriodicLti with_tilt_integral(const PeriodicLti& plant, double rate) {
  constexpr Index kRate = 3;
  validate(plant, kWhere);
  if (plant.B.front().cols() != 1 || plant.C.rows() <= kRate)
    throw InvalidInput(kWhere,
                       fmt::format("the plant has {} inputs and {} outputs, expected 1 "
                                   "(torque) and at least 4 (position, velocity, tilt, rate)",
                                   plant.B.front().cols(), plant.C.rows()));
  if (!(rate > 0) || !(rate * plant.dt < 1))
    throw InvalidInput(kWhere, fmt::format("the rate of the tilt integral is {} 1/s, expected 0 to "
                                           "{} 1/s",
                                           rate, 1 / plant.dt));
  const Index nx = plant.A.front().rows(), integral = nx, filter = nx + 1;
  PeriodicLti result = plant;
  for (std::size_t k = 0; k < plant.period(); ++k) {
    // s[k+1] = s[k] + dt v[k], u[k] = v[k] + rate s[k];
    // f[k+1] = f[k] + dt y[k], y[k] = q[k] - rate f[k]
    result.A[k].conservativeResizeLike(MatrixXd::Zero(nx + 2, nx + 2));
    result.A[k].col(integral).head(nx) = rate * plant.B[k];
    result.A[k](integral, integral) = 1;
    result.A[k].row(filter).head(nx) = plant.dt * plant.C.row(kRate);
    result.A[k](filter, filter) = 1 - rate * plant.dt;
    result.B[k].conservativeResizeLike(MatrixXd::Zero(nx + 2, 1));
    result.B[k](integral) = plant.dt;
  }
  result.C.conservativeResizeLike(MatrixXd::Zero(plant.C.rows(), nx + 2));
  result.C(kRate, filter) = -rate;
  if (!plant.states.empty()) {
    result.states.push_back({"integral of the tilt loop", ""});
    result.states.push_back({"filter of the tilt's rate", ""});
  }
  return result;
}

PeriodicLti with_rate_lead(const PeriodicLti& plant, Index rate, double gain, double share) {
  validate(plant, kWhere);
  if (rate < 0 || rate >= plant.C.rows())
    throw InvalidInput(
        kWhere, fmt::format("the rate is output {}, expected 0 to {}", rate, plant.C.rows() - 1));
  if (!(gain >= 0) || !std::isfinite(gain) || !(share > 0 && share <= 1))
    throw InvalidInput(kWhere, fmt::format("the lead has the gain {} and the share {}, expected a "
                                           "finite gain of 0 or more and a share up to 1",
                                           gain, share));
  const Index nx = plant.A.front().rows();
  const Eigen::RowVectorXd measured = plant.C.row(rate);
  PeriodicLti result = plant;
  for (std::size_t k = 0; k < plant.period(); ++k) {
    result.A[k].conservativeResizeLike(MatrixXd::Zero(nx + 1, nx + 1));
    result.A[k].row(nx).head(nx) = share * measured;
    result.A[k](nx, nx) = 1 - share;
    result.B[k].conservativeResizeLike(MatrixXd::Zero(nx + 1, plant.B[k].cols()));
  }
  result.C.conservativeResizeLike(MatrixXd::Zero(plant.C.rows(), nx + 1));
  result.C.row(rate).head(nx) = (1 + gain) * measured;
  result.C(rate, nx) = -gain;
  if (!plant.states.empty()) result.states.push_back({"low pass of the rate", ""});
  return result;
}

VectorXd rest_at(const PeriodicLti& plant, Index index) {
  const Index nx = plant.A.front().rows(), ny = plant.C.rows();
  // A delayed sample is a state only in some periods. A steady state is therefore periodic:
  // P(N, 0) x = x, and C P(k, 0) x = -e in every period k.
  const auto N = static_cast<Index>(plant.period());
  MatrixXd M(nx + N * ny, nx);
  VectorXd v = VectorXd::Zero(M.rows());
  MatrixXd P = MatrixXd::Identity(nx, nx);
  for (Index k = 0; k < N; ++k) {
    M.middleRows(nx + k * ny, ny) = plant.C * P;
    v(nx + k * ny + index) = -1;
    P = (plant.A[static_cast<std::size_t>(k)] * P).eval();
  }
  M.topRows(nx) = P - MatrixXd::Identity(nx, nx);
  return M.completeOrthogonalDecomposition().solve(v);
}

OutputFeedbackProblem axis_problem(const PeriodicLti& part, FlownAxis axis,
                                   const AxisWeights& weights, double now) {
  const std::vector<Index>& states = states_of(axis);
  const auto count = static_cast<Index>(states.size());
  if (weights.q.size() != count || part.C.rows() != count)
    throw InvalidInput(kWhere,
                       fmt::format("there are {} weights and {} outputs, expected {} of each",
                                   weights.q.size(), part.C.rows(), count));
  const double dt = part.dt;
  const Index nx = part.A.front().rows();
  OutputFeedbackProblem problem;
  problem.Q = MatrixXd::Zero(nx, nx);
  for (Index j = 0; j < count; ++j) {
    Eigen::RowVectorXd row = part.C.row(j);
    const std::string& name = part.outputs[static_cast<std::size_t>(j)].name;
    for (std::size_t i = 0; i < part.states.size(); ++i)
      if (part.states[i].name == name) row = Eigen::RowVectorXd::Unit(nx, static_cast<Index>(i));
    problem.Q += dt * weights.q(j) * row.transpose() * row;
  }
  problem.R = MatrixXd::Constant(1, 1, dt * weights.r);
  problem.start = MatrixXd(nx, 2);
  problem.start << weights.step * rest_at(part, 0), weights.impulse / dt * part.B.back();
  problem.plant = part;
  if (weights.q_integral > 0) {
    problem.plant = with_integrals(part, {0}, now);
    problem.Q.conservativeResizeLike(MatrixXd::Zero(nx + 1, nx + 1));
    problem.Q(nx, nx) = dt * weights.q_integral;
    problem.start.conservativeResizeLike(MatrixXd::Zero(nx + 1, 2));
  }
  return problem;
}

}  // namespace quadtune
