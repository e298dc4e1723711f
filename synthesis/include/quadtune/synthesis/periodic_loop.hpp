// SPDX-License-Identifier: Apache-2.0
/// Linear systems whose matrices repeat after N control periods, as loops whose sensors sample at
/// other rates than the law. Theory: docs/theory.md, "The flown loop".
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

/// A time-invariant plant as a periodic one with N = 1.
/// @throws InvalidInput  for a plant with feed-through.
[[nodiscard]] PeriodicLti periodic(const DiscreteLti& plant);

/// The plant without the states that no input affects or that affect no output, determined from the
/// zero pattern of the matrices. Such states are part of no loop: the true position of a vehicle
/// without a position sensor, or a constant bias.
/// @param kept  if not null, receives the indices of the states that were kept, in order
[[nodiscard]] PeriodicLti loop_part(const PeriodicLti& plant,
                                    std::vector<Eigen::Index>* kept = nullptr);

/// The loop transfer L cut at the plant's inputs: L under negative feedback is the closed loop.
/// @param law  inputs are the plant's outputs, outputs its inputs
/// @return     states of the plant, then of the law; inputs and outputs are the plant's inputs
/// @throws InvalidInput  for other sizes or another period
[[nodiscard]] PeriodicLti cut_at_inputs(const PeriodicLti& plant, const DiscreteLti& law);

/// The loop transfer cut at the plant's outputs, where the law reads them, likewise.
/// @return  states of the plant, then of the law; inputs and outputs are the plant's outputs
/// @throws InvalidInput  for other sizes or another period
[[nodiscard]] PeriodicLti cut_at_outputs(const PeriodicLti& plant, const DiscreteLti& law);

/// The loop transfer of one channel with all other channels closed.
/// @param loop  under negative feedback, as many inputs as outputs
[[nodiscard]] PeriodicLti channel(const PeriodicLti& loop, Eigen::Index index);

/// Each channel of a loop, reduced to the states that are coupled to it when all channels are
/// closed. An instability of states that are not coupled to a channel does not affect its margins.
[[nodiscard]] std::vector<PeriodicLti> own_channels(const PeriodicLti& loop);

/// The matrices of the closed loop, A[k] - B[k] C.
[[nodiscard]] std::vector<Eigen::MatrixXd> closed(const PeriodicLti& loop);

/// The poles z of one control period: z^N is an eigenvalue of the product A[N-1] … A[0] (a Floquet
/// multiplier). Of the N roots the result is the one nearest to an eigenvalue of the mean of the
/// matrices; |z| does not depend on that choice.
/// @return  in order of decreasing |z|
[[nodiscard]] Eigen::VectorXcd periodic_poles(const std::vector<Eigen::MatrixXd>& A);

/// A pole and the states that dominate its mode.
struct NamedMode {
  std::complex<double> z;           ///< of one control period
  std::vector<std::string> states;  ///< largest first, at most three
};

/// The mode of the largest |z|.
/// @param states  names of the states, one each
/// @param scale   a typical size of each state, > 0
[[nodiscard]] NamedMode largest_mode(const std::vector<Eigen::MatrixXd>& A,
                                     const std::vector<Signal>& states,
                                     const Eigen::VectorXd& scale);

/// The mean frequency response of a periodic plant: for u[k] = e^(jw k dt) the output is e^(jw k
/// dt) times a sequence that repeats after N steps, and the mean response is the mean of that
/// sequence. For N = 1 it is the frequency response.
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

/// Margins of a loop with one channel, computed from the mean response S of the closed loop with
/// L = 1/S - 1. `stable` is exact. For N = 1 they are those of OpenLoop.
/// @param loop  one input, one output, under negative feedback
/// @param skew  as loop_margins()
/// @throws InvalidInput  for a loop of several channels
[[nodiscard]] LoopMargins loop_margins(const PeriodicLti& loop, double skew = 0);

}  // namespace quadtune
