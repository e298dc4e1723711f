// SPDX-License-Identifier: Apache-2.0
#include "quadtune/synthesis/kalman.hpp"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <cmath>

#include "quadtune/discretize/van_loan.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/internal/counted.hpp"
#include "quadtune/matrix_checks.hpp"

namespace quadtune {
namespace {

/// The process noise mapped to the states by G: W = G Q Gᵀ and the cross term G N.
struct StateNoise {
  Eigen::MatrixXd W;   // (nx × nx)
  Eigen::MatrixXd GN;  // (nx × ny), or empty
};

/// Rejects an indefinite joint covariance of w and v.
void require_covariance(const KalmanNoise& noise) {
  const Eigen::Index nw = noise.Q.rows();
  Eigen::MatrixXd joint(nw + noise.R.rows(), nw + noise.R.rows());
  joint << noise.Q, noise.N, noise.N.transpose(), noise.R;
  // Check the correlation matrix, so that different units do not matter. A noise with zero variance
  // is uncorrelated with all others.
  Eigen::VectorXd units = joint.diagonal();
  for (Eigen::Index i = 0; i < units.size(); ++i) {
    const double size = units(i) > 0 ? std::sqrt(units(i)) : joint.row(i).cwiseAbs().maxCoeff();
    units(i) = size > 0 ? 1 / size : 1;
  }
  const Eigen::MatrixXd correlations = units.asDiagonal() * joint * units.asDiagonal();
  constexpr double kTyped = 1e-9;  // as 0.3333333333 for a third
  const double min =
      Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(correlations, Eigen::EigenvaluesOnly)
          .eigenvalues()
          .minCoeff();
  if (min >= -kTyped) return;
  throw InvalidInput(
      "kalman", fmt::format("[Q N; N' R] is indefinite: its correlation matrix has the eigenvalue "
                            "{:.3g}, expected all >= 0 because it is the covariance of w and v",
                            min));
}

void require_not_negative(const Eigen::MatrixXd& covariance, const char* where, const char* name) {
  const Eigen::VectorXd eigenvalues =
      Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(covariance, Eigen::EigenvaluesOnly)
          .eigenvalues();
  if (eigenvalues.minCoeff() < -1e-12 * eigenvalues.cwiseAbs().maxCoeff())
    throw InvalidInput(where, fmt::format("{} has eigenvalue {:.6g}, expected none below 0 because "
                                          "it is a covariance",
                                          name, eigenvalues.minCoeff()));
}

template <class Lti>
StateNoise check_and_map(const Lti& model, const KalmanNoise& noise) {
  const char* where = "kalman";
  const Eigen::Index nx = model.A.rows();
  if (nx == 0) throw InvalidInput(where, "A is empty, expected at least one state");
  if (model.A.cols() != nx)
    throw InvalidInput(where, fmt::format("A is {}, expected a square matrix", shape(model.A)));
  const Eigen::Index ny = model.C.rows();
  if (ny == 0) throw InvalidInput(where, "C is empty, expected at least one measurement");
  if (model.C.cols() != nx)
    throw InvalidInput(where, fmt::format("C is {}, expected {} (A is {})", shape(model.C),
                                          internal::counted(nx, "column"), shape(model.A)));
  const Eigen::MatrixXd G =
      noise.G.size() ? noise.G : Eigen::MatrixXd(Eigen::MatrixXd::Identity(nx, nx));
  if (G.rows() != nx)
    throw InvalidInput(where, fmt::format("G is {}, expected {} (A is {})", shape(G),
                                          internal::counted(nx, "row"), shape(model.A)));
  const Eigen::Index nw = G.cols();
  require_shape(noise.Q, nw, nw, where, "Q",
                noise.G.size() ? "G is " + shape(G) : "A is " + shape(model.A));
  require_shape(noise.R, ny, ny, where, "R", "C is " + shape(model.C));
  if (noise.N.size())
    require_shape(noise.N, nw, ny, where, "N", "one row per w, one column per measurement");
  require_finite(model.A, where, "A");
  require_finite(model.C, where, "C");
  require_finite(G, where, "G");
  require_finite(noise.Q, where, "Q");
  require_finite(noise.R, where, "R");
  require_finite(noise.N, where, "N");
  require_symmetric(noise.Q, where, "Q");
  require_symmetric(noise.R, where, "R");
  require_not_negative(noise.Q, where, "Q");
  require_not_negative(noise.R, where, "R");
  if (noise.N.size()) require_covariance(noise);
  StateNoise mapped;
  mapped.W = G * noise.Q * G.transpose();
  mapped.W = 0.5 * (mapped.W + mapped.W.transpose()).eval();
  if (noise.N.size()) mapped.GN = G * noise.N;
  return mapped;
}

/// Calls care() or dare(): the regulator of (Aᵀ, Cᵀ) is the filter of (A, C). Their errors are
/// rethrown with the name of kalman().
template <class Equation, class Lti>
RiccatiResult solve_dual(Equation equation, const Lti& model, const StateNoise& mapped,
                         const Eigen::MatrixXd& R, RiccatiOptions options) {
  options.problem = RiccatiProblem::filter;
  if (options.state_names.empty() && !model.states.empty())
    options.state_names = names_or_numbers(model.states, model.A.rows());
  try {
    return equation(model.A.transpose(), model.C.transpose(), mapped.W, R, mapped.GN, options);
  } catch (const InvalidInput& error) {
    throw InvalidInput("kalman", error.message());
  }
}

/// Controllability of (Aᵀ, Cᵀ) is observability of (A, C), and vice versa.
RiccatiStatus filter_status(RiccatiStatus dual) {
  switch (dual) {
    case RiccatiStatus::not_stabilizable:
      return RiccatiStatus::not_detectable;
    case RiccatiStatus::not_detectable:
      return RiccatiStatus::not_stabilizable;
    default:
      return dual;
  }
}

KalmanResult from_dual(const RiccatiResult& dual) {
  KalmanResult result;
  result.status = filter_status(dual.status);
  result.P = dual.X;
  result.L = dual.K.transpose();
  result.poles = dual.poles;
  result.residual = dual.residual;
  result.rcond = dual.rcond;
  result.iterations = dual.iterations;
  result.culprit = dual.culprit;
  result.warning = dual.warning;
  return result;
}

}  // namespace

KalmanResult kalman(const DiscreteLti& model, const KalmanNoise& noise,
                    const RiccatiOptions& options) {
  const StateNoise mapped = check_and_map(model, noise);
  KalmanResult result = from_dual(solve_dual(dare, model, mapped, noise.R, options));
  const Eigen::Index nx = model.A.rows();
  if (!result.solved()) {
    result.M =
        Eigen::MatrixXd::Constant(nx, model.C.rows(), std::numeric_limits<double>::quiet_NaN());
    result.Z = result.P;
    return result;
  }
  // M = P Cᵀ (C P Cᵀ + R)⁻¹
  const Eigen::MatrixXd PCt = result.P * model.C.transpose();
  const Eigen::MatrixXd S = model.C * PCt + noise.R;
  result.M = S.ldlt().solve(PCt.transpose()).transpose();
  // Z = (I - M C) P (I - M C)ᵀ + M R Mᵀ: Joseph's form stays symmetric and ≥ 0.
  const Eigen::MatrixXd T = Eigen::MatrixXd::Identity(nx, nx) - result.M * model.C;
  result.Z = T * result.P * T.transpose() + result.M * noise.R * result.M.transpose();
  result.Z = 0.5 * (result.Z + result.Z.transpose()).eval();
  return result;
}

KalmanResult kalman(const ContinuousLti& model, const KalmanNoise& noise,
                    const RiccatiOptions& options) {
  const StateNoise mapped = check_and_map(model, noise);
  return from_dual(solve_dual(care, model, mapped, noise.R, options));
}

SampledKalman sampled_kalman(const ContinuousLti& model, const KalmanNoise& noise, double dt) {
  const StateNoise mapped = check_and_map(model, noise);
  if (noise.N.size() && noise.N.cwiseAbs().maxCoeff() > 0)
    throw InvalidInput("kalman",
                       "N is not zero, expected zero for a sampled problem, which assumes that "
                       "the noises of states and measurements are independent");
  const SampledNoise sampled = sampled_noise(model.A, mapped.W, dt);
  SampledKalman result;
  result.model.A = sampled.A;
  result.model.C = model.C;
  result.model.dt = dt;
  result.model.states = model.states;
  result.noise = {{}, sampled.Q, noise.R / dt, {}};
  return result;
}

KalmanResult kalman_sampled(const ContinuousLti& model, const KalmanNoise& noise, double dt,
                            const RiccatiOptions& options) {
  const SampledKalman sampled = sampled_kalman(model, noise, dt);
  return kalman(sampled.model, sampled.noise, options);
}

}  // namespace quadtune
