// SPDX-License-Identifier: Apache-2.0
#include "quadtune/exports/uquad.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "export_text.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/estimation/uquad_filter.hpp"
#include "quadtune/internal/counted.hpp"
#include "quadtune/internal/joined.hpp"
#include "quadtune/matrix_checks.hpp"
#include "uquad/uquad_numbers.hpp"

namespace quadtune {
namespace {

constexpr double kFlightProgramDt = 0.01;  // [s]
constexpr int kRotors = 4;

const std::vector<std::string> kWithoutPosition = {"z",   "psi", "phi", "theta",
                                                   "vqz", "wqx", "wqy", "wqz"};
const std::vector<std::string> kFull = {"x",   "y",   "z",   "psi", "phi", "theta",
                                        "vqx", "vqy", "vqz", "wqx", "wqy", "wqz"};

bool same_names(std::vector<std::string> a, std::vector<std::string> b) {
  std::sort(a.begin(), a.end());
  std::sort(b.begin(), b.end());
  return a == b;
}

// The column of `signals` for each name.
std::vector<int> columns(const std::vector<Signal>& signals,
                         const std::vector<std::string>& wanted) {
  std::vector<int> result;
  result.reserve(wanted.size());
  for (const std::string& name : wanted)
    result.push_back(
        static_cast<int>(std::find_if(signals.begin(), signals.end(),
                                      [&](const Signal& signal) { return signal.name == name; }) -
                         signals.begin()));
  return result;
}

std::string all_in_words() {
  std::vector<std::string> words;
  for (const UquadFileSet& set : uquad_file_sets()) words.push_back(set.proportional);
  return fmt::format("one of {}", internal::joined(words, ", "));
}

const UquadFileSet& set_of_path(const std::filesystem::path& path) {
  const std::string name = path.filename().string();
  for (const UquadFileSet& set : uquad_file_sets())
    if (name == set.proportional || (!name.empty() && name == set.integral)) return set;
  throw InvalidInput(path.string(), "is not a gain file of uquad; expected " + all_in_words());
}

const UquadFileSet& set_of_directory(const std::filesystem::path& directory) {
  std::vector<const UquadFileSet*> present;
  std::vector<std::string> found;
  for (const UquadFileSet& set : uquad_file_sets()) {
    if (!std::filesystem::exists(directory / set.proportional)) continue;
    present.push_back(&set);
    found.push_back(set.proportional);
  }
  if (present.empty())
    throw InvalidInput(directory.string(),
                       "has no gain files of uquad; expected " + all_in_words());
  if (present.size() > 1)
    throw InvalidInput(
        directory.string(),
        fmt::format("has the gains of several builds of the flight program ({}), expected those of "
                    "one; name the file instead of the directory",
                    internal::joined(found, ", ")));
  return *present.front();
}

std::vector<Signal> signals_of(const std::vector<std::string>& wanted, bool integrated) {
  std::vector<Signal> signals;
  for (const std::string& name : wanted)
    for (const Signal& state : convention("uquad", "uquad").states)
      if (state.name == name) signals.push_back({name, state.unit + (integrated ? " s" : "")});
  return signals;
}

// The program's loop has a period of 10 ms, and it uses these files for hover only: x and y are
// then world axes, and every velocity and rate must be zero.
void require_hover_at_program_rate(const Gains& gains) {
  if (std::abs(gains.dt - kFlightProgramDt) > 1e-9)
    throw InvalidInput("uquad",
                       fmt::format("the gain's sample time is {} s, expected {} s, because "
                                   "the flight program's loop is fixed",
                                   gains.dt, kFlightProgramDt));
  if (gains.memory || gains.axes == PositionAxes::heading)
    throw InvalidInput("uquad",
                       fmt::format("the law {}, expected a matrix on the states in world axes, "
                                   "which is all that the flight program implements",
                                   gains.memory ? "feeds back its past commands"
                                                : "sees the position error in heading axes"));
  if (gains.limits != FeedbackLimits{})
    throw InvalidInput("uquad",
                       "the law limits its position error or its integrals, expected none, because "
                       "the flight program's files contain only the matrices");
  for (std::size_t i = 0; i < gains.states.size(); ++i) {
    const std::string& name = gains.states[i].name;
    const double value = gains.x0(static_cast<Eigen::Index>(i));
    if ((name.starts_with("vq") || name.starts_with("wq")) && std::abs(value) > 1e-8)
      throw InvalidInput("uquad",
                         fmt::format("the gain's trim has {} = {:.6g}, expected 0, because "
                                     "the flight program flies these files in hover",
                                     name, value));
  }
}

}  // namespace

const std::vector<UquadFileSet>& uquad_file_sets() {
  static const std::vector<UquadFileSet> sets = {
      {"K.txt", "", kWithoutPosition, {}},
      {"K_prop.txt", "K_int.txt", kWithoutPosition, {"z", "theta"}},
      {"K_full.txt", "", kFull, {}},
      {"K_prop_full.txt", "K_int_full.txt", kFull, {"x", "y", "z", "theta"}},
      {"K_prop_full_pptz.txt", "K_int_full_pptz.txt", kFull, {"psi", "phi", "z", "theta"}},
  };
  return sets;
}

const UquadFileSet& uquad_file_set(const Gains& gains) {
  validate(gains, "uquad");
  if (gains.convention != "uquad")
    throw InvalidInput("uquad", fmt::format("the gain is in the convention '{}', expected 'uquad', "
                                            "because the flight program has its own axes and order",
                                            gains.convention));
  if (gains.input_kind != InputKind::rotor_speed || gains.inputs.size() != kRotors)
    throw InvalidInput(
        "uquad", fmt::format("the gain commands {} inputs of kind {}, expected 4 of kind "
                             "rotor-speed, because the flight program adds K to its rotor speeds",
                             gains.inputs.size(), to_string(gains.input_kind)));
  if (gains.sign_law != SignLaw::set_point_minus_state)
    throw InvalidInput(
        "uquad", fmt::format("the gain's sign law is {}, expected {}, because the "
                             "flight program subtracts the state from the set point",
                             to_string(gains.sign_law), to_string(SignLaw::set_point_minus_state)));
  require_hover_at_program_rate(gains);
  for (const UquadFileSet& set : uquad_file_sets())
    if (same_names(names_or_numbers(gains.states, std::ssize(gains.states)), set.states) &&
        same_names(names_or_numbers(gains.integrals, std::ssize(gains.integrals)), set.integrals))
      return set;
  throw InvalidInput("uquad",
                     fmt::format("no build of the flight program has the states {} with the "
                                 "integrals '{}', expected the states and integrals of {}",
                                 names(gains.states), names(gains.integrals), all_in_words()));
}

UquadDiagonals uquad_diagonals(const UquadFilterSettings<double>& settings) {
  // A permutation except for its signs, which do not affect variances.
  const Eigen::Matrix<double, 12, 12> axes = convention("uquad", "uquad").from_ned.cwiseAbs();
  UquadDiagonals result;
  result.Q.resize(kUquadStates);
  result.Q.head<12>() = axes * settings.Q.head<12>();
  result.Q.tail<3>() = axes.block<3, 3>(kVelocity, kVelocity) * settings.Q.tail<3>();
  result.R.resize(16);
  const auto three = Eigen::Vector3d::Ones();
  result.R << settings.R_tilt, settings.R_tilt, settings.R_yaw, settings.R_force * three,
      settings.R_rates * three, settings.R_height, settings.R_gps_position * three,
      settings.R_gps_velocity * three;
  return result;
}

std::vector<FileContent> uquad_files(const Gains& gains, const Eigen::MatrixXd& Q,
                                     const Eigen::MatrixXd& R,
                                     const std::optional<UquadDiagonals>& filter) {
  const UquadFileSet& set = uquad_file_set(gains);
  const std::vector<int> states = columns(gains.states, set.states);
  std::vector<int> integrals = columns(gains.integrals, set.integrals);
  std::vector<FileContent> files;
  const auto add = [&](const std::string& name, const Eigen::MatrixXd& M) {
    files.push_back({name, uquad_matrix_text(M, name)});
  };
  add(set.proportional, gains.K(Eigen::all, states));
  if (!integrals.empty()) add(set.integral, gains.K_int(Eigen::all, integrals));
  if (Q.size() > 0) {
    const auto n = static_cast<Eigen::Index>(states.size() + integrals.size());
    require_shape(Q, n, n, "uquad", "Q", "states, then integrals");
    std::vector<int> order = states;
    for (const int i : integrals) order.push_back(static_cast<int>(states.size()) + i);
    add("lqr-Q.txt", Q(order, order));
  }
  if (R.size() > 0) {
    require_shape(R, kRotors, kRotors, "uquad", "R", "inputs: " + names(gains.inputs));
    add("lqr-R.txt", R);
  }
  if (filter) {
    add("kalman-Q.txt", filter->Q.transpose());
    add("kalman-R.txt", filter->R.transpose());
  }
  return files;
}

std::string uquad_matrix_text(const Eigen::MatrixXd& M, const std::string& name) {
  require_finite(M, "uquad", name);
  std::string text;
  for (Eigen::Index i = 0; i < M.rows(); ++i) {
    for (Eigen::Index j = 0; j < M.cols(); ++j) text += fmt::format(" {:23.16e}", M(i, j));
    text += '\n';
  }
  return text;
}

Eigen::MatrixXd parse_uquad_matrix(const std::string& text, Eigen::Index rows, Eigen::Index cols,
                                   const std::string& origin) {
  Eigen::MatrixXd M(rows, cols);
  Eigen::Index row = 0;
  int number = 0;
  for (std::size_t start = 0; start < text.size();) {
    const std::size_t end = std::min(text.find('\n', start), text.size());
    const std::string where = fmt::format("{}:{}", origin, ++number);
    const std::vector<double> line =
        exports::numbers_of_line(text.substr(start, end - start), where);
    start = end + 1;
    if (line.empty()) continue;
    if (static_cast<Eigen::Index>(line.size()) != cols)
      throw InvalidInput(where, fmt::format("has {}, expected {}, because the flight "
                                            "program would read the rest into wrong places",
                                            internal::counted(line.size(), "number"), cols));
    if (row == rows)
      throw InvalidInput(where, fmt::format("has more than {}, expected {}x{}, because the "
                                            "flight program would ignore the rest",
                                            internal::counted(rows, "row"), rows, cols));
    M.row(row++) = Eigen::Map<const Eigen::RowVectorXd>(line.data(), cols);
  }
  if (row != rows)
    throw InvalidInput(origin, fmt::format("ends after {}, expected {}x{}",
                                           internal::counted(row, "row"), rows, cols));
  return M;
}

Gains read_uquad_gains(const std::filesystem::path& path) {
  const bool is_directory = std::filesystem::is_directory(path);
  const UquadFileSet& set = is_directory ? set_of_directory(path) : set_of_path(path);
  const std::filesystem::path directory = is_directory ? path : path.parent_path();
  const auto read = [&](const std::string& name, std::size_t cols) {
    const std::filesystem::path file = directory / name;
    return parse_uquad_matrix(exports::export_text(file), kRotors, static_cast<Eigen::Index>(cols),
                              file.string());
  };
  Gains gains;
  gains.K = read(set.proportional, set.states.size());
  gains.K_int = Eigen::MatrixXd(kRotors, 0);
  if (!set.integral.empty()) gains.K_int = read(set.integral, set.integrals.size());
  gains.states = signals_of(set.states, false);
  gains.integrals = signals_of(set.integrals, true);
  gains.inputs = input_signals(convention("uquad", "uquad"), InputKind::rotor_speed, kRotors, "");
  gains.x0 = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(set.states.size()));
  gains.u0 = Eigen::VectorXd::Zero(kRotors);
  gains.convention = "uquad";
  gains.dt = kFlightProgramDt;
  return gains;
}

}  // namespace quadtune
