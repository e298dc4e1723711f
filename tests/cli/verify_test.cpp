// SPDX-License-Identifier: Apache-2.0
// A manifest that disagrees with its gains: verify and diff detect it.
#include <gmock/gmock.h>

#include <filesystem>
#include <fstream>
#include <functional>
#include <nlohmann/json.hpp>
#include <sstream>
#include <tuple>

#include "quadtune/exports/file_set.hpp"
#include "quadtune/workbench/verify/verify_directory.hpp"
#include "run_program.hpp"
#include "source_folder.hpp"
#include "temporary_directory.hpp"

namespace quadtune::testing {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using Json = nlohmann::ordered_json;

class VerifyManifest : public ::testing::Test {
 protected:
  /// A design, exported to its own directory next to the design file.
  std::string exported(const std::string& design, const std::string& more = "") {
    std::ifstream file(testing::source_folder() + "/designs/" + design + ".toml");
    std::ostringstream text;
    text << file.rdbuf() << more;
    const std::string path = folder_.write(design + ".toml", text.str()).string();
    std::string out = (folder_.path() / ("out-" + design)).string();
    const ProgramResult result = run_program({"design", path, "-o", out, "--quiet"});
    EXPECT_EQ(result.status, 0) << result.err;
    return out;
  }

  /// The result of verify for a modified manifest.
  std::string verified(const std::string& out, const std::function<void(Json&)>& change,
                       int status = 1) {
    const std::string name = std::filesystem::path(out).filename().string() + "/manifest.json";
    const std::string before = folder_.read(name);
    Json manifest = Json::parse(before);
    change(manifest);
    folder_.write(name, manifest.dump());
    const ProgramResult result = run_program({"verify", out});
    EXPECT_EQ(result.status, status) << result.out << result.err;
    folder_.write(name, before);
    return result.out + result.err;
  }

  TemporaryDirectory folder_;
};

TEST_F(VerifyManifest, PassesWhatWasWritten) {
  for (const char* design : {"uquad-hover", "mambo-hover"}) {
    const std::string text = verified(
        exported(design), [](Json&) {}, 0);
    EXPECT_THAT(text, HasSubstr("ok   weights give the gains: solved again"));
    EXPECT_THAT(text, HasSubstr("ok   the recorded evidence agrees with the weights"));
    EXPECT_THAT(text, HasSubstr(std::string("ok   inputs are those of the manifest: ") + design));
  }
}

// The vehicle file next to the export has the hash of the manifest, so it need not be named.
TEST_F(VerifyManifest, FindsTheVehicleFileByItsHash) {
  std::ifstream file(testing::source_folder() + "/vehicles/uquad.toml");
  std::ostringstream text;
  text << file.rdbuf();
  std::string vehicle = text.str();
  const std::string name = "name = \"uquad\"";
  ASSERT_NE(vehicle.find(name), std::string::npos);
  vehicle.replace(vehicle.find(name), name.size(), "name = \"own\"");
  const std::string path = folder_.write("own.toml", vehicle).string();
  const std::string out = (folder_.path() / "out").string();
  const ProgramResult made =
      run_program({"pid", path, "--method", "loops", "-o", (folder_.path() / "own.json").string()});
  ASSERT_EQ(made.status, 0) << made.err;
  const ProgramResult written = run_program({"export", (folder_.path() / "own.json").string(),
                                             "--to", "json", "--vehicle", path, "-o", out});
  ASSERT_EQ(written.status, 0) << written.err;
  EXPECT_THAT(verified(
                  out, [](Json&) {}, 0),
              HasSubstr("ok   inputs are those of the manifest: own.toml"));
  // `export` finds it in the same way; gains in a file have no manifest.
  const std::string code = (folder_.path() / "code").string();
  EXPECT_EQ(run_program({"export", out, "--to", "c", "-o", code}).status, 0);
  const std::string gains = (folder_.path() / "own.json").string();
  const ProgramResult unnamed = run_program({"export", gains, "--to", "c", "-o", code + "2"});
  EXPECT_EQ(unnamed.status, 2);
  EXPECT_THAT(unnamed.err, HasSubstr("--vehicle is missing, expected the file of 'own', the "
                                     "vehicle of " +
                                     gains + ", which is not built in"));
  const ProgramResult other = run_program({"verify", out, "--vehicle", "uquad"});
  EXPECT_EQ(other.status, 2);
  EXPECT_THAT(other.err,
              HasSubstr("--vehicle is 'uquad', expected 'own', the vehicle of the manifest"));
  folder_.write("own.toml", vehicle + "\n");
  EXPECT_THAT(verified(
                  out, [](Json&) {}, 2),
              HasSubstr("--vehicle is missing, expected the file of 'own'"));
}

// A calibration of the sensors is exported with the gains; only its hash protects it.
// Only verify checks an export; what else reads it must not be silent about a changed file.
TEST_F(VerifyManifest, FlyAndDiffNoteAChangedFileOnce) {
  const std::string out = exported("mambo-hover");
  const auto notes = [&](const std::vector<std::string>& args) {
    const ProgramResult result = run_program(args);
    EXPECT_EQ(result.status, 0) << result.err;
    return result.err;
  };
  const std::vector<std::string> fly = {"fly",        "mambo", "--gains",   out,
                                        "--duration", "30",    "--sensors", "ideal"};
  EXPECT_THAT(notes({"diff", out, out}), Not(HasSubstr("does not match")));
  EXPECT_THAT(notes(fly), Not(HasSubstr("does not match")));
  const Json manifest = Json::parse(folder_.read("out-mambo-hover/manifest.json"));
  const std::string file = manifest["files"][0]["path"];
  folder_.write("out-mambo-hover/" + file, folder_.read("out-mambo-hover/" + file) + "\n");
  const std::string note = "note: " + out + "/" + file +
                           " does not match manifest.json: it was changed after the export";
  for (const std::string& err : {notes(fly), notes({"diff", out, out})}) {
    EXPECT_THAT(err, HasSubstr(note));
    EXPECT_EQ(err.find("does not match"), err.rfind("does not match")) << err;
  }
}

TEST_F(VerifyManifest, SensorsCalibrationGoesWithUquadsGains) {
  (void)exported("uquad-hover");
  const std::string design = (folder_.path() / "uquad-hover.toml").string();
  const std::string file = (folder_.path() / "imu.txt").string();
  const std::string out = (folder_.path() / "out").string();
  ASSERT_EQ(run_program({"calibrate", "imu", "--simulate", "--quiet", "-o", file}).status, 0);
  const std::vector<std::string> words = {
      "export", design, "--to", "uquad", "-o", out, "--quiet", "--constants", "--imu-calibration"};
  const auto with = [&](const std::string& path) {
    std::vector<std::string> all = words;
    all.push_back(path);
    return run_program(all);
  };
  ASSERT_EQ(with(file).status, 0);
  EXPECT_EQ(folder_.read("out/imu_calib.txt"), folder_.read("imu.txt"));
  const std::string header = folder_.read("out/uquad_constants.h");
  EXPECT_THAT(header, HasSubstr("#define UQUAD_MASS 1.741 /* kg */"));
  EXPECT_THAT(header, HasSubstr("#define UQUAD_SAMPLE_PERIOD 0.01 /* s */"));
  EXPECT_THAT(header, HasSubstr("#define UQUAD_HOVER_SPEED 316."));
  EXPECT_EQ(run_program({"verify", out}).status, 0);
  EXPECT_EQ(run_program({"verify", out, "--design", design}).status, 0);
  std::string text = folder_.read("out/imu_calib.txt");
  text[text.find_first_of("123456789")] = '0';
  folder_.write("out/imu_calib.txt", text);
  EXPECT_EQ(run_program({"verify", out}).status, 1);

  const std::string short_file = folder_.write("short.txt", "1 0 0 0 1 0\n").string();
  const ProgramResult refused = with(short_file);
  EXPECT_EQ(refused.status, 3);
  EXPECT_THAT(refused.err, HasSubstr("ends after 6 numbers, expected 36"));
  EXPECT_EQ(with((folder_.path() / "none.txt").string()).status, 5);
  const ProgramResult other =
      run_program({"export", design, "--to", "json", "-o", out + "2", "--imu-calibration", file});
  EXPECT_EQ(other.status, 2);
  EXPECT_THAT(other.err, HasSubstr("--imu-calibration applies to the format uquad only"));
}

TEST_F(VerifyManifest, NoticesSwappedInputs) {
  for (const char* design : {"uquad-hover", "mambo-hover"}) {
    const std::string out = exported(design);
    const auto swap = [](Json& manifest) {
      std::swap(manifest["gains"]["inputs"][0], manifest["gains"]["inputs"][1]);
    };
    EXPECT_THAT(verified(out, swap), HasSubstr("FAIL gains are those of the manifest: inputs "));
    // A manifest is also a file of gains: rows under other names are other gains.
    Json manifest = Json::parse(
        folder_.read(std::filesystem::path(out).filename().string() + "/manifest.json"));
    swap(manifest);
    const std::string swapped = folder_.write("manifest.json", manifest.dump()).string();
    const ProgramResult result = run_program({"diff", out, swapped, "--json"});
    EXPECT_EQ(result.status, 0) << result.err;
    EXPECT_GT(Json::parse(result.out)["max_relative"], 0.1) << design;
    std::filesystem::remove(swapped);
  }
}

TEST_F(VerifyManifest, NoticesOtherWordsForTheSignals) {
  const std::string out = exported("uquad-hover");
  for (const auto& [where, value, said] : std::vector<std::tuple<std::string, Json, std::string>>{
           {"/gains/states/0/unit", "ft", "x in 'm', the manifest has 'ft'"},
           {"/gains/inputs/2/name", "w7", "inputs w1 w2 w3 w4, the manifest has w1 w2 w7 w4"},
           {"/gains/dt_s", 0.02, "sample time 0.01 in the file, 0.02"},
           {"/gains/input_kind", "rotor-thrust", "kind of inputs rotor-speed in the file"},
           {"/gains/law", "u = u0 - K x", "gains.law: is 'u = u0 - K x'"}}) {
    // gains.dt_s of a uquad export comes from the manifest itself; the rate of the program detects
    // a change.
    const std::string text = verified(
        out,
        [&, where = where, value = value](Json& manifest) {
          manifest[Json::json_pointer(where)] = value;
        },
        where == "/gains/law" ? 3 : 1);
    if (where != "/gains/dt_s") {
      EXPECT_THAT(text, HasSubstr(said)) << where;
    }
  }
}

TEST_F(VerifyManifest, NoticesOtherWeights) {
  for (const char* design : {"uquad-hover", "mambo-hover"}) {
    const std::string out = exported(design);
    for (const char* where : {"/weights/Q/0/0", "/weights/Q/13/13", "/weights/R/2/2"}) {
      const Json::json_pointer entry(where);
      Json manifest = Json::parse(
          folder_.read(std::filesystem::path(out).filename().string() + "/manifest.json"));
      if (!manifest.contains(entry)) continue;  // fewer integrals
      EXPECT_THAT(verified(out, [&](Json& m) { m[entry] = 1.001 * m[entry].get<double>(); }),
                  HasSubstr("FAIL weights give the gains: solved again: entries differ"))
          << design << where;
    }
  }
}

TEST_F(VerifyManifest, NoticesOtherEvidence) {
  const std::string out = exported("mambo-hover");
  const std::string said = "FAIL the recorded evidence agrees with the weights";
  EXPECT_THAT(verified(out, [](Json& m) { m["evidence"]["poles"][0][0] = 0.5; }), HasSubstr(said));
  EXPECT_THAT(verified(out, [](Json& m) { m["evidence"]["poles"].erase(0); }), HasSubstr(said));
  EXPECT_THAT(verified(out, [](Json& m) { m["evidence"]["rcond"] = 0.9; }), HasSubstr(said));
  EXPECT_THAT(verified(out, [](Json& m) { m["evidence"]["residual"] = 1e-3; }), HasSubstr(said));
  EXPECT_THAT(verified(out, [](Json& m) { m["evidence"]["status"] = "perfect"; }), HasSubstr(said));
  EXPECT_THAT(verified(out, [](Json& m) { m["evidence"].erase("poles"); }), HasSubstr(said));
  EXPECT_THAT(verified(out, [](Json& m) { m["evidence"]["method"] = "continuous LQR"; }),
              HasSubstr("FAIL weights give the gains"));
  EXPECT_THAT(verified(out, [](Json& m) { m.erase("weights"); }),
              HasSubstr(said + ": the manifest has evidence, but not the weights"));
  EXPECT_THAT(verified(out, [](Json& m) { m["evidence"].erase("method"); }),
              HasSubstr("FAIL weights give the gains: "));
  EXPECT_THAT(verified(
                  out, [](Json& m) { m["closed_loop"]["spectral_radius"] = 0.9; }, 3),
              HasSubstr("closed_loop.spectral_radius"));
}

TEST_F(VerifyManifest, NoticesInputsThatAreNotTheFiles) {
  const std::string out = exported("uquad-hover");
  for (const int i : {0, 1})
    for (const char* key : {"sha256", "size"})
      EXPECT_THAT(
          verified(out,
                   [&](Json& m) {
                     Json& value = m["inputs"][i][key];
                     if (value.is_string())
                       value = std::string(64, 'a');
                     else
                       value = value.get<int>() + 1;
                   }),
          ::testing::AllOf(HasSubstr("FAIL inputs are those of the manifest: "),
                           HasSubstr(i == 0 ? "/uquad-hover.toml has " : ": uquad.toml has ")))
          << i << key;
  // A missing input is reported, and an option names it.
  std::filesystem::create_directory(folder_.path() / "elsewhere");
  std::filesystem::rename(folder_.path() / "uquad-hover.toml",
                          folder_.path() / "elsewhere" / "uquad-hover.toml");
  const std::filesystem::path here = std::filesystem::current_path();
  std::filesystem::current_path(folder_.path());
  EXPECT_THAT(run_program({"verify", out}).out,
              HasSubstr("not at hand, so not compared: uquad-hover.toml"));
  const std::string design = (folder_.path() / "elsewhere" / "uquad-hover.toml").string();
  EXPECT_THAT(run_program({"verify", out, "--design", design}).out,
              HasSubstr("uquad-hover.toml, uquad.toml as listed"));
  folder_.write("elsewhere/uquad-hover.toml", "name = \"other\"\n");
  const ProgramResult other = run_program({"verify", out, "--design", design});
  EXPECT_EQ(other.status, 1);
  EXPECT_THAT(other.out, HasSubstr("FAIL inputs are those of the manifest: " + design + " has"));
  EXPECT_THAT(
      run_program(
          {"verify", out, "--design", testing::source_folder() + "/designs/mambo-hover.toml"})
          .err,
      HasSubstr("--design is 'mambo-hover.toml', expected 'uquad-hover.toml', from which the "
                "export was made"));
  // The vehicle of the export is an input as well, but not a design.
  EXPECT_THAT(
      run_program({"verify", out, "--design", testing::source_folder() + "/vehicles/uquad.toml"})
          .err,
      HasSubstr("--design is 'uquad.toml', expected 'uquad-hover.toml'"));
  std::filesystem::current_path(here);
}

TEST_F(VerifyManifest, NoticesAnotherCascade) {
  const std::string out = exported("mambo-hover", "\n[[export]]\nto = \"json\"\n");
  for (const char* kind : {"mambo", "json"}) {
    const std::string directory = out + "/" + kind;
    const std::string name = std::filesystem::path(out).filename().string() + "/" + kind;
    const std::string before = folder_.read(name + "/manifest.json");
    const auto verify_with = [&](const std::string& where, const Json& value) {
      Json manifest = Json::parse(before);
      manifest[Json::json_pointer(where)] = value;
      folder_.write(name + "/manifest.json", manifest.dump());
      const ProgramResult result = run_program({"verify", directory});
      EXPECT_EQ(result.status, 1) << result.out;
      return result.out;
    };
    EXPECT_THAT(verify_with("/cascade/loops/3/Kp", 0.02),
                HasSubstr("FAIL cascade is that of the manifest: 1 number differs, most Kp(roll)"));
    EXPECT_THAT(verify_with("/cascade/dt_s", 0.01), HasSubstr("FAIL cascade is that of"));
    EXPECT_THAT(verify_with("/cascade_closed_loop/poles/0/0", -0.25),
                HasSubstr("FAIL poles of the cascade are those of the manifest"));
    folder_.write(name + "/manifest.json", before);
    EXPECT_EQ(run_program({"verify", directory}).status, 0);
  }
  // A cascade with an unstable loop, with a corrected hash.
  Json gains = Json::parse(folder_.read("out-mambo-hover/json/gains.json"));
  gains["cascade"]["loops"][3]["Kp"] = -gains["cascade"]["loops"][3]["Kp"].get<double>();
  folder_.write("out-mambo-hover/json/gains.json", gains.dump());
  Json manifest = Json::parse(folder_.read("out-mambo-hover/json/manifest.json"));
  manifest["files"][0]["sha256"] = sha256(gains.dump());
  manifest["files"][0]["size"] = gains.dump().size();
  manifest["cascade"] = gains["cascade"];
  folder_.write("out-mambo-hover/json/manifest.json", manifest.dump());
  EXPECT_THAT(run_program({"verify", out + "/json"}).out,
              HasSubstr("FAIL closed loop of the cascade is stable"));
}

}  // namespace
}  // namespace quadtune::testing
