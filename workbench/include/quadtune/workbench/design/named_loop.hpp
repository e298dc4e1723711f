// SPDX-License-Identifier: Apache-2.0
/// Loops whose margins are asked for: of a gain on matrices, or of a vehicle's gains, ideal and as
/// they fly.
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
  OpenLoop loop;
  std::vector<std::string> names = {};  ///< empty for one that is just "loop"
  /// What matrices were taken for where nothing declared it, "note: …" or "warning: …"; else empty.
  std::string taken_as = {};
  std::string controller = {};  ///< of a vehicle's loop, as FlightOptions::controller; else empty
};

/// A delay as a number of samples: of a discrete loop nothing between them is known.
/// @param delay  [s], ≥ 0
/// @param dt     [s], > 0
/// @throws OptionError  naming "delay": no whole number, or more than 2000
[[nodiscard]] int whole_samples(double delay, double dt);

/// What the matrices of a plant are.
enum class MatrixTime {
  continuous,
  discrete,
  sampled,  ///< continuous, but the input is held for a sample period
};

struct GainLoopOptions {
  MatrixTime time = MatrixTime::continuous;
  double dt = 0;           ///< sample period [s], > 0 unless continuous
  bool declared = true;    ///< whether somebody said so; if not, it is doubted in taken_as
  bool at_states = false;  ///< cut at the states, not at the inputs
  double delay = 0;        ///< [s], ≥ 0; whole samples unless continuous
};

/// The loop of u = -K x.
/// @param plant  A (nx × nx) and B (nx × nu), continuous or discrete as the options say
/// @param K      (nu × nx)
/// @throws OptionError  as whole_samples()
[[nodiscard]] NamedLoop gain_loop(const ContinuousLti& plant, const Eigen::MatrixXd& K,
                                  const GainLoopOptions& options = {});

/// A loop and its margins.
struct LoopReport {
  NamedLoop loop;
  MarginsReport ideal;                  ///< of that loop
  std::optional<FlownLoop> flown = {};  ///< of a vehicle's loop as it flies, if it was asked for

  /// Of the flown loop, where there is one.
  [[nodiscard]] const MarginsReport& margins() const { return flown ? flown->margins : ideal; }
};

[[nodiscard]] LoopReport loop_report(NamedLoop loop);

/// The loop of a vehicle's gains on the ideal plant, and on the plant that flies: with the rotors'
/// lag, the sensors and the estimator.
/// @param flight  vehicle, gains, estimator and sensors are used
/// @param at      for both loops the delay, for the flown one the height
/// @param flown   whether the flown loop is analysed
/// @throws OptionError   for words that no option knows; naming "delay": one that is not a whole
///                       number of samples, or for the flown loop more than kMostDelayPeriods
/// @throws InvalidInput  for gains of another vehicle, or without a sample period
/// @throws FileError, NoSolution
[[nodiscard]] LoopReport loop_report(const FlightOptions& flight, const FlownLoopOptions& at = {},
                                     bool flown = true);

}  // namespace quadtune
