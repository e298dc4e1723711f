// SPDX-License-Identifier: Apache-2.0
#include "quadtune/synthesis/margins.hpp"

#include <fmt/format.h>
#include <fmt/ostream.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <functional>
#include <memory>
#include <numbers>
#include <ostream>

#include "margins/channel_response.hpp"
#include "margins/crossover_margins.hpp"
#include "margins/disk.hpp"
#include "margins/loop_grid.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/frequency_response.hpp"

namespace quadtune {

namespace {

using Complex = std::complex<double>;
using internal::ChannelResponse;
using internal::Peak;
constexpr double kPi = std::numbers::pi;
constexpr double kInfinite = std::numeric_limits<double>::infinity();
constexpr double kZeroPhase = 1e-9;  // [rad] smaller phase margins are 0 up to rounding

/// The response of one channel on the grid.
struct Samples {
  std::vector<double> w;
  std::vector<Complex> L;
  std::vector<Complex> S;
};

/// The same loop with its states in reverse order; the response differs by rounding only.
FrequencyResponse reordered(const OpenLoop& loop) {
  const auto fill = [&](auto plant) {
    plant.A = loop.A().reverse();
    plant.B = loop.B().colwise().reverse();
    plant.C = loop.C().rowwise().reverse();
    plant.D = loop.D();
    return plant;
  };
  if (!loop.discrete()) return FrequencyResponse(fill(ContinuousLti{}));
  DiscreteLti plant = fill(DiscreteLti{});
  plant.dt = loop.dt();
  return FrequencyResponse(plant);
}

/// @param loop  must outlive the result
ChannelResponse response_of(const OpenLoop& loop) {
  ChannelResponse response;
  response.at = [&loop](double w) { return loop.at(w)(0, 0); };
  const auto turned = std::make_shared<FrequencyResponse>(reordered(loop));
  response.again = [turned, delay = loop.delay()](double w) {
    return turned->at(w)(0, 0) * std::polar(1.0, -w * delay);
  };
  response.sensitivity = [&loop](double w) { return loop.sensitivity(w)(0, 0); };
  response.grid = frequency_grid(loop);
  response.discrete = loop.discrete();
  response.delay = loop.delay();
  return response;
}

/// Scale-free functions of L whose zeros are crossovers. Their errors are comparable between
/// frequencies at which |L| differs.
double log_size(Complex L) { return std::log(std::abs(L)); }
double sine_of_phase(Complex L) {
  const double size = std::abs(L);
  return size > 0 ? L.imag() / size : 0;
}

class SingleLoop {
 public:
  explicit SingleLoop(const ChannelResponse& response) : response_(response) {
    for (const double w : response_.grid) {
      const Complex L = at(w);
      // The response is not finite at a pole on the axis; the neighbouring frequencies suffice.
      if (!std::isfinite(L.real()) || !std::isfinite(L.imag())) continue;
      samples_.w.push_back(w);
      samples_.L.push_back(L);
      // Not finite where L is finite: L = -1, a closed-loop pole on the axis.
      const Complex S = sensitivity(w);
      const bool finite = std::isfinite(S.real()) && std::isfinite(S.imag());
      samples_.S.push_back(finite ? S : Complex(kInfinite, 0));
    }
    // Exactly real, so that a crossing at Nyquist is detected.
    if (response_.discrete && !samples_.L.empty()) samples_.L.back().imag(0);
  }

  [[nodiscard]] Complex at(double w) const { return response_.at(w); }
  [[nodiscard]] Complex sensitivity(double w) const { return response_.sensitivity(w); }

  using Function = double (*)(Complex L);

  /// Computes the zeros of f(L): the sign changes between frequencies at which f exceeds its
  /// rounding error, and 0 and Nyquist, where L is real by symmetry, if f is 0 there and not
  /// everywhere.
  [[nodiscard]] std::vector<double> roots(Function f) const {
    const std::size_t count = samples_.w.size();
    std::vector<double> values;
    values.reserve(count);
    for (const Complex& L : samples_.L) values.push_back(f(L));
    std::vector<double> errors(count, -1);  // -1: not computed yet; shared by neighbours
    const auto certain = [&](std::size_t i) {
      return values[i] != 0 && std::abs(values[i]) > kOverRounding * rounding_near(i, f, errors);
    };
    std::vector<double> found =
        internal::crossings([&](double w) { return f(at(w)); }, samples_.w, values, certain);
    const auto is_root = [&](std::size_t end) {
      constexpr double kFar = 1e-3;  // certainly not 0, whatever the rounding error
      if (std::abs(values[end]) > kFar || certain(end)) return false;
      for (std::size_t i = 0; i < count; ++i)
        if (certain(i)) return true;
      return false;
    };
    if (count > 0 && samples_.w.front() == 0 && is_root(0)) found.insert(found.begin(), 0);
    if (count > 1 && response_.discrete && is_root(count - 1)) found.push_back(samples_.w.back());
    return found;
  }

  /// Whether |L| at w exceeds its rounding error. If L has a pole or a zero at 0, its value there
  /// is only rounding: infinite or 0 up to the last digits of the coefficients.
  [[nodiscard]] bool is_seen(double w) const {
    constexpr double kInfiniteAtRest = 1e10;
    if (w < lowest()) {
      const double size = std::abs(at(w));
      if (!(size < kInfiniteAtRest && size * kInfiniteAtRest > 1)) return false;
    }
    return kOverRounding * rounding(w, log_size) < 1;
  }

  /// Computes the maximum of |S + offset| and its frequency.
  [[nodiscard]] Peak peak(double offset) const {
    std::vector<double> values;
    values.reserve(samples_.S.size());
    for (const Complex& S : samples_.S) values.push_back(std::abs(S + offset));
    const Peak best = internal::highest_peak(
        [&](double w) { return std::abs(sensitivity(w) + offset); }, samples_.w, values);
    if (response_.discrete || response_.delay > 0) return best;
    const double at_infinity = std::abs(sensitivity(kInfinite) + offset);
    return at_infinity > best.value ? Peak{at_infinity, kInfinite} : best;
  }

  /// The feed-through of a continuous loop without delay; otherwise 0.
  [[nodiscard]] double feed_through() const {
    return response_.discrete || response_.delay > 0 ? 0 : at(kInfinite).real();
  }

 private:
  static constexpr double kOverRounding = 30;

  [[nodiscard]] double lowest() const { return samples_.w.size() > 1 ? samples_.w[1] : 0; }

  /// Estimates the rounding error of f(L) at w from its difference with reordered states, and from
  /// its scatter over frequencies so close that L does not change: they differ by a few last digits
  /// of w or, at 0, of the lowest frequency.
  [[nodiscard]] double rounding(double w, Function f) const {
    constexpr double kNear = 0x1p-50;
    const double centre = w > 0 ? f(at(w)) : f(at(kNear * lowest()));
    double scatter = std::abs(f(response_.again(w)) - f(at(w)));
    for (const int k : {2, 3, 4, 5, 6, 7}) {
      const double there = w > 0 ? w * (1 - k * kNear) : k * kNear * lowest();
      scatter = std::max(scatter, std::abs(f(at(there)) - centre));
    }
    return scatter;
  }

  /// The same, also considering neighbours: the difference of two computations is occasionally much
  /// smaller than their errors, but not at five consecutive frequencies.
  [[nodiscard]] double rounding_near(std::size_t i, Function f, std::vector<double>& errors) const {
    constexpr std::size_t kReach = 2;
    double largest = 0;
    for (std::size_t k = i > kReach ? i - kReach : 0; k <= i + kReach && k < samples_.w.size();
         ++k) {
      if (errors[k] < 0) errors[k] = rounding(samples_.w[k], f);
      largest = std::max(largest, errors[k]);
    }
    return largest;
  }

  const ChannelResponse& response_;
  Samples samples_;
};

/// Wraps an angle to (-π, π].
double wrap_angle(double angle) {
  const double turned = std::remainder(angle, 2 * kPi);
  return turned <= -kPi ? turned + 2 * kPi : turned;
}

std::vector<GainCrossover> gain_crossovers(const SingleLoop& loop) {
  std::vector<GainCrossover> all;
  for (const double w : loop.roots(log_size)) {
    const double phase = wrap_angle(std::arg(loop.at(w)) + kPi);
    // If the phase margin is 0 up to rounding, so is the delay margin; it is not a whole turn.
    const double lag = std::abs(phase) < kZeroPhase ? 0 : phase > 0 ? phase : phase + 2 * kPi;
    all.push_back({w, phase, w > 0 ? lag / w : kInfinite});
  }
  return all;
}

std::vector<PhaseCrossover> phase_crossovers(const SingleLoop& loop) {
  std::vector<PhaseCrossover> all;
  for (const double w : loop.roots(sine_of_phase)) {
    const Complex L = loop.at(w);
    // A change of sign through infinity, at a pole on the axis, is not a crossing of 0.
    const bool real = std::abs(L.imag()) <= 1e-6 * std::abs(L);
    if (real && L.real() < 0 && loop.is_seen(w)) all.push_back({w, 1 / std::abs(L)});
  }
  // The feed-through of a continuous loop is also real, but infinity is not on the grid.
  if (loop.feed_through() < 0) all.push_back({kInfinite, -1 / loop.feed_through()});
  return all;
}

/// Omits crossovers at extreme gains unless they define a margin: with a delay, even a tiny L keeps
/// crossing the negative axis.
void shorten(LoopMargins& margins) {
  constexpr double kOfInterest = 1e6;
  const auto is_far = [&](const PhaseCrossover& at) {
    return at.gain_margin != margins.gain_margin && at.gain_margin != margins.gain_reduction &&
           !(at.gain_margin < kOfInterest && at.gain_margin * kOfInterest > 1);
  };
  margins.far_phase_crossovers = static_cast<int>(std::erase_if(margins.phase_crossovers, is_far));
}

/// Stability with a delay (Walton, Marshall 1987): as the delay increases from 0, roots cross the
/// axis only at the gain crossovers, in pairs: to the right where |L| decreases, and back where it
/// increases.
bool stable_with_delay(const OpenLoop& loop) {
  const OpenLoop prompt = loop.without_delay();
  // With |L| ≥ 1 at infinity, every delay leaves arbitrarily fast poles that are not stable.
  if (std::abs(prompt.at(kInfinite)(0, 0)) >= 1) return false;
  const Eigen::VectorXcd poles = prompt.closed_loop_poles();
  // Poles on the axis count as unstable, on whichever side of it they are computed.
  auto unstable =
      static_cast<long>((poles.real().array() >= -kZeroPhase * poles.array().abs()).count());
  const ChannelResponse of_prompt = response_of(prompt);
  const SingleLoop response(of_prompt);
  for (const GainCrossover& crossover : gain_crossovers(response)) {
    const double w = crossover.w;
    if (!(w > 0) || crossover.delay_margin > loop.delay()) continue;
    const double passed = std::floor((loop.delay() - crossover.delay_margin) * w / (2 * kPi)) + 1;
    const bool falls = std::abs(response.at(w * (1 + 1e-6))) < std::abs(response.at(w));
    unstable += (falls ? 2 : -2) * static_cast<long>(passed);
  }
  return unstable == 0;
}

}  // namespace

namespace internal {

bool closed_loop_is_stable(const OpenLoop& loop) {
  if (loop.delay() > 0) return stable_with_delay(loop);
  const Eigen::VectorXcd poles = loop.closed_loop_poles();
  return loop.discrete() ? poles.cwiseAbs().maxCoeff() < 1 : poles.real().maxCoeff() < 0;
}

DiskMargin disk_of_peak(double peak, double w, double skew) {
  DiskMargin disk;
  disk.alpha = 1 / peak;
  disk.w = w;
  const double a = disk.alpha;
  disk.gain_low = (2 - a * (1 - skew)) / (2 + a * (1 + skew));
  const double open = 2 - a * (1 + skew);
  disk.gain_high = open > 1e-12 ? (2 + a * (1 - skew)) / open : kInfinite;
  // The factor e^(jθ) corresponds to |δ|² = (2 - 2 cos θ)/((1 + σ²)/2 + (1 - σ²)/2 cos θ), which
  // increases with θ; at π it is (2/σ)².
  disk.phase =
      a * std::abs(skew) >= 2
          ? kPi
          : std::acos(std::clamp((4 - a * a * (1 + skew * skew)) / (4 + a * a * (1 - skew * skew)),
                                 -1.0, 1.0));
  return disk;
}

DiskMargin disk_margin(const OpenLoop& loop, double skew) {
  const ChannelResponse response = response_of(loop);
  const auto [peak, w] = SingleLoop(response).peak((skew - 1) / 2);
  return disk_of_peak(peak, w, skew);
}

LoopMargins margins_of(const ChannelResponse& channel, double skew) {
  const SingleLoop response(channel);
  LoopMargins margins;
  margins.stable = channel.stable;
  margins.gain_crossovers = gain_crossovers(response);
  margins.phase_crossovers = phase_crossovers(response);
  internal::set_margins_of_crossovers(margins);
  shorten(margins);
  const Peak S = response.peak(0), T = response.peak(-1);  // |T| = |1 - S|
  margins.Ms = S.value;
  margins.w_Ms = S.w;
  margins.Mt = T.value;
  margins.w_Mt = T.w;
  if (margins.stable) {
    const auto [peak, w] = response.peak((skew - 1) / 2);
    margins.disk = disk_of_peak(peak, w, skew);
  }
  return margins;
}

}  // namespace internal

LoopMargins loop_margins(const OpenLoop& loop, double skew) {
  if (loop.size() != 1)
    throw InvalidInput(
        "loop_margins",
        fmt::format("the loop has {} channels, expected 1 (use OpenLoop::channel())", loop.size()));
  if (!std::isfinite(skew))
    throw InvalidInput("loop_margins", fmt::format("skew is {}, expected a finite number", skew));
  ChannelResponse response = response_of(loop);
  response.stable = internal::closed_loop_is_stable(loop);
  return internal::margins_of(response, skew);
}

std::ostream& operator<<(std::ostream& out, const LoopMargins& m) {
  return out << fmt::format(
             "{}, gain margin {:.4g} (reduction {:.4g}), phase margin {:.4g} rad at {:.4g} rad/s, "
             "delay margin {:.4g} s, Ms {:.4g}, Mt {:.4g}, disk {:.4g} at {:.4g} rad/s",
             m.stable ? "stable" : "unstable", m.gain_margin, m.gain_reduction, m.phase_margin,
             m.crossover, m.delay_margin, m.Ms, m.Mt, m.disk.alpha, m.disk.w);
}

}  // namespace quadtune
