// SPDX-License-Identifier: Apache-2.0
#include "quadtune/internal/json_value.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <nlohmann/json.hpp>
#include <random>
#include <set>
#include <string>
#include <vector>

#include "quadtune/internal/joined.hpp"

namespace quadtune::internal {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

TEST(JsonValue, WritesObjectsInTheOrderOfTheirMembers) {
  Json json = {{"z", 1}, {"a", {1.5, "two", nullptr, true}}};
  json["m"] = -3;
  EXPECT_EQ(json_text(json), R"({"z":1,"a":[1.5,"two",null,true],"m":-3})");
  EXPECT_THAT(json.keys(), ElementsAre("z", "a", "m"));
}

TEST(JsonValue, ListsOfPairsThatBeginWithATextAreObjects) {
  EXPECT_TRUE((Json{{"a", 1}, {"b", 2}}).is_object());
  EXPECT_TRUE((Json{{"a", 1}, {2, 2}}).is_array());
  EXPECT_TRUE((Json{{"a", 1, 2}}).is_array());
  EXPECT_TRUE((Json{"a", "b"}).is_array());
  EXPECT_EQ(json_text(Json::array({{"a", 1}})), R"([["a",1]])");
}

TEST(JsonValue, TheFirstOfTwoMembersOfOneNameCounts) {
  EXPECT_EQ(json_text(Json{{"a", 1}, {"a", 2}}), R"({"a":1})");
}

TEST(JsonValue, KindsAreThoseOfTheValues) {
  EXPECT_TRUE(Json().is_null());
  EXPECT_TRUE(Json(true).is_boolean());
  EXPECT_TRUE(Json(1.0).is_number_float());
  EXPECT_TRUE(Json(7).is_number_unsigned());
  EXPECT_FALSE(Json(-7).is_number_unsigned());
  EXPECT_TRUE(Json(-7).is_number_integer());
  EXPECT_TRUE(Json("text").is_string());
  EXPECT_TRUE(Json(std::vector<double>{1, 2}).is_array());
  EXPECT_EQ(json_text(Json(std::vector<std::string>{"a", "b"})), R"(["a","b"])");
}

TEST(JsonValue, NumbersAreEqualWhereTheirValuesAre) {
  EXPECT_EQ(Json(1), Json(1.0));
  EXPECT_EQ(Json(1U), Json(1));
  EXPECT_NE(Json(1), Json(true));
  EXPECT_NE(Json(1), Json("1"));
  EXPECT_EQ(Json(std::numeric_limits<std::uint64_t>::max()), Json::parse("18446744073709551615"));
}

// Seeded random doubles of all magnitudes, and the library's own text of the same values.
TEST(JsonValue, NumbersReadBackToTheSameDouble) {
  std::mt19937_64 random(20);
  for (int i = 0; i < 20000; ++i) {
    double number = 0;
    const std::uint64_t bits = random();
    std::memcpy(&number, &bits, sizeof number);
    if (!std::isfinite(number)) continue;
    const std::string text = json_text(Json(number));
    EXPECT_EQ(text, nlohmann::json(number).dump());
    EXPECT_EQ(Json::parse(text).get<double>(), number) << text;
  }
}

TEST(JsonValue, ReadsAndWritesTheSameText) {
  const std::string text =
      R"({"b":[[],{},[1,2.5,-3,1e-300],"\u0001\"\\ö"],"a":{"n":null,"t":true,"f":false}})";
  EXPECT_EQ(json_text(Json::parse(text)), text);
}

TEST(JsonValue, RefusesTextThatIsNotJson) {
  try {
    (void)Json::parse("{\"a\": 1,\n \"b\": }");
    FAIL();
  } catch (const JsonError& error) {
    EXPECT_EQ(error.byte(), 16U);
    EXPECT_FALSE(error.out_of_range());
    EXPECT_THAT(error.what(), HasSubstr("line 2"));
  }
  try {
    (void)Json::parse("[1e999]");
    FAIL();
  } catch (const JsonError& error) {
    EXPECT_TRUE(error.out_of_range());
  }
}

// A million brackets: copying or destroying such a value would overflow the stack.
TEST(JsonValue, RefusesWhatIsNestedTooDeep) {
  const auto nested = [](std::size_t depth) {
    return std::string(depth, '[') + std::string(depth, ']');
  };
  EXPECT_EQ(json_text(Json::parse(nested(400))), nested(400));
  for (const std::size_t depth : {600U, 1000000U})
    EXPECT_THAT([&] { (void)Json::parse(nested(depth)); },
                ThrowsMessage<JsonError>(HasSubstr("more than 500 levels deep")));
}

TEST(JsonValue, RefusesNumbersThatATypeCannotHold) {
  EXPECT_EQ(Json(2.0).get<int>(), 2);
  EXPECT_EQ(Json::parse("18446744073709551615").get<std::uint64_t>(),
            std::numeric_limits<std::uint64_t>::max());
  for (const char* text : {"2.5", "1e300", "4294967297", "18446744073709551615"})
    EXPECT_THROW((void)Json::parse(text).get<int>(), JsonError) << text;
  for (const char* text : {"-1", "-1.0", "0.5", "1e300"})
    EXPECT_THROW((void)Json::parse(text).get<std::uint64_t>(), JsonError) << text;
  EXPECT_THROW((void)Json(std::nan("")).get<int>(), JsonError);
}

TEST(JsonValue, RefusesWhatIsOfAnotherKind) {
  const Json json = {{"text", "x"}, {"number", 1}, {"list", {1, 2}}};
  EXPECT_THAT([&] { (void)json["text"].get<double>(); },
              ThrowsMessage<JsonError>("is a string, expected a number"));
  EXPECT_THAT([&] { (void)json["number"].get<std::string>(); },
              ThrowsMessage<JsonError>("is a number, expected text"));
  EXPECT_THAT([&] { (void)json["number"].get<bool>(); },
              ThrowsMessage<JsonError>("is a number, expected a boolean"));
  EXPECT_THAT([&] { (void)json["absent"]; }, ThrowsMessage<JsonError>("has no \"absent\""));
  EXPECT_THAT([&] { (void)json["list"][2]; }, ThrowsMessage<JsonError>("has no entry 2 of 2"));
  EXPECT_THAT([&] { (void)json["number"]["x"]; },
              ThrowsMessage<JsonError>("is a number, expected an object"));
  Json text = "x";
  EXPECT_THAT([&] { text.push_back(1); },
              ThrowsMessage<JsonError>("is a string, expected an array"));
  EXPECT_EQ(json.find("absent"), nullptr);
}

TEST(JsonValue, UpdateReplacesAndAdds) {
  Json json = {{"a", 1}, {"b", 2}};
  json.update({{"b", 3}, {"c", 4}});
  EXPECT_EQ(json_text(json), R"({"a":1,"b":3,"c":4})");
}

TEST(JsonValue, ReadableTextPutsRowsUnderRows) {
  EXPECT_EQ(readable({{"K", {{1, 2}, {3, 4}}}, {"name", "x"}, {"empty", Json::array()}}),
            "{\n  \"K\": [\n    [1, 2],\n    [3, 4]\n  ],\n  \"name\": \"x\",\n  \"empty\": []\n}");
}

TEST(Joined, PutsTheSeparatorBetween) {
  EXPECT_EQ(joined(std::vector<std::string>{"a", "b", "c"}, ", "), "a, b, c");
  EXPECT_EQ(joined(std::vector<std::string>{"a"}, ", "), "a");
  EXPECT_EQ(joined(std::vector<std::string>{}, ", "), "");
  EXPECT_EQ(joined(std::set<std::string>{"b", "a"}, " or "), "a or b");
}

}  // namespace
}  // namespace quadtune::internal
