// SPDX-License-Identifier: Apache-2.0
/// LQR, LQI and LQG for plants that are given as matrices, with their evidence.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "quadtune/synthesis/lqg_regulator.hpp"
#include "quadtune/synthesis/lqr.hpp"
#include "quadtune/workbench/design/lqr_report.hpp"
#include "quadtune/workbench/design/named_loop.hpp"

namespace quadtune {

/// An LQR problem with integrals of outputs and a delay of the input.
struct MatrixLqrProblem {
  LqrProblem lqr;          ///< with integrals, Q and N have their rows after those of the states
  Eigen::MatrixXd C;       ///< (ny × nx) outputs to integrate; empty: none
  Eigen::MatrixXd D = {};  ///< (ny × nu), or empty for zero
  double dt = 1;           ///< sample period of a discrete problem [s], > 0
  int delay = 0;           ///< [samples] of the input, ≥ 0; only discrete or sampled
};

/// Its solution: u = -K x + K_int ∫(r - y) - Σ K_past,j u[k-j].
struct MatrixLqrReport {
  LqrReport lqr;           ///< of all states together; if it is not solved, the gains are empty
  Eigen::MatrixXd K;       ///< (nu × nx)
  Eigen::MatrixXd K_int;   ///< (nu × ny); empty without integrals
  Eigen::MatrixXd K_past;  ///< (nu × nu delay): of u[k-1], u[k-2], …; empty without delay
  std::optional<SampledLqr> sampled = {};  ///< of a sampled problem: plant and cost per step
};

/// With `sampled`, the cost of the states is sampled exactly, and the integrals are those of a
/// program, i[k+1] = i[k] + dt y[k], whose weight is held for a sample.
/// @throws InvalidInput  as lqr() and with_output_integrals(); for a sampled problem also if Q has
/// cross weights between states and integrals; for a continuous problem with a
///                        delay
[[nodiscard]] MatrixLqrReport matrix_lqr(const MatrixLqrProblem& problem,
                                         std::optional<MarginsEvidence> evidence = {});

/// An LQG problem for given matrices.
struct MatrixLqgProblem {
  Eigen::MatrixXd A,       ///< (nx × nx)
      B,                   ///< (nx × nu)
      C;                   ///< (ny × nx)
  Eigen::MatrixXd D = {};  ///< (ny × nu), or empty for zero
  LqrWeights weights;      ///< per step if discrete
  KalmanNoise noise;       ///< covariances per step if discrete, otherwise densities
  /// Whether plant, cost and noise are continuous, discrete or sampled.
  MatrixTime time = MatrixTime::continuous;
  double dt = 1;                                ///< [s], > 0 unless continuous
  LqgEstimate estimate = LqgEstimate::current;  ///< the measurements that an estimate uses
};

/// A regulator, discrete if dt > 0, with the margins of its loop.
struct MatrixLqgReport {
  RiccatiResult lqr;    ///< of the state feedback
  KalmanResult filter;  ///< of the filter
  Eigen::MatrixXd A,    ///< (n × n) of the controller from y to -u; empty unless both are solved
      B,                ///< (n × ny)
      C,                ///< (nu × n)
      D;                ///< (nu × ny)
  Eigen::VectorXcd poles;     ///< of the closed loop
  Eigen::VectorXd state_rms,  ///< (nx) rms of the states in the closed loop
      input_rms;              ///< (nu) rms of the inputs
  /// Mean cost, per step if discrete; NaN unless both are solved.
  double cost = std::numeric_limits<double>::quiet_NaN();
  double dt = 0;                      ///< [s]; 0: continuous
  MarginsReport margins;              ///< at the inputs of the plant
  std::vector<std::string> messages;  ///< "warning: …" and "note: …" for the user

  /// Whether both equations are solved.
  [[nodiscard]] bool solved() const { return lqr.solved() && filter.solved(); }
};

/// With MatrixTime::sampled, plant, cost and process noise are sampled exactly, and the measurement
/// noise is that of a sample, R/dt.
/// @throws InvalidInput  as lqg_regulator()
[[nodiscard]] MatrixLqgReport matrix_lqg(const MatrixLqgProblem& problem);

}  // namespace quadtune
