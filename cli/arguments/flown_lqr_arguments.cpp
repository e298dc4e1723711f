// SPDX-License-Identifier: Apache-2.0
#include "arguments/flown_lqr_arguments.hpp"

#include <algorithm>
#include <cmath>

#include "program/command_line.hpp"
#include "program/program.hpp"
#include "program/refusal.hpp"
#include "quadtune/convention_file.hpp"
#include "quadtune/internal/joined.hpp"
#include "quadtune/synthesis/flown_axis.hpp"
#include "report/text/print.hpp"

namespace quadtune::cli {
namespace {

/// @throws UsageError  if it is not an integer in the valid range
int past_periods(double past) {
  if (past != std::floor(past) || past < 0 || past > kMaxPastCommands)
    refuse("--past", "--past is {}, expected an integer from 0 to {}", number(past),
           kMaxPastCommands);
  return static_cast<int>(past);
}

/// A gain of this structure acts on each state that is integrated and on its integral, so both need
/// a weight.
void require_weights(const LqiDesign& design) {
  const auto positive = [](const std::string& name, double weight) {
    if (!(weight > 0))
      refuse("--Q", "--Q: the weight of {} is {}; expected more than 0 with --structure matrix",
             name, number(weight));
  };
  if (!design.Q) return;
  for (std::size_t i = 0; i < kFlownAxes.size(); ++i) {
    const std::string& name = design.integrals[i];
    positive(name, (*design.Q)(states_of(kFlownAxes[i]).front()));
    positive("int_" + name, (*design.Q_integral)(static_cast<Eigen::Index>(i)));
  }
}

/// Every other state is 0 in hover, so its integral cannot be controlled.
void require_positions(const std::vector<std::string>& integrals) {
  std::vector<std::string> known;
  for (const FlownAxis axis : kFlownAxes)
    known.push_back(
        ned_convention().states[static_cast<std::size_t>(states_of(axis).front())].name);
  for (const std::string& name : integrals)
    if (std::find(known.begin(), known.end(), name) == known.end())
      refuse(
          "--integral",
          "--integral: the integral of {} cannot be controlled, because {} is 0 in hover; expected "
          "names from {}, or none",
          name, name, internal::joined(known, " "));
}

}  // namespace

void add_flown_lqr_options(CommandLine& line, FlownLqrArguments& arguments) {
  line.add_option("--change LIST", arguments.change,
                  "flown plant: weights of the change of each command from one control period to "
                  "the next; default: no such cost");
  line.add_number(
      "--past N", arguments.past,
      "flown plant: number of control periods that the law predicts; default: chosen so "
      "that the flown loop meets its margins");
  line.add_option("--estimator NAME", arguments.estimator,
                  "flown plant: as for `quadtune fly`; default: one that the sensors allow");
  line.add_option("--sensors NAME", arguments.sensors, "flown plant: real (default) or ideal");
  line.add_number("--height M", arguments.height,
                  "flown plant: height of the hover [m], default 1.1");
}

LqiDesign lqi_design(const LqrArguments& common, const FlownLqrArguments& arguments) {
  LqiDesign design;
  if (common.dt) require_positive(*common.dt, "--dt");
  design.dt = common.dt.value_or(design.dt);
  const std::vector<std::string> states = names_of(ned_convention().states);
  const std::vector<std::string> inputs = names_of(ned_convention().wrench);
  if (!common.integral.empty()) design.integrals = read_integrals(common, states);
  require_positions(design.integrals);
  if (arguments.past) design.past = past_periods(*arguments.past);
  if (!common.Q.empty()) {
    const Eigen::VectorXd Q = state_weights(common.Q, states, design.integrals);
    design.Q = Q.head(12);
    design.Q_integral = Q.tail(Q.size() - 12);
  }
  if (!common.R.empty()) {
    design.R = input_weights(common.R, inputs, "--R");
    if (!(design.R->minCoeff() > 0))
      refuse("--R", "--R has a weight of 0, expected weights greater than 0");
  }
  if (!arguments.change.empty()) {
    if (design.past && *design.past < 1)
      refuse("--change",
             "--change cannot be combined with --past 0; expected --past of at least 1, because "
             "the law must store its last command");
    design.R_change = input_weights(arguments.change, inputs, "--change");
  }
  return design;
}

LqiDesign matrix_design(const LqrArguments& common, const FlownLqrArguments& arguments,
                        bool asks_for_inputs) {
  LqiDesign design = lqi_design(common, arguments);
  MatrixConvention words;
  words.convention = named_convention(common.plant.convention, "--convention").name;
  if (asks_for_inputs) words.input_kind = input_kind(common.plant.inputs, "--inputs");
  design.matrix = words;
  require_weights(design);
  return design;
}

}  // namespace quadtune::cli
