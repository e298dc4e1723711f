// SPDX-License-Identifier: Apache-2.0
// A gain schedule of 10,000 points: the Riccati solves alone against SLICOT, then the whole
// schedule, trim and Jacobian included, on one thread and on two. docs/benchmarks.md describes what
// is timed.
#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <memory>
#include <span>
#include <vector>

#include "contest.hpp"
#include "peers/slicot.hpp"
#include "quadtune/linearize/linearize.hpp"
#include "quadtune/synthesis/riccati_batch.hpp"
#include "quadtune/tuning/schedule.hpp"
#include "residuals.hpp"
#include "wall_time.hpp"

namespace quadtune::bench {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

/// Interval between the points that are evaluated in extended precision.
constexpr std::size_t kSample = 101;

std::vector<double> evenly(double first, double last, int count) {
  std::vector<double> values;
  values.reserve(static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i) values.push_back(first + (last - first) * i / (count - 1));
  return values;
}

/// The grid with the intermediate results of the stages.
struct Flights {
  Vehicle vehicle = load_vehicle("uquad");
  std::vector<ScheduleAxis> axes = {{ScheduleQuantity::speed, evenly(0, 5, 25)},
                                    {ScheduleQuantity::yaw_rate, evenly(-1, 1, 20)},
                                    {ScheduleQuantity::mass, evenly(0.9, 1.1, 20)}};
  LqrDesign design;
  std::vector<TrimResult> trims;
  std::vector<RiccatiMatrices> equations;
  std::vector<MatrixXd> G;  // B R⁻¹ Bᵀ, passed to the peers
};

/// trim() at every point, each started from the one before, as in gain_schedule().
void trim_all(Flights& flights) {
  Vehicle moved = flights.vehicle;
  moved.text.clear();
  const TrimResult* neighbour = nullptr;
  for (std::size_t i = 0; i < flights.trims.size(); ++i) {
    const SchedulePoint point = schedule_point(flights.vehicle, flights.axes,
                                               grid_point(flights.axes, static_cast<Index>(i)), 0);
    moved.mass = point.mass;
    flights.trims[i] = trim(moved, point.condition, {}, neighbour);
    neighbour = &flights.trims[i];
  }
}

void linearize_all(Flights& flights) {
  Vehicle moved = flights.vehicle;
  moved.text.clear();
  Linearizer linearizer(flights.vehicle, linearize_options(flights.design));
  for (std::size_t i = 0; i < flights.trims.size(); ++i) {
    const Eigen::VectorXd at = grid_point(flights.axes, static_cast<Index>(i));
    moved.mass = schedule_point(flights.vehicle, flights.axes, at, 0).mass;
    const Linearization& model = linearizer.at(moved, flights.trims[i]);
    flights.equations[i].A = model.plant.A;
    flights.equations[i].B = model.plant.B;
  }
}

std::shared_ptr<Flights> make_flights() {
  auto flights = std::make_shared<Flights>();
  const ContinuousLti words = Linearizer(flights->vehicle, {}).unsolved().plant;
  for (const Signal& state : words.states) flights->design.states.push_back(state.name);
  for (const Signal& input : words.inputs) flights->design.inputs.push_back(input.name);
  // 0.1 m, 0.1 rad, 0.5 m/s, 1 rad/s relative to 30 rad/s.
  Eigen::VectorXd Q(12);
  Q << 100, 100, 100, 100, 100, 100, 4, 4, 4, 1, 1, 1;
  flights->design.Q = Q.asDiagonal();
  flights->design.R = MatrixXd::Identity(4, 4) / 900;
  const auto size = static_cast<std::size_t>(checked_grid_size(flights->axes, "benchmark"));
  flights->trims.resize(size);
  flights->equations.assign(
      size, {MatrixXd(12, 12), MatrixXd(12, 4), flights->design.Q, flights->design.R, MatrixXd()});
  trim_all(*flights);
  linearize_all(*flights);
  flights->G.reserve(size);
  for (const RiccatiMatrices& p : flights->equations)
    flights->G.push_back(p.B * p.R.llt().solve(p.B.transpose()));
  return flights;
}

/// Solutions of the sampled points, for the residual.
class Samples {
 public:
  explicit Samples(std::shared_ptr<const Flights> flights) : flights_(std::move(flights)) {
    X_.resize(flights_->equations.size() / kSample + 1);
  }
  void keep(std::size_t point, const MatrixXd& X) {
    if (point % kSample == 0) X_[point / kSample] = X;
  }
  [[nodiscard]] double worst_residual() const {
    double worst = 0;
    for (std::size_t i = 0; i < X_.size(); ++i) {
      if (i * kSample >= flights_->equations.size()) break;
      const RiccatiMatrices& p = flights_->equations[i * kSample];
      worst = std::max(worst, care_residual({p.A, p.B, p.Q, p.R}, X_[i]));
    }
    return worst;
  }

 private:
  std::shared_ptr<const Flights> flights_;
  std::vector<MatrixXd> X_;
};

using Flown = std::shared_ptr<const Flights>;

Contestant our_batch(const Flown& flights) {
  auto batch = std::make_shared<RiccatiBatch>(12, 4);
  auto samples = std::make_shared<Samples>(flights);
  return {"quadtune", true,
          [flights, batch, samples] {
            bool solved = true;
            const std::span<const RiccatiMatrices> all = flights->equations;
            for (std::size_t i = 0; i < all.size(); i += RiccatiBatch::kLanes) {
              const std::size_t count = std::min(RiccatiBatch::kLanes, all.size() - i);
              const auto results = batch->care(all.subspan(i, count));
              for (std::size_t lane = 0; lane < count; ++lane) {
                solved = solved && results[lane].solved();
                samples->keep(i + lane, results[lane].X);
              }
            }
            return solved;
          },
          [samples] { return samples->worst_residual(); }};
}

Contestant our_solver(const Flown& flights) {
  RiccatiOptions options;
  options.evidence = RiccatiEvidence::essential;
  auto solver = std::make_shared<RiccatiSolver>(12, 4, options);
  auto samples = std::make_shared<Samples>(flights);
  return {"quadtune, one by one", true,
          [flights, solver, samples] {
            bool solved = true;
            for (std::size_t i = 0; i < flights->equations.size(); ++i) {
              const RiccatiMatrices& p = flights->equations[i];
              const RiccatiResult& result = solver->care(p.A, p.B, p.Q, p.R);
              solved = solved && result.solved();
              samples->keep(i, result.X);
            }
            return solved;
          },
          [samples] { return samples->worst_residual(); }};
}

#ifdef QUADTUNE_WITH_SLICOT
Contestant slicot(const std::string& name, bool scaled, const Flown& flights) {
  auto solver = std::make_shared<Sb02md>(12, false, scaled);
  auto samples = std::make_shared<Samples>(flights);
  return {name, false,
          [flights, solver, samples] {
            bool solved = true;
            for (std::size_t i = 0; i < flights->equations.size(); ++i) {
              const RiccatiMatrices& p = flights->equations[i];
              solved = solver->solve(p.A, flights->G[i], p.Q) && solved;
              samples->keep(i, solver->X());
            }
            return solved;
          },
          [samples] { return samples->worst_residual(); }};
}
#endif

Contest solves(const Flown& flights) {
  Contest contest;
  contest.name = fmt::format("schedule, {} solves n=12", flights->equations.size());
  contest.goal_ratio = 5;
  contest.goal_residual = 1e-12;
  contest.rival = "SB02MD";
  contest.contestants = {our_batch(flights), our_solver(flights)};
#ifdef QUADTUNE_WITH_SLICOT
  contest.contestants.push_back(slicot("SB02MD", false, flights));
  contest.contestants.push_back(slicot("SB02MD scaled", true, flights));
#endif
  return contest;
}

void print_stage(const std::string& name, const Wall& wall, std::size_t points) {
  fmt::print("| {} | {:.1f} | {:.1f} | {:.2f} |\n", name, wall.median * 1e3, wall.min * 1e3,
             wall.median * 1e6 / static_cast<double>(points));
}

/// Largest relative difference of a gain of the schedule from that of RiccatiSolver.
double gain_difference(const Flights& flights, const GainSchedule& schedule) {
  RiccatiSolver solver(12, 4);
  double worst = 0;
  for (std::size_t i = 0; i < flights.equations.size(); i += kSample) {
    const RiccatiMatrices& p = flights.equations[i];
    const MatrixXd& K = solver.care(p.A, p.B, p.Q, p.R).K;
    worst = std::max(worst, (schedule.gains(static_cast<Index>(i)).K - K).norm() / K.norm());
  }
  return worst;
}

void print_schedule(Flights& flights) {
  const std::size_t points = flights.trims.size();
  fmt::print(
      "\n| whole schedule, wall time | median [ms] | least [ms] | per point [us] |\n"
      "|---|---:|---:|---:|\n");
  print_stage("trim, one thread", wall_of([&] { trim_all(flights); }), points);
  print_stage("Jacobian, one thread", wall_of([&] { linearize_all(flights); }), points);
  const std::vector<std::size_t> counts = {1, 2};
  GainSchedule schedule;
  for (const std::size_t threads : counts)
    print_stage(
        fmt::format("trim, Jacobian and gain, {} thread{}", threads, threads > 1 ? "s" : ""),
        wall_of([&] {
          schedule =
              gain_schedule(flights.vehicle, flights.axes, flights.design, {.threads = threads});
        }),
        points);
  fmt::print(
      "\n{} of {} points solved, residual at most {:.1e}, gain at most {:.1e} from that of "
      "the single solver\n",
      schedule.solved_count(), points, schedule.residual.maxCoeff(),
      gain_difference(flights, schedule));
}

}  // namespace
}  // namespace quadtune::bench

int main(int argc, char** argv) {
  const auto flights = quadtune::bench::make_flights();
  const int status = quadtune::bench::run({quadtune::bench::solves(flights)}, argc, argv);
  if (status == 0) quadtune::bench::print_schedule(*flights);
  return status;
}
