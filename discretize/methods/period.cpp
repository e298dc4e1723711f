// SPDX-License-Identifier: Apache-2.0
#include "methods/period.hpp"

#include <fmt/format.h>

#include <cmath>

#include "quadtune/errors.hpp"

namespace quadtune::internal {

void require_period(double dt, const std::string& where) {
  if (dt > 0 && std::isfinite(dt)) return;
  throw InvalidInput(where, fmt::format("dt is {} s, expected a positive, finite number of "
                                        "seconds",
                                        dt));
}

void refuse_long_period(double dt, const std::string& where) {
  throw InvalidInput(where,
                     fmt::format("dt is {} s, expected a shorter period because within it the "
                                 "plant grows beyond the range of a double",
                                 dt));
}

}  // namespace quadtune::internal
