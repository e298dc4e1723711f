// SPDX-License-Identifier: Apache-2.0
#include "quadtune/internal/uncertainty_reader.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "quadtune/errors.hpp"
#include "quadtune/estimation/filter_file.hpp"
#include "quadtune/internal/counted.hpp"
#include "quadtune/internal/joined.hpp"
#include "quadtune/internal/suggest.hpp"
#include "quadtune/internal/text_file.hpp"

namespace quadtune::internal {
namespace {

/// The unit of a variance of a quantity with this unit, as filter models write it: "m/s^2" gives
/// "m2/s4".
std::string unit_of_variance(const std::string& unit) {
  static const std::map<std::string, std::string> units = {
      {"m", "m2"}, {"Pa", "Pa2"}, {"uT", "uT2"}, {"rad/s", "rad2/s2"}, {"m/s^2", "m2/s4"}};
  const auto found = units.find(unit);
  return found == units.end() ? "" : found->second;
}

/// "m^2" and "m2" are the same unit.
std::string without_carets(std::string unit) {
  std::erase(unit, '^');
  return unit;
}

/// Distribution of a sensor's standard deviation from a variance that was fitted to logs.
Distribution read_fitted(const TomlTable& table, const UncertainQuantity& quantity,
                         const std::filesystem::path& folder) {
  table.allow({{"file"}, {"parameter"}});
  if (!quantity.name.ends_with("_deviation"))
    throw InvalidInput(table.where(),
                       fmt::format("fitted is for a sensor's standard deviation, e.g. "
                                   "sonar_deviation, not for {}",
                                   quantity.name));
  const FilterModel model = load_filter_model((folder / table.text("file")).string());
  const int index = parameter_index(model, table.text("parameter"), table.where("parameter"));
  const NoiseParameter& parameter = model.parameters[static_cast<std::size_t>(index)];
  if (!parameter.logarithmic || !parameter.interval)
    throw InvalidInput(table.where("parameter"),
                       fmt::format("{} of the model '{}' has no interval, expected a variance that "
                                   "`quadtune tune kalman -o` estimated",
                                   parameter.name, model.name));
  const std::string variance = unit_of_variance(quantity.unit);
  if (!parameter.unit.empty() && !variance.empty() && without_carets(parameter.unit) != variance)
    throw InvalidInput(
        table.where("parameter"),
        fmt::format("{} of the model '{}' is in {}, expected a variance in {} for {}",
                    parameter.name, model.name, parameter.unit, variance, quantity.name));
  // The 95 % interval refers to the logarithm of the variance; that of the standard deviation is
  // half as wide.
  constexpr double kQuantile = 1.959963984540054;
  const auto& [low, high] = *parameter.interval;
  return {DistributionKind::log_normal, std::sqrt(parameter.start),
          0.5 * std::log(high / low) / (2 * kQuantile)};
}

/// Rejects a distribution of a ratio whose centre is far from 1, such as a mass in kg. Lags and
/// noise may be far from the vehicle file's.
void require_ratio(const TomlTable& table, const UncertainQuantity& quantity, double centre) {
  constexpr double kMin = 0.2, kMax = 5;
  if (quantity.kind != QuantityKind::ratio || quantity.name.ends_with("_noise") ||
      quantity.name.ends_with("_lag") || !(centre > 0) || (centre >= kMin && centre <= kMax))
    return;
  throw InvalidInput(
      table.where(),
      fmt::format("{} has the centre {:.6g}, expected {} to {}, because {} is a ratio to the value "
                  "of the vehicle file",
                  table.title(), centre, kMin, kMax, quantity.name));
}

Distribution read_distribution(const TomlTable& vary, const UncertainQuantity& quantity,
                               const std::filesystem::path& folder) {
  const std::vector<std::string> kinds = {"normal", "uniform", "log_normal", "fitted"};
  std::vector<std::string> present;
  for (const std::string& kind : kinds)
    if (vary.has(kind)) present.push_back(kind);
  if (present.size() != 1)
    throw InvalidInput(
        vary.where(),
        fmt::format("{} has {}, expected one of {}", vary.title(),
                    present.empty() ? "no distribution"
                                    : fmt::format("{}", internal::joined(present, " and ")),
                    internal::joined(kinds, ", ")));
  const TomlTable table = vary.table(present[0]);
  if (present[0] == "fitted") return read_fitted(table, quantity, folder);
  const double nominal = quantity.kind == QuantityKind::ratio ? 1 : 0;
  Distribution result;
  if (present[0] == "uniform") {
    table.allow({{"low"}, {"high"}});
    result.kind = DistributionKind::uniform;
    result.first = table.number("low");
    result.second = table.number("high");
    require_ratio(table, quantity, 0.5 * (result.first + result.second));
    return result;
  }
  const bool logarithmic = present[0] == "log_normal";
  const std::string centre = logarithmic ? "median" : "mean";
  table.allow({{centre}, {"deviation"}, {"least"}, {"most"}});
  result.kind = logarithmic ? DistributionKind::log_normal : DistributionKind::normal;
  // A value that replaces another one has no default centre.
  result.first = quantity.kind == QuantityKind::value ? table.number(centre)
                                                      : table.number_or(centre, nominal);
  require_ratio(table, quantity, result.first);
  result.second = table.number("deviation");
  result.min = table.number_or("least", result.min);
  result.max = table.number_or("most", result.max);
  return result;
}

std::size_t position_of(const Uncertainty& uncertainty, const std::string& name,
                        const std::string& where) {
  std::vector<std::string> known;
  for (const UncertainNumber& number : uncertainty.numbers) {
    if (number.quantity == name) return known.size();
    known.push_back(number.quantity);
  }
  throw InvalidInput(
      where,
      fmt::format("'{}' is not an uncertain quantity of this file, expected {}{}", printable(name),
                  known.empty() ? "a [[vary]] for it"
                                : fmt::format("some of {}", internal::joined(known, ", ")),
                  did_you_mean(name, known)));
}

void read_correlation(const TomlTable& table, Uncertainty& uncertainty) {
  table.allow({{"quantities"}, {"value"}});
  const std::vector<std::string> names = table.texts("quantities");
  if (names.size() < 2)
    throw InvalidInput(table.where("quantities"),
                       fmt::format("quantities has {}, expected 2 or more",
                                   internal::counted(names.size(), "entry", "entries")));
  const double value = table.number("value", {-1, Range::Bound::open, 1, Range::Bound::open});
  for (std::size_t i = 0; i < names.size(); ++i)
    for (std::size_t j = 0; j < i; ++j) {
      const auto a = static_cast<Eigen::Index>(
          position_of(uncertainty, names[i], table.where("quantities", i)));
      const auto b = static_cast<Eigen::Index>(
          position_of(uncertainty, names[j], table.where("quantities", j)));
      if (a == b)
        throw InvalidInput(table.where("quantities", i),
                           fmt::format("{} is given twice, expected each quantity once", names[i]));
      if (uncertainty.correlation(a, b) != 0)
        throw InvalidInput(
            table.where("quantities", i),
            fmt::format("the correlation of {} and {} is given twice, expected each pair once",
                        names[j], names[i]));
      uncertainty.correlation(a, b) = uncertainty.correlation(b, a) = value;
    }
}

}  // namespace

Uncertainty read_uncertainty(const TomlTable& file, const std::filesystem::path& folder) {
  Uncertainty uncertainty;
  for (const TomlTable& vary : file.tables("vary")) {
    vary.allow({{"quantity"}, {"normal"}, {"uniform"}, {"log_normal"}, {"fitted"}});
    const UncertainQuantity& quantity =
        uncertain_quantity(vary.text("quantity"), vary.where("quantity"));
    uncertainty.numbers.push_back({quantity.name, read_distribution(vary, quantity, folder)});
    validate(uncertainty, vary.where());
  }
  const std::vector<TomlTable> correlations = file.tables("correlation");
  if (correlations.empty()) return uncertainty;
  const auto n = static_cast<Eigen::Index>(uncertainty.numbers.size());
  uncertainty.correlation = Eigen::MatrixXd::Identity(n, n);
  for (const TomlTable& table : correlations) read_correlation(table, uncertainty);
  validate(uncertainty, correlations.front().where());
  return uncertainty;
}

}  // namespace quadtune::internal
