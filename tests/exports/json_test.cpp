// SPDX-License-Identifier: Apache-2.0
#include "quadtune/internal/json.hpp"

#include <gmock/gmock.h>

#include <limits>
#include <random>

#include "matrix_near.hpp"
#include "quadtune/errors.hpp"

namespace quadtune::internal {
namespace {

using ::testing::HasSubstr;
using testing::MatrixNear;
using ::testing::ThrowsMessage;

TEST(Json, MatricesReadBackToTheSameDoubles) {
  std::mt19937_64 random(1);
  Eigen::MatrixXd M(7, 5);
  for (double& entry : M.reshaped())
    entry = std::ldexp(std::uniform_real_distribution<double>(-1, 1)(random),
                       std::uniform_int_distribution<int>(-900, 900)(random));
  const Json json = Json::parse(readable(matrix_to_json(M, "M")));
  EXPECT_THAT(matrix_from_json(json, "M"), MatrixNear(M, 0));
}

TEST(Json, RefusesNumbersThatAreNotFinite) {
  Eigen::MatrixXd M = Eigen::MatrixXd::Ones(2, 2);
  M(1, 0) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT([&] { (void)matrix_to_json(M, "K"); },
              ThrowsMessage<InvalidInput>(HasSubstr("K has nan at (2,1)")));
  EXPECT_THAT([&] { (void)number_to_json(-std::numeric_limits<double>::infinity(), "residual"); },
              ThrowsMessage<InvalidInput>(HasSubstr("residual: -inf cannot be written")));
  Eigen::VectorXcd poles(1);
  poles(0) = {1, std::numeric_limits<double>::quiet_NaN()};
  EXPECT_THROW((void)poles_to_json(poles, "poles"), InvalidInput);
}

TEST(Json, WritesOneRowALine) {
  Json json;
  json["K"] = {{1, 2}, {3, 4}};
  json["states"] = signals_to_json({{"z", "m"}});
  json["none"] = Json::array();
  EXPECT_EQ(readable(json),
            "{\n  \"K\": [\n    [1, 2],\n    [3, 4]\n  ],\n"
            "  \"states\": [\n    {\"name\": \"z\", \"unit\": \"m\"}\n  ],\n  \"none\": []\n}");
}

TEST(Json, RefusalsNameThePath) {
  const auto refusal = [](const char* text, const std::string& message) {
    EXPECT_THAT([&] { (void)matrix_from_json(Json::parse(text), "a.json: K"); },
                ThrowsMessage<InvalidInput>(HasSubstr(message)))
        << text;
  };
  refusal("[[1, 2], [3]]", "a.json: K[1]: has 1 entry, expected 2");
  refusal("[[1, \"2\"]]", "a.json: K[0][1]: is \"2\", expected a finite number");
  refusal("[[1, null]]", "a.json: K[0][1]: is null, expected a finite number");
  refusal("3", "a.json: K: is a number, expected an array of rows");
}

TEST(Json, PolesAndSignalsReadBack) {
  Eigen::VectorXcd poles(2);
  poles << std::complex<double>(0.9, 0.1), std::complex<double>(0.9, -0.1);
  EXPECT_EQ(poles_from_json(poles_to_json(poles, "p"), "p"), poles);
  const std::vector<Signal> signals = {{"z", "m"}, {"psi", ""}};
  EXPECT_EQ(signals_from_json(signals_to_json(signals), "s"), signals);
}

}  // namespace
}  // namespace quadtune::internal
