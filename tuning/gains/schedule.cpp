// SPDX-License-Identifier: Apache-2.0
#include "quadtune/tuning/schedule.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <memory>
#include <optional>

#include "quadtune/discretize/van_loan.hpp"
#include "quadtune/discretize/zoh.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/internal/in_parallel.hpp"
#include "quadtune/linearize/linearize.hpp"
#include "quadtune/synthesis/lqr.hpp"
#include "quadtune/synthesis/riccati_batch.hpp"

namespace quadtune {
namespace {

/// Number of consecutive points that one thread solves at a time: a multiple of the lanes of a
/// batch.
constexpr Eigen::Index kRun = 8 * static_cast<Eigen::Index>(RiccatiBatch::kLanes);

/// Computes the Riccati equation of a design from the A and B of a plant, in memory that it owns.
class RegulatorEquation {
 public:
  RegulatorEquation(const ContinuousLti& any_plant, const LqrDesign& design)
      : method_(design.method), dt_(design.dt), nx_(any_plant.A.rows()) {
    ContinuousLti still = any_plant;
    still.A.setZero();
    still.B.setZero();
    plant_ = with_integrals(still, design.integrals);
    weights_ = {design.Q, design.R, {}};
    if (!design.integrals.empty()) weights_ = with_integral_weights(weights_, design.Q_integral);
    if (method_ == LqrMethod::discrete) hold_.emplace(plant_.A.rows(), plant_.B.cols());
  }

  [[nodiscard]] Eigen::Index states() const { return plant_.A.rows(); }
  [[nodiscard]] Eigen::Index inputs() const { return plant_.B.cols(); }
  [[nodiscard]] std::vector<std::string> state_names() const {
    return names_or_numbers(plant_.states, states());
  }
  [[nodiscard]] bool continuous() const { return method_ == LqrMethod::continuous; }

  /// An equation of the right sizes, with the weights that are the same at all points.
  [[nodiscard]] RiccatiMatrices prototype() const {
    return {plant_.A, plant_.B, weights_.Q, weights_.R, weights_.N};
  }

  /// @param equation  a copy of prototype()
  void fill(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B, RiccatiMatrices& equation) {
    plant_.A.topLeftCorner(nx_, nx_) = A;
    plant_.B.topRows(nx_) = B;
    switch (method_) {
      case LqrMethod::continuous:
        equation.A = plant_.A;
        equation.B = plant_.B;
        return;
      case LqrMethod::discrete:
        hold_->solve(plant_.A, plant_.B, dt_, equation.A, equation.B);
        return;
      case LqrMethod::sampled: {
        SampledCost cost =
            sampled_cost(plant_.A, plant_.B, weights_.Q, weights_.R, weights_.N, dt_);
        equation = {std::move(cost.A), std::move(cost.B), std::move(cost.Q), std::move(cost.R),
                    std::move(cost.N)};
      }
    }
  }

 private:
  LqrMethod method_;
  double dt_;
  Eigen::Index nx_;
  ContinuousLti plant_;  // with the integrals
  LqrWeights weights_;
  std::optional<ZohWorkspace> hold_;
};

RiccatiOptions riccati_options(const RegulatorEquation& equation) {
  RiccatiOptions options;
  options.state_names = equation.state_names();
  return options;
}

/// State of one thread: solves sequences of points into a schedule that all threads share.
class RunSolver {
 public:
  RunSolver(const Vehicle& vehicle, const LqrDesign& design, double yaw, GainSchedule& schedule)
      : vehicle_(vehicle),
        yaw_(yaw),
        schedule_(schedule),
        linearizer_(vehicle, linearize_options(design)),
        equation_(linearizer_.unsolved().plant, design),
        batch_(equation_.states(), equation_.inputs(), riccati_options(equation_)),
        problems_(RiccatiBatch::kLanes, equation_.prototype()) {
    moved_ = vehicle;
    moved_.text.clear();  // avoids a needless copy
  }

  /// Solves the points first … last - 1.
  void solve(Eigen::Index first, Eigen::Index last) {
    waiting_.clear();
    neighbour_ = {};
    for (Eigen::Index point = first; point < last; ++point) {
      add(point);
      if (waiting_.size() == RiccatiBatch::kLanes) solve_waiting();
    }
    if (!waiting_.empty()) solve_waiting();
  }

 private:
  void add(Eigen::Index point) {
    const SchedulePoint at =
        schedule_point(vehicle_, schedule_.axes, grid_point(schedule_.axes, point), yaw_);
    moved_.mass = at.mass;
    TrimOptions trim_options;
    trim_options.density_ratio = at.density_ratio;
    TrimResult trimmed = trim(moved_, at.condition, trim_options, &neighbour_);
    const auto p = static_cast<std::size_t>(point);
    if (!trimmed.solved()) {
      schedule_.status[p] = PointStatus::no_trim;
      schedule_.culprit[p] = trimmed.culprit;
      return;
    }
    const Linearization& model = linearizer_.at(moved_, trimmed);
    neighbour_ = std::move(trimmed);
    schedule_.x0.col(point) = model.x0;
    schedule_.u0.col(point) = model.u0;
    equation_.fill(model.plant.A, model.plant.B, problems_[waiting_.size()]);
    waiting_.push_back(point);
  }

  void solve_waiting() {
    const std::span<const RiccatiMatrices> problems(problems_.data(), waiting_.size());
    const std::span<const RiccatiResult> results =
        equation_.continuous() ? batch_.care(problems) : batch_.dare(problems);
    for (std::size_t lane = 0; lane < waiting_.size(); ++lane) keep(waiting_[lane], results[lane]);
    waiting_.clear();
  }

  void keep(Eigen::Index point, const RiccatiResult& result) {
    const auto p = static_cast<std::size_t>(point);
    if (!result.solved()) {
      schedule_.status[p] = PointStatus::no_gain;
      schedule_.culprit[p] = fmt::format("{}: {}", to_string(result.status), result.culprit);
      schedule_.x0.col(point).setConstant(std::numeric_limits<double>::quiet_NaN());
      schedule_.u0.col(point).setConstant(std::numeric_limits<double>::quiet_NaN());
      return;
    }
    // The first columns of a gain belong to the states, the others to the integrals.
    schedule_.status[p] = PointStatus::solved;
    schedule_.K.col(point) = result.K.reshaped().head(schedule_.K.rows());
    schedule_.K_int.col(point) = result.K.reshaped().tail(schedule_.K_int.rows());
    schedule_.residual(point) = result.residual;
  }

  const Vehicle& vehicle_;
  Vehicle moved_;
  double yaw_;
  GainSchedule& schedule_;
  Linearizer linearizer_;
  TrimResult neighbour_;  // the last trim of this sequence
  RegulatorEquation equation_;
  RiccatiBatch batch_;
  std::vector<RiccatiMatrices> problems_;
  std::vector<Eigen::Index> waiting_;  // points of the batch that is being filled
};

void check_design(const LqrDesign& design) {
  if (design.method != LqrMethod::continuous && !(design.dt > 0))
    throw InvalidInput("gain_schedule",
                       fmt::format("dt is {} s, expected a positive number", design.dt));
}

}  // namespace

SchedulePoint schedule_point(const Vehicle& vehicle, const std::vector<ScheduleAxis>& axes,
                             const Eigen::VectorXd& values, double yaw) {
  double speed = 0;
  double climb = 0;
  double yaw_rate = 0;
  SchedulePoint point;
  point.mass = vehicle.mass;
  for (std::size_t a = 0; a < axes.size(); ++a) {
    const double value = values(static_cast<Eigen::Index>(a));
    switch (axes[a].quantity) {
      case ScheduleQuantity::speed:
        speed = value;
        break;
      case ScheduleQuantity::climb:
        climb = value;
        break;
      case ScheduleQuantity::yaw_rate:
        yaw_rate = value;
        break;
      case ScheduleQuantity::mass:
        point.mass = vehicle.mass * value;
        break;
      case ScheduleQuantity::density:
        point.density_ratio = value;
        break;
    }
  }
  point.condition = steady_flight(speed, climb, yaw_rate, yaw);
  return point;
}

GainSchedule gain_schedule(const Vehicle& vehicle, std::vector<ScheduleAxis> axes,
                           const LqrDesign& design, const ScheduleOptions& options) {
  check_design(design);
  const ContinuousLti words = Linearizer(vehicle, linearize_options(design)).unsolved().plant;
  GainSchedule schedule = empty_schedule(std::move(axes), words.states, words.inputs,
                                         integral_signals(words.states, design.integrals));
  schedule.vehicle = vehicle.name;
  schedule.convention = design.convention;
  schedule.input_kind = design.input_kind;
  schedule.sign_law = convention(design.convention, "gain_schedule").sign_law;
  schedule.dt = design.dt;
  schedule.yaw = options.yaw;
  const Eigen::Index size = schedule.size();
  const auto make_worker = [&]() -> internal::PartWorker {
    const auto solver = std::make_shared<RunSolver>(vehicle, design, options.yaw, schedule);
    return [solver, size](std::size_t run) {
      const Eigen::Index first = static_cast<Eigen::Index>(run) * kRun;
      solver->solve(first, std::min(first + kRun, size));
    };
  };
  internal::in_parallel(static_cast<std::size_t>((size + kRun - 1) / kRun),
                        internal::thread_count(options.threads), make_worker, options.interrupted);
  return schedule;
}

}  // namespace quadtune
