// SPDX-License-Identifier: Apache-2.0
/// The picture that compares sampling methods of one system.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "quadtune/synthesis/pid/step_response.hpp"
#include "report/plots/figure.hpp"

namespace quadtune::report {

/// The system sampled by one method.
struct SampledMethod {
  std::string name;                     ///< "tustin"
  std::vector<double> outputs;          ///< response to a unit step, at Comparison::times
  std::vector<double> frequency_error;  ///< |G_d/G - 1| at Comparison::frequencies
  Eigen::VectorXcd poles;               ///< in the z-plane
};

struct Comparison {
  std::string title;
  double dt = 0;                       ///< sample period [s], > 0
  std::vector<double> times;           ///< [s] of the samples
  std::vector<double> exact;           ///< outputs of the continuous system at these times
  StepResponse continuous;             ///< the same between the samples
  std::vector<double> frequencies;     ///< [rad/s], up to π/dt
  Eigen::VectorXcd exact_poles;        ///< e^(p dt) of the continuous poles p
  std::vector<SampledMethod> methods;  ///< at most seven can be distinguished
};

/// Step responses, their errors, errors of the frequency responses, and the poles in the z-plane.
[[nodiscard]] Figure comparison_figure(const Comparison& comparison);

}  // namespace quadtune::report
