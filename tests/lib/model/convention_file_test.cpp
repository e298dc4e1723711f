// SPDX-License-Identifier: Apache-2.0
#include "quadtune/convention_file.hpp"

#include <gmock/gmock.h>

#include <string>

#include "quadtune/design.hpp"
#include "quadtune/errors.hpp"
#include "source_folder.hpp"
#include "temporary_directory.hpp"

namespace quadtune {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

/// World and body x forward, y left, z up; attitude first; with different names.
std::string up_and_left(const std::string& name) {
  return "name = \"" + name + R"("
description = "x forward, y left, z up"
states = ["phi = roll", "theta = -pitch", "psi = -yaw", "x = px", "y = -py", "z = -pz",
          "vx = u", "vy = -v", "vz = -w", "wx = p", "wy = -q", "wz = -r"]
wrench = ["thrust = T", "mx = tau_x", "my = -tau_y", "mz = -tau_z"]
)";
}

std::string with(std::string text, const std::string& before, const std::string& after) {
  const std::size_t at = text.find(before);
  EXPECT_NE(at, std::string::npos) << before;
  return text.replace(at, before.size(), after);
}

TEST(ConventionFile, MapsItsStatesToNed) {
  const Convention c = parse_convention(up_and_left("own"), "c.toml");
  EXPECT_EQ(c.states[1], (Signal{"theta", "rad"}));
  EXPECT_EQ(c.wrench[3], (Signal{"mz", "N m"}));
  EXPECT_EQ(c.sign_law, SignLaw::set_point_minus_state);
  Eigen::Matrix<double, 12, 1> ned;
  ned << 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12;
  Eigen::Matrix<double, 12, 1> expected;
  expected << 4, -5, -6, 1, -2, -3, 7, -8, -9, 10, -11, -12;
  EXPECT_EQ(c.from_ned * ned, expected);
  EXPECT_EQ(c.wrench_from_ned * Eigen::Vector4d(1, 2, 3, 4), Eigen::Vector4d(1, 2, -3, -4));
}

TEST(ConventionFile, OfABuiltInConventionIsThatConvention) {
  for (const Convention& c : conventions()) {
    const testing::TemporaryDirectory directory;
    const std::string path = directory.write("c.toml", convention_text(c));
    EXPECT_EQ(&named_convention(path, "here"), &c);
    // Relative to a folder.
    EXPECT_EQ(&named_convention("c.toml", "here", directory.path()), &c);
  }
}

TEST(ConventionFile, IsKnownByItsNameOnceRead) {
  EXPECT_THAT([] { (void)convention("own-name", "here"); },
              ThrowsMessage<InvalidInput>(HasSubstr("no convention 'own-name', expected ned")));
  const testing::TemporaryDirectory directory;
  const std::string path = directory.write("c.toml", up_and_left("own-name"));
  const Convention& own = named_convention(path, "here");
  EXPECT_EQ(&convention("own-name", "here"), &own);
  EXPECT_FALSE(is_built_in(own));
  // As often as asked; its own text is the same convention.
  EXPECT_EQ(&add_convention(parse_convention(convention_text(own), "c"), "here"), &own);
  // Another one cannot have its name, nor that of a built-in one.
  for (const std::string name : {"own-name", "uquad"})
    EXPECT_THAT(
        [&] {
          const std::string other = with(up_and_left(name), "x = px", "x = -px");
          (void)add_convention(parse_convention(other, "c"), "other.toml");
        },
        ThrowsMessage<InvalidInput>(
            AllOf(HasSubstr("other.toml: another convention with the name '" + name + "'"),
                  HasSubstr("expected a different name"))));
}

TEST(ConventionFile, CanBeThatOfADesign) {
  const testing::TemporaryDirectory directory;
  directory.write("c.toml", convention_text(convention("uquad", "test")));
  const std::string text = load_design(testing::source_folder() + "/designs/uquad-hover.toml").text;
  const std::string own = with(text, "convention = \"uquad\"", "convention = \"c.toml\"");
  const std::string path = directory.write("d.toml", own);
  const Design design = load_design(path), expected = parse_design(text, "d.toml");
  EXPECT_EQ(design.lqr->convention, "uquad");
  EXPECT_EQ(design.lqr->states, expected.lqr->states);
  EXPECT_EQ(design.lqr->Q, expected.lqr->Q);
  EXPECT_THAT([&] { (void)parse_design(own, "d.toml"); },
              ThrowsMessage<FileError>(HasSubstr("c.toml")));
}

TEST(ConventionFile, RefusesWhatIsNoPermutation) {
  const std::string good = up_and_left("own");
  const auto refused = [&](const std::string& before, const std::string& after,
                           const std::string& message) {
    EXPECT_THAT([&] { (void)parse_convention(with(good, before, after), "c.toml"); },
                ThrowsMessage<InvalidInput>(HasSubstr(message)));
  };
  refused("theta = -pitch", "theta = -pich",
          "c.toml:3: states: 'theta = -pich' does not name a signal of ned, expected one of px, "
          "py, pz, "
          "roll, pitch, yaw, u, v, w, p, q, r; did you mean 'pitch'?");
  refused("vy = -v", "vy = -u",
          "c.toml:4: states: 'vy = -u' uses u, which is already used; expected each");
  refused("vy = -v", "vx = -v",
          "c.toml:4: states: 'vx = -v' defines a name that is already defined");
  refused("\"vy = -v\"", "\"vy\"",
          "c.toml:4: states: 'vy' is not a definition, expected 'NAME = v' or 'NAME = -v'");
  refused("vy = -v", "v y = -v", "is not a definition");
  refused("\"vy = -v\", ", "", "c.toml:3: states has 11 entries, expected 12, one for each of px");
  refused("my = -tau_y", "my = -tau_x", "wrench: 'my = -tau_x' uses tau_x, which is already used");
  refused("wrench = [", "thrusts = [", "thrusts");
  refused("name = \"own\"", "name = \"my own\"", "c.toml:1: ");
  refused("description", "sign_law = \"minus\"\ndescription", "c.toml:2: no sign law 'minus'");
}

}  // namespace
}  // namespace quadtune
