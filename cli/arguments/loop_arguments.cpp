// SPDX-License-Identifier: Apache-2.0
#include "arguments/loop_arguments.hpp"

#include "arguments/matrix_arguments.hpp"
#include "program/command_line.hpp"
#include "program/refusal.hpp"
#include "quadtune/transfer_function.hpp"

namespace quadtune::cli {

bool ControllerArguments::given() const {
  return !num.empty() || !den.empty() || !A.empty() || !B.empty() || !C.empty() || !D.empty() ||
         !pid.empty();
}

void add_controller_options(CommandLine& line, ControllerArguments& arguments) {
  line.add_option("--controller-num LIST", arguments.num,
                  "controller from y to -u: numerator, descending powers");
  line.add_option("--controller-den LIST", arguments.den, "its denominator");
  line.add_option("--controller-A FILE", arguments.A, "controller as matrices: dynamics");
  line.add_option("--controller-B FILE", arguments.B, "its inputs, one column per output y");
  line.add_option("--controller-C FILE", arguments.C, "its outputs -u, one row per input u");
  line.add_option("--controller-D FILE", arguments.D,
                  "its feed-through; default 0; alone: a constant gain");
  line.add_option("--pid LIST", arguments.pid, "PID controller Kp[,Ki[,Kd[,Tf]]]");
  line.add_option("--integrator NAME", arguments.integrator,
                  "with --pid in a discrete loop: euler, backward-euler or tustin (default)");
}

PidGains pid_gains_of(const std::string& list, const std::string& option) {
  const std::vector<double> values = number_list(list, option);
  if (values.empty() || values.size() > 4)
    refuse(option, "{} has {} numbers, expected Kp[,Ki[,Kd[,Tf]]]", option, values.size());
  const auto at = [&](std::size_t i) { return i < values.size() ? values[i] : 0.0; };
  if (at(3) < 0) refuse(option, "{}: Tf is {} s, expected 0 or more", option, at(3));
  return {at(0), at(1), at(2), at(3)};
}

std::optional<LoopController> controller_of(const ControllerArguments& arguments,
                                            std::istream& in) {
  const bool fraction = !arguments.num.empty() || !arguments.den.empty();
  const bool matrices =
      !arguments.A.empty() || !arguments.B.empty() || !arguments.C.empty() || !arguments.D.empty();
  const bool pid = !arguments.pid.empty();
  if (int{fraction} + int{matrices} + int{pid} > 1)
    refuse(pid ? "--pid" : "--controller-num",
           "more than one controller was given, expected only one: either --controller-num and "
           "--controller-den, --controller-A to --controller-D, or --pid");
  LoopController controller;
  if (pid) {
    controller.pid = pid_gains_of(arguments.pid, "--pid");
    controller.method = pid_method(arguments.integrator, "--integrator");
  } else if (fraction) {
    controller.num = coefficients(arguments.num, "--controller-num");
    controller.den = coefficients(arguments.den, "--controller-den");
  } else if (matrices) {
    controller.D = read_matrix(arguments.D, in, "--controller-D");
    const bool gain = arguments.A.empty() && arguments.B.empty() && arguments.C.empty();
    if (gain) return controller;
    controller.A = require_matrix(arguments.A, in, "--controller-A");
    controller.B = require_matrix(arguments.B, in, "--controller-B");
    controller.C = require_matrix(arguments.C, in, "--controller-C");
  } else {
    return {};
  }
  return controller;
}

void add_system_options(CommandLine& line, SystemArguments& arguments) {
  line.add_option("--A FILE", arguments.A, "dynamics (nx x nx)");
  line.add_option("--B FILE", arguments.B, "inputs (nx x nu)");
  line.add_option("--C FILE", arguments.C, "outputs (ny x nx); default: the states");
  line.add_option("--D FILE", arguments.D, "feed-through (ny x nu); default: 0");
  line.add_option("--num LIST", arguments.num, "numerator, descending powers");
  line.add_option("--den LIST", arguments.den, "denominator, descending powers");
  line.add_number("--dt T", arguments.dt, "sample period [s] of a discrete system");
}

std::variant<ContinuousLti, DiscreteLti> system_of(const SystemArguments& arguments,
                                                   std::istream& in) {
  const bool fraction = !arguments.num.empty() || !arguments.den.empty();
  const bool matrices =
      !arguments.A.empty() || !arguments.B.empty() || !arguments.C.empty() || !arguments.D.empty();
  if (fraction == matrices)
    refuse(fraction ? "--num" : "--A",
           "expected either --A and --B, with --C and --D if required, or --num and --den");
  if (arguments.dt) require_positive(*arguments.dt, "--dt");
  if (fraction) {
    const Eigen::VectorXd num = coefficients(arguments.num, "--num");
    const Eigen::VectorXd den = coefficients(arguments.den, "--den");
    if (arguments.dt) {
      const DiscreteTransferFunction g{num, den, *arguments.dt, 0};
      validate(g, "--num, --den");
      return realize(g);
    }
    const ContinuousTransferFunction g{num, den, 0};
    validate(g, "--num, --den");
    return realize(g);
  }
  ContinuousLti plant;
  plant.A = require_matrix(arguments.A, in, "--A");
  plant.B = require_matrix(arguments.B, in, "--B");
  plant.C = read_matrix(arguments.C, in, "--C");
  plant.D = read_matrix(arguments.D, in, "--D");
  validate(plant, "--A, --B, --C, --D");
  if (!arguments.dt) return plant;
  return DiscreteLti{plant.A, plant.B, plant.C, plant.D, *arguments.dt, {}, {}, {}};
}

}  // namespace quadtune::cli
