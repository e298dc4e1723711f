// SPDX-License-Identifier: Apache-2.0
#include "sample_flight.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <utility>
#include <vector>

#include "numbers.hpp"

namespace quadtune::testing {
namespace {

using Eigen::Vector3d;
using report::SeriesStyle;
using std::numbers::pi;

using testing::kNaN;
constexpr double kGravity = 9.81;    // [m/s²]
constexpr double kHoverSpeed = 316;  // of a rotor [rad/s]
constexpr double kDegrees = 180 / pi;

/// 0 before a, 1 after b, smooth up to the second derivative in between.
double smooth_step(double t, double a, double b) {
  const double s = std::clamp((t - a) / (b - a), 0.0, 1.0);
  return s * s * s * (10 + s * (-15 + 6 * s));
}

/// The set point of the position [m], world north-east-down.
Vector3d wanted(double t) {
  const double go = smooth_step(t, 4, 9);
  const double phase = 0.75 * std::max(t - 4, 0.0);
  return {go * 4.5 * std::sin(phase), go * 2.6 * std::sin(2 * phase),
          -2.5 * smooth_step(t, 0.5, 4) - go * 0.6 * std::sin(phase / 2)};
}

/// A temporary displacement to the side [m].
Vector3d gust(double t) {
  const double strength = std::exp(-0.5 * std::pow((t - 21) / 0.8, 2));
  return Vector3d(0.25, 0.55, -0.18) * strength;
}

Vector3d flown(double t) {
  return wanted(t - 0.12) + gust(t) +
         0.03 * Vector3d(std::sin(1.7 * t), std::sin(2.3 * t + 1), 0.5 * std::sin(3.1 * t));
}

/// Second difference: the acceleration [m/s²].
Vector3d acceleration(double t) {
  constexpr double kStep = 0.02;
  return (flown(t + kStep) - 2 * flown(t) + flown(t - kStep)) / (kStep * kStep);
}

struct SampleAttitude {
  double roll, pitch, yaw;  // [rad]
};

/// The attitude whose thrust gives the acceleration, for a given yaw.
SampleAttitude attitude(double t) {
  const double yaw = 0.6 * std::sin(0.2 * t);
  const Vector3d up = -(acceleration(t) - Vector3d(0, 0, kGravity));  // along body +z, down
  const double c = std::cos(yaw), s = std::sin(yaw);
  const double forward = c * up.x() + s * up.y();
  const double right = -s * up.x() + c * up.y();
  return {std::atan2(-right, std::hypot(forward, up.z())), std::atan2(forward, up.z()), yaw};
}

/// Columns that are filled row by row.
class Recorder {
 public:
  explicit Recorder(LogTable& log) : log_(log) {}
  void add(const std::string& name, const std::string& unit, double value) {
    if (next_ == log_.columns.size()) log_.columns.push_back({name, unit, {}});
    log_.columns[next_++].values.push_back(value);
  }
  void end_row() { next_ = 0; }

 private:
  LogTable& log_;
  std::size_t next_ = 0;
};

std::vector<report::ReportRotor> rotors_of_x_layout(double arm) {
  const double d = arm / std::numbers::sqrt2;
  return {{{d, -d, 0}, 1, "rotor.1"},
          {{d, d, 0}, -1, "rotor.2"},
          {{-d, d, 0}, 1, "rotor.3"},
          {{-d, -d, 0}, -1, "rotor.4"}};
}

void add_plots(report::FlightReport& report) {
  const auto value = SeriesStyle::value;
  const auto reference = SeriesStyle::reference;
  const auto estimate = SeriesStyle::estimate;
  const auto measurement = SeriesStyle::measurement;
  report.plots = {
      {"North",
       "m",
       {{"flown", "x.px", value},
        {"reference", "ref.px", reference},
        {"estimate", "estimate.px", estimate},
        {"position sensor", "sensor.px", measurement}}},
      {"East",
       "m",
       {{"flown", "x.py", value},
        {"reference", "ref.py", reference},
        {"estimate", "estimate.py", estimate},
        {"position sensor", "sensor.py", measurement}}},
      {"Down",
       "m",
       {{"flown", "x.pz", value},
        {"reference", "ref.pz", reference},
        {"estimate", "estimate.pz", estimate}}},
      {"Off reference", "m", {{"distance", "error.position", value}}},
      {"Attitude",
       "deg",
       {{"roll", "x.roll", value},
        {"pitch", "x.pitch", value},
        {"yaw", "x.yaw", value},
        {"roll, estimate", "estimate.roll", estimate},
        {"pitch, estimate", "estimate.pitch", estimate}},
       kDegrees},
      {"Velocity",
       "m/s",
       {{"north", "x.vn", value}, {"east", "x.ve", value}, {"down", "x.vd", value}}},
      {"Rotor speeds",
       "rad/s",
       {{"1", "rotor.1", value},
        {"2", "rotor.2", value},
        {"3", "rotor.3", value},
        {"4", "rotor.4", value}}},
      {"Wind", "m/s", {{"north", "wind.n", value}, {"east", "wind.e", value}}},
  };
}

void add_tables(report::FlightReport& report) {
  report.metrics = {
      {"position_rms", "position error, rms", 0.143, "m", 0.25, false, true},
      {"position_peak", "position error, largest", 0.671, "m", 0.8, false, true},
      {"height_rms", "height error, rms", 0.0521, "m", 0.1, false, true},
      {"yaw_rms", "yaw error, rms", 1.92, "deg", 3, false, true},
      {"tilt_peak", "tilt, largest", 31.4, "deg", 35, false, true},
      {"rotor_margin", "rotor speed left, least", 8.3, "%", 10, true, false},
      {"saturated", "time at a rotor's limit", 0.0, "s", 0.1, false, true},
      {"energy", "energy of the rotors", 5312, "J", std::nullopt, false, true},
      {"estimate_rms", "position estimate, rms error", 0.0385, "m", 0.1, false, true},
      {"settling", "settling after the gust", 2.34, "s", 4, false, true},
  };
  Eigen::MatrixXd rates(3, 4);
  rates << 0.01078, 0.02777, -0.001508, 0.12, 0.01322, 0.03391, -0.001714, 0.12, 0.004025, 0.004904,
      0, 0.05;
  report.gains = {
      {"Attitude cascade", {"roll", "pitch", "yaw"}, {"Kp", "Ki", "Kd", "limit"}, rates}};
  Eigen::MatrixXd K(4, 12);
  for (Eigen::Index i = 0; i < 4; ++i)
    for (Eigen::Index j = 0; j < 12; ++j)
      K(i, j) = (i + j) % 3 == 0 ? 0 : 150 * std::sin(1.3 * static_cast<double>(i * 12 + j));
  report.gains.push_back({"K of u = u0 + K (x_sp \xE2\x88\x92 x)",
                          {"w1", "w2", "w3", "w4"},
                          {"px", "py", "pz", "roll", "pitch", "yaw", "u", "v", "w", "p", "q", "r"},
                          K});
  for (const auto& [loop, gain, phase, delay, disk] :
       {std::tuple("roll", 23.8, 70.7, 47.2, 1.41), std::tuple("pitch", 23.1, 66.7, 50.3, 1.38),
        std::tuple("yaw", 31.4, 69.1, 109.6, 1.52),
        std::tuple("altitude", std::numeric_limits<double>::infinity(), 70.0, 195.7, 1.44)})
    report.margins.push_back({loop,
                              {{"gain margin", "dB", gain},
                               {"phase margin", "deg", phase},
                               {"delay margin", "ms", delay},
                               {"disk alpha", "1", disk}}});
}

}  // namespace

report::FlightReport sample_flight(double duration, double rate) {
  report::FlightReport report;
  report.title = "Figure of eight in a gust";
  report.verdict = report::ReportVerdict::fail;
  report.reasons = {"rotor speed left, least: 8.3 %, expected at least 10 %"};
  report.command = "test_report --gtest_filter=Browser.TakesPicturesWideAndNarrow";
  report.version = "0.1.0";
  report.seed = "42";
  report.log.about = {
      {"vehicle", "synthetic, for the tests: 1.7 kg, X layout, arm 0.25 m"},
      {"mission", "take off, figure of eight at 2.5 m, 9 m long, 8.4 s a lap"},
      {"controller", "LQR with integrals of position and yaw, every 10 ms"},
      {"estimator", "extended Kalman filter, every 5 ms"},
      {"sensors", "rates and accelerations 200 Hz, position 5 Hz, delay 80 ms"},
      {"wind", "3 m/s from the west, gust of 6 m/s at 21 s"},
      {"duration", "40 s, step 5 ms"},
  };
  report.log.events = {{0.5, "take-off", "the rotors carry the vehicle"},
                       {4, "lap", "the figure of eight begins"},
                       {19.8, "gust", "6 m/s from the south-west for 2.4 s"},
                       {22.1, "limit", "rotor 2 within 10 % of its largest speed"}};
  std::mt19937 random(1);
  std::normal_distribution<double> noise;
  Recorder record(report.log);
  const auto rows = static_cast<int>(duration * rate);
  const int slow = std::max(1, static_cast<int>(rate / 5));
  for (int i = 0; i <= rows; ++i) {
    const double t = i / rate;
    const Vector3d p = flown(t), ref = wanted(t), v = (flown(t + 0.01) - flown(t - 0.01)) / 0.02;
    const SampleAttitude a = attitude(t);
    const Vector3d drift(0.05 * std::sin(0.4 * t), 0.05 * std::sin(0.31 * t + 2),
                         0.03 * std::sin(0.53 * t));
    record.add("t", "s", t);
    const char* axes[] = {"px", "py", "pz"};
    for (int k = 0; k < 3; ++k) record.add(std::string("x.") + axes[k], "m", p(k));
    for (int k = 0; k < 3; ++k) record.add(std::string("ref.") + axes[k], "m", ref(k));
    for (int k = 0; k < 3; ++k)
      record.add(std::string("estimate.") + axes[k], "m", p(k) + drift(k));
    for (int k = 0; k < 2; ++k)
      record.add(std::string("sensor.") + axes[k], "m",
                 i % slow == 0 ? p(k) + 0.08 * noise(random) : kNaN);
    record.add("error.position", "m", (p - ref).norm());
    record.add("x.roll", "rad", a.roll);
    record.add("x.pitch", "rad", a.pitch);
    record.add("x.yaw", "rad", a.yaw);
    record.add("estimate.roll", "rad", a.roll + 0.01 * std::sin(t));
    record.add("estimate.pitch", "rad", a.pitch + 0.012 * std::sin(0.8 * t));
    record.add("x.vn", "m/s", v.x());
    record.add("x.ve", "m/s", v.y());
    record.add("x.vd", "m/s", v.z());
    const double thrust = (acceleration(t) - Vector3d(0, 0, kGravity)).norm() / kGravity;
    for (int k = 1; k <= 4; ++k)
      record.add(
          "rotor." + std::to_string(k), "rad/s",
          kHoverSpeed * std::sqrt(thrust) + 1.5 * noise(random) + 9 * std::sin(0.9 * t + 1.6 * k));
    record.add("wind.n", "m/s", 0.4 * std::sin(0.7 * t) + 4 * gust(t).x() + 0.15 * noise(random));
    record.add("wind.e", "m/s",
               3 + 0.5 * std::sin(0.9 * t) + 8 * gust(t).y() + 0.15 * noise(random));
    record.end_row();
  }
  report::ReportReplay replay;
  replay.position = {"x.px", "x.py", "x.pz"};
  replay.attitude = {"x.roll", "x.pitch", "x.yaw"};
  replay.reference = {{"ref.px", "ref.py", "ref.pz"}};
  replay.estimate = {{"estimate.px", "estimate.py", "estimate.pz"}};
  replay.rotors = rotors_of_x_layout(0.25);
  replay.arm = 0.25;
  replay.rotor_radius = 0.13;
  report.replay = std::move(replay);
  add_plots(report);
  add_tables(report);
  return report;
}

report::FlightReport still_flight(double roll, double pitch, double yaw) {
  report::FlightReport report;
  report.title = "Still";
  report.log.columns = {{"t", "s", {0, 1}},
                        {"n", "m", {0, 0}},
                        {"e", "m", {0, 0}},
                        {"d", "m", {-1, -1}},
                        {"roll", "rad", {roll, roll}},
                        {"pitch", "rad", {pitch, pitch}},
                        {"yaw", "rad", {yaw, yaw}}};
  report::ReportReplay replay;
  replay.position = {"n", "e", "d"};
  replay.attitude = {"roll", "pitch", "yaw"};
  replay.rotors = rotors_of_x_layout(0.25);
  for (report::ReportRotor& rotor : replay.rotors) rotor.speed_column.clear();
  report.replay = std::move(replay);
  return report;
}

}  // namespace quadtune::testing
