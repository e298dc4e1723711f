// SPDX-License-Identifier: Apache-2.0
// Riccati equations: quadtune with every input check against SLICOT and a LAPACK ordered-Schur
// solver. docs/benchmarks.md describes what is timed.
#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <memory>

#include "contest.hpp"
#include "peers/ordered_schur.hpp"
#include "peers/slicot.hpp"
#include "problems.hpp"
#include "quadtune/discretize/zoh.hpp"
#include "quadtune/synthesis/riccati.hpp"
#include "residuals.hpp"

namespace quadtune::bench {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

enum class Time { continuous, discrete };

/// A problem with the precomputed inputs of the peers.
struct Shared {
  Problem problem;
  MatrixXd G;  // B R⁻¹ Bᵀ
  Time time;

  [[nodiscard]] double residual(const MatrixXd& X) const {
    return time == Time::continuous ? care_residual(problem, X) : dare_residual(problem, X);
  }
};

/// RiccatiSolver, which reuses its memory like the peers: X, K, residual and the proof that the
/// loop is stable, with validation of all inputs.
Contestant our_solver(const std::shared_ptr<const Shared>& shared) {
  RiccatiOptions options;
  options.evidence = RiccatiEvidence::essential;
  auto solver =
      std::make_shared<RiccatiSolver>(shared->problem.A.rows(), shared->problem.B.cols(), options);
  auto X = std::make_shared<const MatrixXd*>(nullptr);
  return {"quadtune", true,
          [shared, solver, X] {
            const Problem& p = shared->problem;
            const RiccatiResult& result = shared->time == Time::continuous
                                              ? solver->care(p.A, p.B, p.Q, p.R)
                                              : solver->dare(p.A, p.B, p.Q, p.R);
            *X = &result.X;
            return result.solved();
          },
          [shared, X] { return shared->residual(**X); }};
}

/// The functions care() and dare(), which allocate their memory.
Contestant our_function(const std::string& name, RiccatiEvidence evidence,
                        const std::shared_ptr<const Shared>& shared) {
  auto result = std::make_shared<RiccatiResult>();
  return {name, true,
          [shared, result, evidence] {
            const Problem& p = shared->problem;
            RiccatiOptions options;
            options.evidence = evidence;
            *result = shared->time == Time::continuous
                          ? care(p.A, p.B, p.Q, p.R, MatrixXd(), options)
                          : dare(p.A, p.B, p.Q, p.R, MatrixXd(), options);
            return result->solved();
          },
          [shared, result] { return shared->residual(result->X); }};
}

/// A peer with a precomputed G.
template <class Solver, class Solve>
Contestant peer(const std::string& name, const std::shared_ptr<const Shared>& shared,
                std::shared_ptr<Solver> solver, Solve solve) {
  return {name, false, [shared, solver, solve] { return solve(*solver, *shared); },
          [shared, solver] { return shared->residual(solver->X()); }};
}

Contest contest(const std::string& name, Time time, const Problem& problem, double goal_ratio,
                double goal_residual, const std::string& rival = "") {
  const MatrixXd G = problem.B * problem.R.llt().solve(problem.B.transpose());
  const auto shared = std::make_shared<const Shared>(Shared{problem, G, time});
  const Index nx = problem.A.rows();
  [[maybe_unused]] const Index nu = problem.B.cols();
  [[maybe_unused]] const bool discrete = time == Time::discrete;
  Contest result{
      name,
      goal_ratio,
      goal_residual,
      rival,
      {our_solver(shared), our_function("quadtune function", RiccatiEvidence::essential, shared),
       our_function("quadtune, with poles", RiccatiEvidence::full, shared)}};
  result.contestants.push_back(
      peer("LAPACK ordered Schur", shared, std::make_shared<OrderedSchur>(nx),
           [](OrderedSchur& solver, const Shared& s) {
             return s.time == Time::continuous ? solver.care(s.problem.A, s.G, s.problem.Q)
                                               : solver.dare(s.problem.A, s.G, s.problem.Q);
           }));
#ifdef QUADTUNE_WITH_SLICOT
  const auto solve_G = [](Sb02md& solver, const Shared& s) {
    return solver.solve(s.problem.A, s.G, s.problem.Q);
  };
  result.contestants.push_back(
      peer("SB02MD", shared, std::make_shared<Sb02md>(nx, discrete, false), solve_G));
  result.contestants.push_back(
      peer("SB02MD scaled", shared, std::make_shared<Sb02md>(nx, discrete, true), solve_G));
  result.contestants.push_back(peer("SB02OD", shared, std::make_shared<Sb02od>(nx, nu, discrete),
                                    [](Sb02od& solver, const Shared& s) {
                                      return solver.solve(s.problem.A, s.problem.B, s.problem.Q,
                                                          s.problem.R);
                                    }));
#endif
  return result;
}

/// Zero-order hold at 5 ms with the same weights: the discrete problem of a flight computer.
Problem sampled(const Problem& problem) {
  const DiscreteLti plant = discretize_zoh(
      {.A = problem.A, .B = problem.B, .C = {}, .D = {}, .states = {}, .inputs = {}, .outputs = {}},
      0.005);
  return {plant.A, plant.B, problem.Q, problem.R};
}

std::vector<Contest> contests() {
  std::vector<Contest> all;
  const auto continuous = [&](const std::string& name, const Problem& p, double goal,
                              double residual) {
    all.push_back(contest(fmt::format("care {} n={}", name, p.A.rows()), Time::continuous, p, goal,
                          residual));
  };
  continuous("random", random_problem(12), 5, 1e-12);
  continuous("random", random_problem(16), 4, 1e-12);
  for (const Index nx : {24, 48, 96, 192}) continuous("random", random_problem(nx), 3, 1e-12);
  continuous("63 g hover", hover_problem(), 3, 1e-13);
  continuous("63 g hover, integrals", hover_with_integrals(), 3, 1e-13);
  continuous("63 g hover, unit weights", unit_weights(hover_problem()), 3, 1e-13);
  continuous("63 g integrals, unit weights", unit_weights(hover_with_integrals()), 3, 1e-13);

  const auto discrete = [&](const std::string& name, const Problem& p, double residual) {
    all.push_back(contest(fmt::format("dare {} n={}", name, p.A.rows()), Time::discrete, p, 5,
                          residual, "SB02MD"));
  };
  discrete("random", random_problem(12), 1e-12);
  discrete("random", random_problem(16), 1e-12);
  discrete("63 g hover 5 ms", sampled(hover_problem()), 1e-12);
  discrete("63 g integrals 5 ms", sampled(hover_with_integrals()), 1e-12);
  return all;
}

}  // namespace
}  // namespace quadtune::bench

int main(int argc, char** argv) {
  return quadtune::bench::run(quadtune::bench::contests(), argc, argv);
}
