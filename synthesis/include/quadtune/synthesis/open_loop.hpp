// SPDX-License-Identifier: Apache-2.0
/// The open-loop transfer function L of a feedback loop that is cut at one place. The sign
/// convention is negative feedback.
#pragma once

#include <Eigen/Core>
#include <complex>
#include <vector>

#include "quadtune/frequency_response.hpp"
#include "quadtune/lti.hpp"
#include "quadtune/transfer_function.hpp"

namespace quadtune {

/// L under negative feedback: the poles of the closed loop are the roots of det(I + L) = 0.
class OpenLoop {
 public:
  /// @throws InvalidInput  if L is not proper, has no pole or is not square, or if the closed loop
  ///                       is algebraic (I + D is singular).
  explicit OpenLoop(const ContinuousTransferFunction& L);
  /// The same for a discrete transfer function.
  explicit OpenLoop(const DiscreteTransferFunction& L);
  /// @param L      as many outputs as inputs
  /// @param delay  [s], ≥ 0; must be 0 if there are several channels. In a discrete loop, states
  ///               represent the delay.
  /// @throws InvalidInput  as validate(); if L is not square, if the closed loop is algebraic, or
  ///                       if the delay is out of range
  explicit OpenLoop(const ContinuousLti& L, double delay = 0);
  explicit OpenLoop(const DiscreteLti& L);  ///< the same for a discrete system

  /// Computes L(jω) e^(-jω delay), or L(e^(jω dt)).
  /// @param w  [rad/s]; infinite for the feed-through of a continuous loop
  [[nodiscard]] Eigen::MatrixXcd at(double w) const;

  /// Computes S = (I + L)⁻¹ at w [rad/s]. Without delay it is the response of a state-space model
  /// of the closed loop: near integrators in series L is large and has few correct digits, whereas
  /// the response of the closed loop is accurate.
  [[nodiscard]] Eigen::MatrixXcd sensitivity(double w) const;

  /// x' = A x + B e, y = C x + D e (discrete: x[k+1] = …), without the delay.
  [[nodiscard]] const Eigen::MatrixXd& A() const { return A_; }  ///< (nx × nx)
  [[nodiscard]] const Eigen::MatrixXd& B() const { return B_; }  ///< (nx × n)
  [[nodiscard]] const Eigen::MatrixXd& C() const { return C_; }  ///< (n × nx)
  [[nodiscard]] const Eigen::MatrixXd& D() const { return D_; }  ///< (n × n)

  [[nodiscard]] Eigen::Index size() const { return D_.rows(); }  ///< n, the number of channels
  [[nodiscard]] bool discrete() const { return dt_ > 0; }        ///< whether the loop is sampled
  [[nodiscard]] double dt() const { return dt_; }                ///< [s]; 0 if continuous
  [[nodiscard]] double delay() const { return delay_; }          ///< [s] in addition to the states
  [[nodiscard]] Eigen::VectorXcd poles() const;                  ///< poles of L
  /// Poles of the closed loop without the delay.
  [[nodiscard]] Eigen::VectorXcd closed_loop_poles() const;
  /// Zeros of a loop with one channel.
  [[nodiscard]] Eigen::VectorXcd zeros() const;

  /// The open loop of one channel with all other channels closed.
  /// @param index  of the channel, 0 ≤ index < size()
  /// @throws InvalidInput  if there is no such channel, or if its own loop is algebraic
  [[nodiscard]] OpenLoop channel(Eigen::Index index) const;
  /// The same loop without its delay.
  [[nodiscard]] OpenLoop without_delay() const;

 private:
  OpenLoop(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B, const Eigen::MatrixXd& C,
           const Eigen::MatrixXd& D, double dt, double delay);

  Eigen::MatrixXd A_, B_, C_, D_;
  double dt_;
  double delay_;
  FrequencyResponse response_;
  FrequencyResponse sensitivity_;
};

/// Computes increasing frequencies [rad/s], from 0 to far beyond the fastest pole or to the Nyquist
/// frequency, at which a loop is evaluated. There are sixty per decade and more around each lightly
/// damped pole and zero of the open and the closed loop, where the spacing is proportional to the
/// distance of the pole or zero to the stability boundary, which is the width of its resonance.
/// With a delay, the grid is fine enough that the delay changes the phase by at most 0.2 rad per
/// step.
[[nodiscard]] std::vector<double> frequency_grid(const OpenLoop& loop);

/// Computes the open loop of u = -K x cut at the plant's inputs: K (sI - A)⁻¹ B.
/// @param plant  nx states, nu inputs; C and D are not used
/// @param K      (nu × nx)
/// @throws InvalidInput  as validate(), or if K has the wrong shape or an entry that is not finite
[[nodiscard]] OpenLoop loop_at_inputs(const ContinuousLti& plant,
                                      const Eigen::Ref<const Eigen::MatrixXd>& K);

/// The same for a discrete plant.
[[nodiscard]] OpenLoop loop_at_inputs(const DiscreteLti& plant,
                                      const Eigen::Ref<const Eigen::MatrixXd>& K);

/// Computes the open loop of u = -K x cut at the measured states: (sI - A)⁻¹ B K.
/// Arguments and errors as loop_at_inputs().
[[nodiscard]] OpenLoop loop_at_states(const ContinuousLti& plant,
                                      const Eigen::Ref<const Eigen::MatrixXd>& K);

/// The same for a discrete plant.
[[nodiscard]] OpenLoop loop_at_states(const DiscreteLti& plant,
                                      const Eigen::Ref<const Eigen::MatrixXd>& K);

}  // namespace quadtune
