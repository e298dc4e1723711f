// SPDX-License-Identifier: Apache-2.0
#include "quadtune/discretize/discretize.hpp"

#include "hover_model.hpp"
#include "matrix_near.hpp"
#include "quadtune/discretize/euler.hpp"
#include "quadtune/discretize/tustin.hpp"
#include "quadtune/discretize/zoh.hpp"
#include "quadtune/errors.hpp"

namespace quadtune {
namespace {

using Eigen::MatrixXd;
using ::testing::HasSubstr;
using testing::MatrixNear;
using ::testing::ThrowsMessage;

TEST(Discretize, WordsReadBack) {
  for (const DiscretizationMethod method :
       {DiscretizationMethod::zoh, DiscretizationMethod::euler, DiscretizationMethod::tustin})
    EXPECT_EQ(discretization_method(to_string(method), "--method"), method);
  EXPECT_EQ(to_string(DiscretizationMethod::zoh), "zoh");
}

TEST(Discretize, RefusesUnknownWordsAndSuggests) {
  EXPECT_THAT([] { (void)discretization_method("tusting", "--method"); },
              ThrowsMessage<InvalidInput>(
                  HasSubstr("--method: no discretization method 'tusting', expected zoh, euler, "
                            "tustin; did you mean 'tustin'?")));
}

TEST(Discretize, GoesThroughTheNamedMethod) {
  const ContinuousLti p = testing::uquad_hover();
  const auto A = [&](DiscretizationMethod method) { return discretize(p, 0.01, method).A; };
  EXPECT_THAT(A(DiscretizationMethod::zoh), MatrixNear(discretize_zoh(p, 0.01).A, 0));
  EXPECT_THAT(A(DiscretizationMethod::euler), MatrixNear(discretize_euler(p, 0.01).A, 0));
  EXPECT_THAT(A(DiscretizationMethod::tustin), MatrixNear(discretize_tustin(p, 0.01).A, 0));
}

TEST(DiscretizeEuler, AddsOneStepOfTheDerivative) {
  ContinuousLti p;
  p.A = MatrixXd{{0, 1}, {-4, -2}};
  p.B = MatrixXd{{0}, {3}};
  p.C = MatrixXd{{1, 0}};
  p.states = {{"z", "m"}, {"vz", "m/s"}};
  const DiscreteLti d = discretize_euler(p, 0.5);
  EXPECT_THAT(d.A, MatrixNear(MatrixXd{{1, 0.5}, {-2, 0}}, 0));
  EXPECT_THAT(d.B, MatrixNear(MatrixXd{{0}, {1.5}}, 0));
  EXPECT_THAT(d.C, MatrixNear(p.C, 0));
  EXPECT_EQ(d.states, p.states);
  EXPECT_EQ(d.dt, 0.5);
}

TEST(DiscretizeEuler, DiffersFromTheHoldBySecondOrder) {
  const ContinuousLti p = testing::uquad_hover();
  const auto error = [&](double dt) {
    return (discretize_euler(p, dt).A - discretize_zoh(p, dt).A).norm();
  };
  EXPECT_NEAR(error(0.01) / error(0.005), 4, 0.05);
}

TEST(DiscretizeEuler, RefusesBadPeriods) {
  ContinuousLti p;
  p.A = MatrixXd{{1}};
  p.B = MatrixXd{{1}};
  EXPECT_THAT([&] { (void)discretize_euler(p, -1); },
              ThrowsMessage<InvalidInput>(HasSubstr("euler: dt is -1 s, expected a positive")));
  p.A = MatrixXd{{1e300}};
  EXPECT_THAT([&] { (void)discretize_euler(p, 1e100); },
              ThrowsMessage<InvalidInput>(HasSubstr("expected a shorter period")));
}

}  // namespace
}  // namespace quadtune
