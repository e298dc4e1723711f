// SPDX-License-Identifier: Apache-2.0
#include "quadtune/simulation/air.hpp"

#include <fmt/format.h>

#include <cmath>

#include "quadtune/errors.hpp"

namespace quadtune {

DrydenNumbers dryden_numbers(const Wind& wind) {
  constexpr double kFoot = 0.3048;
  if (!wind.mean.allFinite() || !wind.gust.velocity.allFinite())
    throw InvalidInput("wind", "a velocity is not finite, expected finite numbers [m/s]");
  if (!std::isfinite(wind.gust.start) || !(wind.gust.length > 0) ||
      !std::isfinite(wind.gust.length))
    throw InvalidInput("wind",
                       fmt::format("the gust begins at {} s and lasts {} s, expected a finite "
                                   "time and a positive duration",
                                   wind.gust.start, wind.gust.length));
  if (!(wind.turbulence >= 0) || !std::isfinite(wind.turbulence))
    throw InvalidInput("wind",
                       fmt::format("turbulence is {} m/s, expected 0 or more", wind.turbulence));
  if (!(wind.turbulence_height >= 3 && wind.turbulence_height <= 300))
    throw InvalidInput(
        "wind", fmt::format("the height of the turbulence is {} m, expected 3 to 300 m, where its "
                            "scales are known",
                            wind.turbulence_height));
  const double h = wind.turbulence_height / kFoot;
  const double shear = 0.177 + 0.000823 * h;
  const double L_across = h / std::pow(shear, 1.2) * kFoot;
  const double L_up = h * kFoot;
  const double sigma_up = 0.1 * wind.turbulence;
  const double sigma_across = sigma_up / std::pow(shear, 0.4);
  const double V = std::max(1.0, std::hypot(wind.mean.x(), wind.mean.y()));
  return {{sigma_across, sigma_across, sigma_up},
          {L_across, L_across, L_up},
          {L_across / V, L_across / V, L_up / V}};
}

}  // namespace quadtune
