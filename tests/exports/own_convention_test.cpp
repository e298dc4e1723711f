// SPDX-License-Identifier: Apache-2.0
// Exports in a convention that is defined in a file.
#include <gmock/gmock.h>

#include <string>

#include "plants/export_models.hpp"
#include "quadtune/convention_file.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/exports/convert.hpp"
#include "quadtune/exports/export.hpp"
#include "quadtune/exports/read_gains.hpp"
#include "quadtune/exports/verify.hpp"
#include "temporary_directory.hpp"

namespace quadtune {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

/// The axes of uquad under another name, from a file.
const Convention& from_file(const std::string& name) {
  const testing::TemporaryDirectory directory;
  Convention convention = quadtune::convention("uquad", "test");
  convention.name = name;
  return named_convention(directory.write("c.toml", convention_text(convention)), "test");
}

std::string replaced(std::string text, const std::string& before, const std::string& after) {
  EXPECT_NE(text.find(before), std::string::npos) << before;
  for (std::size_t at = text.find(before); at != std::string::npos;
       at = text.find(before, at + after.size()))
    text.replace(at, before.size(), after);
  return text;
}

ExportContent content_in(const Convention& convention) {
  ExportContent content = testing::uquad_content();
  content.gains = in_convention(*content.gains, convention);
  return content;
}

TEST(OwnConvention, EqualToABuiltInOneGivesTheSameBytes) {
  const ExportContent built_in = testing::uquad_content();
  // With its own name it is the built-in convention; with another name, it is converted without
  // rounding.
  ExportContent same = content_in(from_file("uquad"));
  ExportContent turned = content_in(from_file("own-uquad"));
  EXPECT_EQ(turned.gains->convention, "own-uquad");
  turned.gains = in_convention(*turned.gains, convention("uquad", "test"));
  const std::vector<FileContent> expected = export_files(ExportKind::uquad, built_in);
  for (const ExportContent& content : {same, turned}) {
    const std::vector<FileContent> files = export_files(ExportKind::uquad, content);
    ASSERT_EQ(files.size(), expected.size());
    for (std::size_t i = 0; i < files.size(); ++i) {
      EXPECT_EQ(files[i].name, expected[i].name);
      EXPECT_EQ(files[i].bytes, expected[i].bytes) << files[i].name;
    }
  }
}

TEST(OwnConvention, IsDefinedInTheExportAndVerified) {
  const testing::TemporaryDirectory directory;
  const ExportContent content = content_in(from_file("own-export"));
  write_export(directory.path(), ExportKind::json, content);
  const VerifyReport report = verify_export(directory.path(), {});
  int compared = 0;
  for (const VerifyCheck& check : report.checks) {
    if (check.name.find("matches") == std::string::npos &&
        check.name.find("gains are those") == std::string::npos)
      continue;
    ++compared;
    EXPECT_TRUE(check.ok) << check.name << ": " << check.detail;
  }
  EXPECT_EQ(compared, 2);
  EXPECT_EQ(read_gains(directory.path()).convention, "own-export");
}

// The other name represents another process, which never read the file of the convention.
TEST(OwnConvention, IsReadBackWithoutItsFile) {
  const testing::TemporaryDirectory directory;
  const std::vector<FileContent> files =
      export_files(ExportKind::json, content_in(from_file("own-before")));
  for (const FileContent& file : files)
    directory.write(file.name, replaced(file.bytes, "own-before", "own-after"));
  const Manifest manifest = read_manifest(directory.path());
  EXPECT_EQ(manifest.gains->convention, "own-after");
  const Gains gains = read_gains(directory.path());
  const Gains back = in_convention(gains, convention("uquad", "test"));
  EXPECT_EQ(back.K, testing::uquad_content().gains->K);
}

TEST(OwnConvention, IsRefusedWhereItsDefinitionIsNotThatOfItsName) {
  const testing::TemporaryDirectory directory;
  const std::string text = gains_json_text(content_in(from_file("own-definition")));
  const auto refused = [&](const std::string& before, const std::string& after,
                           const std::string& message) {
    const auto path = directory.write("gains.json", replaced(text, before, after));
    EXPECT_THAT([&] { (void)read_gains(path); }, ThrowsMessage<InvalidInput>(HasSubstr(message)));
  };
  refused("y = -py", "y = py",
          "gains.convention.definition: another convention with the name 'own-definition'");
  refused("y = -py", "y = -pw",
          "gains.convention.definition:4: states: 'y = -pw' does not name a signal");
  refused("name = \\\"own-definition", "name = \\\"own-other",
          "gains.convention.definition: defines 'own-other', expected 'own-definition'");
}

}  // namespace
}  // namespace quadtune
