// SPDX-License-Identifier: Apache-2.0
/// Options of a system that is given as matrices or as a transfer function, and of a controller in
/// a loop with it.
#pragma once

#include <iosfwd>
#include <optional>
#include <string>
#include <variant>

#include "quadtune/lti.hpp"
#include "quadtune/workbench/systems/matrix_loop.hpp"

namespace quadtune::cli {

class CommandLine;

struct ControllerArguments {
  std::string num, den;    ///< of a transfer function
  std::string A, B, C, D;  ///< matrix files
  std::string pid;         ///< "Kp,Ki,Kd,Tf"
  std::string integrator = "tustin";

  [[nodiscard]] bool given() const;
};

/// Adds --controller-num, --controller-den, --controller-A to --controller-D, --pid and
/// --integrator.
void add_controller_options(CommandLine& line, ControllerArguments& arguments);

/// The controller; no value if no option was given.
/// @throws UsageError  if more than one kind was given, or a part is missing
[[nodiscard]] std::optional<LoopController> controller_of(const ControllerArguments& arguments,
                                                          std::istream& in);

/// Gains of "Kp", "Kp,Ki", "Kp,Ki,Kd" or "Kp,Ki,Kd,Tf".
/// @throws UsageError
[[nodiscard]] PidGains pid_gains_of(const std::string& list, const std::string& option);

struct SystemArguments {
  std::string A, B, C, D, num, den;
  std::optional<double> dt;  ///< [s]; none: continuous
};

/// Adds --A to --D, --num, --den and --dt.
void add_system_options(CommandLine& line, SystemArguments& arguments);

/// @throws UsageError  unless one of both forms was given completely
[[nodiscard]] std::variant<ContinuousLti, DiscreteLti> system_of(const SystemArguments& arguments,
                                                                 std::istream& in);

}  // namespace quadtune::cli
