// SPDX-License-Identifier: Apache-2.0
#include "quadtune/exports/exporter.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <filesystem>

#include "plants/export_models.hpp"
#include "quadtune/design.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/exports/export.hpp"
#include "quadtune/exports/read_gains.hpp"
#include "quadtune/exports/verify.hpp"
#include "quadtune/text_matrix.hpp"
#include "source_folder.hpp"
#include "temporary_directory.hpp"

namespace quadtune {
namespace {

using ::testing::Contains;
using ::testing::Field;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

/// A flight program that reads only K, as numbers in rows: a complete example of an exporter.
Exporter rows_exporter() {
  Exporter exporter;
  exporter.target = {"rows", /*takes_memory=*/false, /*needs_gains=*/true};
  exporter.gain_files = {"rows.txt"};
  exporter.writes_cascade = false;
  exporter.files = [](const ExportContent& content) -> std::vector<FileContent> {
    std::string text;
    for (const auto& row : content.gains->K.rowwise()) {
      for (const double x : row) text += fmt::format("{} ", x);
      text += "\n";
    }
    return {{"rows.txt", text}};
  };
  exporter.read = [](const std::filesystem::path& directory, const Manifest& manifest) {
    StoredLaws laws{manifest.vehicle, *manifest.gains, {}};
    laws.gains->K = read_text_matrix((directory / "rows.txt").string());
    return laws;
  };
  exporter.read_plain = [](const std::filesystem::path& path) -> std::optional<StoredLaws> {
    const bool is_directory = std::filesystem::is_directory(path);
    const std::filesystem::path file = is_directory ? path / "rows.txt" : path;
    if (file.filename() != "rows.txt" || !std::filesystem::exists(file)) return {};
    StoredLaws laws{"rows", Gains{}, {}};
    laws.gains->K = read_text_matrix(file.string());
    return laws;
  };
  return exporter;
}

TEST(Exporter, OneOfTheUsersOwnIsWrittenReadAndVerified) {
  add_exporter(rows_exporter());
  const ExportKind kind = export_kind("rows", "here");
  EXPECT_EQ(to_string(kind), "rows");
  const testing::TemporaryDirectory directory;
  const ExportContent content = testing::uquad_content();
  const std::vector<ManifestFile> files = write_export(directory.path(), kind, content);
  EXPECT_THAT(files, Contains(Field(&ManifestFile::path, "rows.txt")));
  EXPECT_EQ(read_gains(directory.path()).K, content.gains->K);
  const VerifyReport good = verify_export(directory.path(), {});
  for (const VerifyCheck& check : good.checks)
    if (check.name.find("rows.txt") != std::string::npos) {
      EXPECT_TRUE(check.ok) << check.detail;
    }
  // Without the manifest, the exporter itself recognizes the files, in a folder or by name.
  const testing::TemporaryDirectory plain;
  const std::string rows = plain.write("rows.txt", "1 2\n3 4\n");
  EXPECT_EQ(read_laws(plain.path()).gains->K(1, 0), 3);
  EXPECT_EQ(read_laws(rows).vehicle, "rows");
  // The checks that all exporters share detect a changed number.
  directory.write("rows.txt", "1 2 3\n4 5 6\n");
  EXPECT_FALSE(verify_export(directory.path(), {}).ok());
  // A design file may request it.
  std::string design = load_design(testing::source_folder() + "/designs/uquad-hover.toml").text;
  const std::string asked = "to = \"uquad\"";
  ASSERT_NE(design.find(asked), std::string::npos);
  design.replace(design.find(asked), asked.size(), "to = \"rows\"");
  EXPECT_EQ(parse_design(design, "d.toml").exports.at(0).to, "rows");
}

TEST(Exporter, AFolderThatIsNoExportIsRefusedWithTheExportsInIt) {
  const testing::TemporaryDirectory directory;
  const std::string out = directory.path().string();
  EXPECT_THAT([&] { (void)read_laws(directory.path()); },
              ThrowsMessage<InvalidInput>(
                  out + ": has no manifest.json and no gain file; expected an export or one of "
                        "gains.json, controllerVars.m, K.txt, K_prop.txt, K_full.txt, "
                        "K_prop_full.txt, K_prop_full_pptz.txt"));
  for (const char* name : {"b", "a"}) {
    std::filesystem::create_directory(directory.path() / name);
    write_export(directory.path() / name, ExportKind::json, testing::uquad_content());
  }
  std::filesystem::create_directory(directory.path() / "pages");
  EXPECT_THAT([&] { (void)read_laws(directory.path()); },
              ThrowsMessage<InvalidInput>(out +
                                          ": has no manifest.json and no gain file; expected "
                                          "one of the exports in it: " +
                                          out + "/a, " + out + "/b"));
  EXPECT_TRUE(read_laws(directory.path() / "a").gains);
}

TEST(Exporter, AnUnknownOneIsRefusedWithThoseThatThereAre) {
  EXPECT_THAT(
      [] { (void)export_kind("uqad", "--to"); },
      ThrowsMessage<InvalidInput>(HasSubstr("--to: no export 'uqad', expected uquad, mambo, "
                                            "json")));
  EXPECT_THAT([] { (void)export_files(ExportKind("none"), testing::uquad_content()); },
              ThrowsMessage<InvalidInput>(HasSubstr("no export 'none'")));
}

}  // namespace
}  // namespace quadtune
