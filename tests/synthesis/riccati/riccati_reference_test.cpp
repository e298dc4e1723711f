// SPDX-License-Identifier: Apache-2.0
// Published problems: CAREX (Abels and Benner 1999), DAREX (Benner, Laub, Mehrmann 1995) and the
// examples of SLICOT's manual.
#include <Eigen/LU>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>

#include "matrix_near.hpp"
#include "plants/riccati_problems.hpp"
#include "quadtune/synthesis/riccati.hpp"
#include "shared_data.hpp"

namespace quadtune {
namespace {

using Eigen::MatrixXd;
using testing::fortran_numbers;
using testing::MatrixNear;
using testing::RiccatiCase;
using testing::take_matrix;

constexpr double kEps = std::numeric_limits<double>::epsilon();

MatrixXd from_json(const nlohmann::json& rows) {
  MatrixXd M(static_cast<Eigen::Index>(rows.size()), static_cast<Eigen::Index>(rows[0].size()));
  for (Eigen::Index i = 0; i < M.rows(); ++i)
    for (Eigen::Index j = 0; j < M.cols(); ++j)
      M(i, j) = rows[static_cast<std::size_t>(i)][static_cast<std::size_t>(j)].get<double>();
  return M;
}

void expect_accurate(const RiccatiCase& c, bool discrete, const MatrixXd& X,
                     const RiccatiOptions& options = {}) {
  const RiccatiResult r = discrete ? dare(c.A, c.B, c.Q, c.R, MatrixXd(), options)
                                   : care(c.A, c.B, c.Q, c.R, MatrixXd(), options);
  ASSERT_TRUE(r.solved()) << r;
  EXPECT_LE(r.residual, 1e-12);
  EXPECT_LE(testing::riccati_residual(c, r.X, discrete), 1e-12);
  EXPECT_LE((r.X - X).norm() / X.norm(), 100 * kEps / r.rcond) << r;
}

TEST(RiccatiReference, SixtyDigitSolutions) {
  QUADTUNE_REQUIRE_DATA(data);
  std::ifstream file(data / "known" / "riccati_cases.json");
  const nlohmann::json cases = nlohmann::json::parse(file);
  for (const bool discrete : {false, true})
    for (const auto& entry : cases.at(discrete ? "dare" : "care")) {
      SCOPED_TRACE((discrete ? "dare " : "care ") + entry.at("case").dump());
      const RiccatiCase c{from_json(entry.at("A")), from_json(entry.at("B")),
                          from_json(entry.at("Q")), from_json(entry.at("R"))};
      const MatrixXd X = from_json(entry.at("X"));
      expect_accurate(c, discrete, X);
      RiccatiOptions by_schur;
      by_schur.max_iterations = 1;
      expect_accurate(c, discrete, X, by_schur);
    }
}

// CAREX example 1.6: jet engine, 30 states whose sizes differ by 1e5; Q = CᵀC, R = I.
TEST(RiccatiReference, CarexJetEngine) {
  QUADTUNE_REQUIRE_DATA(data);
  std::vector<double> numbers = fortran_numbers(data / "known" / "slicot" / "BB01106.dat");
  RiccatiCase c;
  c.A = take_matrix(numbers, 30, 30);
  c.B = take_matrix(numbers, 30, 3);
  const MatrixXd C = take_matrix(numbers, 5, 30);
  ASSERT_TRUE(numbers.empty());
  c.Q = C.transpose() * C;
  c.R = MatrixXd::Identity(3, 3);
  const RiccatiResult doubling = care(c.A, c.B, c.Q, c.R);
  ASSERT_TRUE(doubling.solved()) << doubling;
  EXPECT_LE(testing::riccati_residual(c, doubling.X, false), 1e-12);
  RiccatiOptions by_schur;
  by_schur.max_iterations = 1;
  const RiccatiResult schur = care(c.A, c.B, c.Q, c.R, MatrixXd(), by_schur);
  ASSERT_TRUE(schur.solved()) << schur;
  EXPECT_LE((doubling.X - schur.X).norm() / schur.X.norm(), 100 * kEps / schur.rcond);
}

struct DarexPlant {
  const char* file;
  Eigen::Index nx;
  Eigen::Index nu;
};

// Plants of the DAREX examples 1.5, 1.6, 1.7, 1.8, 1.10 and 1.11, here with unit weights.
TEST(RiccatiReference, DarexPlantsWithUnitWeights) {
  QUADTUNE_REQUIRE_DATA(data);
  for (const DarexPlant& plant :
       {DarexPlant{"BB02105.dat", 4, 2}, DarexPlant{"BB02106.dat", 4, 2},
        DarexPlant{"BB02107.dat", 4, 4}, DarexPlant{"BB02108.dat", 5, 2},
        DarexPlant{"BB02110.dat", 9, 3}, DarexPlant{"BB02111.dat", 11, 2}}) {
    SCOPED_TRACE(plant.file);
    std::vector<double> numbers = fortran_numbers(data / "known" / "slicot" / plant.file);
    RiccatiCase c;
    c.A = take_matrix(numbers, plant.nx, plant.nx);
    c.B = take_matrix(numbers, plant.nx, plant.nu);
    ASSERT_TRUE(numbers.empty());
    c.Q = MatrixXd::Identity(plant.nx, plant.nx);
    c.R = MatrixXd::Identity(plant.nu, plant.nu);
    const RiccatiResult doubling = dare(c.A, c.B, c.Q, c.R);
    ASSERT_TRUE(doubling.solved()) << doubling;
    EXPECT_LE(testing::riccati_residual(c, doubling.X, true), 1e-13);
    RiccatiOptions by_schur;
    by_schur.max_iterations = 1;
    const RiccatiResult schur = dare(c.A, c.B, c.Q, c.R, MatrixXd(), by_schur);
    ASSERT_TRUE(schur.solved()) << schur;
    EXPECT_LE((doubling.X - schur.X).norm() / schur.X.norm(), 100 * kEps / schur.rcond);
  }
}

/// The solution in a result file of SLICOT's manual: the n × n numbers after "solution matrix X
/// is".
MatrixXd manual_solution(const std::filesystem::path& path, Eigen::Index n) {
  std::ifstream file(path);
  for (std::string line; std::getline(file, line);)
    if (line.find("solution matrix X is") != std::string::npos) break;
  MatrixXd X(n, n);
  for (Eigen::Index i = 0; i < n; ++i)
    for (Eigen::Index j = 0; j < n; ++j) file >> X(i, j);
  EXPECT_TRUE(static_cast<bool>(file)) << path;
  return X;
}

struct ManualExample {
  const char* name;
  bool discrete;
  RiccatiCase problem;
};

// SB02OD and SG02AD give C = [1 0; 0 1; 0 0] and D = [0 0 1]ᵀ: Q = CᵀC, R = DᵀD; SB02ND R = 0.
TEST(RiccatiReference, ExamplesOfTheSlicotManual) {
  QUADTUNE_REQUIRE_DATA(data);
  const MatrixXd integrator = (MatrixXd(2, 2) << 0, 1, 0, 0).finished();
  const MatrixXd b = (MatrixXd(2, 1) << 0, 1).finished();
  const MatrixXd weights = Eigen::Vector2d(1, 2).asDiagonal();
  const MatrixXd unit = MatrixXd::Identity(2, 2);
  const MatrixXd one = MatrixXd::Identity(1, 1);
  const MatrixXd A = (MatrixXd(2, 2) << 2, -1, 1, 0).finished();
  const MatrixXd second = Eigen::Vector2d(0, 1).asDiagonal();
  const std::vector<ManualExample> examples = {
      {"SB02MD", false, {integrator, b, weights, one}},
      {"SB02OD", false, {integrator, b, unit, one}},
      {"SB02RD", false, {integrator, b, weights, one}},
      {"SB02PD", false, {integrator, b, weights, one}},
      {"SG02AD", false, {integrator, b, unit, one}},
      {"SB02ND", true, {A, Eigen::Vector2d(1, 0), second, MatrixXd::Zero(1, 1)}},
  };
  for (const ManualExample& example : examples) {
    SCOPED_TRACE(example.name);
    const RiccatiCase& c = example.problem;
    const RiccatiResult r = example.discrete ? dare(c.A, c.B, c.Q, c.R) : care(c.A, c.B, c.Q, c.R);
    ASSERT_TRUE(r.solved()) << r;
    const std::filesystem::path file =
        data / "known" / "slicot" / (std::string(example.name) + ".res");
    EXPECT_THAT(r.X, MatrixNear(manual_solution(file, 2), 0.5e-4));
  }
}

}  // namespace
}  // namespace quadtune
