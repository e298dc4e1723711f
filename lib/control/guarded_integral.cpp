// SPDX-License-Identifier: Apache-2.0
#include "quadtune/control/guarded_integral.hpp"

#include <fmt/format.h>

#include "quadtune/errors.hpp"

namespace quadtune {
namespace {

template <class Scalar>
void validate_guards(const GuardedIntegralSettings<Scalar>& settings, const std::string& where) {
  if (!(settings.dt > 0) || !std::isfinite(settings.dt))
    throw InvalidInput(where, fmt::format("dt is {} s, expected a positive number", settings.dt));
  const auto require_limit = [&](Scalar limit, const char* name) {
    if (!(limit >= 0))
      throw InvalidInput(where, fmt::format("{} is {}, expected 0 or more because it bounds an "
                                            "absolute value",
                                            name, limit));
  };
  require_limit(settings.error_limit, "error_limit");
  require_limit(settings.increment_limit, "increment_limit");
  require_limit(settings.integral_limit, "integral_limit");
}

}  // namespace

void validate(const GuardedIntegralSettings<double>& settings, const std::string& where) {
  validate_guards(settings, where);
}

void validate(const GuardedIntegralSettings<float>& settings, const std::string& where) {
  validate_guards(settings, where);
}

}  // namespace quadtune
