// SPDX-License-Identifier: Apache-2.0
/// The step with which Tustin's rule is exact at one frequency.
#pragma once

#include <optional>
#include <string>

namespace quadtune::internal {

/// dt, or (2/w) tan(w dt/2), the step with which the rule maps jw to e^(jw dt).
/// @throws InvalidInput  unless 0 < w < π/dt.
[[nodiscard]] double tustin_step(double dt, std::optional<double> prewarp,
                                 const std::string& where);

}  // namespace quadtune::internal
