// SPDX-License-Identifier: Apache-2.0
/// A gain schedule as a C program: its files, and the results that the library's templates give.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <vector>

#include "quadtune/exports/content.hpp"
#include "quadtune/gain_schedule.hpp"
#include "quadtune/internal/grid_cell.hpp"

namespace quadtune::exports {

/// The file of the points that `replay` evaluates, and the suffix of the file with the numbers.
inline constexpr char kRecordedPoints[] = "points.txt";
inline constexpr char kTableEnd[] = "_table.c";

/// qt_status_t of source/schedule/program.h.
enum class ScheduleStatus { found, nearest, no_gain, not_finite };

/// A schedule in the precision T of a program. Its results equal those of the exported C, bit by
/// bit.
template <class T>
class ScheduleProgram {
 public:
  using Matrix = Eigen::Matrix<T, Eigen::Dynamic, Eigen::Dynamic>;
  using Vector = Eigen::Matrix<T, Eigen::Dynamic, 1>;

  explicit ScheduleProgram(const GainSchedule& schedule)
      : status_(schedule.status),
        sign_law_(schedule.sign_law),
        table_K_(schedule.K.cast<T>()),
        table_K_int_(schedule.K_int.cast<T>()),
        table_x0_(schedule.x0.cast<T>()),
        table_u0_(schedule.u0.cast<T>()) {
    for (const ScheduleAxis& axis : schedule.axes) {
      axes_.emplace_back();
      for (const double value : axis.values) axes_.back().push_back(static_cast<T>(value));
    }
    const auto nu = static_cast<Eigen::Index>(schedule.inputs.size());
    K.setZero(nu, static_cast<Eigen::Index>(schedule.states.size()));
    K_int.setZero(nu, static_cast<Eigen::Index>(schedule.integrals.size()));
    x0.setZero(K.cols());
    u0.setZero(nu);
  }

  // Results of the last lookup; initially 0.
  Matrix K, K_int;
  Vector x0, u0;

  /// Interpolates K, K_int, x0 and u0. Beyond the grid, its nearest edge is used. If there is no
  /// gain, the results of the previous lookup are kept.
  /// @param values  one per axis, in the order of the axes
  ScheduleStatus look_up(const Vector& values) {
    bool within = true;
    std::vector<internal::GridPlace<T>> places;
    for (std::size_t a = 0; a < axes_.size(); ++a) {
      const T value = values(static_cast<Eigen::Index>(a));
      if (!std::isfinite(value)) return ScheduleStatus::not_finite;
      const T nearest = std::clamp(value, axes_[a].front(), axes_[a].back());
      within = within && nearest == value;
      places.push_back(internal::place_on_axis(axes_[a], nearest));
    }
    std::vector<internal::GridCorner<T>> corners;
    for (unsigned c = 0; c < 1u << axes_.size(); ++c) {
      corners.push_back(internal::corner_of_cell(places, c));
      if (corners.back().weight == 0)
        corners.pop_back();
      else if (status_[static_cast<std::size_t>(corners.back().point)] != PointStatus::solved)
        return ScheduleStatus::no_gain;
    }
    const auto sum = [&](const Matrix& table) {
      Vector total = Vector::Zero(table.rows());
      for (const internal::GridCorner<T>& corner : corners)
        total += corner.weight * table.col(corner.point);
      return total;
    };
    K = sum(table_K_).reshaped(K.rows(), K.cols());
    K_int = sum(table_K_int_).reshaped(K_int.rows(), K_int.cols());
    x0 = sum(table_x0_);
    u0 = sum(table_u0_);
    return within ? ScheduleStatus::found : ScheduleStatus::nearest;
  }

  /// u = u0 + K (sp - x) + K_int x_int, or with x - sp, according to the sign law.
  [[nodiscard]] Vector inputs(const Vector& sp, const Vector& x, const Vector& x_int) const {
    Vector u = u0;
    for (Eigen::Index i = 0; i < u.size(); ++i) {
      for (Eigen::Index j = 0; j < x.size(); ++j)
        u(i) +=
            K(i, j) * (sign_law_ == SignLaw::set_point_minus_state ? sp(j) - x(j) : x(j) - sp(j));
      for (Eigen::Index j = 0; j < x_int.size(); ++j) u(i) += K_int(i, j) * x_int(j);
    }
    return u;
  }

 private:
  std::vector<std::vector<T>> axes_;
  std::vector<PointStatus> status_;
  SignLaw sign_law_;
  Matrix table_K_, table_K_int_, table_x0_, table_u0_;  ///< one column per point
};

/// The name of a content's program: the requested one, or the vehicle's with "_schedule".
/// @throws InvalidInput  if the name is not an identifier
[[nodiscard]] std::string schedule_program_name(const ExportContent& content);

/// As flight_code_files(), for content with a schedule.
[[nodiscard]] std::vector<FileContent> schedule_program_files(const ExportContent& content);

/// The expected output of the program `replay` of such an export: points of the grid, points within
/// and beyond it, and numbers that are not finite.
/// @param count  number of random points
[[nodiscard]] std::string recorded_points(const GainSchedule& schedule, bool double_precision,
                                          int count);

}  // namespace quadtune::exports
