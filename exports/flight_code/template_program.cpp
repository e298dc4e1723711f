// SPDX-License-Identifier: Apache-2.0
#include "flight_code/board_float.hpp"
#include "flight_code/flight_program.hpp"
#include "flight_code/flight_recording.hpp"
#include "quadtune/simulation/pack_math.hpp"

namespace quadtune::exports {

// source/state.h repeats these sizes as literals.
static_assert(QT_HISTORY == kMaxHistoryPeriods && QT_HORIZON == kMaxHorizonPeriods);
static_assert(QT_ERRORS == kErrorStates);

namespace {

template <class T>
class TemplateProgram final : public RunningProgram {
 public:
  explicit TemplateProgram(const ProgramSettings& settings) : settings_(settings) {}

  void start(const ProgramStart& start) override {
    program_ = std::make_unique<FlightProgram<T>>(settings_, start);
  }

  Estimate<double> estimate(const EstimatorInput& input) override {
    if (settings_.has_estimator())
      estimate_ = program_->estimate(input.sensors, input.on_ground);
    else
      convert_field(estimate_.x, input.true_state);
    Estimate<double> result;
    for (int i = 0; i < 12; ++i) result.x(i) = lane(estimate_.x(i), 0);
    result.finite = all(estimate_.finite);
    return result;
  }

  ProgramOutput control(const Reference<double>& reference, const Eigen::VectorXd& idle) override {
    return reference.phase == FlightPhase::off ? program_->idle(estimate_, idle)
                                               : program_->control(estimate_, reference);
  }

 private:
  ProgramSettings settings_;
  std::unique_ptr<FlightProgram<T>> program_;
  Estimate<T> estimate_;
};

}  // namespace

std::shared_ptr<RunningProgram> template_program(const ProgramSettings& settings,
                                                 bool double_precision) {
  if (double_precision) return std::make_shared<TemplateProgram<Pack<1>>>(settings);
  return std::make_shared<TemplateProgram<BoardFloat>>(settings);
}

}  // namespace quadtune::exports
