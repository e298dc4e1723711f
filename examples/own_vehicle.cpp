// SPDX-License-Identifier: Apache-2.0
/// From a vehicle to gains that have flown: own_vehicle [NAME|FILE]
/// Exit status: 0 if the hover passes, 1 if not, 2 and one line for any error.
#include <cmath>
#include <exception>
#include <iostream>
#include <numbers>
#include <quadtune/model/vehicle.hpp>
#include <quadtune/workbench/design/design.hpp>
#include <string>

namespace {

void print_margins(const quadtune::MarginsReport& margins) {
  for (std::size_t i = 0; i < margins.loops.size(); ++i) {
    const quadtune::LoopMargins& loop = margins.loops[i];
    std::cout << "  " << margins.names[i] << ": gain margin " << 20 * std::log10(loop.gain_margin)
              << " dB, phase margin " << loop.phase_margin * 180 / std::numbers::pi
              << " deg, delay margin " << 1e3 * loop.delay_margin << " ms\n";
  }
  for (const std::string& warning : quadtune::margin_warnings(margins))
    std::cout << "  warning: " << warning << '\n';
}

/// The verdict on a flight, the choices made for it and, if it failed, the reasons.
void print_flight(const quadtune::FlownFlight& flight) {
  std::cout << flight.plan.setup.mission.name << ", " << flight.plan.sensors
            << " sensors, estimator " << flight.plan.estimator << ": "
            << (flight.passed ? "pass" : "fail") << '\n';
  for (const std::string& note : flight.plan.notes) std::cout << "  note: " << note << '\n';
  for (const std::string& why : quadtune::reasons(flight)) std::cout << "  " << why << '\n';
}

}  // namespace

int main(int count, char** words) {
  try {
    const quadtune::Vehicle vehicle = quadtune::load_vehicle(count > 1 ? words[1] : "crazyflie");
    quadtune::DesignRequirements requirements;
    requirements.cascade = quadtune::usual_cascade(vehicle);
    requirements.missions = {{.mission = "hover", .sensors = "real"}};
    const quadtune::DesignOutcome outcome = quadtune::design(vehicle, requirements);
    std::cout << vehicle.name << ": largest |z| "
              << outcome.cascade->cascade.poles.cwiseAbs().maxCoeff() << '\n';
    print_margins(outcome.cascade->margins);
    for (const quadtune::FlownFlight& flight : outcome.flights) print_flight(flight);
    return quadtune::missions_passed(outcome) ? 0 : 1;
  } catch (const std::exception& error) {
    std::cerr << "own_vehicle: " << error.what() << '\n';
    return 2;
  }
}
