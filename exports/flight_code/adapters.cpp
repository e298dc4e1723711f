// SPDX-License-Identifier: Apache-2.0
#include "flight_code/adapters.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <numeric>
#include <optional>

#include "flight_code/source_text.hpp"
#include "quadtune/design/flight_code_words.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/internal/joined.hpp"

namespace quadtune::exports {
namespace {

/// The place of a motor, seen from above: signs of x (forward) and y (right), and its spin.
struct MotorPlace {
  int x, y;
  std::optional<Spin> spin;  ///< none: either
};

// Crazyflie: M1 front right, M2 back right, M3 back left, M4 front left.
constexpr std::array<MotorPlace, 4> kCrazyflieMotors = {{{1, 1, Spin::counter_clockwise},
                                                         {-1, 1, Spin::clockwise},
                                                         {-1, -1, Spin::counter_clockwise},
                                                         {1, -1, Spin::clockwise}}};
// Mambo: 1 front left, 2 front right, 3 back right, 4 back left.
constexpr std::array<MotorPlace, 4> kMamboMotors = {{{1, -1, Spin::clockwise},
                                                     {1, 1, Spin::counter_clockwise},
                                                     {-1, 1, Spin::clockwise},
                                                     {-1, -1, Spin::counter_clockwise}}};
// PX4, quadrotor X: 1 front right, 2 back left, 3 front left, 4 back right. The airframe's
// parameters define the spins, which are arbitrary.
constexpr std::array<MotorPlace, 4> kPx4Motors = {
    {{1, 1, {}}, {-1, -1, {}}, {1, -1, {}}, {-1, 1, {}}}};

/// The rotor in each motor's place; empty unless each place has exactly one.
std::vector<std::size_t> by_place(const std::array<MotorPlace, 4>& motors, const Vehicle& vehicle) {
  std::vector<std::size_t> rotors;
  if (vehicle.rotors.size() != motors.size()) return {};
  for (const MotorPlace& motor : motors) {
    const auto is_there = [&](const Rotor& rotor) {
      return rotor.position.x() * motor.x > 0 && rotor.position.y() * motor.y > 0 &&
             (!motor.spin || rotor.spin == *motor.spin);
    };
    if (std::count_if(vehicle.rotors.begin(), vehicle.rotors.end(), is_there) != 1) return {};
    const auto at = std::find_if(vehicle.rotors.begin(), vehicle.rotors.end(), is_there);
    rotors.push_back(static_cast<std::size_t>(at - vehicle.rotors.begin()));
  }
  return rotors;
}

/// For each motor of the firmware, the index from 0 of the vehicle's rotor in its place: "2, 0, 3,
/// 1".
/// @throws InvalidInput  if the vehicle's rotors do not match the firmware's motors
std::string rotors_of_motors(const std::string& adapter, const Vehicle& vehicle) {
  const auto& motors = adapter == "crazyflie" ? kCrazyflieMotors
                       : adapter == "mambo"   ? kMamboMotors
                                              : kPx4Motors;
  std::vector<std::size_t> rotors = by_place(motors, vehicle);
  if (rotors.empty() && adapter != "px4")
    throw InvalidInput(
        "adapter " + adapter,
        fmt::format("the rotors of '{}' are not those of its firmware, expected four in X: front "
                    "right counter-clockwise, back right clockwise, back left counter-clockwise, "
                    "front left clockwise",
                    vehicle.name));
  if (rotors.empty()) {  // a custom airframe: numbered as in the vehicle file
    rotors.resize(vehicle.rotors.size());
    std::iota(rotors.begin(), rotors.end(), 0);
  }
  return fmt::format("{}", fmt::join(rotors, ", "));
}

/// Converts a name such as "my_racer" to "MyRacer".
std::string class_name(const std::string& name) {
  std::string result;
  bool capital = true;
  for (const char c : name) {
    if (c != '_')
      result += capital ? static_cast<char>(std::toupper(static_cast<unsigned char>(c))) : c;
    capital = c == '_';
  }
  return result;
}

}  // namespace

std::vector<AdapterFile> adapter_files(const std::string& adapter) {
  if (adapter == "main")
    return {{"adapters/main.c", "adapter_main.c"},
            {"adapters/board.h", "adapter_board.h"},
            {"adapters/board.c", "adapter_board.c"}};
  if (adapter == "mambo")
    return {{"adapters/mambo.h", "adapter_mambo.h"}, {"adapters/mambo.c", "adapter_mambo.c"}};
  if (adapter == "crazyflie") return {{"adapters/crazyflie.c", "adapter_crazyflie.c"}};
  if (adapter == "px4")
    return {{"adapters/px4.cpp", "adapter_px4.cpp"},
            {"adapters/px4_CMakeLists.txt", "CMakeLists.txt"},
            {"adapters/px4_Kconfig", "Kconfig"}};
  return {};
}

bool adapter_estimates(const std::string& adapter) {
  return adapter == "mambo" || adapter == "crazyflie" || adapter == "px4";
}

std::string adapter_text(const std::string& from, const ExportContent& content,
                         const std::string& name, double dt) {
  std::string text = source_text(from);
  const std::string& adapter = content.flight_code.adapter;
  if (adapter != "main")
    text = replaced(text, "QT_ROTORS_OF_MOTORS", rotors_of_motors(adapter, content.vehicle));
  text = replaced(text, "QT_STEPS_PER_PERIOD", fmt::format("{:.0f}u", dt * 1000));
  return replaced(text, "QtModule", class_name(name) + "Module");
}

void require_adapter(const ExportContent& content, double dt) {
  const std::string& adapter = content.flight_code.adapter;
  if (adapter.empty()) return;
  require_flight_code_adapter(adapter, "flight code");
  const std::string where = "adapter " + adapter;
  if (adapter != "main" && content.flight_code.double_precision)
    throw InvalidInput(where,
                       "the program is in double precision, expected float, because the structures "
                       "of the board are");
  if (adapter == "crazyflie") {
    constexpr std::array<double, 3> kPeriods = {0.002, 0.004, 0.01};
    if (std::none_of(kPeriods.begin(), kPeriods.end(),
                     [&](double period) { return std::abs(dt - period) < 1e-9; }))
      throw InvalidInput(where,
                         fmt::format("the law's period is {} s, expected 0.002, 0.004 or "
                                     "0.01 s, because the firmware runs loops at 500, 250 or "
                                     "100 Hz, but not at 200 Hz",
                                     dt));
  }
  if (adapter != "main") (void)rotors_of_motors(adapter, content.vehicle);
  if (adapter == "px4" && content.vehicle.rotors.size() > 12)
    throw InvalidInput(where, fmt::format("the vehicle has {} rotors, expected at most 12",
                                          content.vehicle.rotors.size()));
}

std::string adapter_page(const std::string& adapter) {
  if (adapter == "main")
    return "## On a computer with POSIX clocks\n\n"
           "[adapter_main.c](adapter_main.c) calls the program in each control period. "
           "[adapter_board.c](adapter_board.c) is a "
           "vehicle at rest: replace it\nby your sensors, pilot and motors "
           "([adapter_board.h](adapter_board.h)).\n\n"
           "    cc -std=c99 -ffp-contract=off -O2 -o flight adapter_main.c adapter_board.c "
           "@SOURCES@ -lm\n\n";
  if (adapter == "mambo")
    return "## In the Mambo's model project\n\n"
           "[adapter_mambo.c](adapter_mambo.c) has the functions and global structures of a model "
           "`flightController`, whose estimate comes\nfrom the model project. Compare "
           "[adapter_mambo.h](adapter_mambo.h) with the header that your release generates: which "
           "axes\n`dx`, `dy`, "
           "`dz` are in decides whether `-DMAMBO_BODY_VELOCITY` is right.\n\n"
           "    arm-linux-gnueabihf-gcc -std=c99 -ffp-contract=off -O2 -mcpu=cortex-a9 -fPIC "
           "-shared -o flightController.so \\\n        adapter_mambo.c @SOURCES@ -lm\n\n";
  if (adapter == "crazyflie")
    return "## In the firmware of the Crazyflie\n\n"
           "[adapter_crazyflie.c](adapter_crazyflie.c) is an out-of-tree controller; the estimate "
           "is the firmware's. In a folder of an\napp, with the program's files in `src/`:\n\n"
           "    app-config:  CONFIG_APP_ENABLE=y\n"
           "                 CONFIG_APP_PRIORITY=1\n"
           "                 CONFIG_APP_STACKSIZE=350\n"
           "                 CONFIG_CONTROLLER_OOT=y\n"
           "    Kbuild:      obj-y += src/\n"
           "    src/Kbuild:  ccflags-y += -ffp-contract=off\n"
           "                 obj-y += adapter_crazyflie.o @OBJECTS_ON_BOARD@\n\n"
           "and a Makefile that sets `CRAZYFLIE_BASE` and `OOT_CONFIG` and includes "
           "`$(CRAZYFLIE_BASE)/tools/make/oot.mk`.\nThe vehicle's file should not give a motor "
           "more "
           "thrust than the firmware's `THRUST_MAX`. Fly it tethered first: one\nmotor in a wrong "
           "place or sense turns the vehicle over at once.\n\n";
  if (adapter == "px4")
    return "## In PX4\n\n"
           "[adapter_px4.cpp](adapter_px4.cpp) is a module for `src/modules`, with "
           "[CMakeLists.txt](CMakeLists.txt) and [Kconfig](Kconfig);\n`@NAME@ start` starts it. "
           "The "
           "estimate is PX4's. Its head says what must be stopped and set before.\nThe motors of a "
           "quadrotor in X are numbered as PX4 does; those of another frame as the vehicle's file: "
           "compare them with your\nairframe, without propellers.\n\n";
  return "";
}

}  // namespace quadtune::exports
