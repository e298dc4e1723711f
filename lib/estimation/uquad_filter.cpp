// SPDX-License-Identifier: Apache-2.0
#include "quadtune/estimation/uquad_filter.hpp"

#include <fmt/format.h>

#include "estimation/checks.hpp"

namespace quadtune {
namespace {

template <class T>
void require_variances(const UquadVector<T>& values, const char* name, const std::string& where) {
  for (int i = 0; i < kUquadStates; ++i)
    require_variance(values(i), fmt::format("{}({})", name, i + 1).c_str(), "", where);
}

template <class T>
void validate_uquad(const UquadFilterSettings<T>& settings, const std::string& where) {
  require_positive(settings.dt, "dt", " s", where);
  if (!(settings.calibration_time >= 0) || !std::isfinite(settings.calibration_time))
    throw InvalidInput(where, fmt::format("calibration_time is {} s, expected 0 or more and finite",
                                          settings.calibration_time));
  require_variances(settings.Q, "Q", where);
  require_variances(settings.P0, "P0", where);
  require_positive(settings.R_tilt, "R_tilt", " rad2", where);
  require_positive(settings.R_yaw, "R_yaw", " rad2", where);
  require_positive(settings.R_force, "R_force", " m2/s4", where);
  require_positive(settings.R_rates, "R_rates", " rad2/s2", where);
  require_positive(settings.R_height, "R_height", " m2", where);
  require_positive(settings.R_gps_position, "R_gps_position", " m2", where);
  require_positive(settings.R_gps_velocity, "R_gps_velocity", " m2/s2", where);
  require_positive(settings.R_vision, "R_vision", " m2", where);
  require_positive(settings.zero_velocity_variance, "still_variance", " m2/s2", where);
  require_positive(settings.standing_variance, "standing_variance", " m2/s2", where);
  if (!(settings.gate > 0))
    throw InvalidInput(
        where, fmt::format("gate is {}, expected more than 0 because otherwise no measurement "
                           "is accepted",
                           settings.gate));
  require_positive(settings.force_band, "force_band", "", where);
  require_positive(settings.field_band, "field_band", "", where);
  require_not_negative(settings.field_norm, "field_norm", " uT", where);
  if (!std::isfinite(settings.declination))
    throw InvalidInput(where, fmt::format("declination is {} rad, expected a finite number",
                                          settings.declination));
  require_positive(settings.reference_pressure, "reference_pressure", " Pa", where);
  require_not_negative(settings.gps_timeout, "gps_timeout", " s", where);
}

}  // namespace

void validate(const UquadFilterSettings<double>& settings, const std::string& where) {
  validate_uquad(settings, where);
}

void validate(const UquadFilterSettings<float>& settings, const std::string& where) {
  validate_uquad(settings, where);
}

}  // namespace quadtune
