// SPDX-License-Identifier: Apache-2.0
#include "quadtune/simulation/campaign/uncertainty.hpp"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "quadtune/errors.hpp"
#include "quadtune/internal/enum_names.hpp"
#include "quadtune/internal/joined.hpp"
#include "quadtune/internal/suggest.hpp"
#include "quadtune/internal/tails.hpp"
#include "quadtune/internal/text_file.hpp"
#include "quadtune/matrix_checks.hpp"
#include "quadtune/simulation/random.hpp"
#include "simulation/campaign/uncertain_quantities.hpp"

namespace quadtune {
namespace {

using internal::quantity_effects;
using internal::QuantityEffect;

// Random streams, numbered after those of sensors and wind.
constexpr std::uint32_t kFirstStream = 0x10000;

std::size_t index_of(const std::string& name, const std::string& where) {
  const std::vector<QuantityEffect>& all = quantity_effects();
  const auto found = std::find_if(all.begin(), all.end(), [&](const QuantityEffect& effect) {
    return effect.quantity.name == name;
  });
  if (found != all.end()) return static_cast<std::size_t>(found - all.begin());
  std::vector<std::string> known;
  known.reserve(all.size());
  for (const QuantityEffect& effect : all) known.push_back(effect.quantity.name);
  std::string near = internal::did_you_mean(name, known);
  throw InvalidInput(
      where, fmt::format("no quantity '{}', expected one of those in docs/formats.md, e.g. mass, "
                         "thrust, wind_north or gyroscope_noise{}",
                         internal::printable(name), near));
}

/// The quantile of a standard normal distribution truncated to [low, high] that corresponds to the
/// standard normal number z, computed in the lower tail for accuracy.
double within(double low, double high, double z) {
  const bool upper = low > 0;
  const double a = upper ? -high : low, b = upper ? -low : high;
  const double from = internal::normal_below(a), to = internal::normal_below(b);
  const double share = internal::normal_below(upper ? -z : z);
  const double q = from + share * (to - from);
  const double x = q <= 0 ? a : q >= 1 ? b : internal::normal_quantile(q);
  return std::clamp(upper ? -x : x, low, high);
}

/// Truncation limits of the standard normal number of a normal or log-normal distribution.
struct Cut {
  double low;
  double high;
};
Cut cut_of(const Distribution& d) {
  const bool logarithmic = d.kind == DistributionKind::log_normal;
  const auto standard = [&](double x) {
    if (logarithmic)
      return x <= 0 ? -std::numeric_limits<double>::infinity() : std::log(x / d.first) / d.second;
    return (x - d.first) / d.second;
  };
  return {standard(d.min), standard(d.max)};
}

void check(const Distribution& d, const UncertainQuantity& quantity, const std::string& where) {
  const auto refuse = [&](const std::string& what) {
    throw InvalidInput(where, fmt::format("{}: {}", quantity.name, what));
  };
  const auto number = [&](double x, const char* name) {
    if (!std::isfinite(x)) refuse(fmt::format("{} is {}, expected a finite number", name, x));
  };
  double low = d.min, high = d.max;
  switch (d.kind) {
    case DistributionKind::normal:
      number(d.first, "mean");
      number(d.second, "deviation");
      if (d.second < 0) refuse(fmt::format("deviation is {}, expected 0 or more", d.second));
      break;
    case DistributionKind::uniform:
      number(d.first, "low");
      number(d.second, "high");
      if (d.first > d.second)
        refuse(
            fmt::format("low is {} and high is {}, expected low at most high", d.first, d.second));
      low = d.first;
      high = d.second;
      break;
    case DistributionKind::log_normal:
      number(d.first, "median");
      number(d.second, "deviation");
      if (d.first <= 0) refuse(fmt::format("median is {}, expected more than 0", d.first));
      if (d.second < 0) refuse(fmt::format("deviation is {}, expected 0 or more", d.second));
      break;
  }
  if (d.kind != DistributionKind::uniform) {
    if (std::isnan(low) || std::isnan(high) || !(low < high))
      refuse(fmt::format("least is {} and most is {}, expected least below most", low, high));
    if (d.second == 0 && (d.first < low || d.first > high))
      refuse(fmt::format("{} is outside least and most", d.first));
    const Cut cut = cut_of(d);
    if (d.second > 0 && (cut.low > 8 || cut.high < -8))
      refuse(
          fmt::format("least is {:.4g} and most is {:.4g}, but the distribution extends from "
                      "{:.4g} to {:.4g} (8 deviations), expected an overlap{}",
                      low, high, value_at({d.kind, d.first, d.second}, -8),
                      value_at({d.kind, d.first, d.second}, 8),
                      quantity.kind == QuantityKind::ratio
                          ? "; the quantity is a ratio to the value of the vehicle file"
                          : ""));
    // Without limits, the extremes are taken at 8 standard deviations, a probability of about
    // 10⁻¹⁵.
    if (d.second == 0) {
      low = high = d.first;
    } else {
      low = std::max(low, value_at({d.kind, d.first, d.second}, -8));
      high = std::min(high, value_at({d.kind, d.first, d.second}, 8));
    }
  }
  if (low < quantity.min || high > quantity.max)
    refuse(fmt::format(
        "the draws extend from {:.6g} to {:.6g}{}, expected within {:.6g} to {:.6g}; the "
        "keys least and most limit a distribution",
        low, high, quantity.unit == "1" ? "" : " " + quantity.unit, quantity.min, quantity.max));
}

void check_correlation(const Uncertainty& uncertainty, const std::string& where) {
  const Eigen::MatrixXd& C = uncertainty.correlation;
  const auto n = static_cast<Eigen::Index>(uncertainty.numbers.size());
  if (C.size() == 0) return;
  require_shape(C, n, n, where, "correlation", fmt::format("{} quantities", n));
  require_finite(C, where, "correlation");
  require_symmetric(C, where, "correlation");
  if (!C.diagonal().isOnes(1e-12)) throw InvalidInput(where, "correlation: the diagonal must be 1");
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(C);
  if (!(eigen.eigenvalues()(0) > 1e-10)) {
    // Name the quantities whose correlations contradict each other.
    const Eigen::VectorXd v = eigen.eigenvectors().col(0).cwiseAbs();
    std::vector<std::string> culprits;
    for (Eigen::Index i = 0; i < n; ++i)
      if (v(i) > 0.3 * v.maxCoeff())
        culprits.push_back(uncertainty.numbers[static_cast<std::size_t>(i)].quantity);
    throw InvalidInput(where,
                       fmt::format("the correlations of {} have the eigenvalue {:.3g}, "
                                   "expected a positive definite matrix",
                                   internal::joined(culprits, ", "), eigen.eigenvalues()(0)));
  }
}

}  // namespace

const std::vector<UncertainQuantity>& uncertain_quantities() {
  static const std::vector<UncertainQuantity> all = [] {
    std::vector<UncertainQuantity> quantities;
    for (const QuantityEffect& effect : quantity_effects()) quantities.push_back(effect.quantity);
    return quantities;
  }();
  return all;
}

const UncertainQuantity& uncertain_quantity(const std::string& name, const std::string& where) {
  return quantity_effects()[index_of(name, where)].quantity;
}

constexpr internal::EnumName<DistributionKind> kDistributionKinds[] = {
    {DistributionKind::normal, "normal"},
    {DistributionKind::uniform, "uniform"},
    {DistributionKind::log_normal, "log_normal"}};

std::string to_string(DistributionKind kind) { return internal::name_in(kDistributionKinds, kind); }

double value_at(const Distribution& d, double z) {
  if (d.kind == DistributionKind::uniform)
    return std::min(d.second, d.first + internal::normal_below(z) * (d.second - d.first));
  if (d.second == 0) return d.first;
  if (std::isfinite(d.min) || std::isfinite(d.max)) {
    const Cut cut = cut_of(d);
    z = within(cut.low, cut.high, z);
  }
  const double value = d.kind == DistributionKind::normal ? d.first + d.second * z
                                                          : d.first * std::exp(d.second * z);
  return std::clamp(value, d.min, d.max);
}

void validate(const Uncertainty& uncertainty, const std::string& where) {
  for (std::size_t i = 0; i < uncertainty.numbers.size(); ++i) {
    const UncertainNumber& number = uncertainty.numbers[i];
    check(number.distribution, uncertain_quantity(number.quantity, where), where);
    for (std::size_t j = 0; j < i; ++j)
      if (uncertainty.numbers[j].quantity == number.quantity)
        throw InvalidInput(
            where, fmt::format("{} is given twice, expected each quantity once", number.quantity));
  }
  check_correlation(uncertainty, where);
}

Eigen::VectorXd draw(const Uncertainty& uncertainty, std::uint64_t seed, std::uint32_t flight) {
  const auto n = static_cast<Eigen::Index>(uncertainty.numbers.size());
  const RandomSource<1> source{seed, {flight}};
  Eigen::VectorXd z(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const std::size_t of =
        index_of(uncertainty.numbers[static_cast<std::size_t>(i)].quantity, "draw");
    z(i) = lane(random_normal(source, kFirstStream + static_cast<std::uint32_t>(of), 0).first, 0);
  }
  if (uncertainty.correlation.size() > 0) z = (uncertainty.correlation.llt().matrixL() * z).eval();
  Eigen::VectorXd drawn(n);
  for (Eigen::Index i = 0; i < n; ++i)
    drawn(i) = value_at(uncertainty.numbers[static_cast<std::size_t>(i)].distribution, z(i));
  return drawn;
}

void apply(const Uncertainty& uncertainty, const Eigen::Ref<const Eigen::VectorXd>& drawn,
           FlightSetup& setup) {
  if (!setup.flown) setup.flown = setup.vehicle;
  internal::UncertainParts parts{*setup.flown, setup.environment};
  for (std::size_t i = 0; i < uncertainty.numbers.size(); ++i) {
    const std::string& name = uncertainty.numbers[i].quantity;
    const QuantityEffect& effect = quantity_effects()[index_of(name, "apply")];
    if (effect.of_sensor && !setup.real_sensors)
      throw InvalidInput(name,
                         "the flight has ideal sensors, expected sensors = \"real\" for a "
                         "quantity of a sensor");
    if (effect.change(parts, drawn(static_cast<Eigen::Index>(i)))) continue;
    if (effect.of_air)
      throw InvalidInput(name,
                         fmt::format("the vehicle '{}' has no drag, so that wind has no effect "
                                     "on it; expected drag of the body or of the rotors",
                                     setup.vehicle.name));
    throw InvalidInput(name, fmt::format("the file of the vehicle '{}' has nothing that this "
                                         "quantity ({}) changes",
                                         setup.vehicle.name, effect.quantity.meaning));
  }
}

}  // namespace quadtune
