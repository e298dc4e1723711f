// SPDX-License-Identifier: Apache-2.0
#include "quadtune/workbench/missions/lqr_tuning.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "quadtune/errors.hpp"
#include "quadtune/internal/joined.hpp"
#include "quadtune/synthesis/diagonal_lqr.hpp"
#include "quadtune/workbench/design/chosen_law.hpp"
#include "quadtune/workbench/design/standard_lqr.hpp"
#include "quadtune/workbench/flown/flying_loop.hpp"

namespace quadtune {
namespace {

/// Ratio of an integral's weight to that of its state [1/s²].
constexpr double kIntegralShare = 0.1;

/// The name shared by weights that are tied together: x and y, roll and pitch, all rotors.
std::string kind_of(const std::string& name) {
  for (const auto& [a, b] : {std::pair("roll", "pitch"), std::pair("phi", "theta"),
                             std::pair("u", "v"), std::pair("p", "q"), std::pair("x", "y")})
    if (name == a || name == b) return fmt::format("{}, {}", a, b);
  if (name.size() == 2 && name[0] == 'w' && std::isdigit(static_cast<unsigned char>(name[1])) != 0)
    return "rotors";
  if (name.size() > 1 && (name.back() == 'x' || name.back() == 'y')) {
    const std::string stem = name.substr(0, name.size() - 1);
    return stem + "x, " + stem + "y";
  }
  return name;
}

/// Weights that one parameter scales.
struct Group {
  std::string name;
  std::vector<Eigen::Index> weights;
};

/// The shared state of the functions of a MissionTuning.
class LqrTuning {
 public:
  LqrTuning(LinearVehicle plant, const LqrDesign& design, bool standard, bool separate)
      : plant_(std::move(plant)), design_(design) {
    if (standard) take_standard_weights();
    lqr_.emplace(plant_.model.plant, design_);
    weights_ = diagonals_of(design_);
    make_groups(separate);
  }

  [[nodiscard]] TunedDesign design(const Eigen::VectorXd& x) const {
    TunedDesign tuned;
    if (const std::optional<Gains> found = gains(x, &tuned.margins))
      tuned.point.controller = feedback_controller(*found, design_.dt);
    return tuned;
  }

  [[nodiscard]] std::vector<TunedNumber> numbers(const Eigen::VectorXd& x) const {
    const Eigen::VectorXd w = weights(x);
    std::vector<TunedNumber> all;
    for (Eigen::Index i = 0; i < w.size(); ++i)
      all.push_back(
          {i < lqr_->states() ? "Q" : "R", lqr_->names()[static_cast<std::size_t>(i)], "", w(i)});
    return all;
  }

  [[nodiscard]] TunedWeights tuned(const Eigen::VectorXd& x) const {
    return {lqr_->names(), weights(x), gains(x, nullptr)};
  }

  [[nodiscard]] std::string file(const Eigen::VectorXd& x, const std::string& comment) const {
    const LqrDesign found = with_diagonals(design_, weights(x));
    const auto list = [](const Eigen::MatrixXd& M) {
      std::vector<double> numbers;
      for (Eigen::Index i = 0; i < M.rows(); ++i) numbers.push_back(M(i, i));
      return fmt::format("[{}]", fmt::join(numbers, ", "));
    };
    std::string text = fmt::format(
        "# {}\nname = \"tuned-{}\"\nvehicle = {}\n\n[trim]\nat = \"hover\"\nyaw_rad = {}\n\n"
        "[lqr]\nconvention = \"{}\"\ninputs = \"{}\"\nstates = [\"{}\"]\nQ = {}\nR = {}\n",
        comment, plant_.vehicle.name, vehicle_text(place_of(plant_.vehicle)), plant_.flight.yaw,
        found.convention, to_string(found.input_kind), internal::joined(found.states, "\", \""),
        list(found.Q), list(found.R));
    if (!found.integrals.empty())
      text += fmt::format("integral = [\"{}\"]\nQ_integral = {}\n",
                          internal::joined(found.integrals, "\", \""), list(found.Q_integral));
    return text + fmt::format("method = \"{}\"\ndt_s = {}\n\n[[export]]\nto = \"json\"\n",
                              to_string(found.method), found.dt);
  }

  [[nodiscard]] const Vehicle& vehicle() const { return plant_.vehicle; }
  [[nodiscard]] const std::vector<Group>& groups() const { return groups_; }

 private:
  /// Sets Bryson's weights, in the order of the model's states; those of integrals in proportion.
  void take_standard_weights() {
    const Convention& words = ned_convention();
    const LqrWeights standard =
        standard_weights(cascade_vehicle(plant_.vehicle, place_of(plant_.vehicle)));
    design_.Q = standard.Q;
    design_.R = standard.R;
    for (std::size_t i = 0; i < design_.integrals.size(); ++i)
      for (std::size_t j = 0; j < words.states.size(); ++j)
        if (words.states[j].name == design_.integrals[i])
          design_.Q_integral(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(i)) =
              kIntegralShare *
              standard.Q(static_cast<Eigen::Index>(j), static_cast<Eigen::Index>(j));
  }

  /// Groups all weights except those of the first input and those tied to it: a gain determines the
  /// weights only up to a factor.
  void make_groups(bool separate) {
    const std::vector<std::string>& names = lqr_->names();
    const auto kind = [&](Eigen::Index i) {
      const std::string& name = names[static_cast<std::size_t>(i)];
      return separate ? name : kind_of(name);
    };
    const Eigen::Index first_input = lqr_->states();
    for (Eigen::Index i = 0; i < lqr_->size(); ++i) {
      if (weights_(i) == 0) continue;
      const bool input = i >= first_input;
      if (input && kind(i) == kind(first_input)) continue;
      const std::string name = (input ? "R of " : "Q of ") + kind(i);
      const auto same = std::find_if(groups_.begin(), groups_.end(),
                                     [&](const Group& group) { return group.name == name; });
      if (same == groups_.end())
        groups_.push_back({name, {i}});
      else
        same->weights.push_back(i);
    }
  }

  [[nodiscard]] Eigen::VectorXd weights(const Eigen::VectorXd& x) const {
    Eigen::VectorXd w = weights_;
    for (std::size_t g = 0; g < groups_.size(); ++g)
      for (const Eigen::Index i : groups_[g].weights)
        w(i) *= std::exp(x(static_cast<Eigen::Index>(g)));
    return w;
  }

  [[nodiscard]] std::optional<Gains> gains(const Eigen::VectorXd& x,
                                           std::vector<NamedMargins>* margins) const {
    const Eigen::VectorXd w = weights(x);
    StateFeedback feedback;
    feedback.riccati = lqr_->solve(w);
    if (!feedback.solved()) return std::nullopt;
    const Eigen::Index nx = plant_.model.plant.A.rows();
    feedback.K = feedback.riccati.K.leftCols(nx);
    feedback.K_int = feedback.riccati.K.rightCols(feedback.riccati.K.cols() - nx);
    Gains found = make_gains(plant_.vehicle, plant_.model, with_diagonals(design_, w), feedback);
    if (margins != nullptr) {
      const MarginsReport report = flying_margins(plant_.model, found, feedback.riccati);
      for (std::size_t i = 0; i < report.loops.size(); ++i)
        margins->push_back({report.names[i], report.loops[i]});
    }
    return found;
  }

  LinearVehicle plant_;
  LqrDesign design_;
  std::optional<DiagonalLqr> lqr_;
  Eigen::VectorXd weights_;
  std::vector<Group> groups_;
};

}  // namespace

MissionTuning lqr_tuning(LinearVehicle plant, const LqrDesign& design, bool standard,
                         bool separate) {
  const auto lqr = std::make_shared<const LqrTuning>(std::move(plant), design, standard, separate);
  MissionTuning tuning;
  tuning.vehicle = lqr->vehicle();
  tuning.law = "state feedback, LQR";
  for (const Group& group : lqr->groups()) tuning.names.push_back(group.name);
  tuning.start = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(tuning.names.size()));
  tuning.design = [lqr](const Eigen::VectorXd& x) { return lqr->design(x); };
  tuning.gains_title = "Weights";
  tuning.numbers = [lqr](const Eigen::VectorXd& x) { return lqr->numbers(x); };
  tuning.gains = [lqr](const Eigen::VectorXd& x) { return lqr->tuned(x); };
  tuning.file = [lqr](const Eigen::VectorXd& x, const std::string& comment) {
    return lqr->file(x, comment);
  };
  return tuning;
}

}  // namespace quadtune
