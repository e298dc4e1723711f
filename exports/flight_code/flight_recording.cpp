// SPDX-License-Identifier: Apache-2.0
#include "flight_code/flight_recording.hpp"

#include <cmath>
#include <numbers>
#include <utility>

namespace quadtune::exports {
namespace {

/// A program as estimator and law of a simulated flight.
class Flown {
 public:
  Flown(ProgramSettings settings, std::shared_ptr<RunningProgram> program, bool double_precision)
      : settings_(std::move(settings)),
        program_(std::move(program)),
        lines_(settings_.has_estimator(), double_precision) {}

  void start(const ProgramStart& start) {
    yaw_ = start.x(5);
    program_->start(start);
    text_ += lines_.start(start) + "\n";
  }

  [[nodiscard]] Estimate<double> estimate(EstimatorInput input) {
    // The law uses the unwrapped yaw.
    constexpr double kTurn = 2 * std::numbers::pi;
    input.true_state(5) += kTurn * std::nearbyint((yaw_ - input.true_state(5)) / kTurn);
    yaw_ = input.true_state(5);
    input_ = lines_.input(input);
    return program_->estimate(input);
  }

  [[nodiscard]] Eigen::VectorXd command(const Reference<double>& reference) {
    commanded_ = true;
    const Eigen::VectorXd signs = direction();
    return keep(reference, Eigen::VectorXd::Zero(signs.size())).cwiseProduct(signs);
  }

  /// Informs the program of the actual commands in periods in which the law does not control the
  /// motors.
  void on_realized(const Eigen::VectorXd& made) {
    if (std::exchange(commanded_, false)) return;
    Reference<double> reference;
    reference.phase = FlightPhase::off;
    (void)keep(reference, made.cwiseProduct(direction()));
  }

  [[nodiscard]] std::string text() const { return text_; }

 private:
  [[nodiscard]] Eigen::VectorXd direction() const {
    return Eigen::Map<const Eigen::VectorXd>(settings_.direction.data(),
                                             settings_.allocation.rotors);
  }
  Eigen::VectorXd keep(const Reference<double>& reference, const Eigen::VectorXd& idle) {
    const ProgramOutput output = program_->control(reference, idle);
    text_ += input_ + " " + lines_.reference(reference, idle) + " " + lines_.output(output) + "\n";
    return output.commands;
  }

  ProgramSettings settings_;
  std::shared_ptr<RunningProgram> program_;
  FlightLines lines_;
  double yaw_ = 0;
  bool commanded_ = false;  ///< whether command() was called in this period
  std::string input_, text_;
};

class FlownEstimator final : public FlightEstimator {
 public:
  explicit FlownEstimator(std::shared_ptr<Flown> flown) : flown_(std::move(flown)) {}
  Estimate<double> update(const EstimatorInput& input) override { return flown_->estimate(input); }

 private:
  std::shared_ptr<Flown> flown_;
};

class FlownLaw final : public FlightLaw {
 public:
  explicit FlownLaw(std::shared_ptr<Flown> flown) : flown_(std::move(flown)) {}
  Eigen::VectorXd command(const Estimate<double>& /*estimate*/,
                          const Reference<double>& reference) override {
    return flown_->command(reference);
  }
  void on_realized(const Eigen::VectorXd& /*asked*/, const Eigen::VectorXd& made) override {
    flown_->on_realized(made);
  }

 private:
  std::shared_ptr<Flown> flown_;
};

/// A flight that starts in the air starts with the sensors' true biases, as with the library's
/// filters, because they were estimated before.
ProgramStart start_of(const FlightSetup& setup, const ProgramSettings& settings,
                      const StateVector<double>& x) {
  ProgramStart start;
  start.x = x;
  const bool moving =
      setup.mission.start.in_air || std::holds_alternative<Carried>(setup.mission.kind);
  const Sensors sensors = sensors_of(setup);
  if (!moving || !sensors.gyroscope || !sensors.accelerometer) return start;
  if (settings.mambo) {
    start.gyro_bias = sensors.gyroscope->bias;
    start.force_bias = sensors.accelerometer->bias;
  }
  if (settings.uquad) start.gyro_bias = sensors.gyroscope->bias;
  if (!settings.general) return start;
  const GeneralFilterSettings& filter = *settings.general;
  start.gyro_bias = sensors.gyroscope->bias.cwiseQuotient(filter.gyroscope.scale);
  start.force_bias = sensors.accelerometer->bias.cwiseQuotient(filter.accelerometer.scale);
  if (filter.pressure && sensors.barometer)
    start.pressure_height =
        sensors.barometer->faults.bias(0) / (filter.pressure->slope() * filter.pressure->aid.scale);
  return start;
}

}  // namespace

RecordedFlight record_flight(const FlightSetup& setup, const ProgramSettings& settings,
                             const std::shared_ptr<RunningProgram>& program, bool double_precision,
                             const std::function<bool()>& interrupted) {
  const auto flown = std::make_shared<Flown>(settings, program, double_precision);
  FlightSetup with = setup;
  with.estimator = EstimatorKind::own;
  with.own_estimator = {"flight code", [&](const EstimatorStart& start) {
                          flown->start(start_of(setup, settings, start.state));
                          return std::make_unique<FlownEstimator>(flown);
                        }};
  with.controller =
      OwnController{"flight code", settings.dt, InputKind::command,
                    [&](const Vehicle&) { return std::make_unique<FlownLaw>(flown); }};
  // The program limits its own commands.
  with.allocation = AllocationRule::clipped;
  RecordedFlight result;
  result.flight = fly(with, interrupted);
  result.text = flown->text();
  return result;
}

}  // namespace quadtune::exports
