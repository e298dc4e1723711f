// SPDX-License-Identifier: Apache-2.0
#include "quadtune/gain_schedule.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "quadtune/errors.hpp"
#include "quadtune/internal/counted.hpp"
#include "quadtune/internal/enum_names.hpp"
#include "quadtune/internal/grid_cell.hpp"
#include "quadtune/internal/joined.hpp"
#include "quadtune/internal/suggest.hpp"

namespace quadtune {
namespace {

/// A smaller distance to a grid, relative to its span, or to a single value, relative to it, is
/// rounding.
constexpr double kRounding = 1e-9;

void check_range(ScheduleQuantity quantity, double value, const std::string& where) {
  const std::string name = to_string(quantity);
  if (!std::isfinite(value))
    throw InvalidInput(where, fmt::format("{} has {}, expected finite numbers", name, value));
  if (quantity == ScheduleQuantity::speed && value < 0)
    throw InvalidInput(where, fmt::format("{} has {} m/s, expected 0 or more because the speed is "
                                          "along the heading",
                                          name, value));
  const bool ratio = quantity == ScheduleQuantity::mass || quantity == ScheduleQuantity::density;
  if (ratio && !(value > 0))
    throw InvalidInput(where,
                       fmt::format("{} has {}, expected more than 0 because it is a ratio to "
                                   "the vehicle's value",
                                   name, value));
}

void check_axis(const ScheduleAxis& axis, const std::string& where) {
  const std::string name = to_string(axis.quantity);
  if (axis.values.empty())
    throw InvalidInput(where, fmt::format("{} has no values, expected at least one", name));
  for (const double value : axis.values) check_range(axis.quantity, value, where);
  const auto fall = std::adjacent_find(axis.values.begin(), axis.values.end(),
                                       [](double a, double b) { return !(a < b); });
  if (fall != axis.values.end())
    throw InvalidInput(where, fmt::format("{} has {} after {}, expected ascending values", name,
                                          *std::next(fall), *fall));
}

/// Empty if the value is outside the axis.
std::optional<internal::GridPlace<double>> place_on(const std::vector<double>& grid, double value) {
  const double first = grid.front();
  const double last = grid.back();
  const double slack =
      kRounding * (grid.size() > 1 ? last - first : std::max(1.0, std::abs(first)));
  if (!(value >= first - slack && value <= last + slack)) return {};
  return internal::place_on_axis(grid, std::clamp(value, first, last));
}

template <class M>
auto as_matrix(const M& columns, Eigen::Index point, Eigen::Index rows) {
  return Eigen::Map<const Eigen::MatrixXd>(columns.col(point).data(), rows, columns.rows() / rows);
}

}  // namespace

constexpr internal::EnumName<ScheduleQuantity> kScheduleQuantities[] = {
    {ScheduleQuantity::speed, "speed"},
    {ScheduleQuantity::climb, "climb"},
    {ScheduleQuantity::yaw_rate, "yaw_rate"},
    {ScheduleQuantity::mass, "mass"},
    {ScheduleQuantity::density, "density"}};

std::string to_string(ScheduleQuantity quantity) {
  return internal::name_in(kScheduleQuantities, quantity);
}

ScheduleQuantity schedule_quantity(const std::string& name, const std::string& where) {
  if (const auto quantity = internal::value_in(kScheduleQuantities, name)) return *quantity;
  const std::vector<std::string> known = internal::names_in(kScheduleQuantities);
  throw InvalidInput(
      where, fmt::format("no axis '{}', expected one of {}{}", name, internal::joined(known, ", "),
                         internal::did_you_mean(name, known)));
}

std::string unit(ScheduleQuantity quantity) {
  switch (quantity) {
    case ScheduleQuantity::speed:
    case ScheduleQuantity::climb:
      return "m/s";
    case ScheduleQuantity::yaw_rate:
      return "rad/s";
    case ScheduleQuantity::mass:
    case ScheduleQuantity::density:
      return "";
  }
  return "";
}

constexpr internal::EnumName<PointStatus> kPointStatuses[] = {{PointStatus::solved, "solved"},
                                                              {PointStatus::no_trim, "no trim"},
                                                              {PointStatus::no_gain, "no gain"}};

std::string to_string(PointStatus status) { return internal::name_in(kPointStatuses, status); }

PointStatus point_status(const std::string& name, const std::string& where) {
  if (const auto status = internal::value_in(kPointStatuses, name)) return *status;
  throw InvalidInput(where, "'" + name + "', expected solved, no trim or no gain");
}

Eigen::Index checked_grid_size(const std::vector<ScheduleAxis>& axes, const std::string& where) {
  if (axes.empty()) throw InvalidInput(where, "the grid has no axis, expected at least one");
  Eigen::Index size = 1;
  for (std::size_t a = 0; a < axes.size(); ++a) {
    check_axis(axes[a], where);
    for (std::size_t b = 0; b < a; ++b)
      if (axes[b].quantity == axes[a].quantity)
        throw InvalidInput(where, fmt::format("axis {} is given twice, expected each once",
                                              to_string(axes[a].quantity)));
    const auto length = static_cast<Eigen::Index>(axes[a].values.size());
    // Both factors are at most the limit when they are multiplied, so the product does not
    // overflow.
    if (length > kMaxSchedulePoints || size * length > kMaxSchedulePoints)
      throw InvalidInput(where, fmt::format("the grid has more than {} points with axis {}; "
                                            "is a step too small?",
                                            kMaxSchedulePoints, to_string(axes[a].quantity)));
    size *= length;
  }
  return size;
}

Eigen::VectorXd grid_point(const std::vector<ScheduleAxis>& axes, Eigen::Index index) {
  Eigen::VectorXd values(static_cast<Eigen::Index>(axes.size()));
  for (Eigen::Index a = values.size(); a-- > 0;) {
    const std::vector<double>& axis = axes[static_cast<std::size_t>(a)].values;
    const auto length = static_cast<Eigen::Index>(axis.size());
    values(a) = axis[static_cast<std::size_t>(index % length)];
    index /= length;
  }
  return values;
}

std::string grid_words(const std::vector<ScheduleAxis>& axes, const Eigen::VectorXd& values) {
  std::string words;
  for (std::size_t a = 0; a < axes.size(); ++a)
    words += fmt::format("{}{} {:.6g}", a == 0 ? "" : ", ", to_string(axes[a].quantity),
                         values(static_cast<Eigen::Index>(a)));
  return words;
}

Eigen::Index GainSchedule::solved_count() const {
  return std::count(status.begin(), status.end(), PointStatus::solved);
}

Gains GainSchedule::gains(Eigen::Index point) const {
  const auto nu = static_cast<Eigen::Index>(inputs.size());
  return {as_matrix(K, point, nu),
          as_matrix(K_int, point, nu),
          states,
          inputs,
          integrals,
          x0.col(point),
          u0.col(point),
          vehicle,
          convention,
          input_kind,
          sign_law,
          dt};
}

ScheduledGain GainSchedule::at(const Eigen::Ref<const Eigen::VectorXd>& values) const {
  if (values.size() != static_cast<Eigen::Index>(axes.size()))
    throw InvalidInput("schedule",
                       fmt::format("got {}, expected {}, one for each axis",
                                   internal::counted(values.size(), "value"), axes.size()));
  ScheduledGain result;
  std::vector<internal::GridPlace<double>> places;
  places.reserve(axes.size());
  for (std::size_t a = 0; a < axes.size(); ++a) {
    const double value = values(static_cast<Eigen::Index>(a));
    if (const auto place = place_on(axes[a].values, value)) {
      places.push_back(*place);
      continue;
    }
    result.culprit = fmt::format("{} is {:.6g}, outside the grid's range from {:.6g} to {:.6g}",
                                 to_string(axes[a].quantity), value, axes[a].values.front(),
                                 axes[a].values.back());
    return result;
  }
  Eigen::VectorXd K_sum = Eigen::VectorXd::Zero(K.rows());
  Eigen::VectorXd K_int_sum = Eigen::VectorXd::Zero(K_int.rows());
  Eigen::VectorXd x0_sum = Eigen::VectorXd::Zero(x0.rows());
  Eigen::VectorXd u0_sum = Eigen::VectorXd::Zero(u0.rows());
  for (unsigned c = 0; c < 1u << axes.size(); ++c) {
    const auto corner = internal::corner_of_cell(places, c);
    if (corner.weight == 0) continue;
    if (!solved(corner.point)) {
      result.status = LookupStatus::infeasible;
      result.culprit =
          fmt::format("{} at {}: {}", to_string(status[static_cast<std::size_t>(corner.point)]),
                      grid_words(axes, grid_point(axes, corner.point)),
                      culprit[static_cast<std::size_t>(corner.point)]);
      return result;
    }
    K_sum += corner.weight * K.col(corner.point);
    K_int_sum += corner.weight * K_int.col(corner.point);
    x0_sum += corner.weight * x0.col(corner.point);
    u0_sum += corner.weight * u0.col(corner.point);
  }
  const auto nu = static_cast<Eigen::Index>(inputs.size());
  result.status = LookupStatus::found;
  result.K = as_matrix(K_sum, 0, nu);
  result.K_int = as_matrix(K_int_sum, 0, nu);
  result.x0 = x0_sum;
  result.u0 = u0_sum;
  return result;
}

GainSchedule empty_schedule(std::vector<ScheduleAxis> axes, std::vector<Signal> states,
                            std::vector<Signal> inputs, std::vector<Signal> integrals) {
  const Eigen::Index size = checked_grid_size(axes, "schedule");
  const auto nx = static_cast<Eigen::Index>(states.size());
  const auto nu = static_cast<Eigen::Index>(inputs.size());
  const auto ni = static_cast<Eigen::Index>(integrals.size());
  const double nan = std::numeric_limits<double>::quiet_NaN();
  GainSchedule schedule;
  schedule.axes = std::move(axes);
  schedule.states = std::move(states);
  schedule.inputs = std::move(inputs);
  schedule.integrals = std::move(integrals);
  schedule.status.resize(static_cast<std::size_t>(size), PointStatus::no_trim);
  schedule.culprit.resize(static_cast<std::size_t>(size));
  schedule.K.setConstant(nu * nx, size, nan);
  schedule.K_int.setConstant(nu * ni, size, nan);
  schedule.x0.setConstant(nx, size, nan);
  schedule.u0.setConstant(nu, size, nan);
  schedule.residual.setConstant(size, nan);
  return schedule;
}

}  // namespace quadtune
