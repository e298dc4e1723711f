// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "margins/loop_grid.hpp"
#include "quadtune/discretize/zoh.hpp"
#include "quadtune/synthesis/pid/pid_rules.hpp"

namespace quadtune {
namespace {

std::string written(std::complex<double> root) {
  if (root.imag() == 0) return fmt::format("{:.4g}", root.real());
  return fmt::format("{:.4g} +- {:.4g}i", root.real(), std::abs(root.imag()));
}

/// The reason why the step response of the plant does not converge to a value other than 0; empty
/// if it does.
std::string unsettled(const ContinuousTransferFunction& plant) {
  if (plant.den.size() < 2) return "the plant has no pole, so there is no lag to fit";
  const Eigen::VectorXcd poles = polynomial_roots(plant.den);
  for (Eigen::Index i = 0; i < poles.size(); ++i)
    if (!(poles[i].real() < -1e-12 * poles.cwiseAbs().maxCoeff()))
      return fmt::format("the pole at {} is not stable", written(poles[i]));
  if (plant.num[plant.num.size() - 1] == 0) return "the plant's gain is 0";
  return "";
}

/// Computes the step response at time t without the delay, exactly, from the hold over t.
double step_at(const ContinuousLti& plant, double t) {
  const double direct = plant.D.size() > 0 ? plant.D(0, 0) : 0;
  return plant.C.row(0).dot(discretize_zoh(plant, t).B.col(0)) + direct;
}

/// Computes the first time at which the response reaches the fraction `part` of its final value;
/// empty if it already exceeds it at 0.
std::optional<double> first_passage(const ContinuousLti& plant, const std::vector<double>& times,
                                    double gain, double part) {
  const auto beyond = [&](double t) { return step_at(plant, t) / gain - part; };
  std::size_t k = 0;
  double before = 0, here = 0;
  while (k < times.size() && (here = beyond(times[k])) < 0) {
    before = here;
    ++k;
  }
  if (k == 0 || k == times.size()) return std::nullopt;
  return internal::crossing(beyond, times[k - 1], times[k], before, here);
}

/// Lags in decreasing order and the delay, or the reason why there are none.
struct Lags {
  double gain = 0;
  std::vector<double> lags;
  double delay = 0;
  std::string culprit;
};

Lags lags_of(const ContinuousTransferFunction& plant) {
  Lags result;
  result.culprit = unsettled(plant);
  if (!result.culprit.empty()) return result;
  result.gain = plant.num[plant.num.size() - 1] / plant.den[plant.den.size() - 1];
  result.delay = plant.delay;
  const Eigen::VectorXcd poles = polynomial_roots(plant.den);
  for (Eigen::Index i = 0; i < poles.size(); ++i) {
    // Computed multiple poles are complex pairs; their imaginary parts are of the order of the n-th
    // root of the rounding error.
    if (std::abs(poles[i].imag()) > 1e-3 * std::abs(poles[i])) {
      result.culprit = fmt::format(
          "the half rule does not apply to poles at {}, which "
          "oscillate",
          written(poles[i]));
      return result;
    }
    result.lags.push_back(-1 / poles[i].real());
  }
  const Eigen::VectorXcd zeros = polynomial_roots(plant.num);
  for (Eigen::Index i = 0; i < zeros.size(); ++i) {
    if (zeros[i].imag() != 0 || !(zeros[i].real() > 0)) {
      result.culprit =
          fmt::format("the half rule does not apply to the zero at {}", written(zeros[i]));
      return result;
    }
    result.delay += 1 / zeros[i].real();
  }
  std::sort(result.lags.rbegin(), result.lags.rend());
  return result;
}

/// Keeps the `kept` largest lags: half of the next lag is added to the last of them, and the rest
/// to the delay.
void apply_half_rule(Lags& lags, std::size_t kept) {
  if (lags.lags.size() > kept) {
    lags.lags[kept - 1] += lags.lags[kept] / 2;
    lags.delay += lags.lags[kept] / 2;
    for (std::size_t i = kept + 1; i < lags.lags.size(); ++i) lags.delay += lags.lags[i];
  }
  lags.lags.resize(kept);
}

}  // namespace

LagFit<FopdtModel> fit_fopdt(const ContinuousTransferFunction& plant) {
  validate(plant, "fit_fopdt");
  LagFit<FopdtModel> fit;
  fit.culprit = unsettled(plant);
  if (!fit.fitted()) return fit;
  const Eigen::VectorXcd poles = polynomial_roots(plant.den);
  const double first = 1e-6 / poles.cwiseAbs().maxCoeff();
  const double last = 40 * static_cast<double>(poles.size()) / poles.real().cwiseAbs().minCoeff();
  std::vector<double> times;
  const int count = static_cast<int>(std::log(last / first) / std::log(1.02)) + 1;
  times.reserve(static_cast<std::size_t>(count));
  for (int k = 0; k < count; ++k) times.push_back(first * std::pow(1.02, k));

  const double gain = plant.num[plant.num.size() - 1] / plant.den[plant.den.size() - 1];
  const ContinuousLti model = realize(plant);
  const std::optional<double> t28 = first_passage(model, times, gain, 1 - std::exp(-1.0 / 3));
  const std::optional<double> t63 = first_passage(model, times, gain, 1 - std::exp(-1.0));
  if (!t28 || !t63) {
    fit.culprit =
        "the step response jumps past 28 % of its final value at t = 0: there is no lag to fit";
    return fit;
  }
  const double T = 1.5 * (*t63 - *t28);
  // A single lag has no delay of its own; the times are known to rounding only.
  const double own = *t63 - T;
  fit.model = {gain, T, plant.delay + (own > 1e-9 * T ? own : 0)};
  return fit;
}

LagFit<FopdtModel> half_rule_fopdt(const ContinuousTransferFunction& plant) {
  validate(plant, "half_rule_fopdt");
  Lags lags = lags_of(plant);
  if (!lags.culprit.empty()) return {{}, lags.culprit};
  apply_half_rule(lags, 1);
  return {{lags.gain, lags.lags[0], lags.delay}, ""};
}

LagFit<SopdtModel> half_rule_sopdt(const ContinuousTransferFunction& plant) {
  validate(plant, "half_rule_sopdt");
  Lags lags = lags_of(plant);
  if (!lags.culprit.empty()) return {{}, lags.culprit};
  if (lags.lags.size() < 2) return {{}, "the plant has one lag, but the model needs two"};
  apply_half_rule(lags, 2);
  return {{lags.gain, lags.lags[0], lags.lags[1], lags.delay}, ""};
}

}  // namespace quadtune
