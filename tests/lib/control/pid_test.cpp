// SPDX-License-Identifier: Apache-2.0
#include "quadtune/control/pid.hpp"

#include <gmock/gmock.h>

#include <complex>
#include <cstring>
#include <random>
#include <utility>
#include <vector>

#include "numbers.hpp"
#include "quadtune/errors.hpp"

namespace quadtune {
namespace {

using ::testing::HasSubstr;
using ::testing::StrEq;
using ::testing::ThrowsMessage;

using testing::kNaN;
constexpr double kFrequencies[] = {0.1, 0.3, 1, 3, 10, 30, 100, 300};  // [rad/s]
constexpr PidMethod kMethods[] = {PidMethod::forward_euler, PidMethod::backward_euler,
                                  PidMethod::tustin};

PidSettings<double> filtered_pid(PidMethod method) {
  PidSettings<double> settings;
  settings.dt = 0.01;
  settings.Kp = 2;
  settings.Ki = 3;
  settings.Kd = 0.4;
  settings.Tf = 0.03;
  settings.b = 0.7;
  settings.c = 0.2;
  settings.method = method;
  settings.derivative = PidDerivative::filtered;
  return settings;
}

/// Outputs to a set point that is 1 from the first sample on, with the measurement at 0.
std::vector<double> step_response(const PidSettings<double>& settings, int samples) {
  PidState<double> state;
  std::vector<double> outputs;
  outputs.reserve(static_cast<std::size_t>(samples));
  for (int k = 0; k < samples; ++k) outputs.push_back(step(settings, state, {1, 0}).value);
  return outputs;
}

TEST(Pid, ProportionalPartWeighsTheSetPoint) {
  PidSettings<double> settings;
  settings.dt = 0.005;
  settings.Kp = 2;
  settings.b = 0.5;
  PidState<double> state;
  EXPECT_DOUBLE_EQ(step(settings, state, {3, 1}).value, 2 * (0.5 * 3 - 1));
  EXPECT_DOUBLE_EQ(step(settings, state, {-3, 1, 0, 10}).value, 2 * (-0.5 * 3 - 1) + 10);
}

// The integral of 1 after sample k is k dt, (k + 1) dt or (k + ½) dt.
TEST(Pid, IntegratesAStepByEachMethod) {
  const double ahead[] = {0, 1, 0.5};
  for (int m = 0; m < 3; ++m) {
    PidSettings<double> settings;
    settings.dt = 0.005;
    settings.Ki = 4;
    settings.method = kMethods[m];
    const std::vector<double> outputs = step_response(settings, 1000);
    // Each of the 1000 sums rounds by up to 2e-15.
    for (int k = 0; k < 1000; ++k) EXPECT_NEAR(outputs[k], 4 * 0.005 * (k + ahead[m]), 2e-12);
  }
}

// Step response of Kd s/(Tf s + 1), c = 1: first g, then a power of the pole.
TEST(Pid, DifferentiatesAStepByEachMethod) {
  const double dt = 0.01;
  const double Tf = 0.03;
  const double Kd = 0.4;
  const double pole[] = {1 - dt / Tf, Tf / (Tf + dt), (2 * Tf - dt) / (2 * Tf + dt)};
  const double first[] = {Kd / Tf, Kd / (Tf + dt), 2 * Kd / (2 * Tf + dt)};
  for (int m = 0; m < 3; ++m) {
    PidSettings<double> settings = filtered_pid(kMethods[m]);
    settings.Kp = settings.Ki = 0;
    settings.c = 1;
    const std::vector<double> outputs = step_response(settings, 50);
    for (int k = 0; k < 50; ++k) EXPECT_NEAR(outputs[k], first[m] * std::pow(pole[m], k), 1e-13);
  }
}

// A ramp of slope a has the derivative a, exactly at once or after the filter.
TEST(Pid, DerivativeOfARampIsItsSlope) {
  for (const PidMethod method : kMethods) {
    for (const PidDerivative form : {PidDerivative::difference, PidDerivative::filtered}) {
      PidSettings<double> settings = filtered_pid(method);
      settings.Kp = settings.Ki = 0;
      settings.derivative = form;
      PidState<double> state;
      double output = 0;
      for (int k = 0; k < 300; ++k) output = step(settings, state, {0, 5 * 0.01 * k}).value;
      EXPECT_NEAR(output, -0.4 * 5, 1e-12);
    }
  }
}

TEST(Pid, TakesAMeasuredRateAsItIs) {
  PidSettings<double> settings;
  settings.dt = 0.005;
  settings.Kd = 0.5;
  PidState<double> state;
  EXPECT_DOUBLE_EQ(step(settings, state, {1, 7, 2}).value, -1);
  EXPECT_DOUBLE_EQ(step(settings, state, {1, -7, -2}).value, 1);
}

/// Kd on rate + lead · derivative, the derivative by backward Euler behind a low pass of 20 ms.
PidSettings<double> leading_pid() {
  PidLoop loop = cascade_loop(CascadeAxis::roll);
  loop.Kp = 2;
  loop.Kd = -0.5;
  loop.rate_lead = 0.04;
  loop.rate_filter = 0.02;
  return pid_settings(loop, 0.005);
}

// A step of the rate: the derivative is 1/(Tf + dt), and then a power of Tf/(Tf + dt).
TEST(Pid, LeadOfTheRateDecaysWithItsFilter) {
  PidState<double> state;
  for (int k = 0; k < 40; ++k)
    EXPECT_NEAR(step(leading_pid(), state, {0, 0, 3}).value,
                -0.5 * 3 * (1 + 0.04 / 0.025 * std::pow(0.8, k)), 1e-14);
}

// A ramp of the rate: the derivative ends at its slope.
TEST(Pid, LeadOfARampIsItsSlope) {
  PidState<double> state;
  double last = 0;
  for (int k = 0; k < 400; ++k) last = step(leading_pid(), state, {0, 0, 7 * 0.005 * k}).value;
  EXPECT_NEAR(last, -0.5 * (7 * 0.005 * 399 + 0.04 * 7), 1e-12);
}

TEST(Pid, LeadOfTheRateIsTheContinuousOneWithSReplaced) {
  const auto C = pid_transfer_function(leading_pid(), PidChannel::rate);
  for (const double w : kFrequencies) {
    const std::complex<double> z = std::polar(1.0, w * 0.005), s = (z - 1.0) / (0.005 * z);
    const std::complex<double> want = -0.5 * (1.0 + 0.04 * s / (0.02 * s + 1.0));
    EXPECT_LT(std::abs(C(z) - want), 1e-12 * std::abs(want));
  }
}

TEST(Pid, WithALeadStartsWithoutABumpAndKeepsItsStateThroughNaN) {
  PidState<double> state = pid_start(leading_pid(), {1, 0.9, 4, 0}, 2.0);
  EXPECT_NEAR(step(leading_pid(), state, {1, 0.9, 4, 0}).value, 2, 1e-14);
  PidState<double> untouched = state;
  EXPECT_FALSE(step(leading_pid(), state, {1, 0.9, kNaN, 0}).finite);
  EXPECT_FALSE(step(leading_pid(), state, {1, 0.9, PidSettings<double>::kInfinity, 0}).finite);
  EXPECT_EQ(step(leading_pid(), state, {1, 0.5, 3, 0}).value,
            step(leading_pid(), untouched, {1, 0.5, 3, 0}).value);
}

// The recorded impulse response, transformed: Σ h[k] z^-k just outside the unit circle.
std::complex<double> transformed_impulse(const PidSettings<double>& settings,
                                         const PidInput<double>& unit, std::complex<double> z) {
  PidState<double> state;
  std::complex<double> sum = 0;
  std::complex<double> power = 1;
  for (int k = 0; k < 4000; ++k) {
    sum += step(settings, state, k == 0 ? unit : PidInput<double>{}).value * power;
    power /= z;
  }
  return sum;
}

TEST(Pid, RunsItsTransferFunction) {
  for (const PidMethod method : kMethods) {
    for (const PidDerivative form :
         {PidDerivative::measured_rate, PidDerivative::difference, PidDerivative::filtered}) {
      PidSettings<double> settings = filtered_pid(method);
      settings.derivative = form;
      const auto set_point = pid_transfer_function(settings, PidChannel::set_point);
      const auto measurement = pid_transfer_function(settings, PidChannel::measurement);
      const auto error = pid_transfer_function(settings, PidChannel::error);
      const auto rate = pid_transfer_function(settings, PidChannel::rate);
      for (const double w : kFrequencies) {
        const std::complex<double> z = std::polar(1.02, w * settings.dt);
        const auto near = [&](const DiscreteTransferFunction& G, const PidInput<double>& unit) {
          return std::abs(G(z) - transformed_impulse(settings, unit, z));
        };
        EXPECT_LT(near(set_point, {1, 0}), 1e-11);
        EXPECT_LT(near(measurement, {0, 1}), 1e-11);
        EXPECT_LT(near(rate, {0, 0, 1}), 1e-12);
        EXPECT_LT(std::abs(error(z) + measurement(z)), 1e-11);
      }
    }
  }
}

TEST(Pid, RunsTheTransferFunctionOfItsLead) {
  const auto rate = pid_transfer_function(leading_pid(), PidChannel::rate);
  for (const double w : kFrequencies) {
    const std::complex<double> z = std::polar(1.02, w * 0.005);
    EXPECT_LT(std::abs(rate(z) - transformed_impulse(leading_pid(), {0, 0, 1}, z)), 1e-12);
  }
}

// The same from the continuous controller, with s replaced by hand.
TEST(Pid, TransferFunctionIsTheContinuousOneWithSReplaced) {
  const double dt = 0.01;
  for (const PidMethod method : kMethods) {
    const PidSettings<double> p = filtered_pid(method);
    const auto C = pid_transfer_function(p, PidChannel::error);
    for (const double w : kFrequencies) {
      const std::complex<double> z = std::polar(1.0, w * dt);
      const std::complex<double> s = method == PidMethod::forward_euler ? (z - 1.0) / dt
                                     : method == PidMethod::backward_euler
                                         ? (z - 1.0) / (dt * z)
                                         : 2 / dt * (z - 1.0) / (z + 1.0);
      const std::complex<double> want = p.Kp + p.Ki / s + p.Kd * s / (p.Tf * s + 1.0);
      EXPECT_LT(std::abs(C(z) - want), 1e-11 * std::abs(want));
    }
  }
}

TEST(Pid, PartsThatAreOffBringNoPole) {
  PidSettings<double> settings;
  settings.dt = 0.01;
  settings.Kp = 2;
  EXPECT_EQ(pid_transfer_function(settings, PidChannel::error).den.size(), 1);
  settings.Ki = 1;
  EXPECT_EQ(pid_transfer_function(settings, PidChannel::error).den.size(), 2);
}

TEST(Pid, FloatFollowsDouble) {
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> uniform(-1, 1);
  for (const PidMethod method : kMethods) {
    PidSettings<double> settings = filtered_pid(method);
    settings.output_max = 2;
    settings.output_min = -2;
    settings.back_calculation = 20;
    const PidSettings<float> single = pid_cast<float>(settings);
    PidState<double> state;
    PidState<float> single_state;
    for (int k = 0; k < 2000; ++k) {
      const double r = uniform(random);
      const double y = 0.1 * uniform(random);
      const double wide = step(settings, state, {r, y}).value;
      const float narrow = step(single, single_state, {float(r), float(y)}).value;
      EXPECT_NEAR(narrow, wide, 2e-4) << k;  // 2000 roundings of 6e-8 · 2, at worst all alike
    }
  }
}

// A pure integral against a standing error e settles where the back-calculation balances it; when
// the error turns to -e, the excess x over the limit shrinks as x ← (1 - a) x - h, a = dt Kt,
// h = Ki dt e. It leaves the limit in the first sample with x < 0.
TEST(Pid, BackCalculationLeavesSaturationWhenItSays) {
  PidSettings<double> settings;
  settings.dt = 0.01;
  settings.Ki = 3;
  settings.method = PidMethod::backward_euler;
  settings.output_max = 1;
  settings.output_min = -1;
  settings.back_calculation = 2;
  const double a = settings.dt * settings.back_calculation;
  const double h = settings.Ki * settings.dt * 1;
  PidState<double> state;
  for (int k = 0; k < 2000; ++k) step(settings, state, {1, 0});
  EXPECT_NEAR(state.integral, 1 + h / a * (1 - a), 1e-12);

  // x_k = (x_0 + h/a)(1 - a)^k - h/a with x_0 = h/a before the first turned sample
  const int expected = static_cast<int>(std::ceil(std::log(0.5) / std::log(1 - a)));
  int samples = 0;
  do {
    ++samples;
  } while (samples < 5000 && step(settings, state, {-1, 0}).value == 1);
  EXPECT_EQ(samples, expected);  // 35; without anti-windup it would be as long as it was saturated
  EXPECT_EQ(expected, 35);
}

TEST(Pid, WithoutBackCalculationWindsUp) {
  PidSettings<double> settings;
  settings.dt = 0.01;
  settings.Ki = 3;
  settings.output_max = 1;
  PidState<double> state;
  for (int k = 0; k < 2000; ++k) step(settings, state, {1, 0});
  int samples = 0;
  do {
    ++samples;
  } while (samples < 5000 && step(settings, state, {-1, 0}).value == 1);
  EXPECT_NEAR(samples, 2000 - 1 / 0.03, 2);
}

TEST(Pid, LimitsItsIntegralOnBothSides) {
  PidSettings<double> settings;
  settings.dt = 0.01;
  settings.Ki = 3;
  settings.integral_min = -0.5;
  settings.integral_max = 0.25;
  PidState<double> state;
  for (int k = 0; k < 100; ++k) step(settings, state, {1, 0});
  EXPECT_EQ(state.output, 0.25);
  for (int k = 0; k < 100; ++k) step(settings, state, {-1, 0});
  EXPECT_EQ(state.output, -0.5);
  // It comes off the limit with the next increment: the integral was never beyond it.
  step(settings, state, {1, 0});
  EXPECT_EQ(step(settings, state, {1, 0}).value, -0.5 + 0.03);
}

TEST(Pid, LimitsItsOutputAndReportsTheUnlimitedOne) {
  PidSettings<double> settings;
  settings.dt = 0.01;
  settings.Kp = 10;
  settings.output_min = -1;
  settings.output_max = 2;
  PidState<double> state;
  const PidOutput<double> high = step(settings, state, {1, 0});
  EXPECT_EQ(high.value, 2);
  EXPECT_EQ(high.unlimited, 10);
  EXPECT_EQ(step(settings, state, {-1, 0}).value, -1);
}

// Oliveira 2020, table 3.3, pitch: Kp 0.013, Ki 0.01, Kd -0.002 on the measured rate, 5 ms. The
// numbers are worked out by hand.
TEST(Pid, FliesTheMamboPitchLoop) {
  PidSettings<double> settings =
      pid_settings({"pitch", "tau_y", "N m/rad", 0.013, 0.01, -0.002}, 0.005);
  PidState<double> state;
  EXPECT_NEAR(step(settings, state, {0.1, 0, 0}).value, 0.0013, 1e-15);
  EXPECT_NEAR(step(settings, state, {0.1, 0.01, 2}).value, 0.00117 + 5e-6 - 0.004, 1e-15);
  EXPECT_NEAR(step(settings, state, {0.1, 0.03, 4}).value, 0.00091 + 9.5e-6 - 0.008, 1e-15);
  EXPECT_NEAR(step(settings, state, {0.1, 0.05, 1}).value, 0.00065 + 1.3e-5 - 0.002, 1e-15);

  settings.method = PidMethod::tustin;
  state = {};
  EXPECT_NEAR(step(settings, state, {0.1, 0, 0}).value, 0.0013 + 2.5e-6, 1e-15);
  EXPECT_NEAR(step(settings, state, {0.1, 0.01, 2}).value, 0.00117 + 7.25e-6 - 0.004, 1e-15);
  EXPECT_NEAR(step(settings, state, {0.1, 0.03, 4}).value, 0.00091 + 1.125e-5 - 0.008, 1e-15);
}

// The same table: x at -0.24, Kd 0.1. Ahead of its set point and still moving ahead, the vehicle
// must pitch its nose up, which is positive, by both parts.
TEST(Pid, MamboPositionLoopBrakes) {
  const PidSettings<double> x = pid_settings({"x", "pitch", "rad/m", -0.24, 0, 0.1}, 0.005);
  PidState<double> state;
  EXPECT_NEAR(step(x, state, {0, 0.5, 0.3}).value, 0.12 + 0.03, 1e-15);
}

TEST(Pid, ACopyOfItsStateResumesIdentically) {
  std::mt19937_64 random(6);
  std::uniform_real_distribution<float> uniform(-1, 1);
  const PidSettings<float> settings = pid_cast<float>(filtered_pid(PidMethod::tustin));
  PidState<float> state;
  for (int k = 0; k < 100; ++k) step(settings, state, {uniform(random), uniform(random)});
  PidState<float> copy;
  std::memcpy(&copy, &state, sizeof state);
  for (int k = 0; k < 100; ++k) {
    const PidInput<float> input = {uniform(random), uniform(random)};
    EXPECT_EQ(step(settings, state, input).value, step(settings, copy, input).value);
  }
}

TEST(Pid, StartsWithoutABump) {
  for (const PidMethod method : kMethods) {
    const PidSettings<double> settings = filtered_pid(method);
    const PidInput<double> input = {1, 0.9, 0, 0.5};
    PidState<double> state = pid_start(settings, input, 4.0);
    EXPECT_NEAR(step(settings, state, input).value, 4 + 3 * 0.01 * 0.1, 1e-14);
  }
}

TEST(Pid, KeepsItsStateThroughNaN) {
  const PidSettings<double> settings = filtered_pid(PidMethod::tustin);
  PidState<double> state;
  const double last = step(settings, state, {1, 0.5}).value;
  PidState<double> untouched = state;
  for (const PidInput<double>& bad :
       {PidInput<double>{kNaN, 0}, PidInput<double>{0, kNaN}, PidInput<double>{0, 0, 0, kNaN},
        PidInput<double>{PidSettings<double>::kInfinity, 0}}) {
    const PidOutput<double> output = step(settings, state, bad);
    EXPECT_FALSE(output.finite);
    EXPECT_EQ(output.value, last);
  }
  EXPECT_EQ(step(settings, state, {1, 0.5}).value, step(settings, untouched, {1, 0.5}).value);
}

// What runs on board throws nothing; the compiler sees to it.
static_assert(noexcept(step(std::declval<const PidSettings<float>&>(),
                            std::declval<PidState<float>&>(), PidInput<float>{})));
static_assert(noexcept(pid_start(std::declval<const PidSettings<float>&>(), PidInput<float>{},
                                 0.0F)));

TEST(PidSettings, AreRefusedWithTheirReason) {
  const auto refusal = [](auto change) {
    PidSettings<double> settings = filtered_pid(PidMethod::forward_euler);
    change(settings);
    try {
      validate(settings, "here");
    } catch (const InvalidInput& mistake) {
      return std::string(mistake.what());
    }
    return std::string("accepted");
  };
  EXPECT_THAT(refusal([](auto&) {}), StrEq("accepted"));
  EXPECT_THAT(refusal([](auto& s) { s.dt = 0; }),
              StrEq("here: dt is 0 s, expected a positive number"));
  EXPECT_THAT(refusal([](auto& s) { s.dt = kNaN; }), HasSubstr("dt is nan"));
  EXPECT_THAT(refusal([](auto& s) { s.Kd = kNaN; }), HasSubstr("Kd is nan, expected a finite"));
  EXPECT_THAT(refusal([](auto& s) { s.b = kNaN; }), HasSubstr("b is nan"));
  EXPECT_THAT(refusal([](auto& s) { s.output_min = kNaN; }), HasSubstr("output_min is nan"));
  EXPECT_THAT(refusal([](auto& s) { s.integral_max = -1, s.integral_min = 1; }),
              StrEq("here: integral_min is 1 and integral_max -1, expected the minimum not to "
                    "exceed the maximum"));
  EXPECT_THAT(refusal([](auto& s) { s.back_calculation = 101; }),
              HasSubstr("back_calculation is 101 1/s, expected 0 to 1/dt = 100"));
  EXPECT_THAT(refusal([](auto& s) { s.Tf = 0.005; }),
              StrEq("here: Tf is 0.005 s, expected more than dt/2 = 0.005 s because otherwise "
                    "forward Euler makes the filter unstable"));
  EXPECT_THAT(refusal([](auto& s) { s.Tf = 0, s.method = PidMethod::tustin; }),
              HasSubstr("rings forever"));
  EXPECT_THAT(refusal([](auto& s) { s.Tf = 0, s.method = PidMethod::backward_euler; }),
              StrEq("accepted"));
  EXPECT_THAT(refusal([](auto& s) { s.Tf = -1, s.method = PidMethod::backward_euler; }),
              HasSubstr("Tf is -1 s"));
  EXPECT_THAT(refusal([](auto& s) { s.rate_lead = -1; }),
              HasSubstr("rate_lead is -1 and rate_share 0, expected a finite number of 0 or more"));
  EXPECT_THAT(refusal([](auto& s) { s.rate_lead = kNaN; }), HasSubstr("rate_lead is nan"));
  EXPECT_THAT(refusal([](auto& s) { s.rate_share = 1.1; }), HasSubstr("rate_share 1.1"));
  PidLoop backwards = cascade_loop(CascadeAxis::roll);
  backwards.rate_lead = -0.01;
  EXPECT_THAT([&] { (void)pid_settings(backwards, 0.005); },
              ThrowsMessage<InvalidInput>(HasSubstr("loop roll: rate_lead is -0.01 s")));
  backwards.rate_lead = 0.01;
  backwards.rate_filter = kNaN;
  EXPECT_THAT([&] { (void)pid_settings(backwards, 0.005); },
              ThrowsMessage<InvalidInput>(HasSubstr("rate_filter nan s")));
  EXPECT_THROW(validate(PidSettings<float>{}, "here"), InvalidInput);
  EXPECT_THAT(
      [] {
        (void)pid_settings({"yaw", "tau_z", "", kNaN, 0, 0}, 0.005);
      },
      ThrowsMessage<InvalidInput>(HasSubstr("loop yaw: Kp is nan")));
}

}  // namespace
}  // namespace quadtune
