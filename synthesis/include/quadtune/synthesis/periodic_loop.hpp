// SPDX-License-Identifier: Apache-2.0
/// Loops whose sensors have clocks of their own: linear systems that change from one control period
/// to the next and repeat after N of them. Theory: docs/theory.md, "The flown loop".
#pragma once

#include <Eigen/Core>
#include <memory>
#include <string>
#include <vector>

#include "quadtune/lti.hpp"
#include "quadtune/synthesis/margins.hpp"

namespace quadtune {

/// x[k+1] = A[k mod N] x[k] + B[k mod N] u[k], y[k] = C x[k], one step every dt seconds.
struct PeriodicLti {
  std::vector<Eigen::MatrixXd> A;  ///< N ≥ 1 matrices (nx × nx)
  std::vector<Eigen::MatrixXd> B;  ///< N matrices (nx × nu)
  Eigen::MatrixXd C;               ///< (ny × nx)
  double dt = 0;                   ///< [s], > 0
  std::vector<Signal> states;      ///< nx names, or empty
  std::vector<Signal> inputs;      ///< nu names, or empty
  std::vector<Signal> outputs;     ///< ny names, or empty

  [[nodiscard]] std::size_t period() const { return A.size(); }  ///< N
};

/// Checks shapes and finiteness.
/// @throws InvalidInput  naming the matrix, its shape and what was expected.
void validate(const PeriodicLti& plant, const std::string& where);

/// The same plant at every step, as one of period 1.
/// @throws InvalidInput  for a plant with feed-through.
[[nodiscard]] PeriodicLti periodic(const DiscreteLti& plant);

/// Only the states that some input can move and that some output can tell of, judged by which
/// entries of the matrices are 0. What is left out is no part of any loop: the true position of a
/// vehicle that no sensor sees, a bias that nothing changes.
/// @param kept  where not null, which states were kept, in order
[[nodiscard]] PeriodicLti loop_part(const PeriodicLti& plant,
                                    std::vector<Eigen::Index>* kept = nullptr);

/// The loop cut at the plant's inputs: L with L under negative feedback the loop as it flies.
/// @param law  inputs are the plant's outputs, outputs its inputs
/// @return     states of the plant, then of the law; inputs and outputs are the plant's inputs
/// @throws InvalidInput  for other sizes or another period
[[nodiscard]] PeriodicLti cut_at_inputs(const PeriodicLti& plant, const DiscreteLti& law);

/// The loop of one channel with all others closed.
/// @param loop  under negative feedback, as many inputs as outputs
[[nodiscard]] PeriodicLti channel(const PeriodicLti& loop, Eigen::Index index);

/// The matrices of the loop when closed: A[k] - B[k] C.
[[nodiscard]] std::vector<Eigen::MatrixXd> closed(const PeriodicLti& loop);

/// Eigenvalues of the product A[N-1] … A[0], the Floquet multipliers, each as the pole z of one
/// control period that it amounts to: z^N is the multiplier. Of the N roots the one nearest to an
/// eigenvalue of the mean of the matrices is taken; |z| does not depend on that choice.
/// @return  by falling |z|
[[nodiscard]] Eigen::VectorXcd periodic_poles(const std::vector<Eigen::MatrixXd>& A);

/// A pole with the states in which its motion shows most.
struct NamedMode {
  std::complex<double> z;           ///< of one control period
  std::vector<std::string> states;  ///< most first, at most three
};

/// The mode of the largest |z|.
/// @param states  names of the states, one each
/// @param scale   size of each state that counts as 1, > 0
[[nodiscard]] NamedMode largest_mode(const std::vector<Eigen::MatrixXd>& A,
                                     const std::vector<Signal>& states,
                                     const Eigen::VectorXd& scale);

/// What comes back at the frequency that goes in, on average over the N steps: for u[k] = e^(jw k
/// dt) the output is e^(jw k dt) times something that repeats after N steps, whose mean this is. It
/// is the frequency response where N = 1.
class MeanResponse {
 public:
  /// @throws InvalidInput  as validate()
  explicit MeanResponse(const PeriodicLti& plant);
  ~MeanResponse();
  MeanResponse(MeanResponse&&) noexcept;
  MeanResponse& operator=(MeanResponse&&) noexcept;

  /// @param w  [rad/s]
  /// @return   (ny × nu); not finite at a pole
  [[nodiscard]] Eigen::MatrixXcd at(double w) const;

 private:
  struct Reduced;
  std::unique_ptr<Reduced> reduced_;
};

/// Margins of a loop of one channel by the mean response S of the closed loop, L = 1/S - 1;
/// `stable` is exact. For N = 1 those of OpenLoop.
/// @param loop  one input, one output, under negative feedback
/// @param skew  as loop_margins()
/// @throws InvalidInput  for a loop of several channels
[[nodiscard]] LoopMargins loop_margins(const PeriodicLti& loop, double skew = 0);

}  // namespace quadtune
