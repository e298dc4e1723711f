// SPDX-License-Identifier: Apache-2.0
/// How results look to a person.
#pragma once

#include <Eigen/Core>
#include <complex>
#include <string>
#include <vector>

#include "quadtune/lti.hpp"

namespace quadtune::report {

/// A matrix with a name per row and column, entries to six digits, entries that are zero up to
/// rounding (1e-13 of the largest in the row) as 0.
[[nodiscard]] std::string table(const Eigen::MatrixXd& M, const std::vector<std::string>& rows,
                                const std::vector<std::string>& columns);

/// A matrix without names, indented.
[[nodiscard]] std::string plain(const Eigen::MatrixXd& M);

/// Poles one a line with natural frequency [rad/s], damping and time constant [s]; slowest first.
/// @param dt  sample period [s] for poles of a discrete system; 0 for continuous ones.
[[nodiscard]] std::string pole_table(const Eigen::VectorXcd& poles, double dt);

/// Greatest real part (dt = 0) or modulus of the poles.
[[nodiscard]] double stability_measure(const Eigen::VectorXcd& poles, double dt);

/// "316.104", "1e-16": six significant digits.
[[nodiscard]] std::string number(double value);
/// "0.1 0.2 0.3"
[[nodiscard]] std::string numbers(const Eigen::VectorXd& values);

/// The names of signals, for the rows and columns of table().
[[nodiscard]] std::vector<std::string> names_of(const std::vector<Signal>& signals);

/// A gain as decibels, and an angle in radians as degrees: how every result shows them.
[[nodiscard]] double decibels(double gain);
[[nodiscard]] double degrees(double angle);

/// Text lines, indented by 12 blanks. The first stands beside the heading, or under it if the
/// heading is longer than that.
[[nodiscard]] std::string section(const std::string& heading, const std::string& text);

}  // namespace quadtune::report
