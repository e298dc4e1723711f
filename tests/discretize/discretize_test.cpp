// SPDX-License-Identifier: Apache-2.0
#include "quadtune/discretize/discretize.hpp"

#include "matrix_near.hpp"
#include "plants/hover_model.hpp"
#include "quadtune/discretize/backward_euler.hpp"
#include "quadtune/discretize/euler.hpp"
#include "quadtune/discretize/foh.hpp"
#include "quadtune/discretize/impulse.hpp"
#include "quadtune/discretize/tustin.hpp"
#include "quadtune/discretize/zoh.hpp"
#include "quadtune/errors.hpp"

namespace quadtune {
namespace {

using Method = DiscretizationMethod;

using Eigen::MatrixXd;
using ::testing::HasSubstr;
using testing::MatrixNear;
using ::testing::ThrowsMessage;

constexpr DiscretizationMethod kAll[] = {DiscretizationMethod::zoh,
                                         DiscretizationMethod::foh,
                                         DiscretizationMethod::impulse,
                                         DiscretizationMethod::euler,
                                         DiscretizationMethod::backward_euler,
                                         DiscretizationMethod::tustin,
                                         DiscretizationMethod::matched};

TEST(Discretize, WordsReadBack) {
  std::string words;
  for (const DiscretizationMethod method : kAll) {
    EXPECT_EQ(discretization_method(to_string(method), "--method"), method);
    words += to_string(method) + " ";
  }
  EXPECT_EQ(words, "zoh foh impulse euler backward-euler tustin matched ");
}

TEST(Discretize, RefusesUnknownWordsAndSuggests) {
  EXPECT_THAT([] { (void)discretization_method("tusting", "--method"); },
              ThrowsMessage<InvalidInput>(
                  HasSubstr("--method: no discretization method 'tusting', expected zoh, foh, "
                            "impulse, euler, backward-euler, tustin, matched; did you mean "
                            "'tustin'?")));
}

TEST(Discretize, GoesThroughTheNamedMethod) {
  const ContinuousLti p = testing::uquad_hover();
  const auto sampled = [&](DiscretizationMethod method) { return discretize(p, 0.01, method); };
  const auto expect_same = [](const DiscreteLti& got, const DiscreteLti& want) {
    EXPECT_THAT(got.A, MatrixNear(want.A, 0));
    EXPECT_THAT(got.B, MatrixNear(want.B, 0));
    EXPECT_THAT(got.D, MatrixNear(want.D, 0));
  };
  expect_same(sampled(Method::zoh), discretize_zoh(p, 0.01));
  expect_same(sampled(Method::foh), discretize_foh(p, 0.01));
  expect_same(sampled(Method::impulse), discretize_impulse(p, 0.01));
  expect_same(sampled(Method::euler), discretize_euler(p, 0.01));
  expect_same(sampled(Method::backward_euler), discretize_backward_euler(p, 0.01));
  expect_same(sampled(Method::tustin), discretize_tustin(p, 0.01));
  expect_same(discretize(p, 0.01, Method::tustin, {.prewarp = 20, .delays = {}}),
              discretize_tustin(p, 0.01, 20));
}

TEST(Discretize, RefusesToPrewarpOtherMethods) {
  const ContinuousLti p = testing::uquad_hover();
  for (const DiscretizationMethod method : kAll) {
    if (method == DiscretizationMethod::tustin) continue;
    EXPECT_THAT(
        [&] { (void)discretize(p, 0.01, method, {.prewarp = 20, .delays = {}}); },
        ThrowsMessage<InvalidInput>(HasSubstr(
            to_string(method) + ": prewarp is 20 rad/s, expected no prewarping because only")));
  }
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
