// SPDX-License-Identifier: Apache-2.0
/// Vehicles and their linear models.
#include <fmt/format.h>

#include "plants.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/internal/json.hpp"
#include "quadtune/model/plausibility.hpp"
#include "quadtune/workbench/vehicle/vehicle_check.hpp"
#include "report/loops/loops.hpp"
#include "report/vehicles/vehicle_report.hpp"
#include "support/results.hpp"
#include "support/topics.hpp"

namespace quadtune::python {
namespace {

namespace py = pybind11;
using namespace py::literals;

void add_vehicles(py::module_& module) {
  py::class_<Rotor>(module, "Rotor", "Motor and propeller.")
      .def_readonly("position", &Rotor::position, "Hub from the centre of mass, body axes [m].")
      .def_property_readonly(
          "spin", [](const Rotor& rotor) { return to_string(rotor.spin); }, "\"cw\" or \"ccw\".")
      .def_readonly("thrust_a2", &Rotor::thrust_a2, "Thrust per squared speed [N s2/rad2].")
      .def_readonly("thrust_a1", &Rotor::thrust_a1, "Thrust per speed [N s/rad].")
      .def_readonly("torque_d2", &Rotor::torque_d2, "Drag torque per squared speed [N m s2/rad2].")
      .def_readonly("torque_d1", &Rotor::torque_d1, "Drag torque per speed [N m s/rad].")
      .def_readonly("inertia", &Rotor::inertia, "Of the turning parts [kg m2].")
      .def_readonly("lag", &Rotor::lag, "Time constant of the speed [s].");
  py::class_<Vehicle> vehicle(module, "Vehicle", "The numbers of one multirotor, in SI units.");
  vehicle.def_readonly("name", &Vehicle::name, "Name.")
      .def_readonly("description", &Vehicle::description, "One sentence.")
      .def_readonly("source", &Vehicle::source, "Where the numbers come from.")
      .def_readonly("mass", &Vehicle::mass, "Mass [kg].")
      .def_readonly("inertia", &Vehicle::inertia, "(3, 3) about the centre of mass [kg m2].")
      .def_readonly("rotors", &Vehicle::rotors, "The rotors, numbered from 1 in messages.")
      .def_readonly("gravity", &Vehicle::gravity, "Acceleration of gravity [m/s2].")
      .def_readonly("air_density", &Vehicle::air_density, "At which the rotor curves hold [kg/m3].")
      .def_property_readonly(
          "file", [](const Vehicle& self) { return self.file.string(); }, "It was read from.")
      .def("__repr__", [](const Vehicle& self) {
        return fmt::format("<Vehicle {}, {} kg, {} rotors>", self.name, self.mass,
                           self.rotors.size());
      });
  add_report(
      vehicle, "quadtune vehicle show V", [](const Vehicle& self) { return report::to_json(self); },
      [](const Vehicle& self) { return report::to_text(self); });
  module.def("vehicles", &built_in_vehicles, "Names of the built-in vehicles.");
  module.def(
      "vehicle", [](const VehicleWord& vehicle_word) { return load_vehicle(vehicle_word.text); },
      "vehicle"_a,
      "Load a built-in vehicle by name, or a vehicle file (TOML).\n\n"
      "Raises InvalidInput with \"file:line\" for an unknown name or a wrong file, FileError\n"
      "if it cannot be read.");
}

void add_trim(py::module_& module) {
  py::class_<TrimResult>(module, "Trim", "A steady flight, or the reason why there is none.")
      .def_property_readonly(
          "status", [](const TrimResult& trim) { return to_string(trim.status); },
          "\"solved\", \"not enough thrust\", ...")
      .def_property_readonly("solved", &TrimResult::solved, "Whether status is \"solved\".")
      .def_readonly("x", &TrimResult::x, "(12) state in the words of ned; NaN unless solved.")
      .def_readonly("u", &TrimResult::u, "Rotor speeds [rad/s]; NaN unless solved.")
      .def_readonly("thrust", &TrimResult::thrust, "Rotor thrusts [N]; NaN unless solved.")
      .def_readonly("residual", &TrimResult::residual, "Relative acceleration that remains.")
      .def_readonly("tilt", &TrimResult::tilt, "From the vertical [rad].")
      .def_readonly("thrust_to_weight", &TrimResult::thrust_to_weight, "Of all rotors at most.")
      .def_readonly("culprit", &TrimResult::culprit, "What is missing; empty when solved.");
  py::class_<VehicleCheck>(module, "VehicleCheck", "A vehicle that can hover.")
      .def_readonly("vehicle", &VehicleCheck::vehicle, "The vehicle.")
      .def_readonly("hover", &VehicleCheck::hover, "Its hover.")
      .def_property_readonly(
          "warnings",
          [](const VehicleCheck& check) {
            std::vector<std::string> lines;
            for (const Implausibility& figure : check.warnings) lines.push_back(to_string(figure));
            return lines;
          },
          "Figures outside their plausible ranges.");
  module.def(
      "check_vehicle", [](const VehicleWord& vehicle) { return check_vehicle(vehicle.text); },
      "vehicle"_a,
      "Check that a vehicle can hover and that its rotors command thrust and all torques.\n\n"
      "vehicle: a built-in name, a file or a Vehicle. Raises NoSolution with the cause if it\n"
      "cannot, InvalidInput with \"file:line\" for a wrong file, FileError if it cannot be\n"
      "read.");
}

void add_linearize(py::module_& module) {
  py::class_<Linearization> model(
      module, "Linearization", "x' = A (x - x0) + B (u - u0) about a steady flight, with names.");
  model.def_readonly("trim", &Linearization::trim, "The steady flight.")
      .def_property_readonly(
          "A", [](const Linearization& self) -> const Eigen::MatrixXd& { return self.plant.A; },
          py::return_value_policy::reference_internal, "(nx, nx) dynamics.")
      .def_property_readonly(
          "B", [](const Linearization& self) -> const Eigen::MatrixXd& { return self.plant.B; },
          py::return_value_policy::reference_internal, "(nx, nu) effect of the inputs.")
      .def_readonly("x0", &Linearization::x0, "(nx) state of the trim.")
      .def_readonly("x0_rate", &Linearization::x0_rate, "(nx) its derivative in the trim.")
      .def_readonly("u0", &Linearization::u0, "(nu) input of the trim.")
      .def_property_readonly(
          "states", [](const Linearization& self) { return names_of(self.plant.states); },
          "Names of the states.")
      .def_property_readonly(
          "state_units", [](const Linearization& self) { return units_of(self.plant.states); },
          "Their units.")
      .def_property_readonly(
          "inputs", [](const Linearization& self) { return names_of(self.plant.inputs); },
          "Names of the inputs.")
      .def_property_readonly(
          "input_units", [](const Linearization& self) { return units_of(self.plant.inputs); },
          "Their units.")
      .def_readonly("convention", &Linearization::convention, "Name of the convention.")
      .def_readonly("notes", &Linearization::notes, "What a reader should know.");
  add_report(
      model, "quadtune linearize V",
      [](const Linearization& self) { return report::to_json(self); },
      [](const Linearization& self) { return report::to_text(self); });
  module.def(
      "linearize",
      [](const VehicleWord& vehicle, const std::string& at, double speed, double climb,
         double radius, double yaw_rate, double yaw, const std::string& convention,
         const std::string& inputs, const Names& states) {
        const PlantWords words{vehicle.text, at,  speed,      climb,  radius,
                               yaw_rate,     yaw, convention, inputs, states.joined()};
        const py::gil_scoped_release without_gil;
        return make_plant(words).model;
      },
      "vehicle"_a, py::kw_only(), "at"_a = "hover", "speed"_a = 0.0, "climb"_a = 0.0,
      "radius"_a = 0.0, "yaw_rate"_a = 0.0, "yaw"_a = 0.0, "convention"_a = "ned",
      "inputs"_a = "rotor-speed", "states"_a = "full",
      "Trim a vehicle and compute its linear model.\n\n"
      "at: \"hover\", \"line\", \"circle\" or \"spin\". speed >= 0 of line and circle [m/s],\n"
      "climb of line, circle and spin, upward [m/s], radius of the circle, not 0 [m], yaw_rate\n"
      "of the spin, not 0 [rad/s], yaw: heading from north, clockwise from above [rad]; a\n"
      "negative radius or yaw_rate turns to the left. convention: \"ned\", \"uquad\",\n"
      "\"mambo\" or a file. inputs: \"rotor-speed\", \"rotor-thrust\", \"wrench\" or\n"
      "\"command\". states: \"full\", \"no-position\" or names. Raises NoSolution if there is\n"
      "no such trim, InvalidInput for a wrong argument, FileError if a file cannot be read.");
}

}  // namespace

void add_models(py::module_& module) {
  add_vehicles(module);
  add_trim(module);
  add_linearize(module);
}

}  // namespace quadtune::python
