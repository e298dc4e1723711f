// SPDX-License-Identifier: Apache-2.0
#include "quadtune/estimation/complementary_filter.hpp"

#include <fmt/format.h>

#include "estimation/checks.hpp"

namespace quadtune {
namespace {

template <class T>
void validate_settings(const ComplementaryFilterSettings<T>& settings, const std::string& where) {
  require_positive(settings.dt, "dt", " s", where);
  require_positive(settings.gravity, "gravity", " m/s2", where);
  require_not_negative(settings.time_constant, "time_constant", " s", where);
  if (!(settings.force_band > 0))
    throw InvalidInput(where, fmt::format("force_band is {}, expected more than 0 because it "
                                          "divides",
                                          settings.force_band));
  if (!(settings.bias_time_constant > 0 &&
        settings.bias_time_constant >= 4 * settings.time_constant))
    throw InvalidInput(where, fmt::format("bias_time_constant is {} s, expected at least 4 times "
                                          "the time constant of {} s because the estimates of "
                                          "bias and attitude otherwise oscillate",
                                          settings.bias_time_constant, settings.time_constant));
}

}  // namespace

void validate(const ComplementaryFilterSettings<double>& settings, const std::string& where) {
  validate_settings(settings, where);
}

void validate(const ComplementaryFilterSettings<float>& settings, const std::string& where) {
  validate_settings(settings, where);
}

}  // namespace quadtune
