// SPDX-License-Identifier: Apache-2.0
// Measures the speed of the simulation: the equations of motion alone, for one vehicle and for a
// pack of them, against SciPy and Octave; then whole flights with sensors, estimator and control.
// docs/benchmarks.md describes what is timed.
#include <fmt/format.h>

#include <array>
#include <bit>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include "machine.hpp"
#include "plants/designed_mambo.hpp"
#include "quadtune/simulation/flight.hpp"
#include "quadtune/simulation/packed_body.hpp"
#include "quadtune/simulation/plant.hpp"
#include "temporary_directory.hpp"
#include "wall_time.hpp"

namespace quadtune::bench {
namespace {

constexpr double kStep = 0.005;      // [s]
constexpr double kDuration = 10;     // duration of a flight of the equations of motion alone [s]
constexpr double kTolerance = 1e-9;  // of the peers, relative and absolute

// --- the equations of motion ---

/// Free flight, tilted and rotating; the rotors accelerate to different speeds.
struct FreeFlight {
  RigidBody body;
  bool lagging = false;
  Eigen::VectorXd start;   // 13 numbers, then the rotor speeds if they lag
  Eigen::Vector4d speeds;  // commanded [rad/s]
};

/// The equations of the peers do not include aerodynamic forces on body or rotors.
Vehicle without_airflow(Vehicle vehicle) {
  vehicle.drag = {};
  for (Rotor& rotor : vehicle.rotors) rotor.drag = rotor.inflow = rotor.flapping = 0;
  return vehicle;
}

FreeFlight free_flight(const Vehicle& vehicle, bool lagging) {
  FreeFlight flight{RigidBody(vehicle), lagging, {}, {}};
  double a2 = 0;
  for (int i = 0; i < 4; ++i) a2 += flight.body.rotors[static_cast<std::size_t>(i)].thrust_a2;
  const double hover = std::sqrt(flight.body.mass * flight.body.gravity / a2);
  flight.speeds = Eigen::Vector4d(1, 1.00001, 0.99999, 1.000005) * hover;
  flight.start = Eigen::VectorXd::Zero(lagging ? 17 : 13);
  StateVector<double> x;
  x << 0, 0, -10000, 0.2, -0.1, 0.5, 1, -0.5, 0.2, 0.3, -0.2, 0.4;
  flight.start.head<13>() = quaternion_state(x);
  if (lagging) flight.start.tail<4>().setConstant(0.95 * hover);
  return flight;
}

/// The same flight in all lanes, by the classical Runge-Kutta method. N as in Plant.
template <int Lanes, int N>
class Flown {
 public:
  using T = Pack<Lanes>;

  explicit Flown(const FreeFlight& flight) {
    const auto ground = ground_contact<T>(T(flight.body.mass), T(1), T(0.05));
    std::array<RigidBody, Lanes> bodies;
    bodies.fill(flight.body);
    plant_ = Plant<T, N>(packed_body<Lanes>(bodies), ground);
    for (int i = 0; i < start_.size(); ++i) start_(i) = T(flight.start(i));
    plant_.command(flight.speeds.unaryExpr([](double w) { return T(w); }), start_);
  }

  void fly(double step) {
    x_ = start_;
    const auto steps = static_cast<int>(std::lround(kDuration / step));
    for (int i = 0; i < steps; ++i) x_ = plant_.step(Integrator::runge_kutta_4, x_, step);
  }
  [[nodiscard]] Eigen::VectorXd end() const {
    Eigen::VectorXd result(x_.size());
    for (int i = 0; i < x_.size(); ++i) result(i) = lane(x_(i), 0);
    return result;
  }

 private:
  Plant<T, N> plant_;
  typename Plant<T, N>::State start_, x_;
};

/// Largest difference of position, attitude and velocity at the end [m, 1, m/s].
double difference(const Eigen::VectorXd& a, const Eigen::VectorXd& b) {
  return (a - b).head<10>().cwiseAbs().maxCoeff();
}

struct Line {
  std::string name;
  double seconds = 0;  // of one flight of kDuration, the least of several measurements
  double steps = 0;
  double error = 0;
  double goal = 0;         // steps a second; 0: none
  double goal_slower = 0;  // of a peer: time relative to that of one vehicle; 0: none
};

template <int Lanes, int N>
Line ours(const std::string& name, const FreeFlight& flight, const Eigen::VectorXd& truth,
          double goal) {
  auto flown = std::make_unique<Flown<Lanes, N>>(flight);
  // Many short measurements: the least of them is the time without other load on the machine.
  constexpr int kTimes = 4, kMeasurements = 100;
  const Wall wall = wall_of(
      [&] {
        for (int i = 0; i < kTimes; ++i) flown->fly(kStep);
      },
      kMeasurements);
  return {name, wall.min / kTimes / Lanes, kDuration / kStep, difference(flown->end(), truth), goal,
          0};
}

std::string json_of(const FreeFlight& flight, double max_step) {
  const auto rotors = [&](auto&& number) {
    std::vector<double> all;
    for (std::size_t i = 0; i < 4; ++i) all.push_back(number(flight.body.rotors[i]));
    return fmt::format("[{:.17g}]", fmt::join(all, ", "));
  };
  const RigidBody& body = flight.body;
  return fmt::format(
      R"({{"mass": {:.17g}, "gravity": {:.17g}, "inertia": [{:.17g}, {:.17g}, {:.17g}], "x": {},
"y": {}, "spin": {}, "a2": {}, "a1": {}, "d2": {}, "d1": {}, "rotor_inertia": {}, "lag": {},
"lagging": {}, "start": [{:.17g}], "speeds": [{:.17g}], "duration": {}, "tolerance": {},
"max_step": {}}})",
      body.mass, body.gravity, body.J(0, 0), body.J(1, 1), body.J(2, 2),
      rotors([](const auto& r) { return r.position.x(); }),
      rotors([](const auto& r) { return r.position.y(); }),
      rotors([](const auto& r) { return r.spin; }),
      rotors([](const auto& r) { return r.thrust_a2; }),
      rotors([](const auto& r) { return r.thrust_a1; }),
      rotors([](const auto& r) { return r.torque_d2; }),
      rotors([](const auto& r) { return r.torque_d1; }),
      rotors([](const auto& r) { return r.inertia; }), rotors([](const auto& r) { return r.lag; }),
      flight.lagging, fmt::join(flight.start, ", "), fmt::join(flight.speeds, ", "), kDuration,
      kTolerance, max_step);
}

/// The result of the program of a peer; nothing if it cannot be run.
std::optional<Line> peer(const std::string& name, const std::string& command,
                         const FreeFlight& flight, double max_step, const Eigen::VectorXd& truth) {
  const testing::TemporaryDirectory directory;
  const std::filesystem::path input = directory.write("flight.json", json_of(flight, max_step));
  const std::string whole = fmt::format(fmt::runtime(command), fmt::arg("input", input.string()));
  FILE* pipe = popen((whole + " 2>/dev/null").c_str(), "r");
  if (!pipe) return std::nullopt;
  std::string text;
  std::array<char, 4096> buffer;
  while (std::fgets(buffer.data(), buffer.size(), pipe)) text += buffer.data();
  const bool failed = pclose(pipe) != 0;
  if (failed) return std::nullopt;
  Line line{name, 0, 0, 0, 0, 0};
  std::istringstream words(text);
  std::string evaluations;
  words >> line.seconds >> line.steps >> evaluations;
  Eigen::VectorXd end(flight.start.size());
  for (double& number : end) words >> number;
  if (!words) return std::nullopt;
  line.error = difference(end, truth);
  return line;
}

void print_header(const std::string& title) {
  fmt::print(
      "\n| {} | ns/step | steps/s | {:.0f} s of flight [ms] | error at the end | slower | goal |\n"
      "|---|---:|---:|---:|---:|---:|---|\n",
      title, kDuration);
}

void print(const Line& line, double single) {
  const double rate = line.steps / line.seconds, slower = line.seconds / single;
  const auto verdict = [](bool met) { return met ? "met" : "not met"; };
  std::string goal;
  if (line.goal > 0)
    goal = fmt::format("{:.0f} million: {}", line.goal / 1e6, verdict(rate >= line.goal));
  if (line.goal_slower > 0)
    goal = fmt::format("{:.0f} times: {}", line.goal_slower, verdict(slower >= line.goal_slower));
  fmt::print("| {} | {:.1f} | {} | {:.3g} | {:.1e} | {} | {} |\n", line.name, 1e9 / rate,
             rate > 1e6 ? fmt::format("{:.1f} million", rate / 1e6) : fmt::format("{:.0f}", rate),
             line.seconds * 1e3, line.error,
             line.goal > 0 ? "" : fmt::format("{:.{}f} times", slower, slower < 10 ? 1 : 0), goal);
}

template <int N>
Eigen::VectorXd finely(const FreeFlight& flight) {
  Flown<1, N> fine(flight);
  fine.fly(kStep / 32);
  return fine.end();
}

template <int N>
void race(const char* vehicle, double goal_single) {
  const Vehicle whole = load_vehicle(vehicle);
  const FreeFlight flight = free_flight(without_airflow(whole), N != 0);
  const int states = 13 + N;
  const Eigen::VectorXd truth = finely<N>(flight);
  print_header(fmt::format("equations of motion, {} states ({})", states, vehicle));
  const Line single = ours<1, N>("quadtune, one vehicle", flight, truth, goal_single);
  print(single, single.seconds);
  print(ours<kPackLanes, N>(fmt::format("quadtune, packs of {}", kPackLanes), flight, truth, 40e6),
        single.seconds);
  const std::string python =
      fmt::format("/usr/bin/python3 {}/flight_scipy.py < {{input}}", QUADTUNE_PEERS);
  const std::string octave =
      fmt::format("octave-cli --norc --quiet {}/flight_octave.m {{input}}", QUADTUNE_PEERS);
  bool any = false;
  for (const auto& [name, command] :
       {std::pair("SciPy solve_ivp RK45", python), std::pair("Octave ode45", octave)})
    for (const auto& [words, max_step] :
         {std::pair("steps of 5 ms at most", kStep), std::pair("steps as it likes", kDuration)})
      if (auto line = peer(fmt::format("{}, {}", name, words), command, flight, max_step, truth)) {
        if (max_step == kStep) line->goal_slower = 500;
        print(*line, single.seconds);
        any = true;
      }
  if (has_aerodynamics(whole)) {
    const FreeFlight airy = free_flight(whole, N != 0);
    const Eigen::VectorXd end = finely<N>(airy);
    print(ours<1, N>("quadtune, one vehicle in moving air", airy, end, 0), single.seconds);
    print(ours<kPackLanes, N>(fmt::format("quadtune, packs of {} in moving air", kPackLanes), airy,
                              end, 0),
          single.seconds);
  }
  if (!any) fmt::print("\nneither SciPy nor Octave is installed: no peer was measured\n");
}

// --- whole flights ---

FlightSetup mambo_hover() {
  FlightSetup setup;
  setup.vehicle = load_vehicle("mambo");
  setup.mission = load_mission("hover");
  setup.controller = testing::designed_mambo_cascade();
  calibrate_flow(setup);
  return setup;
}

/// The same with every type of sensor, in turbulent wind, with the filter of 15 states. The law
/// receives only the estimates of that filter.
FlightSetup everything() {
  FlightSetup setup = mambo_hover();
  setup.vehicle.sensors = typical_sensors();
  setup.estimator = EstimatorKind::uquad;
  setup.uquad_filter = uquad_filter_in_si<double>();
  setup.environment.wind.mean = {1, 0, 0};
  setup.environment.wind.turbulence = 1;
  setup.safety.tilt = 10;
  return setup;
}

/// With the general filter, which supports every set of sensors.
FlightSetup general_hover() {
  FlightSetup setup = mambo_hover();
  setup.estimator = EstimatorKind::general;
  return setup;
}

bool same_bytes(const FlightResult& a, const FlightResult& b) {
  const auto bits = [](double x) { return std::bit_cast<std::uint64_t>(x); };
  bool same = a.end == b.end && a.steps == b.steps && a.events.size() == b.events.size();
  for (int i = 0; i < 12; ++i)
    same = same && bits(a.final_state(i)) == bits(b.final_state(i)) &&
           bits(a.final_estimate(i)) == bits(b.final_estimate(i));
  for (std::size_t i = 0; i < kMetrics; ++i)
    same = same && bits(a.metrics.value[i]) == bits(b.metrics.value[i]);
  for (std::size_t c = 0; c < a.log.columns.size(); ++c)
    for (std::size_t k = 0; same && k < a.log.columns[c].values.size(); ++k)
      same = bits(a.log.columns[c].values[k]) == bits(b.log.columns[c].values[k]);
  return same;
}

bool same_bytes(const std::vector<FlightResult>& a, const std::vector<FlightResult>& b) {
  bool same = a.size() == b.size();
  for (std::size_t i = 0; same && i < a.size(); ++i) same = same_bytes(a[i], b[i]);
  return same;
}

/// @param goal       times real time, for one flight; 0: none, and none for the pack
/// @param goal_pack  times real time, for a pack; 0: four times that of one flight
void fly_whole(const std::string& name, const FlightSetup& setup, double goal,
               double goal_pack = 0) {
  FlightResult result;
  // The least of several times is that without other load on the machine.
  const Wall single = wall_of([&] { result = fly(setup); }, 50);
  const double real_time = result.end_time / single.min;
  std::vector<FlightSetup> setups(32, setup);
  for (std::size_t i = 0; i < setups.size(); ++i) setups[i].flight = static_cast<std::uint32_t>(i);
  std::vector<FlightResult> packed;
  const Wall pack = wall_of([&] { packed = fly_all(setups, 1); }, 10);
  std::vector<FlightResult> alone(setups.size());
  double flown = 0;
  for (std::size_t i = 0; i < setups.size(); ++i) alone[i] = fly(setups[i]);
  for (const FlightResult& one : alone) flown += one.end_time;
  const double packed_rate = flown / pack.min;
  const auto verdict = [](double value, double min) {
    return min > 0 ? fmt::format(" (goal {}: {})", min, value >= min ? "met" : "not met") : "";
  };
  const double times = packed_rate / real_time;
  fmt::print("| {} | {} | {:.2f} | {:.0f}{} | {:.2f} | {:.0f}{} | {:.1f} times{} | {} |\n", name,
             to_string(result.end), single.min * 1e3, real_time, verdict(real_time, goal),
             pack.min / static_cast<double>(setups.size()) * 1e3, packed_rate,
             verdict(packed_rate, goal_pack), times,
             verdict(times, goal > 0 && goal_pack == 0 ? 4 : 0),
             same_bytes(packed, alone) ? "same bytes" : "NOT the same");
}

void fly_threads() {
  FlightSetup setup = mambo_hover();
  setup.duration = 10;
  setup.log = true;
  std::vector<FlightSetup> setups(45, setup);
  for (std::size_t i = 0; i < setups.size(); ++i) {
    setups[i].flight = static_cast<std::uint32_t>(i);
    setups[i].environment.wind.turbulence = i % 2 == 0 ? 1 : 0;
  }
  const std::vector<FlightResult> one = fly_all(setups, 1);
  fmt::print("\n{} flights of 10 s with logs:", setups.size());
  for (const std::size_t threads : {2, 4, 8})
    fmt::print(" {} threads {};", threads,
               same_bytes(one, fly_all(setups, threads)) ? "the same bytes as one"
                                                         : "NOT the same bytes as one");
  fmt::print("\n");
}

void fly_everything() {
  fmt::print("{}", describe_machine());
  race<4>("crazyflie", 5e6);
  race<0>("mambo", 12e6);
  fmt::print(
      "\n| whole flight of 100 s, one thread | ended | alone [ms] | times real time | of a pack "
      "[ms] | times real time | pack over alone | a pack's flights and those alone |\n"
      "|---|---|---:|---:|---:|---:|---:|---|\n");
  fly_whole("mambo hovers, its sensors and estimator", mambo_hover(), 3000);
  fly_whole("mambo hovers, its sensors and the general filter", general_hover(), 2000, 8000);
  fly_whole("every sensor, turbulence, filter of 15 states", everything(), 0);
  fly_threads();
}

}  // namespace
}  // namespace quadtune::bench

int main(int argc, char** argv) {
  // ./dev bench passes the options of Google Benchmark to every program; this one does not use it.
  for (const std::string_view option : std::span(argv, static_cast<std::size_t>(argc)).subspan(1))
    if (option.starts_with("--benchmark_filter=") && option.find("flight") == option.npos) return 0;
  try {
    quadtune::bench::fly_everything();
  } catch (const std::exception& error) {
    std::fputs(error.what(), stderr);
    return 1;
  }
}
