// SPDX-License-Identifier: Apache-2.0
#include "quadtune/internal/utf8.hpp"

#include <gtest/gtest.h>

#include <random>
#include <string>

#include "quadtune/internal/json.hpp"

namespace quadtune::internal {
namespace {

TEST(Utf8, ShowsEveryByteThatIsNone) {
  EXPECT_EQ(valid_utf8("c\xff"), "c\\xff");
  EXPECT_EQ(valid_utf8("J\xc3\xb6rg \xe2\x86\x92 \xf0\x9f\x9a\x81"),
            "J\xc3\xb6rg \xe2\x86\x92 \xf0\x9f\x9a\x81");
  // Latin-1, overlong, a surrogate, beyond U+10FFFF, cut short.
  EXPECT_EQ(valid_utf8("J\xf6rg"), "J\\xf6rg");
  EXPECT_EQ(valid_utf8("\xc0\xaf"), "\\xc0\\xaf");
  EXPECT_EQ(valid_utf8("\xed\xa0\x80"), "\\xed\\xa0\\x80");
  EXPECT_EQ(valid_utf8("\xf4\x90\x80\x80"), "\\xf4\\x90\\x80\\x80");
  EXPECT_EQ(valid_utf8("a\xe2\x86"), "a\\xe2\\x86");
}

TEST(Utf8, LetsNoControlAndNoMarkReachATerminal) {
  EXPECT_EQ(visible_text("a\x1b[31mb\x07\x7f\tc\nd"), "a\\x1b[31mb\\x07\\x7f\tc\nd");
  EXPECT_EQ(visible_text("\xc2\x9b\x9b"), "\\x9b\\x9b");  // C1 in UTF-8 and in Latin-1
  EXPECT_EQ(visible_text("gains\xe2\x80\xaetxt\xe2\x81\xa6\xe2\x80\x8f"),
            "gains\\u202etxt\\u2066\\u200f");
}

TEST(Utf8, CutsNoCharacterInTwo) {
  EXPECT_EQ(whole_characters("a\xc3\xb6", 2), "a");
  EXPECT_EQ(whole_characters("a\xc3\xb6", 3), "a\xc3\xb6");
}

TEST(JsonText, IsUtf8WhateverItsNamesAre) {
  std::mt19937 random(1);
  for (int i = 0; i < 2000; ++i) {
    std::string name;
    for (int k = 0; k < 12; ++k) name += static_cast<char>(random() % 256);
    const Json json = {{name, {name, 1.5, {{"inner", name}}}}};
    for (const std::string& text : {json_text(json), readable(json), json_text(json, true)}) {
      const Json back = Json::parse(text);
      EXPECT_EQ(back.keys()[0], valid_utf8(name));
      EXPECT_EQ(back[back.keys()[0]][2]["inner"], valid_utf8(name));
      EXPECT_EQ(visible_text(text), text);
    }
  }
}

TEST(JsonText, KeepsMarksOfDirection) {
  const Json json = "a\xe2\x80\xae\xc2\x85\x7f z";
  EXPECT_EQ(json_text(json), "\"a\\u202e\\u0085\\u007f z\"");
  EXPECT_EQ(Json::parse(json_text(json)), json);
}

}  // namespace
}  // namespace quadtune::internal
