// SPDX-License-Identifier: Apache-2.0
/// Loops of a plant with outputs and a controller, and loops that are known by frequency response
/// data.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "quadtune/control/pid_method.hpp"
#include "quadtune/synthesis/frequency_data.hpp"
#include "quadtune/synthesis/pid/pid_gains.hpp"
#include "quadtune/workbench/design/named_loop.hpp"

namespace quadtune {

/// A controller from the output y of a plant to -u: matrices, a transfer function, or a PID
/// controller. A constant gain is a D alone. It is continuous or discrete as its loop is; a PID
/// controller of a discrete loop is discretized by `method`.
struct LoopController {
  Eigen::MatrixXd A,                 ///< (n × n), or empty
      B,                             ///< (n × ny), or empty
      C,                             ///< (nu × n), or empty
      D;                             ///< (nu × ny), or empty
  Eigen::VectorXd num,               ///< numerator in descending powers, or empty
      den;                           ///< denominator, likewise
  std::optional<PidGains> pid = {};  ///< PID controller; empty: matrices or a transfer function
  /// By which a PID controller of a discrete loop is discretized.
  PidMethod method = PidMethod::tustin;
};

/// Options of matrix_loop().
struct MatrixLoopOptions {
  MatrixTime time = MatrixTime::continuous;  ///< whether the matrices are continuous or discrete
  double dt = 0;                             ///< sample period [s], > 0 unless continuous
  bool at_outputs = false;  ///< cut at the outputs of the plant instead of at its inputs
  double delay = 0;         ///< [s], ≥ 0; whole samples unless continuous
};

/// The open loop of a plant and a controller: controller times plant, or without a controller the
/// plant itself, which then is L.
/// @param plant       A, B, C and D, continuous or discrete according to the options
/// @param controller  empty: the plant is L
/// @param options     time, place of the cut, and delay
/// @throws OptionError   as whole_samples()
/// @throws InvalidInput  if shapes disagree, or the controller cannot be discretized
[[nodiscard]] NamedLoop matrix_loop(const ContinuousLti& plant,
                                    const std::optional<LoopController>& controller,
                                    const MatrixLoopOptions& options = {});

/// Replaces the disk margins by those of another skew.
/// @param report  its disk margins are replaced
/// @param loop    the loop of the report
/// @param skew    as for loop_margins()
void set_skew(MarginsReport& report, const OpenLoop& loop, double skew);

/// Margins of measured frequency response data.
struct FrequencyDataReport {
  FrequencyDataMargins data;       ///< margins of the samples
  double w_min = 0,                ///< minimum frequency of the data [rad/s]
      w_max = 0;                   ///< maximum frequency [rad/s]
  Eigen::Index samples = 0;        ///< number of frequencies
  MarginsReport margins;           ///< of the one loop, without simultaneous margins
  std::vector<std::string> notes;  ///< what the data leave open, for the user
};

/// @param measured    the response in the file
/// @param what        what was measured
/// @param controller  if given, the measured response is that of the plant, and L is controller
///                    times plant
/// @param dt          [s] of a discrete controller; 0: continuous
/// @param delay       additional delay of the loop [s], ≥ 0
/// @param skew        of the disk, as for loop_margins()
/// @throws InvalidInput  as open_loop_of()
[[nodiscard]] FrequencyDataReport frequency_data_report(
    const FrequencyData& measured, MeasuredResponse what,
    const std::optional<LoopController>& controller, double dt, double delay, double skew = 0);

/// Reads frequency response data from a text with one row per frequency. The first line names the
/// columns: the frequency as `w` [rad/s] or `f` [Hz]; the response as `re` and `im`, or as `mag` or
/// `mag_db` with `phase_deg` or `phase_rad`. Other columns are ignored. Columns are separated by
/// commas, semicolons or blanks; lines that begin with # are comments.
/// @param text    content of the file
/// @param origin  name of the file, for messages
/// @throws InvalidInput  "origin:line: …"
[[nodiscard]] FrequencyData parse_frequency_data(const std::string& text,
                                                 const std::string& origin);

/// The same from a file; "-" is not accepted.
/// @throws FileError, InvalidInput
[[nodiscard]] FrequencyData read_frequency_data(const std::string& path);

/// "loop", "T" or "S".
/// @throws OptionError  "measured", for other words
[[nodiscard]] MeasuredResponse measured_response(const std::string& word);

}  // namespace quadtune
