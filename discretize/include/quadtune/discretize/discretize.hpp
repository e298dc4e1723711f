// SPDX-License-Identifier: Apache-2.0
/// Discretization by any method.
#pragma once

#include <optional>
#include <string>

#include "quadtune/discretize/delay.hpp"
#include "quadtune/lti.hpp"
#include "quadtune/transfer_function.hpp"

namespace quadtune {

/// Discretization methods.
enum class DiscretizationMethod {
  zoh,             ///< exact for inputs held between samples, discretize_zoh()
  foh,             ///< exact for inputs linear between samples, discretize_foh()
  impulse,         ///< sampled impulse response, discretize_impulse()
  euler,           ///< forward Euler, discretize_euler()
  backward_euler,  ///< backward Euler, discretize_backward_euler()
  tustin,          ///< bilinear transformation, discretize_tustin()
  matched,         ///< matched poles and zeros, discretize_matched()
};

/// "zoh", "foh", "impulse", "euler", "backward-euler", "tustin" or "matched".
[[nodiscard]] std::string to_string(DiscretizationMethod method);

/// The method of a name, the inverse of to_string().
/// @throws InvalidInput  with the unknown name, the known methods and the nearest of them.
[[nodiscard]] DiscretizationMethod discretization_method(const std::string& name,
                                                         const std::string& where);

/// Options of a discretization.
struct DiscretizationOptions {
  std::optional<double> prewarp;  ///< [rad/s], for tustin only; discretize_tustin()
  ChannelDelays delays;           ///< fractions of a sample with zoh only
};

/// @param plant    A (nx × nx), B (nx × nu); time in seconds.
/// @param dt       Sample period [s], 0 < dt < ∞.
/// @param method   how the plant is sampled
/// @param options  prewarping and channel delays
/// @throws InvalidInput  as the function of the method and with_delays(), and for prewarping with a
///                       method other than tustin.
[[nodiscard]] DiscreteLti discretize(const ContinuousLti& plant, double dt,
                                     DiscretizationMethod method,
                                     const DiscretizationOptions& options = {});

/// The same for a transfer function. Whole samples of its delay become the delay of the result; a
/// fraction, with zoh only, becomes a pole at 0 and a zero.
///
/// @param plant    proper; time in seconds, delay [s] ≥ 0
/// @param dt       Sample period [s], 0 < dt < ∞.
/// @param method   how the plant is sampled
/// @param options  without channel delays: the plant has its own delay
/// @return         den is monic; its roots are the images of the plant's poles under the method.
/// @throws InvalidInput  likewise.
[[nodiscard]] DiscreteTransferFunction discretize(const ContinuousTransferFunction& plant,
                                                  double dt, DiscretizationMethod method,
                                                  const DiscretizationOptions& options = {});

}  // namespace quadtune
