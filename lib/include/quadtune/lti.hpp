// SPDX-License-Identifier: Apache-2.0
/// Linear time-invariant models with named signals. Continuous and discrete models are different
/// types, so that one cannot be passed for the other.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

namespace quadtune {

/// One scalar signal: a state, an input or an output.
struct Signal {
  std::string name;  ///< name in its convention, e.g. "theta"
  std::string unit;  ///< SI, e.g. "rad"; empty if dimensionless or unknown

  friend bool operator==(const Signal&, const Signal&) = default;
};

/// ẋ = A x + B u, y = C x + D u.
struct ContinuousLti {
  Eigen::MatrixXd A;            ///< (nx × nx) [1/s times units]
  Eigen::MatrixXd B;            ///< (nx × nu)
  Eigen::MatrixXd C;            ///< (ny × nx); empty means all states are outputs
  Eigen::MatrixXd D;            ///< (ny × nu); empty means zero
  std::vector<Signal> states;   ///< nx names, or empty
  std::vector<Signal> inputs;   ///< nu names, or empty
  std::vector<Signal> outputs;  ///< ny names, or empty
};

/// x[k+1] = A x[k] + B u[k], y[k] = C x[k] + D u[k], one step every dt seconds.
struct DiscreteLti {
  Eigen::MatrixXd A;            ///< (nx × nx)
  Eigen::MatrixXd B;            ///< (nx × nu)
  Eigen::MatrixXd C;            ///< (ny × nx); empty means all states are outputs
  Eigen::MatrixXd D;            ///< (ny × nu); empty means zero
  double dt = 0;                ///< sample period [s], > 0
  std::vector<Signal> states;   ///< nx names, or empty
  std::vector<Signal> inputs;   ///< nu names, or empty
  std::vector<Signal> outputs;  ///< ny names, or empty
};

/// Validates shapes, that there are a state and an input, that all entries are finite, and that
/// each list of names is empty or complete.
/// @throws InvalidInput  with the matrix or list, its size and the expected size
void validate(const ContinuousLti& plant, const std::string& where);

/// The same for a discrete model; dt must be positive and finite.
void validate(const DiscreteLti& plant, const std::string& where);

/// The names of the signals separated by blanks, for messages: "x y z".
[[nodiscard]] std::string names(const std::vector<Signal>& signals);

/// The names of `signals`, or "1", "2", … up to `count` if there are none.
[[nodiscard]] std::vector<std::string> names_or_numbers(const std::vector<Signal>& signals,
                                                        Eigen::Index count);

}  // namespace quadtune
