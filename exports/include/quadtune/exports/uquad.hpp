// SPDX-License-Identifier: Apache-2.0
/// The gain files of the uquad flight program: plain numbers, one file per matrix, the names and
/// shapes fixed by how the program was built.
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

/// Diagonals of the flight program's extended filter, for its period of 0.01 s and in its axes.
struct UquadDiagonals {
  /// (15) of x y z psi phi theta vqx vqy vqz wqx wqy wqz and the accelerometer's three offsets.
  Eigen::VectorXd Q;
  /// (16) of psi phi theta, the accelerometer, the gyroscope and the height, then with GPS of x y z
  /// and their velocities.
  Eigen::VectorXd R;
};

/// @param settings  of a period of 0.01 s
[[nodiscard]] UquadDiagonals uquad_diagonals(const UquadFilterSettings<double>& settings);

/// The files of one build of the flight program.
struct UquadFileSet {
  std::string proportional;            ///< file of K, e.g. "K_prop_full.txt"
  std::string integral;                ///< file of K_int; empty when the build has no integral
  std::vector<std::string> states;     ///< columns of K, in the file's order
  std::vector<std::string> integrals;  ///< columns of K_int, in the file's order
};

/// Every build: K.txt, K_prop.txt + K_int.txt, K_full.txt, K_prop_full.txt + K_int_full.txt,
/// K_prop_full_pptz.txt + K_int_full_pptz.txt.
[[nodiscard]] const std::vector<UquadFileSet>& uquad_file_sets();

/// The build that a gain is for, by the names of its states and integrals in any order.
/// @throws InvalidInput  for a gain in another convention, with inputs other than four rotor
/// speeds,
///                       with the other sign law, or with states and integrals of no build; the
///                       message lists the builds.
[[nodiscard]] const UquadFileSet& uquad_file_set(const Gains& gains);

/// The gain files, lqr-Q.txt and lqr-R.txt where the weights are given, and kalman-Q.txt and
/// kalman-R.txt where the filter's diagonals are.
///
/// @param Q  (nx + ni square) weights of states and integrals, in the gain's order; may be empty
/// @param R  (4 × 4); may be empty
/// @throws InvalidInput  as uquad_file_set, and for entries that are not finite.
[[nodiscard]] std::vector<FileContent> uquad_files(
    const Gains& gains, const Eigen::MatrixXd& Q, const Eigen::MatrixXd& R,
    const std::optional<UquadDiagonals>& filter = {});

/// The file of uquad_constants_text().
inline constexpr char kUquadConstantsName[] = "uquad_constants.h";

/// A C header with what the program's model knows of a vehicle: mass, inertia, arm, curves of a
/// rotor, its speeds at hover and at the limits, and the period. The names are quadtune's.
/// @param dt  sample period [s]
/// @throws InvalidInput  for rotors that differ or are not four, and for numbers that are not known
[[nodiscard]] std::string uquad_constants_text(const Vehicle& vehicle, double dt);

/// Rows of numbers as the flight program scans them: "%24.16e", which reads back to the same
/// double, a dot whatever the locale, no header.
/// @throws InvalidInput  naming the first entry that is not finite.
[[nodiscard]] std::string uquad_matrix_text(const Eigen::MatrixXd& M, const std::string& name);

/// Reads rows × cols numbers as fscanf("%lf") would, but refuses what that would misread in
/// silence: too few or surplus numbers, rows of another length, nan, infinity, words, decimal
/// commas.
///
/// @param origin  the file's name in messages
/// @throws InvalidInput  "origin:line: what came, what was expected, why".
[[nodiscard]] Eigen::MatrixXd parse_uquad_matrix(const std::string& text, Eigen::Index rows,
                                                 Eigen::Index cols, const std::string& origin);

/// Reads the gains of one build from a directory, or from its proportional or integral file. Files
/// say nothing of trim and sample time: x0 and u0 are zero, dt is the program's 0.01 s.
///
/// @throws InvalidInput  for bad files, or a directory with none or several builds.
/// @throws FileError     if a file of the build cannot be read.
[[nodiscard]] Gains read_uquad_gains(const std::filesystem::path& path);

}  // namespace quadtune
