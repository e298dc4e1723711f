// SPDX-License-Identifier: Apache-2.0
#include "quadtune/discretize/tustin.hpp"

#include <fmt/format.h>

#include "methods/implicit_rule.hpp"
#include "methods/period.hpp"
#include "methods/prewarp.hpp"

namespace quadtune {

DiscreteLti discretize_tustin(const ContinuousLti& plant, double dt,
                              std::optional<double> prewarp) {
  validate(plant, "tustin");
  internal::require_period(dt, "tustin");
  const double step = internal::tustin_step(dt, prewarp, "tustin");
  const std::string forbidden =
      prewarp ? fmt::format("w/tan(w dt/2) with w = {:.6g} rad/s", *prewarp) : "2/dt";
  return internal::discretize_by_rule(
      plant, dt, {.alpha = 0.5, .step = step, .forbidden = forbidden}, "tustin");
}

}  // namespace quadtune
