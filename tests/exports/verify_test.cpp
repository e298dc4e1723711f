// SPDX-License-Identifier: Apache-2.0
#include "quadtune/exports/verify.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <sys/stat.h>

#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <regex>

#include "matrix_near.hpp"
#include "plants/export_models.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/exports/export.hpp"
#include "quadtune/exports/uquad.hpp"
#include "quadtune/internal/json.hpp"
#include "temporary_directory.hpp"

namespace quadtune {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsSupersetOf;
using testing::mambo_content;
using testing::sampled_mambo;
using testing::sampled_uquad;
using testing::TemporaryDirectory;
using ::testing::ThrowsMessage;
using testing::uquad_content;

std::vector<std::string> failed(const VerifyReport& report) {
  std::vector<std::string> names;
  for (const VerifyCheck& check : report.checks)
    if (!check.ok) names.push_back(check.name);
  return names;
}

std::string all_details(const VerifyReport& report) {
  std::string text;
  for (const VerifyCheck& check : report.checks)
    text += fmt::format("{} {}: {}\n", check.ok ? "ok  " : "FAIL", check.name, check.detail);
  return text;
}

VerifyModel uquad_model() {
  return {sampled_uquad(), uquad_content().gains->x0, uquad_content().gains->u0};
}

VerifyModel mambo_model() {
  return {sampled_mambo(), mambo_content().gains->x0, mambo_content().gains->u0};
}

// The plant of the cascade in mambo_content(): the same hover in ned, all states measured.
VerifyFacts mambo_facts() {
  const DiscreteLti mambo = sampled_mambo();
  const Convention& c = convention("mambo", "test");
  DiscreteLti plant = mambo;
  plant.A = c.from_ned.transpose() * mambo.A * c.from_ned;
  plant.B = c.from_ned.transpose() * mambo.B * c.wrench_from_ned;
  plant.C = Eigen::MatrixXd::Identity(12, 12);
  plant.D = Eigen::MatrixXd::Zero(12, 4);
  plant.states = plant.outputs = ned_convention().states;
  plant.inputs = ned_convention().wrench;
  VerifyFacts facts;
  facts.cascade_plant = plant;
  return facts;
}

// mambo_content() with the plant from which the poles of its cascade are computed.
ExportContent mambo_with_cascade() {
  ExportContent content = mambo_content();
  content.cascade_plant = mambo_facts().cascade_plant;
  return content;
}

// Degree of a forgery: changes the file; also fixes its hash; also fixes the manifest's gains.
enum class Forgery { file, hash, gains };

// Changes a file of a written export, and the manifest to the given degree.
void forge(const TemporaryDirectory& directory, const std::string& name, Forgery forgery,
           const std::function<std::string(std::string)>& change) {
  const std::string before = directory.read(name);
  const std::string bytes = change(before);
  ASSERT_NE(bytes, before);
  directory.write(name, bytes);
  if (forgery == Forgery::file) return;
  Manifest manifest = read_manifest(directory.path());
  for (ManifestFile& file : manifest.files)
    if (file.path == name) file = {name, sha256(bytes), bytes.size()};
  if (forgery == Forgery::gains) {
    const Gains read = read_uquad_gains(directory.path());
    manifest.gains->K = read.K;
    manifest.gains->K_int = read.K_int;
  }
  directory.write(kManifestName, manifest_text(manifest));
}

std::string with_matrix(const std::string& text, Eigen::Index cols,
                        const std::function<Eigen::MatrixXd(Eigen::MatrixXd)>& change) {
  return uquad_matrix_text(change(parse_uquad_matrix(text, 4, cols, "K")), "K");
}

struct Mutation {
  std::string name;
  std::string file;
  std::function<std::string(std::string)> change;
  bool readable;  // still a matrix of the right shape
};

const std::vector<Mutation>& mutations() {
  using M = Eigen::MatrixXd;
  static const std::string K = "K_prop_full.txt";
  static const std::string K_int = "K_int_full.txt";
  static const std::regex third_number(R"(^(\s*\S+\s+\S+\s+)(\S+))");
  static const auto replace_third = [](const std::string& with) {
    return [with](const std::string& text) {
      return std::regex_replace(text, third_number, "$1 " + with,
                                std::regex_constants::format_first_only);
    };
  };
  static const std::vector<Mutation> all = {
      {"transposed", K,
       [](const std::string& t) {
         return uquad_matrix_text(parse_uquad_matrix(t, 4, 12, "K").transpose(), "K");
       },
       false},
      {"transposed integral", K_int,
       [](const std::string& t) {
         return with_matrix(t, 4, [](const M& k) -> M { return k.transpose(); });
       },
       true},
      {"swapped x and y", K,
       [](const std::string& t) {
         return with_matrix(t, 12, [](M k) -> M { return k.col(0).swap(k.col(1)), k; });
       },
       true},
      {"swapped phi and theta", K,
       [](const std::string& t) {
         return with_matrix(t, 12, [](M k) -> M { return k.col(4).swap(k.col(5)), k; });
       },
       true},
      {"swapped z and theta integrals", K_int,
       [](const std::string& t) {
         return with_matrix(t, 4, [](M k) -> M { return k.col(2).swap(k.col(3)), k; });
       },
       true},
      {"all signs flipped", K,
       [](const std::string& t) { return with_matrix(t, 12, [](const M& k) -> M { return -k; }); },
       true},
      {"one sign flipped", K,
       [](const std::string& t) {
         return with_matrix(t, 12, [](M k) -> M { return k(1, 3) *= -1, k; });
       },
       true},
      {"integral's sign flipped", K_int,
       [](const std::string& t) { return with_matrix(t, 4, [](const M& k) -> M { return -k; }); },
       true},
      {"truncated", K, [](const std::string& t) { return t.substr(0, t.size() - 24); }, false},
      {"truncated within a number", K,
       [](const std::string& t) { return t.substr(0, t.size() - 4); }, false},
      {"a number appended", K, [](const std::string& t) { return t + " 1.0\n"; }, false},
      {"a number appended to a row", K, replace_third("$2 1.0"), false},
      {"nan", K, replace_third("nan"), false},
      {"infinity", K, replace_third("inf"), false},
      {"decimal comma", K, replace_third("4,98"), false},
      {"a digit lost", K, replace_third("1.5e0"), true},
      {"a word", K, replace_third("x"), false},
      {"empty", K, [](const std::string&) { return std::string(); }, false},
  };
  return all;
}

TEST(Verify, SaysYesToWhatWasWritten) {
  const TemporaryDirectory directory;
  write_export(directory.path() / "uquad", ExportKind::uquad, uquad_content());
  const VerifyReport uquad = verify_export(directory.path() / "uquad", uquad_model());
  EXPECT_TRUE(uquad.ok()) << all_details(uquad);
  EXPECT_LT(uquad.poles.cwiseAbs().maxCoeff(), 1);
  for (const ExportKind& kind : {ExportKind::mambo, ExportKind::json}) {
    write_export(directory.path() / to_string(kind), kind, mambo_with_cascade());
    const VerifyReport report =
        verify_export(directory.path() / to_string(kind), mambo_model(), mambo_facts());
    EXPECT_TRUE(report.ok()) << all_details(report);
  }
}

TEST(Verify, NoticesEveryMutationHoweverItIsCoveredUp) {
  for (const Mutation& mutation : mutations())
    for (const Forgery forgery : {Forgery::file, Forgery::hash, Forgery::gains}) {
      if (forgery == Forgery::gains && !mutation.readable) continue;
      const TemporaryDirectory directory;
      write_export(directory.path(), ExportKind::uquad, uquad_content());
      forge(directory, mutation.file, forgery, mutation.change);
      const VerifyReport report = verify_export(directory.path(), uquad_model());
      EXPECT_FALSE(report.ok()) << mutation.name << "\n" << all_details(report);
      const std::string expected =
          forgery == Forgery::file   ? mutation.file + " matches the manifest"
          : !mutation.readable       ? "files read as the flight program reads them"
          : forgery == Forgery::hash ? "gains are those of the manifest"
                                     : "poles are those of the manifest";
      EXPECT_THAT(failed(report), Contains(expected)) << mutation.name << "\n"
                                                      << all_details(report);
      if (!mutation.readable) {
        EXPECT_THAT(failed(report), Contains("stability of the closed loop")) << mutation.name;
      }
    }
}

// Even without a manifest, reading like the flight program and the vehicle model detect the worst.
TEST(Verify, SeesAWrongSignByTheVehicleAlone) {
  const TemporaryDirectory directory;
  ExportContent content = uquad_content();
  content.gains->K = -content.gains->K;
  write_files(directory.path(), uquad_files(*content.gains, {}, {}));
  const VerifyReport report = verify_export(directory.path(), uquad_model());
  EXPECT_THAT(failed(report), IsSupersetOf({"manifest", "stability of the closed loop"}));
}

TEST(Verify, NoticesMissingAndForeignFiles) {
  const TemporaryDirectory directory;
  write_export(directory.path(), ExportKind::uquad, uquad_content());
  directory.write("K_full.txt", "1 2 3\n");
  EXPECT_THAT(failed(verify_export(directory.path(), uquad_model())),
              ElementsAre("no other gain files"));
  std::filesystem::remove(directory.path() / "K_full.txt");
  std::filesystem::remove(directory.path() / "lqr-R.txt");
  EXPECT_THAT(failed(verify_export(directory.path(), uquad_model())),
              Contains("lqr-R.txt matches the manifest"));
  directory.write(kManifestName, "{");
  EXPECT_THAT(failed(verify_export(directory.path(), uquad_model())), Contains("manifest"));
}

// Reading a pipe would block forever.
TEST(Verify, NoticesAPipeInThePlaceOfAFile) {
  const TemporaryDirectory directory;
  const std::vector<ManifestFile> files =
      write_export(directory.path(), ExportKind::uquad, uquad_content());
  const std::filesystem::path path = directory.path() / files.front().path;
  std::filesystem::remove(path);
  ASSERT_EQ(::mkfifo(path.c_str(), 0600), 0);
  const VerifyReport report = verify_export(directory.path(), uquad_model());
  EXPECT_FALSE(report.ok());
  EXPECT_THAT(all_details(report), HasSubstr("is a pipe or a socket, expected a regular file"));
}

TEST(Verify, NoticesChangedNumbersInParameterFiles) {
  const std::vector<std::pair<std::string, std::string>> changes = {
      {"Controller.takeoffGain = 0.45", "Controller.takeoffGain = 4.5"},
      {"Controller.takeoffGain = 0.45", "Controller.takeoffGain = 0,45"},
      {"Controller.takeoffGain = 0.45", "Controller.takeoffGain = nan"},
      {"Controller.Cascade.roll.Kp = 0.01", "Controller.Cascade.roll.Kp = -0.01"},
      {"Controller.Q2Ts = inv(Controller.Ts2Q)", "Controller.Q2Ts = [1, 2]"},
      {"Vehicle.Rotor.radius*[1 -1 1 -1]", "Vehicle.Rotor.radius*[-1 1 -1 1]"},
      {"'set-point-minus-state'", "'state-minus-set-point'"},
  };
  for (const auto& [from, to] : changes)
    for (const Forgery forgery : {Forgery::file, Forgery::hash}) {
      const TemporaryDirectory directory;
      write_export(directory.path(), ExportKind::mambo, mambo_content());
      forge(directory, "controllerVars.m", forgery, [&, from = from, to = to](std::string text) {
        return text.replace(text.find(from), from.size(), to);
      });
      const VerifyReport report = verify_export(directory.path(), mambo_model());
      EXPECT_THAT(failed(report),
                  Contains("single numbers, besides gains and weights, are those of the manifest"))
          << to << "\n"
          << all_details(report);
    }
}

// If the thrust at the trim is not the vehicle's weight, it falls, however good K is.
TEST(Verify, NoticesAnotherTrimInTheManifest) {
  const std::vector<std::pair<std::string, std::function<void(Gains&)>>> changes = {
      {"u0(w2) is 300", [](Gains& gains) { gains.u0(1) = 300; }},
      {"x0(phi) is 0.001", [](Gains& gains) { gains.x0(4) = 1e-3; }},
      {"x0(z) is 2", [](Gains& gains) { gains.x0(2) = 2; }},
  };
  for (const auto& [said, change] : changes) {
    const TemporaryDirectory directory;
    write_export(directory.path(), ExportKind::uquad, uquad_content());
    Manifest manifest = read_manifest(directory.path());
    change(*manifest.gains);
    directory.write(kManifestName, manifest_text(manifest));
    const VerifyReport report = verify_export(directory.path(), uquad_model());
    EXPECT_THAT(failed(report), ElementsAre("trim is the vehicle's"));
    EXPECT_THAT(all_details(report), HasSubstr(said));
  }
}

TEST(Verify, NoticesAnotherTrimInGainsJson) {
  for (const char* key : {"x0", "u0"}) {
    const TemporaryDirectory directory;
    write_export(directory.path(), ExportKind::json, uquad_content());
    forge(directory, kGainsJsonName, Forgery::hash, [&](const std::string& text) {
      nlohmann::ordered_json json = nlohmann::ordered_json::parse(text);
      json["gains"][key][3] = 0.5;
      return json.dump();
    });
    const VerifyReport report = verify_export(directory.path(), uquad_model());
    EXPECT_THAT(failed(report),
                ElementsAre("gains are those of the manifest", "trim is the vehicle's"));
  }
}

TEST(Verify, NoticesOtherWeightsUnderAMendedHash) {
  for (const char* name : {"lqr-Q.txt", "lqr-R.txt"}) {
    const TemporaryDirectory directory;
    write_export(directory.path(), ExportKind::uquad, uquad_content());
    forge(directory, name, Forgery::hash,
          [](std::string text) { return text.replace(text.find("1.0000000000000000e"), 1, "2"); });
    const VerifyReport report = verify_export(directory.path(), uquad_model());
    EXPECT_THAT(failed(report), ElementsAre("weights are those of the manifest")) << name;
    EXPECT_THAT(all_details(report), HasSubstr(std::string(name) + " differs"));
  }
  const TemporaryDirectory directory;
  write_export(directory.path(), ExportKind::json, uquad_content());
  forge(directory, kGainsJsonName, Forgery::hash, [](const std::string& text) {
    nlohmann::ordered_json json = nlohmann::ordered_json::parse(text);
    json["weights"]["Q"][1][1] = 3;
    return json.dump();
  });
  EXPECT_THAT(failed(verify_export(directory.path(), uquad_model())),
              ElementsAre("weights are those of the manifest"));
}

TEST(Verify, NoticesWeightsThatTheManifestDoesNotKnow) {
  const TemporaryDirectory directory;
  write_export(directory.path(), ExportKind::uquad, uquad_content());
  Manifest manifest = read_manifest(directory.path());
  manifest.Q.resize(0, 0);
  directory.write(kManifestName, manifest_text(manifest));
  EXPECT_THAT(failed(verify_export(directory.path(), uquad_model())),
              ElementsAre("weights are those of the manifest"));
}

TEST(Verify, CannotSayYesWithoutAVehicleOrInAnotherSampleTime) {
  const TemporaryDirectory directory;
  write_export(directory.path(), ExportKind::uquad, uquad_content());
  EXPECT_THAT(failed(verify_export(directory.path(), std::nullopt)),
              Contains("stability of the closed loop"));
  VerifyModel model = uquad_model();
  DiscreteLti& plant = model.plant;
  plant.dt = 0.02;
  EXPECT_THAT(failed(verify_export(directory.path(), model)),
              Contains("sample time is the vehicle model's"));
  EXPECT_THAT(
      all_details(verify_export(directory.path(), model)),
      HasSubstr("FAIL stability of the closed loop: open_loop: the gains have a sample period of "
                "0.01 s, expected 0.02 s, that of the plant"));
  plant.dt = 0.01;
  std::swap(plant.states[0], plant.states[1]);
  plant.states[0].name = "north";
  EXPECT_THAT(all_details(verify_export(directory.path(), model)),
              HasSubstr("FAIL stability of the closed loop: open_loop: no state 'y'"));
}

TEST(Verify, NoticesAnotherCascade) {
  const TemporaryDirectory directory;
  write_export(directory.path(), ExportKind::json, mambo_with_cascade());
  EXPECT_THAT(failed(verify_export(directory.path(), mambo_model())),
              ElementsAre("closed loop of the cascade is stable",
                          "poles of the cascade are those of the manifest"));
  forge(directory, kGainsJsonName, Forgery::hash, [](const std::string& text) {
    nlohmann::ordered_json json = nlohmann::ordered_json::parse(text);
    json["cascade"]["loops"][3]["Kp"] = 0.02;
    return json.dump();
  });
  EXPECT_THAT(failed(verify_export(directory.path(), mambo_model(), mambo_facts())),
              ElementsAre("cascade is that of the manifest",
                          "poles of the cascade are those of the manifest"));
  // A manifest without the cascade cannot confirm it.
  Manifest manifest = read_manifest(directory.path());
  manifest.cascade.reset();
  directory.write(kManifestName, manifest_text(manifest));
  EXPECT_THAT(failed(verify_export(directory.path(), mambo_model(), mambo_facts())),
              ElementsAre("cascade is that of the manifest"));
}

TEST(Verify, NoticesOtherSignals) {
  const std::vector<std::pair<std::string, std::function<void(Gains&)>>> changes = {
      {"inputs w1 w2 w3 w4, the manifest has w2 w1 w3 w4",
       [](Gains& gains) { std::swap(gains.inputs[0], gains.inputs[1]); }},
      {"x in 'm', the manifest has 'ft'", [](Gains& gains) { gains.states[0].unit = "ft"; }},
      {"integrals x y z theta, the manifest has x y psi theta",
       [](Gains& gains) { gains.integrals[2].name = "psi"; }},
      {"convention uquad in the file, ned in the manifest",
       [](Gains& gains) { gains.convention = "ned"; }},
  };
  for (const auto& [said, change] : changes) {
    const TemporaryDirectory directory;
    write_export(directory.path(), ExportKind::uquad, uquad_content());
    Manifest manifest = read_manifest(directory.path());
    change(*manifest.gains);
    directory.write(kManifestName, manifest_text(manifest));
    const VerifyReport report = verify_export(directory.path(), uquad_model());
    EXPECT_THAT(failed(report), Contains("gains are those of the manifest"));
    EXPECT_THAT(all_details(report), HasSubstr(said));
  }
}

TEST(Verify, ComparesTheInputsThatAreAtHand) {
  const TemporaryDirectory directory;
  write_export(directory.path(), ExportKind::uquad, uquad_content());
  const auto checked = [&](const std::vector<InputAtHand>& at_hand) {
    const VerifyReport report = verify_export(directory.path(), uquad_model(), {{}, at_hand});
    for (const VerifyCheck& check : report.checks)
      if (check.name == "inputs are those of the manifest")
        return (check.ok ? "ok " : "FAIL ") + check.detail;
    return std::string("no check");
  };
  EXPECT_EQ(checked({}), "ok not at hand, so not compared: uquad-hover.toml");
  EXPECT_EQ(checked({{"uquad-hover.toml", "", "abc"}}), "ok uquad-hover.toml as listed");
  EXPECT_THAT(checked({{"uquad-hover.toml", "there/uquad-hover.toml", "abd"}}),
              HasSubstr("FAIL there/uquad-hover.toml has 3 bytes and SHA-256 "));
  // If two have the same name, one of them must match.
  EXPECT_EQ(checked({{"uquad-hover.toml", "", "abd"}, {"uquad-hover.toml", "", "abc"}}),
            "ok uquad-hover.toml as listed");
}

TEST(Verify, NeedsADirectory) {
  EXPECT_THAT([] { (void)verify_export("/nonexistent/out", std::nullopt); },
              ThrowsMessage<FileError>(HasSubstr("/nonexistent/out: ")));
}

// x⁺ = x + u, u = -k x + l i, i⁺ = i - x: (z - 1)² + k (z - 1) + l = 0.
TEST(ClosedLoopPoles, AgreeWithTheCharacteristicPolynomial) {
  DiscreteLti plant;
  plant.A = Eigen::MatrixXd::Ones(1, 1);
  plant.B = Eigen::MatrixXd::Ones(1, 1);
  plant.dt = 1;
  plant.states = {{"z", "m"}};
  plant.inputs = {{"w1", ""}};
  Gains gains;
  gains.K = Eigen::MatrixXd::Constant(1, 1, 0.5);
  gains.K_int = Eigen::MatrixXd::Constant(1, 1, 0.06);
  gains.states = plant.states;
  gains.inputs = plant.inputs;
  gains.integrals = {{"z", "m s"}};
  gains.x0 = gains.u0 = Eigen::VectorXd::Zero(1);
  gains.convention = "uquad";
  gains.dt = 1;
  Eigen::VectorXcd poles = closed_loop_poles(plant, gains);
  EXPECT_NEAR(poles(0).real(), 0.7, 1e-14);  // (z - 1) = -0.3, -0.2
  EXPECT_NEAR(poles(1).real(), 0.8, 1e-14);
  gains.sign_law = SignLaw::state_minus_set_point;
  gains.K = -gains.K;
  gains.K_int = -gains.K_int;
  EXPECT_THAT(closed_loop_poles(plant, gains).real(), testing::MatrixNear(poles.real(), 1e-14));
}

}  // namespace
}  // namespace quadtune
