// SPDX-License-Identifier: Apache-2.0
/// `lqr V` on the plant that flies: rotors' lag, sensors' delays, estimator.
#pragma once

#include <optional>
#include <set>
#include <string>

#include "arguments/lqr_arguments.hpp"
#include "program/program.hpp"
#include "quadtune/workbench/design/lqi_report.hpp"
#include "quadtune/workbench/flown/flown_loop.hpp"

namespace quadtune::cli {

class CommandLine;

struct FlownLqrArguments {
  std::string change;  // list: weights of a command's change
  double past = 0;     // control periods
  std::string estimator, sensors;
  double height = FlownLoopOptions().height;
  std::set<std::string> given = {};  // names of the options of the flown plant that came
};

/// Adds --change, --past, --estimator, --sensors and --height.
void add_flown_lqr_options(CommandLine& line, FlownLqrArguments& arguments);

/// Which of those were given.
/// @param line  after parse()
[[nodiscard]] std::set<std::string> given_flown_options(const CommandLine& line);

/// Runs a design for the flown plant whose options came from the command line.
/// @throws UsageError  in place of OptionError; NoSolution of weights that are given names --Q
template <class Function>
auto weights_of_command(const LqrArguments& common, Function&& function) {
  try {
    return period_of_command(common.verb, common.has_dt, function);
  } catch (const NoSolution& error) {
    // Weights that are given leave a state unseen.
    if (common.Q.empty()) throw;
    throw NoSolution(error.what(), "--Q");
  }
}

/// The design that --Q, --R, --change, --integral, --past and --dt ask for.
/// @throws UsageError  naming the option, what came and what was expected
[[nodiscard]] LqiDesign lqi_design(const LqrArguments& common, const FlownLqrArguments& arguments);

/// Designs and judges.
/// @param verb  for messages
[[nodiscard]] LqiReport lqi_of_command(const Vehicle& vehicle, const LqrArguments& common,
                                       const FlownLqrArguments& arguments);

/// Notes of a design and of its flown loop, warnings of margins.
void write_notes(const std::vector<std::string>& notes, const FlownLoop& flown,
                 const std::string& verb, const Context& context);
void write_notes(const LqiReport& report, const std::string& verb, const Context& context);

/// Runs the verb.
void run_flown_lqr(const LqrArguments& common, const FlownLqrArguments& arguments,
                   Context& context);

/// The flown loop of gains that were designed on the ideal plant.
/// @param model  of the design
/// @return       none unless has_flown_loop(), for gains of some states only, and with a note for a
///               loop that cannot be analysed, e.g. because of its sample period
[[nodiscard]] std::optional<FlownLoop> flown_loop_of_ideal(const Vehicle& vehicle,
                                                           const Linearization& model,
                                                           const Gains& gains,
                                                           const Context& context);

}  // namespace quadtune::cli
