// SPDX-License-Identifier: Apache-2.0
/// A loop cut open: what comes back, with the sign changed, of a signal put in at the cut.
#pragma once

#include <Eigen/Core>
#include <complex>
#include <vector>

#include "quadtune/frequency_response.hpp"
#include "quadtune/lti.hpp"
#include "quadtune/transfer_function.hpp"

namespace quadtune {

/// L under negative feedback: closed, its poles are the roots of det(I + L) = 0.
class OpenLoop {
 public:
  /// @throws InvalidInput  for what is not proper, has no pole, or more outputs than inputs; for a
  ///                       loop that closing makes algebraic, I + D singular.
  explicit OpenLoop(const ContinuousTransferFunction& L);
  explicit OpenLoop(const DiscreteTransferFunction& L);
  /// @param L      as many outputs as inputs
  /// @param delay  [s], ≥ 0; of a loop of one channel. The delay of a discrete loop is states.
  explicit OpenLoop(const ContinuousLti& L, double delay = 0);
  explicit OpenLoop(const DiscreteLti& L);

  /// L(jω) e^(-jω delay), or L(e^(jω dt)).
  /// @param w  [rad/s]; infinite for the feed-through of a continuous loop
  [[nodiscard]] Eigen::MatrixXcd at(double w) const;

  /// S = (I + L)⁻¹ there. Of a loop without delay it is the response of the closed loop's states:
  /// near integrators in series L is large and known to few digits, its inverse is not.
  [[nodiscard]] Eigen::MatrixXcd sensitivity(double w) const;

  /// x' = A x + B e, y = C x + D e (x[k+1] of a discrete loop), the delay left out.
  [[nodiscard]] const Eigen::MatrixXd& A() const { return A_; }  ///< (nx × nx)
  [[nodiscard]] const Eigen::MatrixXd& B() const { return B_; }  ///< (nx × n)
  [[nodiscard]] const Eigen::MatrixXd& C() const { return C_; }  ///< (n × nx)
  [[nodiscard]] const Eigen::MatrixXd& D() const { return D_; }  ///< (n × n)

  [[nodiscard]] Eigen::Index size() const { return D_.rows(); }
  [[nodiscard]] bool discrete() const { return dt_ > 0; }
  [[nodiscard]] double dt() const { return dt_; }        ///< [s]; 0 of a continuous loop
  [[nodiscard]] double delay() const { return delay_; }  ///< [s] beside the states
  [[nodiscard]] Eigen::VectorXcd poles() const;          ///< of L
  /// Poles when closed, the delay left out.
  [[nodiscard]] Eigen::VectorXcd closed_loop_poles() const;
  /// Zeros of a loop of one channel.
  [[nodiscard]] Eigen::VectorXcd zeros() const;

  /// The loop of one channel with all others closed.
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

/// Increasing frequencies [rad/s] from 0 to far beyond the fastest pole, or to Nyquist, at which a
/// loop must be examined: sixty a decade, more around each lightly damped pole and zero of the open
/// and the closed loop, spaced by its distance to the boundary, which is the width of its effect;
/// with a delay, so many that it turns the phase by at most 0.2 rad from one to the next.
[[nodiscard]] std::vector<double> frequency_grid(const OpenLoop& loop);

/// The loop of u = -K x cut at the plant's inputs: K (sI - A)⁻¹ B.
/// @param K  (nu × nx)
[[nodiscard]] OpenLoop loop_at_inputs(const ContinuousLti& plant,
                                      const Eigen::Ref<const Eigen::MatrixXd>& K);
[[nodiscard]] OpenLoop loop_at_inputs(const DiscreteLti& plant,
                                      const Eigen::Ref<const Eigen::MatrixXd>& K);

/// The same cut at the measured states: (sI - A)⁻¹ B K.
[[nodiscard]] OpenLoop loop_at_states(const ContinuousLti& plant,
                                      const Eigen::Ref<const Eigen::MatrixXd>& K);
[[nodiscard]] OpenLoop loop_at_states(const DiscreteLti& plant,
                                      const Eigen::Ref<const Eigen::MatrixXd>& K);

}  // namespace quadtune
