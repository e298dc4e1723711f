// SPDX-License-Identifier: Apache-2.0
/// The public uquad gains against the converged ones, and the recursion that explains the
/// difference. Writes docs/uquad-gains.md.
#include <fmt/format.h>

#include <Eigen/Dense>
#include <fstream>
#include <optional>

#include "golden.hpp"
#include "matrix_near.hpp"
#include "plants/hover_model.hpp"
#include "quadtune/synthesis/lqr.hpp"
#include "quadtune/synthesis/state_feedback.hpp"
#include "shared_data.hpp"

namespace quadtune {
namespace {

constexpr double kDt = 0.01;

/// A published gain and the problem that it solves.
struct Published {
  std::string label;
  std::vector<std::string> files;  // K, and K_int where there is one
  std::vector<std::string> states;
  std::vector<std::string> integrals;
  double r;
};

const std::vector<std::string> kAll = {"x",   "y",   "z",   "psi", "phi", "theta",
                                       "vqx", "vqy", "vqz", "wqx", "wqy", "wqz"};

std::vector<Published> published_gains() {
  return {{"K_full", {"K_full.txt"}, kAll, {}, 0.01},
          {"K_prop_full + K_int_full",
           {"K_prop_full.txt", "K_int_full.txt"},
           kAll,
           {"x", "y", "z", "theta"},
           0.01},
          {"K", {"K.txt"}, {"z", "psi", "phi", "theta", "vqz", "wqx", "wqy", "wqz"}, {}, 1}};
}

Eigen::MatrixXd read_file(const std::filesystem::path& path, Eigen::Index cols) {
  std::ifstream file(path);
  Eigen::MatrixXd M(4, cols);
  for (Eigen::Index i = 0; i < 4; ++i)
    for (Eigen::Index j = 0; j < cols; ++j) file >> M(i, j);
  EXPECT_TRUE(file) << path;
  return M;
}

/// [K K_int] as published.
Eigen::MatrixXd read_published(const Published& gains, const std::filesystem::path& data) {
  const auto nx = static_cast<Eigen::Index>(gains.states.size());
  const auto ni = static_cast<Eigen::Index>(gains.integrals.size());
  Eigen::MatrixXd K(4, nx + ni);
  K.leftCols(nx) = read_file(data / "uquad" / gains.files[0], nx);
  if (ni > 0) K.rightCols(ni) = read_file(data / "uquad" / gains.files[1], ni);
  return K;
}

/// The hover model with the listed states only.
ContinuousLti reduced_hover(const std::vector<std::string>& kept) {
  const ContinuousLti full = testing::uquad_hover();
  std::vector<Eigen::Index> index;
  ContinuousLti plant;
  for (std::size_t i = 0; i < full.states.size(); ++i)
    if (std::find(kept.begin(), kept.end(), full.states[i].name) != kept.end()) {
      index.push_back(static_cast<Eigen::Index>(i));
      plant.states.push_back(full.states[i]);
    }
  plant.A = full.A(index, index);
  plant.B = full.B(index, Eigen::all);
  plant.inputs = full.inputs;
  return plant;
}

LqrDesign problem(const Published& gains) {
  LqrDesign design;
  design.states = gains.states;
  design.integrals = gains.integrals;
  Eigen::VectorXd q(static_cast<Eigen::Index>(gains.states.size()));
  for (std::size_t i = 0; i < gains.states.size(); ++i) {
    const std::string& name = gains.states[i];
    q(static_cast<Eigen::Index>(i)) = name == "psi" || name == "phi" || name == "theta" ? 1e3 : 1;
  }
  design.Q = q.asDiagonal();
  const auto ni = static_cast<Eigen::Index>(gains.integrals.size());
  design.Q_integral = Eigen::MatrixXd::Identity(ni, ni);
  design.R = gains.r * Eigen::MatrixXd::Identity(4, 4);
  design.method = LqrMethod::discrete;
  design.dt = kDt;
  return design;
}

/// The state of the Riccati recursion when it was stopped.
struct Replay {
  Eigen::MatrixXd K;
  int steps = 0;
};

/// Iterates the Riccati difference equation from X = Q on the plant sampled by a third-order Taylor
/// polynomial, until the gain changes by less than 1e-4 in the spectral norm.
Replay replay(const ContinuousLti& plant, const LqrWeights& weights) {
  const Eigen::Index nx = plant.A.rows();
  const Eigen::MatrixXd Adt = plant.A * kDt;
  const Eigen::MatrixXd I = Eigen::MatrixXd::Identity(nx, nx);
  const Eigen::MatrixXd A = I + Adt * (I + Adt / 2 * (I + Adt / 3));
  const Eigen::MatrixXd B = kDt * (I + Adt / 2 * (I + Adt / 3)) * plant.B;
  Eigen::MatrixXd X = weights.Q;
  Replay result;
  for (double moved = 1; moved >= 1e-4 && result.steps < 20000; ++result.steps) {
    const Eigen::MatrixXd K =
        (weights.R + B.transpose() * X * B).ldlt().solve(B.transpose() * X * A);
    if (result.steps > 0)
      moved = Eigen::JacobiSVD<Eigen::MatrixXd>(K - result.K).singularValues()(0);
    result.K = K;
    X = weights.Q + A.transpose() * X * (A - B * K);
    X = 0.5 * (X + X.transpose()).eval();
  }
  return result;
}

/// The contents of the page about one gain.
struct Comparison {
  Published gains;
  Eigen::MatrixXd published;
  StateFeedback converged;
  Replay stopped;
};

double largest_difference(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
  return (a - b).cwiseAbs().maxCoeff() / b.cwiseAbs().maxCoeff();
}

/// Largest difference of an entry relative to that entry, over entries that are not zero.
double largest_entry_difference(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
  const double floor = 1e-9 * b.cwiseAbs().maxCoeff();
  double worst = 0;
  for (Eigen::Index i = 0; i < a.rows(); ++i)
    for (Eigen::Index j = 0; j < a.cols(); ++j)
      if (std::abs(b(i, j)) > floor)
        worst = std::max(worst, std::abs(a(i, j) - b(i, j)) / std::abs(b(i, j)));
  return worst;
}

Comparison compare(const Published& gains, const std::filesystem::path& data) {
  const ContinuousLti plant = reduced_hover(gains.states);
  const LqrDesign design = problem(gains);
  const ContinuousLti augmented = with_integrals(plant, gains.integrals);
  const LqrWeights weights = with_integral_weights({design.Q, design.R, {}}, design.Q_integral);
  return {gains, read_published(gains, data), state_feedback(plant, design),
          replay(augmented, weights)};
}

std::string row_table(const Comparison& c) {
  std::string text = "| column | published | converged | difference |\n|---|---|---|---|\n";
  std::vector<std::string> columns = c.gains.states;
  for (const std::string& name : c.gains.integrals) columns.push_back("int " + name);
  const Eigen::MatrixXd& K = c.converged.riccati.K;
  for (std::size_t j = 0; j < columns.size(); ++j) {
    const auto col = static_cast<Eigen::Index>(j);
    if (std::abs(K(0, col)) < 1e-9 * K.cwiseAbs().maxCoeff()) continue;
    text += fmt::format("| {} | {:.7f} | {:.7f} | {:+.1e} |\n", columns[j], c.published(0, col),
                        K(0, col), c.published(0, col) - K(0, col));
  }
  return text;
}

std::string page(const std::vector<Comparison>& all) {
  std::string text =
      "# The uquad's published gains and the converged ones\n\n"
      "The test `tests/synthesis/lqr/uquad_gains_test.cpp` writes this page; "
      "`QUADTUNE_UPDATE_DOCS=1`\nupdates it.\n\n"
      "This page compares the published gains of the uquad project with the gains that quadtune "
      "computes\nfor the same problems:\n\n"
      "- hover of the 1.741 kg vehicle without a centre-of-mass offset, with rotor speeds as "
      "inputs;\n- all 12 states for `K_full`; these and the integrals of x, y, z and theta for\n"
      "  `K_prop_full + K_int_full`; z, psi, phi, theta, vqz, wqx, wqy and wqz for `K`;\n- "
      "integrals "
      "as states of the continuous model, sampled by zero-order hold at 10 "
      "ms;\n- weights per step of 1 on every state and integral, except 1000 on psi, phi and "
      "theta; R = r I.\n\n"
      "The converged gain is that of the stabilizing solution of the discrete Riccati equation, "
      "with a\nresidual below 1e-12. The published gains are the files of the public project.\n\n"
      "| gain | r | largest difference of an entry, relative to it | relative to the largest "
      "entry |\n|---|---|---|---|\n";
  for (const Comparison& c : all)
    text += fmt::format("| `{}` | {} | {:.1e} | {:.1e} |\n", c.gains.label, c.gains.r,
                        largest_entry_difference(c.published, c.converged.riccati.K),
                        largest_difference(c.published, c.converged.riccati.K));
  text +=
      "\n## Why they differ\n\n"
      "The published gains are iterates of the Riccati recursion and not its limit. The following"
      "\nrecursion reproduces every published digit. It starts with `X = Q` and iterates\n`X <- Q "
      "+ A'X(A - BK)`, `K = (R + B'XB)^-1 B'XA`, with a plant that is sampled by a Taylor\n"
      "polynomial of third order. It stops as soon as the gain changes by less than 1e-4 "
      "(spectral norm)\nin one step.\n\n"
      "| gain | steps until the stop | replayed against published, relative to the largest entry |"
      "\n|---|---|---|\n";
  for (const Comparison& c : all)
    text += fmt::format("| `{}` | {} | below 3e-8 |\n", c.gains.label, c.stopped.steps);
  text +=
      "\nThe files contain eight digits, so 3e-8 is their rounding error. A slow mode (with a "
      "time constant\nof seconds, at 100 steps a second) changes little in one step even if it is "
      "far from its limit.\nThe stop criterion measures the step and not this distance. The "
      "truncated exponential causes a\nrelative difference of less than 2e-7. quadtune iterates "
      "to convergence and does not reproduce\nthis stop criterion.\n\n"
      "## First rows\n\n"
      "The difference is published minus converged. Columns whose entry is zero are omitted.\n";
  for (const Comparison& c : all) text += fmt::format("\n`{}`\n\n", c.gains.label) + row_table(c);
  return text;
}

TEST(UquadGains, PublishedFilesAreTheRecursionStoppedEarly) {
  QUADTUNE_REQUIRE_DATA(data);
  std::vector<Comparison> all;
  for (const Published& gains : published_gains()) {
    all.push_back(compare(gains, data));
    const Comparison& c = all.back();
    ASSERT_TRUE(c.converged.solved()) << c.gains.label << ": " << c.converged.riccati;
    EXPECT_LT(c.converged.riccati.residual, 1e-12) << c.gains.label;
    EXPECT_LT(largest_difference(c.stopped.K, c.published), 3e-8) << c.gains.label;
    EXPECT_LT(largest_entry_difference(c.published, c.converged.riccati.K), 4e-2) << c.gains.label;
    EXPECT_GT(largest_entry_difference(c.published, c.converged.riccati.K), 1e-4) << c.gains.label;
  }
  // reference value of the integral gain on theta
  EXPECT_NEAR(all[1].converged.K_int(0, 3), -4.8083286, 5e-8);
  EXPECT_TRUE(testing::matches_document("docs/uquad-gains.md", page(all)));
}

}  // namespace
}  // namespace quadtune
