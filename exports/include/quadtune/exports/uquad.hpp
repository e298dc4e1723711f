// SPDX-License-Identifier: Apache-2.0
/// The gain files of the uquad flight program: plain numbers, one file per matrix, with names and
/// shapes that depend on how the program was built.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "quadtune/exports/file_set.hpp"
#include "quadtune/gains.hpp"
#include "quadtune/model/vehicle.hpp"

namespace quadtune {

template <class T>
struct UquadFilterSettings;

/// Diagonals of the flight program's extended filter, in its axes and for its period of 0.01 s.
struct UquadDiagonals {
  /// (15) x y z psi phi theta vqx vqy vqz wqx wqy wqz and the accelerometer's three biases.
  Eigen::VectorXd Q;
  /// (16) psi phi theta, the accelerometer, the gyroscope and the height; then, with GPS, x y z and
  /// their velocities.
  Eigen::VectorXd R;
};

/// @param settings  for a period of 0.01 s
[[nodiscard]] UquadDiagonals uquad_diagonals(const UquadFilterSettings<double>& settings);

/// The files of one build of the flight program.
struct UquadFileSet {
  std::string proportional;            ///< file of K, e.g. "K_prop_full.txt"
  std::string integral;                ///< file of K_int; empty if the build has no integral
  std::vector<std::string> states;     ///< columns of K, in the file's order
  std::vector<std::string> integrals;  ///< columns of K_int, in the file's order
};

/// All builds: K.txt, K_prop.txt + K_int.txt, K_full.txt, K_prop_full.txt + K_int_full.txt,
/// K_prop_full_pptz.txt + K_int_full_pptz.txt.
[[nodiscard]] const std::vector<UquadFileSet>& uquad_file_sets();

/// Selects the build for a gain by the names of its states and integrals, in any order.
/// @throws InvalidInput  if the gain has another convention, inputs other than four rotor speeds,
///                       the other sign law, or states and integrals of no build; the message lists
///                       the builds
[[nodiscard]] const UquadFileSet& uquad_file_set(const Gains& gains);

/// Creates the gain files, lqr-Q.txt and lqr-R.txt if weights are given, and kalman-Q.txt and
/// kalman-R.txt if the filter's diagonals are given.
///
/// @param gains  in the convention uquad, with the states and integrals of a build
/// @param Q  (n × n), n = nx + ni, weights of states and integrals, in the gain's order; may be
///           empty
/// @param R  (4 × 4); may be empty
/// @param filter  diagonals of Q and R of the filter; empty: no such files
/// @throws InvalidInput  as uquad_file_set(), or if an entry is not finite
[[nodiscard]] std::vector<FileContent> uquad_files(
    const Gains& gains, const Eigen::MatrixXd& Q, const Eigen::MatrixXd& R,
    const std::optional<UquadDiagonals>& filter = {});

/// The name of the file with uquad_constants_text().
inline constexpr char kUquadConstantsName[] = "uquad_constants.h";

/// A C header with the vehicle's constants for the model of the flight program: mass, inertia, arm,
/// thrust and torque curves of a rotor, its speeds at hover and at the limits, and the period. The
/// names are quadtune's.
/// @param vehicle  with four equal rotors
/// @param dt       sample period [s]
/// @throws InvalidInput  if the vehicle does not have four equal rotors, or a number is unknown
[[nodiscard]] std::string uquad_constants_text(const Vehicle& vehicle, double dt);

/// Formats a matrix as the flight program scans it: "%24.16e", which reads back to the same double;
/// a decimal point in any locale; no header.
/// @throws InvalidInput  naming the first entry that is not finite
[[nodiscard]] std::string uquad_matrix_text(const Eigen::MatrixXd& M, const std::string& name);

/// Reads rows × cols numbers as fscanf("%lf") would, but rejects what fscanf would silently
/// misread: too few or too many numbers, rows of another length, nan, infinity, words and decimal
/// commas.
///
/// @param text    content of the file
/// @param rows    expected number of rows
/// @param cols    expected number of columns
/// @param origin  name of the file in messages
/// @throws InvalidInput  "origin:line: what is wrong, what was expected, why"
[[nodiscard]] Eigen::MatrixXd parse_uquad_matrix(const std::string& text, Eigen::Index rows,
                                                 Eigen::Index cols, const std::string& origin);

/// Reads the gains of one build from a directory, or from its proportional or integral file. The
/// files do not contain trim and sample time: x0 and u0 are zero, and dt is the program's 0.01 s.
///
/// @throws InvalidInput  if a file is malformed, or a directory has no build or several
/// @throws FileError     if a file of the build cannot be read
[[nodiscard]] Gains read_uquad_gains(const std::filesystem::path& path);

}  // namespace quadtune
