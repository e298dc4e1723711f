// SPDX-License-Identifier: Apache-2.0
// Zero-order hold: quadtune against SLICOT's MB05ND and Eigen's exponential of the augmented
// matrix. docs/benchmarks.md describes what is timed.
#include <fmt/format.h>

#include <memory>
#include <unsupported/Eigen/MatrixFunctions>

#include "contest.hpp"
#include "peers/slicot.hpp"
#include "problems.hpp"
#include "quadtune/discretize/zoh.hpp"
#include "residuals.hpp"

namespace quadtune::bench {
namespace {

using Eigen::MatrixXd;

/// A plant, its period, and the output of a contestant.
struct Hold {
  Problem problem;
  double dt;
  MatrixXd Ad;
  MatrixXd Bd;

  [[nodiscard]] double error() const { return hold_error(problem, dt, Ad, Bd); }
};

template <class Solve>
Contestant contestant(const std::string& name, bool is_ours, const Problem& problem, double dt,
                      Solve solve) {
  const auto hold =
      std::make_shared<Hold>(Hold{problem, dt, MatrixXd::Zero(problem.A.rows(), problem.A.rows()),
                                  MatrixXd::Zero(problem.B.rows(), problem.B.cols())});
  return {name, is_ours, [hold, solve]() mutable { return solve(*hold); },
          [hold] { return hold->error(); }};
}

/// The function discretize_zoh(), which allocates its result.
Contestant public_call(const Problem& problem, double dt) {
  ContinuousLti plant;
  plant.A = problem.A;
  plant.B = problem.B;
  return contestant("quadtune function", true, problem, dt, [plant](Hold& hold) {
    DiscreteLti sampled = discretize_zoh(plant, hold.dt);
    hold.Ad.swap(sampled.A);
    hold.Bd.swap(sampled.B);
    return true;
  });
}

/// ZohWorkspace, which reuses its memory like the peer.
Contestant workspace(const Problem& problem, double dt) {
  const auto zoh = std::make_shared<ZohWorkspace>(problem.A.rows(), problem.B.cols());
  return contestant("quadtune", true, problem, dt, [zoh](Hold& hold) {
    zoh->solve(hold.problem.A, hold.problem.B, hold.dt, hold.Ad, hold.Bd);
    return true;
  });
}

#ifdef QUADTUNE_WITH_SLICOT
Contestant mb05nd(const Problem& problem, double dt) {
  const auto solver = std::make_shared<Mb05nd>(problem.A.rows());
  return contestant("MB05ND", false, problem, dt, [solver](Hold& hold) {
    if (!solver->solve(hold.problem.A, hold.dt)) return false;
    hold.Ad = solver->exponential();
    hold.Bd.noalias() = solver->integral() * hold.problem.B;
    return true;
  });
}
#endif

Contestant eigen(const Problem& problem, double dt) {
  return contestant("Eigen exp", false, problem, dt, [](Hold& hold) {
    const Eigen::Index nx = hold.problem.A.rows();
    const Eigen::Index nu = hold.problem.B.cols();
    MatrixXd M = MatrixXd::Zero(nx + nu, nx + nu);
    M.topRows(nx) << hold.problem.A * hold.dt, hold.problem.B * hold.dt;
    const MatrixXd E = M.exp();
    hold.Ad = E.topLeftCorner(nx, nx);
    hold.Bd = E.topRightCorner(nx, nu);
    return true;
  });
}

Contest contest(const std::string& name, const Problem& problem, double dt, double goal) {
  Contest result{fmt::format("zoh {} n={} dt={}", name, problem.A.rows(), dt),
                 goal,
                 1e-14,
                 "",
                 {workspace(problem, dt), public_call(problem, dt)}};
#ifdef QUADTUNE_WITH_SLICOT
  result.rival = "MB05ND";
  result.contestants.push_back(mb05nd(problem, dt));
#endif
  result.contestants.push_back(eigen(problem, dt));
  return result;
}

std::vector<Contest> contests() {
  std::vector<Contest> all;
  all.push_back(contest("63 g hover", hover_problem(), 0.005, 5));
  all.push_back(contest("63 g hover", hover_problem(), 0.01, 5));
  all.push_back(contest("random", random_problem(12), 0.1, 5));
  all.push_back(contest("random", random_problem(12), 1, 5));
  all.push_back(contest("63 g integrals", hover_with_integrals(), 0.01, 0));
  all.push_back(contest("random", random_problem(24), 0.1, 0));
  all.push_back(contest("random", random_problem(48), 0.1, 0));
  return all;
}

}  // namespace
}  // namespace quadtune::bench

int main(int argc, char** argv) {
  return quadtune::bench::run(quadtune::bench::contests(), argc, argv);
}
