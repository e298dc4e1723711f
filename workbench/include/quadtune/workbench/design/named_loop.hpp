// SPDX-License-Identifier: Apache-2.0
/// Loops whose margins are analysed: of a gain with given matrices, or of a vehicle's gains on the
/// ideal and on the flown plant.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "quadtune/lti.hpp"
#include "quadtune/workbench/design/margins_report.hpp"
#include "quadtune/workbench/flight/flight_options.hpp"
#include "quadtune/workbench/flown/flown_loop.hpp"

namespace quadtune {

/// A loop under negative feedback with the names of its channels.
struct NamedLoop {
  OpenLoop loop;                        ///< under negative feedback
  std::vector<std::string> names = {};  ///< empty for a single channel named "loop"
  /// "note: …" or "warning: …" about the assumed meaning of matrices if none was declared; else
  /// empty.
  std::string taken_as = {};
  std::string controller = {};  ///< of a vehicle's loop, as in FlightOptions::controller; else
                                ///< empty
};

/// Converts a delay to a number of samples; a discrete loop is not defined between them.
/// @param delay  [s], ≥ 0
/// @param dt     [s], > 0
/// @throws OptionError  "delay", if it is not a whole number of samples, or more than 2000
[[nodiscard]] int whole_samples(double delay, double dt);

/// The meaning of the matrices of a plant.
enum class MatrixTime {
  continuous,
  discrete,
  sampled,  ///< continuous, but the input is held for a sample period
};

/// Options of gain_loop().
struct GainLoopOptions {
  MatrixTime time = MatrixTime::continuous;  ///< whether the matrices are continuous or discrete
  double dt = 0;                             ///< sample period [s], > 0 unless continuous
  bool declared = true;    ///< whether the user declared `time`; if not, NamedLoop::taken_as
                           ///< reports doubts
  bool at_states = false;  ///< cut at the states instead of at the inputs
  double delay = 0;        ///< [s], ≥ 0; whole samples unless continuous
};

/// The loop of u = -K x.
/// @param plant    A (nx × nx) and B (nx × nu), continuous or discrete according to the options
/// @param K        (nu × nx)
/// @param options  time and place of the cut
/// @throws OptionError  as whole_samples()
[[nodiscard]] NamedLoop gain_loop(const ContinuousLti& plant, const Eigen::MatrixXd& K,
                                  const GainLoopOptions& options = {});

/// A loop and its margins.
struct LoopReport {
  NamedLoop loop;                       ///< the ideal loop
  MarginsReport ideal;                  ///< of `loop`
  std::optional<FlownLoop> flown = {};  ///< of a vehicle's flown loop, if requested

  /// The margins of the flown loop if there is one, otherwise those of the ideal loop.
  [[nodiscard]] const MarginsReport& margins() const { return flown ? flown->margins : ideal; }
};

/// The margins of a loop.
[[nodiscard]] LoopReport loop_report(NamedLoop loop);

/// The loop of a vehicle's gains on the ideal plant and on the flown plant, that is with motor lag,
/// sensors and estimator.
/// @param flight  vehicle, gains, estimator and sensors are used
/// @param at      the delay of both loops, and the height of the flown one
/// @param flown   whether the flown loop is analysed
/// @throws OptionError   for unknown words; "delay" if it is not a whole number of samples, or for
///                       the flown loop more than kMaxDelayPeriods
/// @throws InvalidInput  if the gains are for another vehicle or have no sample period
/// @throws FileError, NoSolution
[[nodiscard]] LoopReport loop_report(const FlightOptions& flight, const FlownLoopOptions& at = {},
                                     bool flown = true);

}  // namespace quadtune
