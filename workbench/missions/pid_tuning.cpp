// SPDX-License-Identifier: Apache-2.0
#include "quadtune/workbench/missions/pid_tuning.hpp"

#include <fmt/format.h>

#include <cmath>
#include <memory>

#include "quadtune/errors.hpp"
#include "quadtune/exports/mambo.hpp"
#include "quadtune/workbench/design/chosen_law.hpp"

namespace quadtune {
namespace {

/// Loops whose gains are scaled by the same factors, as for x and y, or pitch and roll.
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

/// One parameter of the search: the logarithm of a factor.
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

/// The shared state of the functions of a MissionTuning.
class PidTuning {
 public:
  PidTuning(const std::string& vehicle, const std::string& gains, bool separate)
      : vehicle_(load_vehicle(vehicle)) {
    FlightOptions chosen;
    chosen.vehicle = vehicle;
    chosen.gains = gains;
    chosen.controller = kCascadedPid;
    law_ = choose_law(chosen, vehicle_, "tune pid");
    start_ = std::get<CascadeController>(law_.controller);
    hover_ = cascade_vehicle(vehicle_, vehicle);
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

  /// A design file that `quadtune design` and `fly --gains` accept.
  [[nodiscard]] std::string file(const Eigen::VectorXd& x, const std::string& comment) const {
    const CascadeController tuned = controller(x);
    std::string text = fmt::format(
        "# {}\nname = \"tuned-{}\"\nvehicle = {}\n\n[trim]\nat = \"hover\"\n\n[cascade]\ndt_s "
        "= "
        "{}\n",
        comment, vehicle_.name, vehicle_text(place_of(vehicle_)), tuned.gains.dt);
    if (std::isfinite(tuned.attitude_limit))
      text += fmt::format("attitude_limit_rad = {}\n", tuned.attitude_limit);
    if (std::isfinite(tuned.integrator_limit))
      text += fmt::format("integrator_limit = {}\n", tuned.integrator_limit);
    text += fmt::format("back_calculation_per_s = {}\n", tuned.back_calculation);
    if (tuned.method != PidMethod::forward_euler)
      text += fmt::format("integrator = \"{}\"\n", to_string(tuned.method));
    for (const PidLoop& loop : tuned.gains.loops) {
      text +=
          fmt::format("{} = {{ Kp = {}, Ki = {}, Kd = {}", loop.name, loop.Kp, loop.Ki, loop.Kd);
      if (loop.rate_lead != 0)
        text +=
            fmt::format(", rate_lead_s = {}, rate_filter_s = {}", loop.rate_lead, loop.rate_filter);
      text += " }\n";
    }
    // Exports to the model project if it supports the vehicle.
    return text + fmt::format("\n[[export]]\nto = \"{}\"\n",
                              takes_mambo_files(vehicle_) ? "mambo" : "json");
  }

  [[nodiscard]] const ChosenLaw& law() const { return law_; }
  [[nodiscard]] const Vehicle& vehicle() const { return vehicle_; }
  [[nodiscard]] const std::vector<std::string>& names() const { return names_; }

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

MissionTuning pid_tuning(const std::string& vehicle, const std::string& gains, bool separate) {
  const auto pid = std::make_shared<const PidTuning>(vehicle, gains, separate);
  MissionTuning tuning;
  tuning.vehicle = pid->vehicle();
  tuning.law = pid->law().words;
  tuning.position_bandwidth = pid->law().position_bandwidth;
  tuning.names = pid->names();
  tuning.start = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(tuning.names.size()));
  tuning.design = [pid](const Eigen::VectorXd& x) { return pid->design(x); };
  tuning.rival = pid->rival();
  tuning.gains_title = "Gains";
  tuning.numbers = [pid](const Eigen::VectorXd& x) {
    return PidTuning::numbers(pid->controller(x).gains);
  };
  tuning.gains = [pid](const Eigen::VectorXd& x) { return pid->controller(x).gains; };
  tuning.file = [pid](const Eigen::VectorXd& x, const std::string& comment) {
    return pid->file(x, comment);
  };
  return tuning;
}

}  // namespace quadtune
