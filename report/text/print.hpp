// SPDX-License-Identifier: Apache-2.0
/// Formatting of results for a person.
#pragma once

#include <Eigen/Core>
#include <complex>
#include <string>
#include <vector>

#include "quadtune/lti.hpp"

namespace quadtune::report {

/// A matrix with a name for each row and column. Entries have six digits; entries that are zero up
/// to rounding (1e-13 of the largest in the row) are printed as 0.
[[nodiscard]] std::string table(const Eigen::MatrixXd& M, const std::vector<std::string>& rows,
                                const std::vector<std::string>& columns);

/// A matrix without names, indented.
[[nodiscard]] std::string plain(const Eigen::MatrixXd& M);

/// Poles, one per line, with natural frequency [rad/s], damping and time constant [s]; slowest
/// first.
/// @param dt  sample period [s] for poles of a discrete system; 0 for continuous ones.
[[nodiscard]] std::string pole_table(const Eigen::VectorXcd& poles, double dt);

/// The largest real part (dt = 0) or the largest modulus of the poles.
[[nodiscard]] double stability_measure(const Eigen::VectorXcd& poles, double dt);

/// "316.104", "1e-16": six significant digits.
[[nodiscard]] std::string number(double value);
/// "0.1 0.2 0.3"
[[nodiscard]] std::string numbers(const Eigen::VectorXd& values);

/// The names of signals, for the rows and columns of table().
[[nodiscard]] std::vector<std::string> names_of(const std::vector<Signal>& signals);

/// A gain in decibels, and an angle in degrees, as all results show them.
[[nodiscard]] double decibels(double gain);
[[nodiscard]] double degrees(double angle);

/// Lines of text, indented by 12 blanks. The first line follows the heading, or is below it if the
/// heading has 12 characters or more.
[[nodiscard]] std::string section(const std::string& heading, const std::string& text);

}  // namespace quadtune::report
