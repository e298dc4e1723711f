// SPDX-License-Identifier: Apache-2.0
/// Linear systems whose matrices repeat after N control periods, for example loops whose sensors
/// sample at other rates than the law. Theory: docs/theory.md, "The flown loop".
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
/// @throws InvalidInput  if the plant has feed-through.
[[nodiscard]] PeriodicLti periodic(const DiscreteLti& plant);

/// Removes the states that no input affects or that affect no output, as determined from the zero
/// pattern of the matrices. Such states are not part of a loop: the true position of a vehicle
/// without a position sensor, or a constant bias.
/// @param plant  any periodic system
/// @param kept   if not null, receives the indices of the states that were kept, in order
[[nodiscard]] PeriodicLti loop_part(const PeriodicLti& plant,
                                    std::vector<Eigen::Index>* kept = nullptr);

/// Computes the open loop L, cut at the plant's inputs. L under negative feedback is the closed
/// loop.
/// @param plant  sampled with the period of the law
/// @param law    inputs are the plant's outputs, outputs its inputs; C and D explicit, also if zero
/// @return       states of the plant, then of the law; inputs and outputs are the plant's inputs
/// @throws InvalidInput  if the sizes or the control periods of plant and law disagree
[[nodiscard]] PeriodicLti cut_at_inputs(const PeriodicLti& plant, const DiscreteLti& law);

/// Computes the open loop, cut at the plant's outputs where the law reads them, in the same way.
/// @return  states of the plant, then of the law; inputs and outputs are the plant's outputs
/// @throws InvalidInput  if the sizes or the control periods of plant and law disagree
[[nodiscard]] PeriodicLti cut_at_outputs(const PeriodicLti& plant, const DiscreteLti& law);

/// Computes the open loop of one channel with all other channels closed.
/// @param loop   under negative feedback, as many inputs as outputs
/// @param index  of the channel, 0 ≤ index < number of channels
[[nodiscard]] PeriodicLti channel(const PeriodicLti& loop, Eigen::Index index);

/// Computes the channels of a loop, each reduced to the states that are coupled to it when all
/// channels are closed. An instability of states that are not coupled to a channel does not affect
/// its margins.
[[nodiscard]] std::vector<PeriodicLti> decoupled_channels(const PeriodicLti& loop);

/// Computes the matrices of the closed loop, A[k] - B[k] C.
[[nodiscard]] std::vector<Eigen::MatrixXd> closed(const PeriodicLti& loop);

/// The largest growth rate of a mode that counts as neutral [1/s]: 0.1 % in ten seconds. The pole of
/// a mode that nothing observes, such as an estimate that no sensor corrects, is at |z| = 1, where
/// rounding puts it on either side of the unit circle.
inline constexpr double kNeutralGrowth = 1e-4;

/// Computes the poles z of one control period: z^N is an eigenvalue of the product A[N-1] … A[0] (a
/// Floquet multiplier). Of the N roots the result is the one nearest to an eigenvalue of the mean
/// of the matrices; |z| does not depend on that choice.
/// @return  in order of decreasing |z|
[[nodiscard]] Eigen::VectorXcd periodic_poles(const std::vector<Eigen::MatrixXd>& A);

/// A pole and the states that dominate its mode.
struct NamedMode {
  std::complex<double> z;           ///< pole of one control period
  std::vector<std::string> states;  ///< in order of decreasing share, at most three
};

/// Computes the mode with the largest |z|.
/// @param A       (nx × nx) the matrices of one period, in their order
/// @param states  one name for each state
/// @param scale   a typical magnitude of each state, > 0
[[nodiscard]] NamedMode largest_mode(const std::vector<Eigen::MatrixXd>& A,
                                     const std::vector<Signal>& states,
                                     const Eigen::VectorXd& scale);

/// The mean frequency response of a periodic plant: for u[k] = e^(jw k dt) the output is e^(jw k
/// dt) times a sequence that repeats after N steps, and the mean response is the mean of that
/// sequence. For N = 1 it is the frequency response.
class MeanResponse {
 public:
  /// @throws InvalidInput  for the reasons of validate()
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

/// Computes the margins of a loop with one channel from L = 1/S - 1, where S is the mean response
/// of the closed loop. `stable` is exact. For N = 1 the result equals that of the OpenLoop
/// overload.
/// @param loop  one input, one output, under negative feedback
/// @param skew  as for the OpenLoop overload
/// @throws InvalidInput  if the loop has several channels
[[nodiscard]] LoopMargins loop_margins(const PeriodicLti& loop, double skew = 0);

}  // namespace quadtune
