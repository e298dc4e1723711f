// SPDX-License-Identifier: Apache-2.0
/// A PID controller as it runs on board. The same code is simulated, analysed and flown.
#pragma once

#include <cmath>
#include <limits>
#include <string>
#include <type_traits>

#include "quadtune/cascade.hpp"
#include "quadtune/control/pid_method.hpp"
#include "quadtune/scalar.hpp"
#include "quadtune/transfer_function.hpp"

namespace quadtune {

/// The signal that is differentiated. v = c · set point - measurement.
enum class PidDerivative {
  /// -Kd · (rate + lead): the rate of the measurement has its own sensor; c and Tf are not used.
  measured_rate,
  difference,  ///< Kd (v[k] - v[k-1]) / dt; Tf is not used
  filtered,    ///< Kd s / (Tf s + 1) of v, with s replaced according to the method
};

/// Validated by validate(); step() does not check.
template <class Scalar>
struct PidSettings {
  /// Default of the limits: none.
  static constexpr double kInfinity = std::numeric_limits<double>::infinity();

  Scalar dt = 0;  ///< sample period [s], > 0
  Scalar Kp = 0;  ///< [output / error]
  Scalar Ki = 0;  ///< [output / (error · s)]
  Scalar Kd = 0;  ///< [output · s / error]; damping if it has the sign of Kp
  Scalar Tf = 0;  ///< time constant of the filtered derivative [s]
  /// With measured_rate: the lead is this factor times the difference between the rate and its low
  /// pass, ≥ 0; 0 disables it.
  Scalar rate_lead = 0;
  Scalar rate_share = 0;  ///< share of that difference that the low pass takes per sample, 0 … 1
  Scalar b = 1;           ///< weight of the set point in the proportional part
  Scalar c = 0;           ///< weight of the set point in the derivative
  PidMethod method = PidMethod::forward_euler;              ///< rule of the integral
  PidDerivative derivative = PidDerivative::measured_rate;  ///< what the derivative acts on
  Scalar output_min = Scalar(-kInfinity);                   ///< [output]
  Scalar output_max = Scalar(kInfinity);                    ///< [output], ≥ output_min
  Scalar integral_min = Scalar(-kInfinity);  ///< of the integral part of the output [output]
  Scalar integral_max = Scalar(kInfinity);   ///< [output], ≥ integral_min
  /// Anti-windup gain [1/s], 0 … 1/dt; 0 disables it.
  Scalar back_calculation = 0;
};

/// The state kept from one sample to the next. A copy resumes identically.
template <class Scalar>
struct PidState {
  Scalar integral = 0;    ///< Ki ∫error, in units of the output
  Scalar error = 0;       ///< of the last sample
  Scalar v = 0;           ///< c · set point - measurement of the last sample
  Scalar derivative = 0;  ///< derivative part of the last output
  Scalar rate = 0;        ///< low pass of the measured rate
  Scalar output = 0;      ///< the last output
};

/// The inputs of one sample.
template <class Scalar>
struct PidInput {
  Scalar set_point = 0;     ///< desired value of the measurement
  Scalar measurement = 0;   ///< measured value, in the unit of the set point
  Scalar rate = 0;          ///< of the measurement [1/s]; used with PidDerivative::measured_rate
  Scalar feed_forward = 0;  ///< added before the output is limited
  /// Requested minus produced part of the last output [output]. The integral does not grow in this
  /// direction.
  Scalar excess = 0;
};

/// The result of one sample.
template <class Scalar>
struct PidOutput {
  Scalar value = 0;      ///< within output_min … output_max
  Scalar unlimited = 0;  ///< the output without these limits
  /// False if the output, the error or v was not finite: value is then the last output, and the
  /// state is unchanged.
  MaskOf<Scalar> finite = true;
};

/// The derivative part: d[k] = pole · d[k-1] + gain · (v[k] - v[k-1]).
template <class Scalar>
struct PidDifference {
  Scalar pole = 0;  ///< of the filter; 0: no memory
  Scalar gain = 0;  ///< on the change of the input
};

/// The integral part: I[k] = I[k-1] + Ki dt (now · error[k] + before · error[k-1]).
template <class Scalar>
struct PidQuadrature {
  Scalar now = 0;     ///< weight of the present error
  Scalar before = 0;  ///< weight of the previous error; both weights sum to 1
};

/// The weights of the integral's rule.
template <class Scalar>
[[nodiscard]] constexpr PidQuadrature<Scalar> pid_quadrature(PidMethod method) noexcept {
  switch (method) {
    case PidMethod::backward_euler:
      return {1, 0};
    case PidMethod::tustin:
      return {Scalar(0.5), Scalar(0.5)};
    case PidMethod::forward_euler:
      break;
  }
  return {0, 1};
}

/// The coefficients of the derivative part; zero if the rate is measured, since no difference is
/// needed then.
template <class Scalar>
[[nodiscard]] constexpr PidDifference<Scalar> pid_difference(
    const PidSettings<Scalar>& settings) noexcept {
  const Scalar dt = settings.dt;
  const Scalar Tf = settings.Tf;
  if (settings.derivative == PidDerivative::measured_rate) return {0, 0};
  if (settings.derivative == PidDerivative::difference) return {0, settings.Kd / dt};
  switch (settings.method) {
    case PidMethod::backward_euler:
      return {Tf / (Tf + dt), settings.Kd / (Tf + dt)};
    case PidMethod::tustin:
      return {(2 * Tf - dt) / (2 * Tf + dt), 2 * settings.Kd / (2 * Tf + dt)};
    case PidMethod::forward_euler:
      break;
  }
  return {1 - dt / Tf, settings.Kd / Tf};
}

/// One sample: output = Kp (b r - y) + I + D + feed forward, limited.
///
/// I and D are the difference equations of PidQuadrature and PidDifference, with I limited. After
/// the output is formed, back-calculation changes I by
/// dt · back_calculation · (limited - unlimited), which affects the next output. An input with an
/// excess keeps I from growing in its direction. Does not allocate or throw. Theory: "PID element".
template <class Scalar>
PidOutput<Scalar> step(const PidSettings<Scalar>& settings, PidState<Scalar>& state,
                       const PidInput<Scalar>& input) noexcept {
  const Scalar error = input.set_point - input.measurement;
  const Scalar v = settings.c * input.set_point - input.measurement;

  const PidQuadrature<Scalar> weight = pid_quadrature<Scalar>(settings.method);
  const Scalar increment =
      settings.Ki * settings.dt * (weight.now * error + weight.before * state.error);
  const MaskOf<Scalar> winds_up = input.excess * increment > Scalar(0);
  Scalar integral = select(winds_up, state.integral, state.integral + increment);
  integral = clamped(integral, settings.integral_min, settings.integral_max);

  const Scalar ahead = input.rate - state.rate;
  Scalar derivative = -settings.Kd * (input.rate + settings.rate_lead * ahead);
  if (settings.derivative != PidDerivative::measured_rate) {
    const PidDifference<Scalar> difference = pid_difference(settings);
    derivative = difference.pole * state.derivative + difference.gain * (v - state.v);
  }

  const Scalar proportional = settings.Kp * (settings.b * input.set_point - input.measurement);
  const Scalar unlimited = proportional + integral + derivative + input.feed_forward;
  const Scalar output = clamped(unlimited, settings.output_min, settings.output_max);
  // Reject NaN here: once in the state, it would stay there.
  const MaskOf<Scalar> finite = is_finite(unlimited + error + v);
  state.integral =
      select(finite, integral + settings.dt * settings.back_calculation * (output - unlimited),
             state.integral);
  state.error = select(finite, error, state.error);
  state.v = select(finite, v, state.v);
  state.derivative = select(finite, derivative, state.derivative);
  state.rate = select(finite, state.rate + settings.rate_share * ahead, state.rate);
  state.output = select(finite, output, state.output);
  return {state.output, unlimited, finite};
}

/// The state for a bumpless start: as if `input` and `output` had been constant for a long time.
/// With a constant input, the next output differs from `output` only by one increment of the
/// integral.
template <class Scalar>
[[nodiscard]] PidState<Scalar> pid_start(const PidSettings<Scalar>& settings,
                                         const PidInput<Scalar>& input, Scalar output) noexcept {
  PidState<Scalar> state;
  state.error = input.set_point - input.measurement;
  state.v = settings.c * input.set_point - input.measurement;
  const Scalar proportional = settings.Kp * (settings.b * input.set_point - input.measurement);
  if (settings.derivative == PidDerivative::measured_rate)
    state.derivative = -settings.Kd * input.rate;
  state.rate = input.rate;
  state.integral = output - proportional - state.derivative - input.feed_forward;
  state.output = output;
  return state;
}

/// Converts settings to another precision.
template <class To, class From>
[[nodiscard]] constexpr PidSettings<To> pid_cast(const PidSettings<From>& from) noexcept {
  return {
      To(from.dt),         To(from.Kp),           To(from.Ki),           To(from.Kd),
      To(from.Tf),         To(from.rate_lead),    To(from.rate_share),   To(from.b),
      To(from.c),          from.method,           from.derivative,       To(from.output_min),
      To(from.output_max), To(from.integral_min), To(from.integral_max), To(from.back_calculation)};
}

static_assert(std::is_trivially_copyable_v<PidState<float>>);
static_assert(std::is_trivially_copyable_v<PidState<double>>);
static_assert(std::is_trivially_copyable_v<PidSettings<float>>);

/// Checks that step() may use these settings: dt > 0, finite gains, ordered limits, a stable filter
/// (Tf > dt/2 with forward Euler, Tf ≥ 0 with backward Euler, Tf > 0 with Tustin), a lead that is
/// not negative with a share of 0 to 1, and a back-calculation that does not overshoot.
/// @throws InvalidInput  "where: Tf is 0.001 s, expected more than dt/2 = 0.0025 s because …"
void validate(const PidSettings<double>& settings, const std::string& where);

/// The same for single precision.
void validate(const PidSettings<float>& settings, const std::string& where);

/// A loop of a cascade as a PID element: PidDerivative::measured_rate, integral by forward
/// Euler, derivative of the rate by backward Euler, no limits. The sign of Kd changes, since
/// PidLoop adds Kd · rate and the element subtracts it.
/// @throws InvalidInput  as validate(), with the name of the loop.
[[nodiscard]] PidSettings<double> pid_settings(const PidLoop& loop, double dt);

/// The input of a transfer function of the element; the output is always that of the element. By
/// linearity, output = set_point · r + measurement · y + rate · y'.
enum class PidChannel {
  error,      ///< minus the channel `measurement`: the controller in the loop's transfer function
  set_point,  ///< with the weights b and c
  /// -(Kp + I + D); excludes the D of a measured rate.
  measurement,
  rate,  ///< -Kd with the lead if the rate is measured, otherwise 0
};

/// The exact transfer function of step() as long as no limit is active.
/// @throws InvalidInput  as validate()
[[nodiscard]] DiscreteTransferFunction pid_transfer_function(const PidSettings<double>& settings,
                                                             PidChannel channel);

}  // namespace quadtune
