// SPDX-License-Identifier: Apache-2.0
#include "methods/prewarp.hpp"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "quadtune/errors.hpp"

namespace quadtune::internal {

double tustin_step(double dt, std::optional<double> prewarp, const std::string& where) {
  if (!prewarp) return dt;
  const double w = *prewarp;
  const double nyquist = std::numbers::pi / dt;
  if (!(w > 0 && w < nyquist))
    throw InvalidInput(
        where,
        fmt::format("prewarp is {:.6g} rad/s, expected more than 0 and less than {:.6g} rad/s "
                    "(pi/dt) because samples every {} s cannot represent other frequencies",
                    w, nyquist, dt));
  return 2 / w * std::tan(w * dt / 2);
}

}  // namespace quadtune::internal
