// SPDX-License-Identifier: Apache-2.0
#include "quadtune/convention.hpp"

#include <gmock/gmock.h>

#include "matrix_near.hpp"
#include "quadtune/errors.hpp"

namespace quadtune {
namespace {

using ::testing::AllOf;
using ::testing::EndsWith;
using testing::MatrixNear;
using ::testing::Property;
using ::testing::StartsWith;
using ::testing::ThrowsMessage;

TEST(Convention, IsASignedPermutation) {
  for (const Convention& c : conventions()) {
    EXPECT_THAT(c.from_ned * c.from_ned.transpose(),
                MatrixNear(Eigen::MatrixXd::Identity(12, 12), 0))
        << c.name;
    EXPECT_EQ(c.from_ned.cwiseAbs().sum(), 12) << c.name;
  }
}

TEST(Convention, UquadCallsRollPsiAndTurnsYawAround) {
  const Convention& c = convention("uquad", "test");
  EXPECT_EQ(names(c.states), "x y z psi phi theta vqx vqy vqz wqx wqy wqz");
  Eigen::VectorXd ned = Eigen::VectorXd::Zero(12);
  ned << 1, 2, -3, 0.1, 0.2, 0.3, 4, 5, 6, 7, 8, 9;  // 3 m up, nose up, yawed right
  Eigen::VectorXd expected(12);
  expected << 1, -2, 3, 0.1, -0.2, -0.3, 4, -5, -6, 7, -8, -9;
  EXPECT_THAT(c.from_ned * ned, MatrixNear(expected, 0));
}

TEST(Convention, RefusesUnknownNameAndSuggests) {
  EXPECT_THAT([] { (void)convention("uqad", "--convention"); },
              ThrowsMessage<InvalidInput>(AllOf(
                  // Other tests of this program may have added conventions to the list.
                  StartsWith("--convention: no convention 'uqad', expected ned, uquad, mambo"),
                  EndsWith("; did you mean 'uquad'?"))));
}

TEST(Convention, WordsOfInputsAndSignLawReadBack) {
  for (const InputKind kind :
       {InputKind::rotor_speed, InputKind::rotor_thrust, InputKind::wrench, InputKind::command})
    EXPECT_EQ(input_kind(to_string(kind), "test"), kind);
  for (const SignLaw law : {SignLaw::set_point_minus_state, SignLaw::state_minus_set_point})
    EXPECT_EQ(sign_law(to_string(law), "test"), law);
}

}  // namespace
}  // namespace quadtune
