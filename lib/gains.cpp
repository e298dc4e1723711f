// SPDX-License-Identifier: Apache-2.0
#include "quadtune/gains.hpp"

#include <fmt/format.h>

#include <cmath>

#include "quadtune/errors.hpp"
#include "quadtune/matrix_checks.hpp"

namespace quadtune {

void validate(const Gains& gains, const std::string& where) {
  const auto nx = static_cast<Eigen::Index>(gains.states.size());
  const auto nu = static_cast<Eigen::Index>(gains.inputs.size());
  const auto ni = static_cast<Eigen::Index>(gains.integrals.size());
  require_shape(gains.K, nu, nx, where, "K",
                fmt::format("inputs: {}; states: {}", names(gains.inputs), names(gains.states)));
  if (ni > 0 || gains.K_int.size() > 0)
    require_shape(
        gains.K_int, nu, ni, where, "K_int",
        fmt::format("inputs: {}; integrals: {}", names(gains.inputs), names(gains.integrals)));
  require_finite(gains.K, where, "K");
  require_finite(gains.K_int, where, "K_int");
  require_shape(gains.x0, nx, 1, where, "x0", "one entry per state");
  require_shape(gains.u0, nu, 1, where, "u0", "one entry per input");
  require_finite(gains.x0, where, "x0");
  require_finite(gains.u0, where, "u0");
  if (!(gains.dt >= 0) || !std::isfinite(gains.dt))
    throw InvalidInput(where, fmt::format("dt is {} s, expected 0 (continuous) or more", gains.dt));
}

}  // namespace quadtune
