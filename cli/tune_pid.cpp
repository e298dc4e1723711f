// SPDX-License-Identifier: Apache-2.0
/// quadtune tune pid: gains of a PID cascade over missions.
#include <fmt/format.h>

#include <cmath>
#include <memory>

#include "arguments/flight_arguments.hpp"
#include "missions/mission_tuning.hpp"
#include "program/command_line.hpp"
#include "program/program.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/exports/mambo.hpp"
#include "quadtune/internal/json.hpp"

namespace quadtune::cli {
namespace {

using internal::Json;

/// Loops whose gains are scaled by the same factors: x and y, pitch and roll are alike.
struct LoopGroup {
  std::string name;
  std::vector<CascadeAxis> axes;
};

std::vector<LoopGroup> groups(bool separate) {
  if (separate) {
    std::vector<LoopGroup> all;
    all.reserve(std::size(kAllCascadeAxes));
    for (const CascadeAxis axis : kAllCascadeAxes) all.push_back({to_string(axis), {axis}});
    return all;
  }
  return {{"x, y", {CascadeAxis::x, CascadeAxis::y}},
          {"pitch, roll", {CascadeAxis::pitch, CascadeAxis::roll}},
          {"yaw", {CascadeAxis::yaw}},
          {"altitude", {CascadeAxis::altitude}}};
}

PidLoop& loop_of(CascadeGains& gains, CascadeAxis axis) {
  for (PidLoop& loop : gains.loops)
    if (loop.name == to_string(axis)) return loop;
  throw InvalidInput("tune pid", "the cascade lacks the loop " + to_string(axis));
}

/// One number of the search: the logarithm of a factor.
struct Knob {
  double PidLoop::*gain;
  std::vector<CascadeAxis> axes;
};

std::vector<NamedMargins> margins_of(const PidCascade& cascade) {
  std::vector<NamedMargins> margins;
  for (const CascadeAxisDesign& loop : cascade.loops)
    margins.push_back({to_string(loop.axis), loop.design.evidence.margins});
  return margins;
}

class PidTuning {
 public:
  PidTuning(const MissionTuningArguments& arguments, const std::string& gains, bool separate)
      : vehicle_(load_vehicle(arguments.vehicle)) {
    FlightOptions chosen;
    chosen.vehicle = arguments.vehicle;
    chosen.gains = gains;
    chosen.controller = "cascaded-pid";
    law_ = option_of_command("tune pid", [&] { return choose_law(chosen, vehicle_, "tune pid"); });
    start_ = std::get<CascadeController>(law_.controller);
    hover_ = cascade_vehicle(vehicle_, arguments.vehicle);
    specification_.dt = start_.gains.dt;
    specification_.method = start_.method;
    specification_.lag = hover_.lag;
    for (const LoopGroup& group : groups(separate))
      for (const auto& [name, gain] : {std::pair("Kp", &PidLoop::Kp), std::pair("Ki", &PidLoop::Ki),
                                       std::pair("Kd", &PidLoop::Kd)}) {
        if (loop_of(start_.gains, group.axes.front()).*gain == 0) continue;
        names_.push_back(fmt::format("{} of {}", name, group.name));
        knobs_.push_back({gain, group.axes});
      }
  }

  [[nodiscard]] CascadeController controller(const Eigen::VectorXd& x) const {
    CascadeController scaled = start_;
    for (std::size_t i = 0; i < knobs_.size(); ++i)
      for (const CascadeAxis axis : knobs_[i].axes)
        loop_of(scaled.gains, axis).*knobs_[i].gain *= std::exp(x(static_cast<Eigen::Index>(i)));
    return scaled;
  }

  [[nodiscard]] TunedDesign design(const Eigen::VectorXd& x) const {
    TunedDesign tuned;
    const CascadeController scaled = controller(x);
    const PidCascade cascade = assess_cascade(hover_, specification_, scaled.gains);
    tuned.margins = margins_of(cascade);
    if (cascade.poles.size() > 0 && cascade.poles.cwiseAbs().maxCoeff() < 1)
      tuned.point.controller = scaled;
    return tuned;
  }

  [[nodiscard]] std::optional<Rival> rival() const {
    if (!vehicle_.published_cascade) return std::nullopt;
    const CascadeGains& gains = vehicle_.published_cascade->gains;
    CascadeSpecification specification = specification_;
    specification.dt = gains.dt;
    return Rival{"published", CascadeController{gains},
                 margins_of(assess_cascade(hover_, specification, gains)), numbers(gains)};
  }

  [[nodiscard]] static std::vector<TunedNumber> numbers(const CascadeGains& gains) {
    std::vector<TunedNumber> all;
    for (const PidLoop& loop : gains.loops) {
      all.push_back({loop.name, "Kp", loop.unit, loop.Kp});
      all.push_back({loop.name, "Ki", loop.unit + " / s", loop.Ki});
      all.push_back({loop.name, "Kd", loop.unit + " \u00b7 s", loop.Kd});
    }
    return all;
  }

  [[nodiscard]] std::string text(const Eigen::VectorXd& before,
                                 const Eigen::VectorXd& after) const {
    const CascadeController a = controller(before), b = controller(after);
    std::string text = fmt::format("{:<10}{:>24}{:>24}{:>24}\n", "loop", "Kp", "Ki", "Kd");
    const auto pair = [](double then, double now) {
      return then == now ? fmt::format("{:.4g}", now) : fmt::format("{:.4g} -> {:.4g}", then, now);
    };
    for (std::size_t i = 0; i < a.gains.loops.size(); ++i) {
      const PidLoop& then = a.gains.loops[i];
      const PidLoop& now = b.gains.loops[i];
      text += fmt::format("{:<10}{:>24}{:>24}{:>24}\n", now.name, pair(then.Kp, now.Kp),
                          pair(then.Ki, now.Ki), pair(then.Kd, now.Kd));
    }
    text.pop_back();
    return text;
  }

  [[nodiscard]] Json json(const Eigen::VectorXd& x) const {
    Json loops = Json::array();
    for (const PidLoop& loop : controller(x).gains.loops)
      loops.push_back({{"name", loop.name}, {"Kp", loop.Kp}, {"Ki", loop.Ki}, {"Kd", loop.Kd}});
    return loops;
  }

  /// A design file, which `quadtune design` and `fly --gains` read.
  [[nodiscard]] std::string file(const Eigen::VectorXd& x, const std::string& comment) const {
    const CascadeController tuned = controller(x);
    std::string text = fmt::format(
        "# {}\nname = \"tuned-{}\"\nvehicle = {}\n\n[trim]\nat = \"hover\"\n\n[cascade]\ndt_s "
        "= "
        "{}\n",
        comment, vehicle_.name,
        vehicle_text(vehicle_.file.empty() ? vehicle_.name : vehicle_.file.string()),
        tuned.gains.dt);
    if (std::isfinite(tuned.attitude_limit))
      text += fmt::format("attitude_limit_rad = {}\n", tuned.attitude_limit);
    if (std::isfinite(tuned.integrator_limit))
      text += fmt::format("integrator_limit = {}\n", tuned.integrator_limit);
    text += fmt::format("back_calculation_per_s = {}\n", tuned.back_calculation);
    if (tuned.method != PidMethod::forward_euler)
      text += fmt::format("integrator = \"{}\"\n", to_string(tuned.method));
    for (const PidLoop& loop : tuned.gains.loops)
      text += fmt::format("{} = {{ Kp = {}, Ki = {}, Kd = {} }}\n", loop.name, loop.Kp, loop.Ki,
                          loop.Kd);
    // Files for the model project, where it takes the vehicle.
    return text + fmt::format("\n[[export]]\nto = \"{}\"\n",
                              takes_mambo_files(vehicle_) ? "mambo" : "json");
  }

  [[nodiscard]] MissionTuning tuning() const {
    MissionTuning tuning;
    tuning.verb = "tune pid";
    tuning.vehicle = vehicle_;
    tuning.law = law_.words;
    tuning.position_bandwidth = law_.position_bandwidth;
    tuning.names = names_;
    tuning.start = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(knobs_.size()));
    tuning.design = [this](const Eigen::VectorXd& x) { return design(x); };
    tuning.rival = rival();
    tuning.gains_title = "Gains";
    tuning.numbers = [this](const Eigen::VectorXd& x) { return numbers(controller(x).gains); };
    tuning.text = [this](const Eigen::VectorXd& a, const Eigen::VectorXd& b) { return text(a, b); };
    tuning.json = [this](const Eigen::VectorXd& x) { return json(x); };
    tuning.file = [this](const Eigen::VectorXd& x, const std::string& c) { return file(x, c); };
    return tuning;
  }

 private:
  Vehicle vehicle_;
  ChosenLaw law_;
  CascadeController start_;
  CascadeVehicle hover_;
  CascadeSpecification specification_;
  std::vector<std::string> names_;
  std::vector<Knob> knobs_;
};

}  // namespace

Verb tune_pid_verb() {
  struct Options {
    MissionTuningArguments tuning;
    std::string gains = "designed";
    bool separate = false;
  };
  return {"tune pid", "V --mission NAME [options]",
          "search PID gains over missions, and prove them on fresh draws",
          "quadtune tune pid mambo --mission step-north --evaluations 100",
          [](CommandLine& line) -> Action {
            auto options = std::make_shared<Options>();
            line.add_option("V", options->tuning.vehicle, "a built-in vehicle or a vehicle file");
            add_mission_tuning_options(line, options->tuning);
            line.add_option("--gains", options->gains,
                            "where it begins: designed (default), published or a file of gains")
                ->type_name("WHICH");
            line.add_flag("--separate", options->separate,
                          "tune x and y, pitch and roll each for itself");
            return [options](Context& context) {
              if (options->tuning.vehicle.empty())
                throw UsageError("quadtune tune pid: expected a vehicle", "V");
              require_sane("tune pid", options->tuning);
              const MissionRequirements requirements =
                  mission_requirements("tune pid", options->tuning);
              const PidTuning pid(options->tuning, options->gains, options->separate);
              run_mission_tuning(pid.tuning(), requirements, options->tuning, context);
            };
          }};
}

}  // namespace quadtune::cli
