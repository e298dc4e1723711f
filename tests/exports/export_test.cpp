// SPDX-License-Identifier: Apache-2.0
#include "quadtune/exports/export.hpp"

#include <gmock/gmock.h>

#include <limits>

#include "matrix_near.hpp"
#include "plants/export_models.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/exports/diff.hpp"
#include "quadtune/exports/read_gains.hpp"
#include "temporary_directory.hpp"

namespace quadtune {
namespace {

namespace fs = std::filesystem;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using testing::mambo_content;
using testing::MatrixNear;
using ::testing::Not;
using testing::TemporaryDirectory;
using ::testing::ThrowsMessage;
using testing::uquad_content;

std::vector<std::string> names_in(const fs::path& directory) {
  std::vector<std::string> names;
  for (const fs::directory_entry& entry : fs::directory_iterator(directory))
    names.push_back(entry.path().filename());
  std::sort(names.begin(), names.end());
  return names;
}

TEST(Export, GivesTheSameBytesEveryTime) {
  for (const auto& [kind, content] : {std::pair(ExportKind::uquad, uquad_content()),
                                      std::pair(ExportKind::mambo, mambo_content()),
                                      std::pair(ExportKind::json, mambo_content())}) {
    const std::vector<FileContent> first = export_files(kind, content);
    const std::vector<FileContent> second = export_files(kind, content);
    ASSERT_EQ(first.size(), second.size());
    for (std::size_t i = 0; i < first.size(); ++i) EXPECT_EQ(first[i].bytes, second[i].bytes);
    EXPECT_EQ(first.back().name, "manifest.json");
    EXPECT_THAT(first.back().bytes, Not(HasSubstr("made_at")));
  }
}

TEST(Export, ManifestSaysWhatIsInItAndFromWhat) {
  const ExportContent content = uquad_content();
  const std::vector<FileContent> files = export_files(ExportKind::uquad, content);
  const Manifest manifest = parse_manifest(files.back().bytes, "manifest.json");
  EXPECT_EQ(manifest.kind, ExportKind::uquad);
  ASSERT_EQ(manifest.files.size(), 4U);
  EXPECT_EQ(manifest.files[0].path, "K_prop_full.txt");
  EXPECT_EQ(manifest.files[0].sha256, sha256(files[0].bytes));
  EXPECT_EQ(manifest.files[0].size, files[0].bytes.size());
  ASSERT_EQ(manifest.inputs.size(), 1U);
  EXPECT_EQ(manifest.inputs[0].sha256, sha256("abc"));
  EXPECT_EQ(manifest.evidence.residual, 1e-15);
  EXPECT_EQ(manifest.evidence.poles, content.evidence.poles);
  EXPECT_EQ(manifest.closed_loop_poles.size(), 16);
  ASSERT_TRUE(manifest.gains);
  EXPECT_THAT(manifest.gains->K, MatrixNear(content.gains->K, 0));
  EXPECT_EQ(manifest.gains->dt, 0.01);
  EXPECT_EQ(manifest.versions.front().first, "quadtune");
  EXPECT_EQ(manifest_text(manifest), files.back().bytes);  // nothing is lost on the way
}

TEST(Export, GainsReadBackFromEveryKind) {
  const TemporaryDirectory directory;
  for (const auto& [kind, content] : {std::pair(ExportKind::uquad, uquad_content()),
                                      std::pair(ExportKind::mambo, mambo_content()),
                                      std::pair(ExportKind::json, mambo_content())}) {
    const fs::path path = directory.path() / to_string(kind);
    write_export(path, kind, content);
    for (const fs::path& from : {path, path / "manifest.json"}) {
      const Gains read = read_gains(from);
      EXPECT_TRUE(diff(read, *content.gains).entries.empty()) << from;
      EXPECT_EQ(read.dt, content.gains->dt);
      EXPECT_EQ(read.vehicle, content.gains->vehicle);
      EXPECT_THAT(read.u0, MatrixNear(content.gains->u0, 0));
      EXPECT_THAT(read.x0, MatrixNear(content.gains->x0, 0));
    }
    fs::remove(path / "manifest.json");
    EXPECT_TRUE(diff(read_gains(path), *content.gains).entries.empty()) << path;
  }
}

TEST(Export, TakesAwayWhatAnEarlierExportLeft) {
  const TemporaryDirectory directory;
  directory.write("notes.txt", "mine");
  write_export(directory.path(), ExportKind::uquad, uquad_content());
  ExportContent content = uquad_content();
  content.gains->integrals.clear();
  content.gains->K_int.resize(4, 0);
  content.Q.resize(0, 0);
  write_export(directory.path(), ExportKind::uquad, content);
  EXPECT_THAT(names_in(directory.path()),
              ElementsAre("K_full.txt", "lqr-R.txt", "manifest.json", "notes.txt"));
}

TEST(Export, DoesNotTrustAManifestThatNamesFilesElsewhere) {
  const TemporaryDirectory directory;
  directory.write("precious", "mine");
  const fs::path out = directory.path() / "out";
  Manifest manifest;
  manifest.files = {{"../precious", std::string(64, '0'), 4}};
  directory.write("out/manifest.json", manifest_text(manifest));
  EXPECT_THAT([&] { (void)read_manifest(out); },
              ThrowsMessage<InvalidInput>(HasSubstr("files[0].path: is '../precious', expected")));
  write_export(out, ExportKind::uquad, uquad_content());
  EXPECT_EQ(directory.read("precious"), "mine");
}

TEST(Export, NumbersThatAreNotFiniteNeverLeave) {
  const TemporaryDirectory directory;
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto refused = [&](ExportKind kind, const ExportContent& content, const char* message) {
    EXPECT_THAT([&] { write_export(directory.path() / "out", kind, content); },
                ThrowsMessage<InvalidInput>(HasSubstr(message)));
    EXPECT_FALSE(fs::exists(directory.path() / "out"));
  };
  ExportContent content = uquad_content();
  content.gains->K(0, 3) = nan;
  refused(ExportKind::uquad, content, "K has nan at (1,4)");
  content = uquad_content();
  content.Q(2, 2) = nan;
  refused(ExportKind::uquad, content, "lqr-Q.txt has nan at (3,3)");
  content = uquad_content();
  content.evidence.poles(0) = nan;
  refused(ExportKind::uquad, content, "evidence.poles: nan cannot be written");
  content = mambo_content();
  content.vehicle.mass = nan;
  refused(ExportKind::mambo, content, "Vehicle.Airframe.mass has nan");
  refused(ExportKind::json, content, "mass: nan cannot be written");
  content = mambo_content();
  content.cascade->gains.loops[1].Kd = nan;
  refused(ExportKind::mambo, content, "Controller.Cascade.y.Kd has nan");
}

TEST(Export, RefusesUquadWithoutGains) {
  ExportContent content = uquad_content();
  content.gains.reset();
  EXPECT_THAT([&] { (void)export_files(ExportKind::uquad, content); },
              ThrowsMessage<InvalidInput>(HasSubstr("uquad: there is no state feedback")));
}

TEST(Export, WordsOfKindsReadBackAndUnknownOnesAreRefused) {
  for (const ExportKind& kind : {ExportKind::uquad, ExportKind::mambo, ExportKind::json})
    EXPECT_EQ(export_kind(to_string(kind), "--to"), kind);
  EXPECT_THAT(
      [] { (void)export_kind("jason", "--to"); },
      ThrowsMessage<InvalidInput>(HasSubstr(
          "--to: no export 'jason', expected uquad, "
          "mambo, json, mat, c, px4, ardupilot, betaflight, crazyflie; did you mean 'json'?")));
}

TEST(ReadGains, SaysWhereAFileIsWrong) {
  const TemporaryDirectory directory;
  const auto refusal = [&](const std::string& name, const std::string& text,
                           const std::string& message) {
    const fs::path path = directory.write(name, text);
    EXPECT_THAT([&] { (void)read_gains(path); }, ThrowsMessage<InvalidInput>(HasSubstr(message)))
        << text;
  };
  refusal("gains.json", "{\n \"format\": \"quadtune-gains\",\n oops", "gains.json:3: is not JSON");
  refusal("gains.json", "{\"format\": \"x\"}", "gains.json: format is 'x', expected");
  refusal("gains.json", R"({"format": "quadtune-gains", "format_version": 3})",
          "format_version is 3, expected 1 or 2");
  std::string text = gains_json_text(uquad_content());
  text.replace(text.find("\"dt_s\": 0.01"), 12, "\"dt_s\": \"ten\"");
  refusal("gains.json", text, "gains.json: gains.dt_s: is \"ten\", expected a finite number");
  refusal("gains.txt", "1 2\n", "gains.txt: is not a gain file of uquad; expected one of K.txt, ");
  EXPECT_THROW((void)read_gains(directory.path() / "missing"), FileError);
}

}  // namespace
}  // namespace quadtune
