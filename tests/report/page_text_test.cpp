// SPDX-License-Identifier: Apache-2.0
#include "report/page/page_text.hpp"

#include <gmock/gmock.h>

#include <limits>
#include <nlohmann/json.hpp>

#include "hostile_texts.hpp"

namespace quadtune {
namespace {

using namespace report;
using nlohmann::json;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

std::vector<unsigned char> bytes(const std::string& text) { return {text.begin(), text.end()}; }

// RFC 4648, section 10.
TEST(Base64, IsThatOfTheStandard) {
  EXPECT_EQ(base64(bytes("")), "");
  EXPECT_EQ(base64(bytes("f")), "Zg==");
  EXPECT_EQ(base64(bytes("fo")), "Zm8=");
  EXPECT_EQ(base64(bytes("foo")), "Zm9v");
  EXPECT_EQ(base64(bytes("foob")), "Zm9vYg==");
  EXPECT_EQ(base64(bytes("fooba")), "Zm9vYmE=");
  EXPECT_EQ(base64(bytes("foobar")), "Zm9vYmFy");
  EXPECT_EQ(base64(std::vector<unsigned char>{0xfb, 0xff, 0xbe}), "+/++");
}

// 1 is 3f800000, -2 is c0000000, the quiet NaN 7fc00000, all least significant byte first.
TEST(Base64, HoldsFloatsLittleEndian) {
  EXPECT_EQ(float32_base64({1}), base64(std::vector<unsigned char>{0, 0, 0x80, 0x3f}));
  EXPECT_EQ(float32_base64({-2}), base64(std::vector<unsigned char>{0, 0, 0, 0xc0}));
  const std::string nan = base64(std::vector<unsigned char>{0, 0, 0xc0, 0x7f});
  EXPECT_EQ(float32_base64({std::numeric_limits<double>::quiet_NaN()}), nan);
  EXPECT_EQ(float32_base64({std::numeric_limits<double>::infinity()}), nan);
  EXPECT_EQ(float32_base64({-1e39}), nan);  // beyond the range of a float
  EXPECT_EQ(float64_base64({1}), base64(std::vector<unsigned char>{0, 0, 0, 0, 0, 0, 0xf0, 0x3f}));
}

// FIPS 180-2's example "abc": ba7816bf 8f01cfea 414140de 5dae2223 b00361a3 96177a9c b410ff61
// f20015ad.
TEST(PolicyHash, IsSha256InBase64) {
  EXPECT_EQ(policy_hash("abc"), "'sha256-ungWv48Bz+pBQUDeXa4iI7ADYaOWF3qctBD/YfIAFa0='");
}

TEST(HtmlText, EscapesMarkup) {
  EXPECT_EQ(html_text("a <b> & \"c\" 'd'"), "a &lt;b&gt; &amp; &quot;c&quot; &#39;d&#39;");
  EXPECT_EQ(html_text("18 \xC2\xB0, \xE2\x88\x92"
                      "1"),
            "18 \xC2\xB0, \xE2\x88\x92"
            "1");
  EXPECT_EQ(html_text(std::string("\0\n\x7f", 3)), "\xEF\xBF\xBD\xEF\xBF\xBD\xEF\xBF\xBD");
  EXPECT_EQ(html_text("a\xff"), "a\\xff");
}

TEST(HtmlText, LetsNoHostileTextOut) {
  for (const std::string& text : testing::hostile_texts())
    EXPECT_THAT(html_text(text), AllOf(Not(HasSubstr("<")), Not(HasSubstr(">")),
                                       Not(HasSubstr("\"")), Not(HasSubstr("'"))));
}

TEST(ScriptJson, EscapesWhatEndsAScript) {
  EXPECT_EQ(script_json("</script><!--&"), R"("\u003c/script\u003e\u003c!--\u0026")");
  EXPECT_EQ(script_json("\xE2\x80\xA8\xE2\x80\xA9"), R"("\u2028\u2029")");
  EXPECT_EQ(script_json("a\xff"), R"("a\\xff")");
  EXPECT_EQ(script_json({{"a", std::numeric_limits<double>::quiet_NaN()}}), R"({"a":null})");
}

// Plain ASCII without markup, and still the same text for a JSON parser.
TEST(ScriptJson, LetsNoHostileTextOutAndChangesNone) {
  for (const std::string& text : testing::hostile_texts()) {
    const std::string script = script_json(json{{text, text}});
    EXPECT_EQ(script.find_first_of("<>&"), std::string::npos);
    for (const char c : script) {
      EXPECT_GE(c, 0x20);
      EXPECT_LT(c, 0x7f + 1);
    }
    if (text.find("no UTF-8") == std::string::npos) {
      EXPECT_EQ(json::parse(script), (json{{text, text}}));
    } else {
      EXPECT_THAT(json::parse(script).begin().key(), HasSubstr("\\xff\\xfe \\xc0\\x80"));
    }
  }
}

}  // namespace
}  // namespace quadtune
