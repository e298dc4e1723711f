// SPDX-License-Identifier: Apache-2.0
/// Riccati problems whose matrices differ in magnitude as much as double precision permits,
/// verified in 100 digits by an algorithm that the solver does not use.
/// QUADTUNE_RICCATI_PROBLEMS=2000 sets the number of problems of each class.
#include <Eigen/QR>
#include <cmath>
#include <cstdlib>
#include <string>

#include "matrix_near.hpp"
#include "plants/riccati_by_100_digits.hpp"
#include "plants/riccati_problems.hpp"
#include "quadtune/synthesis/riccati.hpp"
#include "sanitized.hpp"

namespace quadtune {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using testing::LongMatrix;
using testing::LongReal;
using testing::RiccatiCase;

double relative_difference(const MatrixXd& K, const LongMatrix& exact) {
  return LongReal((K.cast<LongReal>() - exact).norm() / exact.norm()).convert_to<double>();
}

/// Checks that a solution is accurate to 1e-6, or has a warning and is accurate to ten times the
/// error that it states. Only if Q has a negative eigenvalue by rounding, the exact problem may
/// have no solution; the warning must then state this.
void expect_right(const RiccatiCase& c, bool discrete, bool always_has_one = true) {
  const RiccatiResult r = discrete ? dare(c.A, c.B, c.Q, c.R, c.N) : care(c.A, c.B, c.Q, c.R, c.N);
  ASSERT_TRUE(r.solved()) << r;
  const testing::RiccatiJudgement judgement =
      testing::by_100_digits(testing::LongRiccatiCase(c), discrete, r.K.cast<LongReal>());
  ASSERT_TRUE(judgement.stabilizes) << r;
  if (r.rcond < 1e-12) {
    EXPECT_THAT(r.warning, ::testing::HasSubstr("ill-conditioned"));
  }
  if (!judgement.exact) {
    EXPECT_FALSE(always_has_one) << r;
    EXPECT_EQ(r.gain_error, std::numeric_limits<double>::infinity()) << r;
    EXPECT_THAT(r.warning, ::testing::HasSubstr("decides whether a solution exists"));
    return;
  }
  if (always_has_one) {
    EXPECT_FALSE(std::isinf(r.gain_error)) << r << "; " << r.warning;
  }
  const double error = relative_difference(r.K, judgement.exact->K);
  EXPECT_LE(error, r.warning.empty() ? 1e-6 : std::max(1e-6, 10 * r.gain_error))
      << r << "; " << r.warning;
}

/// Number of problems of each class.
int problems() {
  const char* asked = std::getenv("QUADTUNE_RICCATI_PROBLEMS");
  // 100 digits are twenty times slower under sanitizers.
  const int few = testing::kSanitized ? 4 : 60;
  return asked == nullptr ? few : std::max(1, std::atoi(asked));
}

/// Entries of 20 bits: a product of two such matrices of up to 12 rows is exact, so that Q = CᵀC is
/// of the rank of C to the last bit.
MatrixXd short_entries(Index rows, Index cols, std::mt19937_64& random) {
  return testing::random_matrix(rows, cols, random).unaryExpr([](double x) {
    return std::ldexp(std::round(std::ldexp(x, 17)), -17);
  });
}

double power_of_ten(double low, double high, std::mt19937_64& random) {
  return std::pow(10, std::uniform_real_distribution<double>(low, high)(random));
}

/// V diag(s) Vᵀ with V orthogonal and s from 1 down to 10^-decades, both ends included.
MatrixXd spread(Index m, double decades, std::mt19937_64& random) {
  const MatrixXd V =
      Eigen::HouseholderQR<MatrixXd>(testing::random_matrix(m, m, random)).householderQ();
  Eigen::VectorXd s(m);
  for (Index i = 0; i < m; ++i) s[i] = power_of_ten(-decades, 0, random);
  s[0] = 1;
  if (m > 1) s[m - 1] = std::pow(10, -decades);
  const MatrixXd R = V * s.asDiagonal() * V.transpose();
  return 0.5 * (R + R.transpose());
}

struct Class {
  std::string name;
  bool discrete;
  double q_low, q_high;  ///< decades of Q
  double r_low, r_high;  ///< decades of R
  double r_spread;       ///< decades between R's eigenvalues
  bool cross = false;
};

void PrintTo(const Class& one, std::ostream* out) { *out << one.name; }

class HardRiccati : public ::testing::TestWithParam<Class> {};

TEST_P(HardRiccati, AreNeitherRefusedNorWrong) {
  const Class& kind = GetParam();
  std::mt19937_64 random(18);
  for (int k = 0; k < problems(); ++k) {
    const Index n = std::uniform_int_distribution<Index>(2, 9)(random);
    const Index m = std::uniform_int_distribution<Index>(1, std::min<Index>(n, 5))(random);
    const Index rank = std::uniform_int_distribution<Index>(1, n)(random);
    RiccatiCase c = testing::random_case(n, m, kind.discrete, false, random);
    const double q = power_of_ten(kind.q_low, kind.q_high, random);
    const double r = power_of_ten(kind.r_low, kind.r_high, random);
    if (k % 2 == 0) {
      const MatrixXd C = short_entries(rank, n, random);
      c.Q = std::exp2(std::round(std::log2(q))) * (C.transpose() * C);
    } else {  // rounding leaves eigenvalues on either side of 0
      const MatrixXd C = testing::random_matrix(rank, n, random);
      c.Q = q * (C.transpose() * C);
      c.Q = (0.5 * (c.Q + c.Q.transpose())).eval();
    }
    c.R = r * spread(m, kind.r_spread, random);
    SCOPED_TRACE(::testing::Message() << "problem " << k << ": n = " << n << ", m = " << m
                                      << ", rank of Q " << rank << ", Q " << q << ", R " << r);
    expect_right(c, kind.discrete, k % 2 == 0);
  }
}

INSTANTIATE_TEST_SUITE_P(Classes, HardRiccati,
                         ::testing::Values(Class{"DiscreteTinyR", true, 5, 10, -10, -7, 3},
                                           Class{"DiscreteNearlySingularR", true, -1, 1, -1, 1, 14},
                                           Class{"ContinuousTinyR", false, 5, 10, -10, -7, 3},
                                           Class{"ContinuousNearlySingularR", false, -1, 1, -1, 1,
                                                 14}),
                         [](const auto& kind) { return kind.param.name; });

// Regression: this problem was rejected, although the plain recursion solves it in a few steps.
TEST(HardRiccati, RegressionWronglyRejected) {
  const RiccatiCase c{
      MatrixXd{{1.7201196195664805, 0.041165363426994013, 0.14770458274935161},
               {-1.2792430645800528, 0.78684279923809686, 0.45940270930452715},
               {-1.0950779705776266, 0.43440567557847048, -0.25670235817587544}},
      MatrixXd{{-0.40051856959365306, -0.46724699793066691, 0.912220687825814},
               {1.2183134105951932, -1.0077714990400832, 1.358631239299571},
               {-0.8366120871179884, -0.93808516466711378, -1.7498922510255728}},
      MatrixXd{{20139315.302494008, -1512.3981978709712, 9937884.3579582423},
               {-1512.3981978709712, 0.11357626982681489, -746.30334586225342},
               {9937884.3579582423, -746.30334586225342, 4903917.7364644902}},
      MatrixXd{{2.9155950659709673e-09, -1.6334461020510406e-09, 1.288105358000569e-09},
               {-1.6334461020510406e-09, 1.0823784413989883e-09, -9.1580075932590007e-10},
               {1.288105358000569e-09, -9.1580075932590007e-10, 1.1302718632151552e-09}}};
  expect_right(c, true);
  const RiccatiResult r = dare(c.A, c.B, c.Q, c.R);
  EXPECT_NEAR(r.X.norm(), 2.5e7, 1e6);
  EXPECT_NEAR(r.poles.cwiseAbs().maxCoeff(), 0.80, 0.01);
}

// Regression: the solution had an error of 6e-4 without a warning. Doubling leaves a residual of
// 7e-14, which the nearly singular R amplifies in K much more than in X.
TEST(HardRiccati, RegressionWrongWithoutWarning) {
  const RiccatiCase c{
      MatrixXd{{-0.046867966891066509, 0.0070315883560805297, 0.068605052768975244},
               {-1.651799054011897, 0.76239238287251188, 0.16072454947219836},
               {-0.10722623147240963, 0.93735745588129094, -0.78801163780616801}},
      MatrixXd{{-0.15227677628336306, 1.8124824484743778, -0.69848876034354002},
               {0.02497809645273065, 0.64459691804522756, 2.2552757943566011},
               {-0.84768179008628897, -0.42717346980593413, 0.95320648525046381}},
      MatrixXd{{0.15094867166227149, -0.34215844530023937, -0.13634475564975224},
               {-0.34215844530023937, 1.0227426101248989, 0.32950460787342611},
               {-0.13634475564975224, 0.32950460787342611, 0.12484559046534337}},
      MatrixXd{{0.14459821068328368, 0.060067083785726366, 0.012386411526903229},
               {0.060067083785726366, 0.024952277014968591, 0.0051453971438360528},
               {0.012386411526903229, 0.0051453971438360528, 0.0010610512877714362}}};
  expect_right(c, false, false);
}

// By rounding, Q has the eigenvalue -2.5e-10, while the smallest eigenvalue of R is 3e-11: the
// Hamiltonian matrix has eigenvalues on the imaginary axis, and the result in double precision is
// not a solution.
TEST(HardRiccati, ReportsThatRoundingDecides) {
  const RiccatiCase c{
      MatrixXd{{0.39132280958716753, 1.6941207501232569, -1.0089438279968586},
               {-1.7164933450325932, -1.6433734502649251, -0.13605014661735351},
               {0.54734143840868432, 2.3691106209481032, -0.51541296201749598}},
      MatrixXd{{0.79650231975191632, -1.7630791106367976, -0.72216840482782318},
               {0.54570360924697325, 0.85078449423609159, -0.24176118957268755},
               {1.0092193794022775, -2.6116223128623153, -1.2117208456625248}},
      MatrixXd{{3009344.5617697141, 2892602.2780388724, 128708.32639151503},
               {2892602.2780388724, 2780388.8079852113, 123715.31091930741},
               {128708.32639151503, 123715.31091930741, 5504.7977865196162}},
      MatrixXd{{3.1089392651893559e-10, -1.9925442064533951e-09, 2.1067205227721992e-09},
               {-1.9925442064533951e-09, 1.4526402604921767e-08, -1.5767496559587209e-08},
               {2.1067205227721992e-09, -1.5767496559587209e-08, 1.7993563540722737e-08}}};
  expect_right(c, false, false);
}

// R = 0 and BᵀQB = 0: the input affects the cost after two steps. With K = [0.25 0.7] both poles
// are 0.
TEST(HardRiccati, AcceptsACostThatTheInputAffectsLate) {
  const MatrixXd A{{0.5, 1}, {0, 0.2}}, B{{0}, {1}}, Q{{1, 0}, {0, 0}}, R{{0}};
  const RiccatiResult r = dare(A, B, Q, R);
  ASSERT_TRUE(r.solved()) << r;
  EXPECT_NEAR(r.K(0, 0), 0.25, 1e-12);
  EXPECT_NEAR(r.K(0, 1), 0.7, 1e-12);
  EXPECT_EQ(r.warning, "") << r;
}

}  // namespace
}  // namespace quadtune
