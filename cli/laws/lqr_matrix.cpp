// SPDX-License-Identifier: Apache-2.0
#include "laws/lqr_matrix.hpp"

#include <fmt/format.h>

#include <cmath>
#include <numbers>
#include <ostream>

#include "arguments/flight_arguments.hpp"
#include "arguments/matrix_arguments.hpp"
#include "arguments/read_number.hpp"
#include "quadtune/internal/json.hpp"
#include "report/gains/matrix_report.hpp"
#include "report/text/print.hpp"

namespace quadtune::cli {
namespace {

using internal::Json;

/// A gain of given structure answers each state that is integrated, and its integral.
void require_weights(const LqiDesign& design) {
  const auto positive = [](const std::string& name, double weight) {
    if (!(weight > 0))
      throw UsageError(fmt::format("quadtune lqr: --Q: the weight of {} is {}, expected more than "
                                   "0 with --structure matrix",
                                   name, number(weight)),
                       "--Q");
  };
  if (!design.Q) return;
  for (std::size_t i = 0; i < kFlownAxes.size(); ++i) {
    const std::string& name = design.integrals[i];
    positive(name, (*design.Q)(states_of(kFlownAxes[i]).front()));
    positive("int_" + name, (*design.Q_integral)(static_cast<Eigen::Index>(i)));
  }
}

}  // namespace

void run_matrix_lqr(const LqrArguments& common, const FlownLqrArguments& arguments,
                    bool asks_for_inputs, Context& context) {
  const Vehicle vehicle = load_vehicle(common.plant.vehicle);
  LqiDesign design = lqi_design(common, arguments);
  MatrixWords words;
  words.convention = common.plant.convention;
  (void)convention(words.convention, "--convention");
  if (asks_for_inputs) words.input_kind = input_kind(common.plant.inputs, "--inputs");
  design.matrix = words;
  require_weights(design);
  require_positive(arguments.height, common.verb, "--height", "metres");
  FlightOptions flight;
  flight.vehicle = common.plant.vehicle;
  flight.estimator = arguments.estimator;
  flight.sensors = arguments.sensors;
  FlownLoopOptions at;
  at.height = arguments.height;
  const MatrixReport report = weights_of_command(common, [&] {
    require_flight_words(flight);
    return matrix_report(vehicle, design, flight, at);
  });
  if (!report.estimator && !arguments.estimator.empty())
    context.note(fmt::format(
        "lqr: note: no file of gains holds the estimator '{0}': fly them with --estimator {0}",
        arguments.estimator));
  if (report.gains.axes == PositionAxes::world)
    context.note(
        "lqr: note: the law sees the position error in world axes, as its flight program does: a "
        "heading off north takes its angle from the phase of the position loops");
  write_notes(report.design.notes, report.flown, common.verb, context);
  if (context.json)
    context.out << internal::readable(to_json(report, vehicle)) << "\n";
  else
    context.out << to_text(report);
}

}  // namespace quadtune::cli
