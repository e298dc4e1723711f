// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <cmath>
#include <string>
#include <variant>

#include "quadtune/control/cascade_law.hpp"
#include "quadtune/control/state_feedback_law.hpp"
#include "quadtune/convention.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/synthesis/flown_plant.hpp"

namespace quadtune {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

/// i[k] = i[k-1] - dt x[k], u[k] = K_int i[k] - K x[k].
DiscreteLti without_memory(const StateFeedbackSettings<double>& law, double dt) {
  DiscreteLti result;
  result.dt = dt;
  const Index ni = law.integrals;
  result.A = MatrixXd::Identity(ni, ni);
  result.B = MatrixXd::Zero(ni, 12);
  for (Index j = 0; j < ni; ++j) {
    result.B(j, law.integrated[static_cast<std::size_t>(j)]) = -dt;
    const std::string& name =
        ned_convention()
            .states[static_cast<std::size_t>(law.integrated[static_cast<std::size_t>(j)])]
            .name;
    result.states.push_back({"integral of " + name, ""});
  }
  const MatrixXd K_int = law.K_int.topLeftCorner(law.inputs, ni);
  result.C = K_int;
  result.D = K_int * result.B - law.K.topRows(law.inputs);
  result.inputs = ned_convention().states;
  return result;
}

/// Adds -K_lag m[k] - K_past [u[k-1]; …] to the law's output u[k], with the states m and u[k-j].
/// @param W  the gains' inputs per input of quadtune's own, transposed: u_ned = W u
DiscreteLti with_memory(const DiscreteLti& law, const CommandMemory& memory, const MatrixXd& W) {
  const Index n = law.A.rows(), nu = W.rows(), past = memory.past;
  const Index m_at = n, past_at = n + nu, nx = n + nu * (1 + past);
  DiscreteLti result = law;
  result.C = MatrixXd::Zero(nu, nx);
  result.C.leftCols(n) = law.C;
  result.C.middleCols(m_at, nu) = -W * memory.K_lag * W.transpose();
  for (Index j = 0; j < past; ++j)
    result.C.middleCols(past_at + j * nu, nu) =
        -W * memory.K_past.middleCols(j * nu, nu) * W.transpose();
  result.A = MatrixXd::Zero(nx, nx);
  result.B = MatrixXd::Zero(nx, law.B.cols());
  result.A.topLeftCorner(n, n) = law.A;
  result.B.topRows(n) = law.B;
  // m[k+1] = m[k] + (1 - e^(-dt/lag)) (u[k-past] - m[k])
  const Eigen::VectorXd lag = W.cwiseAbs() * memory.lag;
  for (Index i = 0; i < nu; ++i) {
    const double share = -std::expm1(-law.dt / lag(i));
    if (past == 0) {
      result.A.row(m_at + i) = share * result.C.row(i);
      result.B.row(m_at + i) = share * law.D.row(i);
    } else {
      result.A(m_at + i, past_at + (past - 1) * nu + i) = share;
    }
    result.A(m_at + i, m_at + i) += 1 - share;
    result.states.push_back({fmt::format("lag of command {}", i + 1), ""});
  }
  for (Index j = 0; j < past; ++j)
    for (Index i = 0; i < nu; ++i) {
      const Index row = past_at + j * nu + i;
      if (j == 0) {
        result.A.row(row) = result.C.row(i);
        result.B.row(row) = law.D.row(i);
      } else {
        result.A(row, row - nu) = 1;
      }
      result.states.push_back({fmt::format("command {} of k-{}", i + 1, j + 1), ""});
    }
  return result;
}

}  // namespace

DiscreteLti flown_law(const Vehicle& vehicle, const Gains& gains, double dt) {
  const StateFeedbackSettings<double> settings = state_feedback_settings(vehicle, gains, dt, {});
  DiscreteLti law = without_memory(settings, dt);
  if (!gains.memory) return law;
  const auto rotors = static_cast<int>(vehicle.rotors.size());
  const MatrixXd W =
      input_from_ned(convention(gains.convention, "gains"), gains.input_kind, rotors).transpose();
  return with_memory(law, *gains.memory, W);
}

DiscreteLti flown_law(const CascadeGains& gains, PidMethod method) {
  DiscreteLti law = cascade_law(gains, method);
  law.B = law.B.rightCols(12).eval();
  law.D = law.D.rightCols(12).eval();
  law.inputs = ned_convention().states;
  for (Signal& state : law.states) {
    const bool integral = state.name.starts_with("int_");
    state.name = (integral ? "integral of " : "low pass of the rate of ") +
                 state.name.substr(state.name.find('_') + 1);
  }
  return law;
}

namespace {

const StateFeedbackController& feedback_of(const FlightSetup& setup) {
  if (const auto* own = std::get_if<OwnController>(&setup.controller))
    throw InvalidInput("flown loop",
                       fmt::format("the law '{}' has no linear model, expected a PID cascade or a "
                                   "state feedback, whose gains are known",
                                   own->name));
  return std::get<StateFeedbackController>(setup.controller);
}

}  // namespace

DiscreteLti flown_law(const FlightSetup& setup) {
  if (const auto* cascade = std::get_if<CascadeController>(&setup.controller))
    return flown_law(cascade->gains, cascade->method);
  const StateFeedbackController& feedback = feedback_of(setup);
  return flown_law(setup.vehicle, feedback.gains, feedback.dt);
}

InputKind input_kind(const FlightSetup& setup) {
  if (std::holds_alternative<CascadeController>(setup.controller)) return InputKind::wrench;
  return feedback_of(setup).gains.input_kind;
}

}  // namespace quadtune
