// SPDX-License-Identifier: Apache-2.0
#include "flight_code/parameters.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "flight_code/c_structure.hpp"
#include "flight_code/kalman_module.hpp"
#include "quadtune/control/pid.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/estimation/general_filter.hpp"

namespace quadtune::exports {
namespace {

template <class Vector>
Numbers inverses(const Vector& scale) {
  Numbers result;
  for (const double x : scale) result.push_back(1 / x);
  return result;
}

/// Writes where the samples of a delayed sensor are stored, and their weights.
void write_inertial(Structure& c, const std::string& name, const InertialAid& sensor, double dt,
                    int horizon) {
  const auto place = general_filter_internal::reading_place(sensor.lag, dt, horizon);
  c.integer(name + "_whole", place.whole);
  c.numbers(name + "_mean", {0.5 * (1 - place.part), 0.5 * place.part});
  if (name == "gyro") c.numbers(name + "_point", {1 - place.part, place.part});
  const double time = horizon * dt;
  Numbers later, earlier;
  for (double left = time - sensor.lag; horizon > 0 && left > 1e-12;) {
    const double h = std::min(left, dt), part = h / dt;
    later.push_back((h - 0.5 * h * part) / time);
    earlier.push_back(0.5 * h * part / time);
    left -= h;
  }
  c.open(name + "_now");
  c.number("held", horizon > 0 ? std::min(sensor.lag, time) / time : 0);
  c.integer("count", static_cast<int>(later.size()));
  later.resize(kMaxHorizonPeriods);  // a C array needs all of its elements
  earlier.resize(kMaxHorizonPeriods);
  c.numbers("later", later);
  c.numbers("earlier", earlier);
  c.close();
  c.numbers(name + "_inverse_scale", inverses(sensor.scale));
  c.numbers(name + "_variance", of(sensor.variance));
  Numbers noise;
  for (const double density : sensor.density) noise.push_back(density * density * dt);
  c.numbers(name + "_noise", noise);
  c.number(name + "_walk", sensor.walk * sensor.walk * dt);
}

void write_aid(Structure& c, const std::string& name, const std::optional<Aid>& aid) {
  c.open(name);
  c.boolean("present", aid.has_value());
  if (aid) {
    c.number("lag", aid->lag);
    c.number("variance", aid->variance);
    c.number("inverse_scale", 1 / aid->scale);
  }
  c.close();
}

void write_start(Structure& c, const GeneralFilterSettings& s) {
  const StartDeviations& d = s.start;
  Numbers variances;
  for (const double x : {d.position, d.velocity, d.tilt, d.gyro_bias, d.force_bias})
    variances.insert(variances.end(), 3, x * x);
  variances[8] = d.yaw * d.yaw;
  variances.push_back(s.pressure ? d.pressure_height * d.pressure_height : 0);
  c.numbers("start_variance", variances);
}

void write_sensors(Structure& c, const GeneralFilterSettings& s) {
  write_aid(c, "gps_position", s.gps_position);
  write_aid(c, "gps_velocity", s.gps_velocity);
  write_aid(c, "vision", s.vision);
  c.open("flow");
  c.boolean("present", s.flow.has_value());
  if (s.flow) {
    c.number("lag", s.flow->lag);
    c.number("variance", s.flow->variance);
    c.numbers("inverse_scale", inverses(s.flow->scale));
    c.numbers("mean_square", of(s.flow->mean_square));
    c.number("least_height", s.flow->min_height);
  }
  c.close();
  c.open("range");
  c.boolean("present", s.range.has_value());
  if (s.range) {
    c.number("lag", s.range->aid.lag);
    c.number("variance", s.range->aid.variance);
    c.number("inverse_scale", 1 / s.range->aid.scale);
    c.number("least", s.range->min);
    c.number("greatest", s.range->max);
    c.number("least_cosine", s.range->min_cosine);
  }
  c.close();
  c.open("pressure");
  c.boolean("present", s.pressure.has_value());
  if (s.pressure) {
    const bool linear = std::isfinite(s.pressure->fall);
    c.boolean("linear", linear);
    c.number("lag", s.pressure->aid.lag);
    c.number("variance", s.pressure->aid.variance);
    c.number("inverse_scale", 1 / s.pressure->aid.scale);
    c.number("zero", s.pressure->zero);
    c.number("inverse_fall", linear ? 1 / s.pressure->fall : 0);
  }
  c.close();
  c.open("heading");
  c.boolean("present", s.heading.has_value());
  if (s.heading) {
    const HeadingAid& heading = *s.heading;
    c.number("lag", heading.aid.lag);
    c.number("variance", heading.aid.variance);
    c.number("declination", heading.declination);
    c.numbers("row", {-heading.dip * std::cos(heading.declination),
                      -heading.dip * std::sin(heading.declination), 1});
  }
  c.close();
}

void write_estimator(Structure& c, const GeneralFilterSettings& s) {
  constexpr double kInstant = 1e-9;  // QT_INSTANT
  const int horizon = horizon_periods(s);
  c.open("estimator");
  c.period("dt", s.dt);
  c.number("gravity", s.gravity);
  c.integer("horizon", horizon);
  c.number("horizon_time", horizon * s.dt);
  write_inertial(c, "gyro", s.gyroscope, s.dt, horizon);
  write_inertial(c, "force", s.accelerometer, s.dt, horizon);
  c.number("pressure_walk", s.pressure ? s.pressure->walk * s.pressure->walk * s.dt : 0);
  c.number("gate", s.gate);
  c.number("recovery_time", s.recovery_time);
  c.number("standing_variance", s.standing_velocity * s.standing_velocity);
  c.number("lift_off_variance", s.lift_off_velocity * s.lift_off_velocity);
  write_start(c, s);
  Numbers due, behind;
  for (int k = 0; k < kMaxHorizonPeriods + 2; ++k) due.push_back(k * s.dt - kInstant);
  for (int k = 0; k < kMaxHorizonPeriods + 1; ++k) behind.push_back(k * s.dt);
  c.numbers("due", due);
  c.numbers("behind", behind);
  write_sensors(c, s);
  c.close();
}

/// Number of control periods k with (k + 1/2) dt before the end of the calibration: the same rule
/// as in the filters.
int calibration_periods(const auto& s) {
  int periods = 0;
  while ((periods + 0.5) * s.dt < s.calibration_time) ++periods;
  return periods;
}

void write_estimator(Structure& c, const MamboEstimatorSettings<double>& s) {
  c.open("estimator");
  c.number("gravity", s.gravity);
  c.integer("calibration_periods", calibration_periods(s));
  c.number("attitude_time_constant", s.attitude_time_constant);
  c.number("force_band", s.force_band);
  c.number("bias_time_constant", s.bias_time_constant);
  c.number("altitude_Q", s.altitude_Q);
  c.number("altitude_R", s.altitude_R);
  c.number("sonar_least", s.sonar_min);
  c.number("sonar_greatest", s.sonar_max);
  c.number("sonar_jump", s.sonar_jump);
  c.number("sonar_deviation", s.sonar_deviation);
  c.number("sonar_recovery_time", s.sonar_recovery_time);
  c.number("velocity_Q", s.velocity_Q);
  c.number("velocity_R", s.velocity_R);
  c.number("flow_scale", s.flow_scale);
  c.numbers("flow_compensation", {s.flow_compensation_x, s.flow_compensation_y});
  c.number("gyro_lag", s.gyro_lag);
  c.number("flow_least_height", s.flow_min_height);
  c.number("flow_timeout", s.flow_timeout);
  c.boolean("hold_flow", s.hold_flow);
  c.boolean("position_of_flow", s.position == MamboPosition::flow_velocity);
  c.number("position_Q", s.position_Q);
  c.number("vision_R", s.vision_R);
  c.close();
}

/// Writes the vehicle model with which the uquad's filter predicts.
void write_body(Structure& c, const RigidBody& body) {
  const auto each = [&](const char* name, const auto& number) {
    Numbers numbers;
    for (int i = 0; i < body.rotor_count; ++i)
      numbers.push_back(number(body.rotors[static_cast<std::size_t>(i)]));
    c.numbers(name, numbers);
  };
  using Rotor = BasicRotor<double>;
  c.number("gravity", body.gravity);
  c.number("inverse_mass", body.inverse_mass);
  c.numbers("J", of(body.J.transpose().reshaped()));
  c.numbers("J_inverse", of(body.J_inv.transpose().reshaped()));
  c.numbers("drag", of(Eigen::Vector3d(body.air_density * body.cda)));
  c.numbers("linear_drag", of(body.linear_drag));
  each("rotor_x", [](const Rotor& rotor) { return rotor.position.x(); });
  each("rotor_y", [](const Rotor& rotor) { return rotor.position.y(); });
  each("spin", [](const Rotor& rotor) { return rotor.spin; });
  each("thrust_a2", [](const Rotor& rotor) { return rotor.thrust_a2; });
  each("thrust_a1", [](const Rotor& rotor) { return rotor.thrust_a1; });
  each("torque_d2", [](const Rotor& rotor) { return rotor.torque_d2; });
  each("torque_d1", [](const Rotor& rotor) { return rotor.torque_d1; });
  each("spin_inertia", [](const Rotor& rotor) { return rotor.spin * rotor.inertia; });
}

void write_estimator(Structure& c, const UquadProgram& program) {
  const UquadFilterSettings<double>& s = program.filter;
  c.open("estimator");
  c.integer("calibration_periods", calibration_periods(s));
  c.numbers("Q", of(s.Q));
  c.numbers("start_variance", of(s.P0));
  c.number("tilt_R", s.R_tilt);
  c.number("yaw_R", s.R_yaw);
  c.number("force_R", s.R_force);
  c.number("rates_R", s.R_rates);
  c.number("height_R", s.R_height);
  c.number("gps_position_R", s.R_gps_position);
  c.number("gps_velocity_R", s.R_gps_velocity);
  c.number("vision_R", s.R_vision);
  c.number("gate", s.gate);
  c.boolean("position", s.position);
  c.boolean("biases", s.biases);
  c.boolean("yaw_by_estimated_tilt", s.yaw_by_estimated_tilt);
  c.boolean("dynamic_covariance", s.dynamic_covariance);
  c.number("force_band", s.force_band);
  c.number("field_band", s.field_band);
  c.number("field_norm", s.field_norm);
  c.number("declination", s.declination);
  c.number("reference_pressure", s.reference_pressure);
  c.number("gps_timeout", s.gps_timeout);
  c.number("still_variance", s.zero_velocity_variance);
  c.number("standing_variance", s.standing_variance);
  write_body(c, program.body);
  c.numbers("hover_speed", of(program.hover));
  c.close();
}

void write_loop(Structure& c, const std::string& name, const PidSettings<double>& loop,
                bool has_lead) {
  const PidQuadrature<double> weight = pid_quadrature<double>(loop.method);
  c.open(name);
  c.period("dt", loop.dt);
  c.number("Kp", loop.Kp);
  c.number("Ki", loop.Ki);
  c.number("Kd", loop.Kd);
  c.number("set_point_weight", loop.b);
  c.number("error_now", weight.now);
  c.number("error_before", weight.before);
  c.number("output_min", loop.output_min);
  c.number("output_max", loop.output_max);
  c.number("integral_min", loop.integral_min);
  c.number("integral_max", loop.integral_max);
  c.number("back_calculation", loop.back_calculation);
  if (has_lead) {
    c.number("rate_lead", loop.rate_lead);
    c.number("rate_share", loop.rate_share);
  }
  c.close();
}

void write_law(Structure& c, const CascadedPidSettings<double>& law) {
  c.open("law");
  for (const CascadeAxis axis : {CascadeAxis::x, CascadeAxis::y, CascadeAxis::roll,
                                 CascadeAxis::pitch, CascadeAxis::yaw, CascadeAxis::altitude})
    write_loop(c, to_string(axis), law.loops[index_of(axis)], has_rate_lead(law));
  c.number("attitude_limit", law.attitude_limit);
  c.number("weight", law.weight);
  c.number("take_off_thrust", law.take_off_thrust);
  c.number("greatest_thrust", law.max_thrust);
  c.boolean("velocity_feed_forward", law.velocity_feed_forward);
  c.boolean("conditional_integration", law.conditional_integration);
  c.close();
}

void write_integrals(Structure& c, const StateFeedbackSettings<double>& law) {
  const int n = law.integrals;
  c.matrix("K_int", law.K_int.topLeftCorner(law.inputs, n));
  const std::vector<int> integrated(law.integrated.begin(), law.integrated.begin() + n);
  c.integers("integrated", integrated);
  c.open("guard");
  for (std::size_t j = 0; j < static_cast<std::size_t>(n); ++j) {
    c.open("");
    c.number("error_limit", law.guards[j].error_limit);
    c.number("increment_limit", law.guards[j].increment_limit);
    c.number("integral_limit", law.guards[j].integral_limit);
    c.close();
  }
  c.close();
  std::vector<int> of_position = {-1, -1};
  for (int j = 0; j < n; ++j)
    if (integrated[static_cast<std::size_t>(j)] < 2)
      of_position[static_cast<std::size_t>(integrated[static_cast<std::size_t>(j)])] = j;
  c.integers("of_position", of_position);
}

void write_law(Structure& c, const StateFeedbackSettings<double>& law, double dt) {
  const int inputs = law.inputs;
  c.open("law");
  c.period("dt", dt);
  c.numbers("x0", of(law.x0));
  c.numbers("u0", of(law.u0.head(inputs)));
  c.matrix("K", law.K.topRows(inputs));
  if (law.integrals > 0) write_integrals(c, law);
  c.boolean("heading_axes", law.axes == PositionAxes::heading);
  c.number("position_error_limit", law.position_error_limit);
  c.boolean("conditional_integration", law.conditional_integration);
  if (law.remembers) {
    c.numbers("lag_share", of(law.lag_share.head(inputs)));
    c.matrix("K_lag", law.K_lag.topLeftCorner(inputs, inputs));
  }
  if (law.past > 0) c.matrix("K_past", law.K_past.topRows(inputs));
  c.close();
}

void write_motors(Structure& c, const ProgramSettings& s) {
  const int n = s.allocation.rotors;
  const auto first = [n](const auto& values) {
    return Numbers(values.begin(), values.begin() + n);
  };
  c.open("motors");
  c.matrix("P", s.allocation.P.topRows(n));
  if (!s.cascade()) c.matrix("M", s.allocation.M.leftCols(n));
  c.numbers("wrench0", of(s.allocation.wrench0));
  c.numbers("thrust0", of(s.allocation.thrust0));
  c.numbers("a2", first(s.allocation.a2));
  c.numbers("a1", first(s.allocation.a1));
  c.numbers("least", first(s.limits.min));
  c.numbers("greatest", first(s.limits.max));
  c.number("floor", s.limits.floor);
  c.number("gain", s.motor.gain);
  c.number("least_command", s.motor.min);
  c.number("greatest_command", s.motor.max);
  if (s.motor.quantum > 0) c.number("quantum", s.motor.quantum);
  c.numbers("direction", first(s.direction));
  c.close();
}

std::string filters_text(const std::vector<KalmanFilter>& filters, bool double_precision,
                         double dt) {
  const KalmanSizes max = kalman_sizes(filters);
  Structure c(double_precision, dt);
  c.open("");
  for (const KalmanFilter& filter : filters) {
    const auto whole = [&](const char* name, const Eigen::MatrixXd& of, int rows, int columns) {
      Eigen::MatrixXd all = Eigen::MatrixXd::Zero(rows, columns);
      all.topLeftCorner(of.rows(), of.cols()) = of;
      c.matrix(name, all);
    };
    c.open("");
    c.integer("states", static_cast<int>(filter.model.A.rows()));
    c.integer("inputs", static_cast<int>(filter.model.B.cols()));
    c.integer("measurements", static_cast<int>(filter.model.C.rows()));
    whole("A", filter.model.A, max.states, max.states);
    whole("B", filter.model.B, max.states, max.inputs);
    whole("C", filter.model.C, max.measurements, max.states);
    whole("M", filter.M, max.states, max.measurements);
    whole("L", filter.L, max.states, max.measurements);
    c.close();
  }
  c.close();
  return c.text();
}

}  // namespace

std::string c_number(double x, bool double_precision, const std::string& where) {
  if (std::isnan(x)) throw InvalidInput(where, "is NaN, expected a number");
  if (std::isinf(x)) return x > 0 ? "QT_INFINITY" : "-QT_INFINITY";
  if (!double_precision && std::abs(x) > static_cast<double>(std::numeric_limits<float>::max()))
    throw InvalidInput(where, fmt::format("is {}, expected at most 3.4e38 because the program "
                                          "computes in float; use double precision",
                                          x));
  std::string text =
      double_precision ? fmt::format("{}", x) : fmt::format("{}", static_cast<float>(x));
  if (text.find_first_of(".e") == std::string::npos) text += ".0";
  return double_precision ? text : text + "f";
}

std::string parameters_text(const ProgramSettings& settings,
                            const std::vector<KalmanFilter>& filters, bool double_precision) {
  Structure c(double_precision, settings.dt);
  c.open("");
  if (settings.general) write_estimator(c, *settings.general);
  if (settings.mambo) write_estimator(c, *settings.mambo);
  if (settings.uquad) write_estimator(c, *settings.uquad);
  if (settings.cascade())
    write_law(c, std::get<0>(settings.law));
  else
    write_law(c, settings.feedback(), settings.dt);
  write_motors(c, settings);
  c.close();
  std::string text =
      "/* SPDX-License-Identifier: Apache-2.0 */\n"
      "/* The numbers of the design; \"internal.h\" says what each is, and its unit. */\n"
      "#include \"internal.h\"\n";
  if (!filters.empty()) text += "#include \"kalman.h\"\n";
  text += "\nconst qt_parameters_t qt_parameters = " + c.text();
  if (!filters.empty())
    text += "\nconst qt_kalman_t qt_kalman[QT_KALMAN_FILTERS] = " +
            filters_text(filters, double_precision, settings.dt);
  return text;
}

}  // namespace quadtune::exports
