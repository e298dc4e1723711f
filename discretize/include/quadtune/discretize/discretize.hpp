// SPDX-License-Identifier: Apache-2.0
/// One door to all methods of discretization.
#pragma once

#include <optional>
#include <string>

#include "quadtune/discretize/delay.hpp"
#include "quadtune/lti.hpp"
#include "quadtune/transfer_function.hpp"

namespace quadtune {

/// How a continuous plant becomes a discrete one.
enum class DiscretizationMethod {
  zoh,             ///< exact for inputs held between samples, discretize_zoh()
  foh,             ///< exact for inputs linear between samples, discretize_foh()
  impulse,         ///< sampled impulse response, discretize_impulse()
  euler,           ///< forward Euler, discretize_euler()
  backward_euler,  ///< backward Euler, discretize_backward_euler()
  tustin,          ///< bilinear transformation, discretize_tustin()
  matched,         ///< matched poles and zeros, discretize_matched()
};

/// "zoh", "foh", "impulse", "euler", "backward-euler", "tustin" or "matched", and back.
/// @throws InvalidInput  naming the word, the methods that exist, and the nearest.
[[nodiscard]] std::string to_string(DiscretizationMethod method);
[[nodiscard]] DiscretizationMethod discretization_method(const std::string& name,
                                                         const std::string& where);

/// What a discretization may be told beside its method.
struct DiscretizationOptions {
  std::optional<double> prewarp;  ///< [rad/s], for tustin only; discretize_tustin()
  ChannelDelays delays;           ///< for fractions of a sample zoh only
};

/// @param plant  A (nx × nx), B (nx × nu); time in seconds.
/// @param dt     Sample period [s], 0 < dt < ∞.
/// @throws InvalidInput  as the method's own function and with_delays(), and for prewarping with
///                       another method than tustin.
[[nodiscard]] DiscreteLti discretize(const ContinuousLti& plant, double dt,
                                     DiscretizationMethod method,
                                     const DiscretizationOptions& options = {});

/// The same for a transfer function. Its whole samples of delay become those of the result; a
/// fraction, for zoh only, is a pole at 0 and a zero.
///
/// @param options  without delays of channels: the plant has its own
/// @return         den is monic, its roots are the plant's poles as the method takes them.
/// @throws InvalidInput  likewise.
[[nodiscard]] DiscreteTransferFunction discretize(const ContinuousTransferFunction& plant,
                                                  double dt, DiscretizationMethod method,
                                                  const DiscretizationOptions& options = {});

}  // namespace quadtune
