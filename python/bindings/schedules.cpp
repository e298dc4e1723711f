// SPDX-License-Identifier: Apache-2.0
/// Gain schedules.
#include <fmt/format.h>

#include "plants.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/exports/schedule_table.hpp"
#include "quadtune/workbench/schedule/schedule_axes.hpp"
#include "quadtune/workbench/schedule/schedule_report.hpp"
#include "report/gains/gains.hpp"
#include "support/arguments.hpp"
#include "support/interrupts.hpp"
#include "support/results.hpp"
#include "support/topics.hpp"

namespace quadtune::python {
namespace {

namespace py = pybind11;
using namespace py::literals;
using Array = py::array_t<double>;

std::vector<ScheduleAxis> axes_of(const Grid& grid) {
  std::vector<ScheduleAxis> axes;
  try {
    if (grid.axes.empty()) axes = schedule_axes(grid.text, "grid");
  } catch (const OptionError& error) {
    throw OptionError("grid", error.what());
  }
  for (const auto& [quantity, values] : grid.axes)
    axes.push_back({schedule_quantity(quantity, "grid"), {values.begin(), values.end()}});
  (void)checked_grid_size(axes, "grid");
  return axes;
}

ScheduleReport make_schedule(const PlantWords& plant, const Grid& grid, const LqrWords& words,
                             std::size_t threads) {
  const std::vector<ScheduleAxis> axes = axes_of(grid);
  const LinearizeOptions options = linearize_options(plant);
  return long_call([&](const Stop& stop) {
    const Vehicle vehicle = load_vehicle(plant.vehicle);
    const ContinuousLti model = Linearizer(vehicle, options).unsolved().plant;
    const LqrDesign design = lqr_design(words, plant, model.states, model.inputs);
    return schedule_report(vehicle, axes, design, {plant.yaw, threads, stop}, plant.vehicle);
  });
}

/// One matrix (rows × columns) or vector of each grid point, in the memory of the schedule: shape
/// (axis 1, axis 2, …, rows, columns).
Array on_grid(py::handle owner, const Eigen::MatrixXd& stored, Eigen::Index rows,
              std::optional<Eigen::Index> columns = std::nullopt) {
  const auto& axes = owner.cast<const ScheduleReport&>().schedule.axes;
  constexpr py::ssize_t kSize = sizeof(double);
  std::vector<py::ssize_t> shape, strides;
  py::ssize_t stride = kSize * rows * columns.value_or(1);
  for (std::size_t i = axes.size(); i-- > 0;) {
    shape.insert(shape.begin(), std::ssize(axes[i].values));
    strides.insert(strides.begin(), stride);
    stride *= std::ssize(axes[i].values);
  }
  shape.push_back(rows);
  strides.push_back(kSize);
  if (columns) {
    shape.push_back(*columns);
    strides.push_back(kSize * rows);
  }
  Array array(shape, strides, stored.data(), owner);
  array.attr("flags").attr("writeable") = false;
  return array;
}

/// @throws NoSolution  for a table without gains, which has no text
const GainSchedule& with_gains(const ScheduleReport& self) {
  if (self.schedule.solved_count() == 0)
    throw NoSolution("schedule: no point has a gain", self.schedule.vehicle);
  return self.schedule;
}

py::dict axes_dict(const GainSchedule& schedule) {
  py::dict axes;
  for (const ScheduleAxis& axis : schedule.axes)
    axes[py::str(to_string(axis.quantity))] = axis.values;
  return axes;
}

std::string json_text(const GainSchedule& schedule) {
  std::string text = schedule_text(schedule, TableFormat::json);
  if (text.ends_with('\n')) text.pop_back();
  return text;
}

void add_scheduled_gain(py::module_& module) {
  py::class_<ScheduledGain>(module, "ScheduledGain",
                            "Gains between the points of a grid, or the reason for none.")
      .def_property_readonly("found", &ScheduledGain::found, "Whether there are gains.")
      .def_readonly("K", &ScheduledGain::K, "(nu, nx); empty unless found.")
      .def_readonly("K_int", &ScheduledGain::K_int, "(nu, ni); empty unless found.")
      .def_readonly("x0", &ScheduledGain::x0, "(nx) trim state; empty unless found.")
      .def_readonly("u0", &ScheduledGain::u0, "(nu) trim input; empty unless found.")
      .def_readonly("culprit", &ScheduledGain::culprit,
                    "The axis and its range, or the point without gain; empty if found.");
}

void add_numbers(py::class_<ScheduleReport>& type) {
  const auto number = [&](const char* name, auto size_of, Eigen::MatrixXd GainSchedule::*member,
                          const char* doc) {
    type.def_property_readonly(
        name,
        [=](const py::object& self) {
          const GainSchedule& schedule = self.cast<const ScheduleReport&>().schedule;
          const auto [rows, columns] = size_of(schedule);
          return on_grid(self, schedule.*member, rows, columns);
        },
        doc);
  };
  using Size = std::pair<Eigen::Index, std::optional<Eigen::Index>>;
  const auto nx = [](const GainSchedule& schedule) { return std::ssize(schedule.states); };
  const auto nu = [](const GainSchedule& schedule) { return std::ssize(schedule.inputs); };
  number(
      "K", [=](const GainSchedule& schedule) { return Size(nu(schedule), nx(schedule)); },
      &GainSchedule::K, "(axis 1, axis 2, ..., nu, nx); NaN where there is no gain.");
  number(
      "K_int",
      [=](const GainSchedule& schedule) {
        return Size(nu(schedule), std::ssize(schedule.integrals));
      },
      &GainSchedule::K_int, "(axis 1, axis 2, ..., nu, ni); NaN where there is no gain.");
  number(
      "x0", [=](const GainSchedule& schedule) { return Size(nx(schedule), std::nullopt); },
      &GainSchedule::x0, "(axis 1, axis 2, ..., nx) trim states; NaN where there is no gain.");
  number(
      "u0", [=](const GainSchedule& schedule) { return Size(nu(schedule), std::nullopt); },
      &GainSchedule::u0, "(axis 1, axis 2, ..., nu) trim inputs; NaN where there is no gain.");
}

void add_words(py::class_<ScheduleReport>& type) {
  const auto of = [](const ScheduleReport& self) -> const GainSchedule& { return self.schedule; };
  type.def_property_readonly(
          "axes", [=](const ScheduleReport& self) { return axes_dict(of(self)); },
          "Values of each axis, by quantity, in their order; the last varies fastest.")
      .def_property_readonly(
          "status",
          [=](const ScheduleReport& self) {
            std::vector<std::string> words;
            for (const PointStatus status : of(self).status) words.push_back(to_string(status));
            return words;
          },
          "\"solved\", \"no trim\" or \"no gain\" of each point; the last axis varies fastest.")
      .def_property_readonly(
          "culprits", [=](const ScheduleReport& self) { return of(self).culprit; },
          "Why a point has no gain; empty if it has one. In the order of status.")
      .def_property_readonly(
          "states", [=](const ScheduleReport& self) { return names_of(of(self).states); },
          "Names of the states.")
      .def_property_readonly(
          "inputs", [=](const ScheduleReport& self) { return names_of(of(self).inputs); },
          "Names of the inputs.")
      .def_property_readonly(
          "integrals", [=](const ScheduleReport& self) { return names_of(of(self).integrals); },
          "Names of the integrated states.")
      .def_property_readonly(
          "vehicle", [=](const ScheduleReport& self) { return of(self).vehicle; },
          "Name of the vehicle.")
      .def_property_readonly(
          "convention", [=](const ScheduleReport& self) { return of(self).convention; },
          "Name of the convention.")
      .def_property_readonly(
          "dt", [=](const ScheduleReport& self) { return of(self).dt; },
          "Sample period [s]; 0 of a continuous law.")
      .def_property_readonly(
          "yaw", [=](const ScheduleReport& self) { return of(self).yaw; },
          "Heading of all points [rad].")
      .def_readonly("messages", &ScheduleReport::messages, "\"warning: ...\" and \"note: ...\".");
}

void add_schedule(py::module_& module) {
  py::class_<ScheduleReport> type(module, "Schedule",
                                  "State-feedback gains over a grid of flights.");
  add_words(type);
  add_numbers(type);
  type.def(
          "at",
          [](const ScheduleReport& self, const Numbers& values) {
            return self.schedule.at(values.values);
          },
          "values"_a,
          "Gains by multilinear interpolation; nothing is extrapolated.\n\n"
          "values: one of each axis, in their order. Outside the grid, and next to a point\n"
          "without a gain, the result is not found. Raises InvalidInput for another count of\n"
          "values.")
      .def(
          "to_json", [](const ScheduleReport& self) { return json_text(self.schedule); },
          "The table that `quadtune lqr V --schedule GRID --json` prints.")
      .def(
          "to_dict",
          [](const ScheduleReport& self) { return py::dict(dict_of(json_text(self.schedule))); },
          "The same as Python objects.")
      .def(
          "save",
          [](const ScheduleReport& self, const std::filesystem::path& file) {
            const TableFormat format = table_format(file, "file");
            save(file.string(), schedule_text(self.schedule, format));
          },
          "file"_a,
          "Write the table as TOML or JSON, by the end of the name, for fly() and export().\n\n"
          "Raises InvalidInput for another name, FileError if it cannot be written.")
      .def(
          "__str__", [](const ScheduleReport& self) { return report::to_text(with_gains(self)); },
          "The text that the command prints.");
}

}  // namespace

void add_schedules(py::module_& module) {
  add_scheduled_gain(module);
  add_schedule(module);
  module.def(
      "schedule",
      [](const VehicleWord& vehicle, const Grid& grid, std::optional<Numbers> Q,
         std::optional<Numbers> R, const std::optional<Names>& integral, const std::string& method,
         std::optional<double> dt, double yaw, const std::string& convention,
         const std::string& inputs, const std::optional<Names>& states, std::size_t threads) {
        PlantWords plant;
        plant.vehicle = vehicle.text;
        plant.yaw = yaw;
        plant.convention = convention;
        plant.inputs = inputs;
        if (states) plant.states = states->joined();
        return make_schedule(plant, grid,
                             {std::move(Q), std::move(R), listed(integral), method, dt}, threads);
      },
      "vehicle"_a, "grid"_a, py::kw_only(), "Q"_a = py::none(), "R"_a = py::none(),
      "integral"_a = py::none(), "method"_a = "continuous", "dt"_a = py::none(), "yaw"_a = 0.0,
      "convention"_a = "ned", "inputs"_a = "rotor-speed", "states"_a = py::none(), "threads"_a = 0,
      "LQR gains of a vehicle over a grid of flights, on the textbook plant.\n\n"
      "grid: a dict from quantities to increasing values, or \"speed=0:0.5:10,\n"
      "yaw_rate=-2:1:2\" (first:step:last). Quantities: speed >= 0 [m/s], climb [m/s] upward,\n"
      "yaw_rate [rad/s] clockwise from above, mass > 0 and density > 0 as ratios to those of\n"
      "the vehicle; at most 100000 points. Q: weights >= 0 of the states, then of the\n"
      "integrals; R > 0: of the inputs; one number stands for all, 1 by default. integral:\n"
      "states to integrate. method: \"continuous\", \"discrete\" (weights per step) or\n"
      "\"sampled\" (exact cost), the last two with dt > 0, the sample period [s]. yaw: heading\n"
      "[rad]. convention, inputs and states as linearize(). threads: 0 for one of each\n"
      "processor; the result does not depend on it. Raises NoSolution if no point has a gain,\n"
      "InvalidInput for a wrong argument, FileError if a file cannot be read.");
  module.def(
      "load_schedule",
      [](const Path& file) {
        return long_call([&](const Stop&) -> ScheduleReport {
          return {read_schedule(file.text), {}};
        });
      },
      "file"_a,
      "Read a schedule that was saved: a table in TOML or JSON.\n\n"
      "Raises FileError if it cannot be read, InvalidInput with \"file:line\" if it is wrong.");
}

}  // namespace quadtune::python
