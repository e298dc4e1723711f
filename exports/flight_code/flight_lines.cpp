// SPDX-License-Identifier: Apache-2.0
#include "flight_code/flight_lines.hpp"

#include <fmt/format.h>

#include <iterator>
#include <string>

namespace quadtune::exports {

class FlightLines::Line {
 public:
  explicit Line(bool double_precision) : double_(double_precision) {}

  void number(double x) {
    if (!text.empty()) text += ' ';
    if (double_)
      fmt::format_to(std::back_inserter(text), "{}", x);
    else
      fmt::format_to(std::back_inserter(text), "{}", static_cast<float>(x));
  }
  void flag(bool x) { number(x ? 1 : 0); }
  void numbers(const auto& all) {
    for (const double x : all) number(x);
  }
  /// Position, roll, pitch, yaw, body velocity, rates.
  void state(const StateVector<double>& x) { numbers(x); }
  /// `0`, or `1 age value…` for a sample that arrived in this period.
  void sample(const auto& of) {
    flag(of.fresh);
    if (!of.fresh) return;
    number(of.age);
    if constexpr (requires { of.value.size(); })
      numbers(of.value);
    else
      number(of.value);
  }

  std::string text;

 private:
  bool double_;
};

FlightLines::Line FlightLines::line() const { return Line(double_); }

std::string FlightLines::start(const ProgramStart& start) const {
  const StateVector<double>& x = start.x;
  Line to = line();
  to.numbers(x.segment<3>(kPosition));
  to.numbers(x.segment<3>(kVelocity));
  to.numbers(x.segment<3>(kRates));
  to.numbers(x.segment<3>(kAttitude));
  to.numbers(start.gyro_bias);
  to.numbers(start.force_bias);
  to.number(start.pressure_height);
  return "start " + to.text;
}

std::string FlightLines::input(const EstimatorInput& input) const {
  Line to = line();
  if (!sensors_) {
    to.state(input.true_state);
    return to.text;
  }
  to.flag(input.on_ground);
  const SensorFrame<double>& s = input.sensors;
  to.sample(s.specific_force);
  to.sample(s.rates);
  to.sample(s.magnetic_field);
  to.sample(s.pressure);
  to.sample(s.sonar);
  to.sample(s.flow);
  to.sample(s.gps_position);
  to.sample(s.gps_velocity);
  to.sample(s.vision);
  return to.text;
}

std::string FlightLines::reference(const Reference<double>& reference,
                                   const Eigen::VectorXd& idle) const {
  const int phase = reference.phase == FlightPhase::flying     ? 2
                    : reference.phase == FlightPhase::take_off ? 1
                                                               : 0;
  Line to = line();
  to.number(phase);
  to.flag(reference.track_position);
  to.numbers(reference.position);
  to.numbers(reference.velocity);
  to.number(reference.roll);
  to.number(reference.pitch);
  to.number(reference.yaw);
  to.numbers(idle);
  return to.text;
}

std::string FlightLines::output(const ProgramOutput& output) const {
  Line to = line();
  to.numbers(output.commands);
  to.state(output.estimate);
  to.flag(output.limited);
  to.flag(output.finite);
  return to.text;
}

}  // namespace quadtune::exports
