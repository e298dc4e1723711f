// SPDX-License-Identifier: Apache-2.0
/// quadtune calibrate imu and quadtune allan: input, output, files and errors.
#include <fcntl.h>
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <unistd.h>

#include <cmath>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <numbers>
#include <string>
#include <vector>

#include "log_files/ulog_writer.hpp"
#include "matrix_near.hpp"
#include "quadtune/exports/imu_calibration_file.hpp"
#include "quadtune/tuning/simulated_imu.hpp"
#include "run_program.hpp"
#include "shared_data.hpp"
#include "temporary_directory.hpp"

namespace quadtune {
namespace {

using SortedJson = nlohmann::json;
using ::testing::HasSubstr;
using testing::MatrixRelativelyNear;
using ::testing::Not;
using testing::ProgramResult;
using testing::run_program;
using testing::TemporaryDirectory;

SortedJson json_of(std::vector<std::string> args) {
  args.push_back("--json");
  const ProgramResult result = run_program(args);
  EXPECT_EQ(result.status, 0) << result.err;
  return SortedJson::parse(result.out);
}

/// The log as CSV with a header.
std::string csv(const ImuLog& log, bool magnetometer = true) {
  std::string text = "t[s],ax[1],ay[1],az[1],gx[1],gy[1],gz[1],";
  text += magnetometer ? "mx,my,mz,temperature [degC]\n" : "temperature [degC]\n";
  for (Eigen::Index i = 0; i < log.t.size(); ++i) {
    text += fmt::format("{}", log.t(i));
    for (int k = 0; k < 3; ++k) text += fmt::format(",{}", log.accelerometer(k, i));
    for (int k = 0; k < 3; ++k) text += fmt::format(",{}", log.gyroscope(k, i));
    for (int k = 0; k < 3 && magnetometer; ++k) text += fmt::format(",{}", log.magnetometer(k, i));
    text += fmt::format(",{}\n", log.temperature(i));
  }
  return text;
}

Eigen::Matrix3d matrix(const SortedJson& json) {
  Eigen::Matrix3d M;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) M(i, j) = json[std::size_t(i)][std::size_t(j)];
  return M;
}

/// Redirects standard input from a file during its lifetime.
class StandardInput {
 public:
  explicit StandardInput(const std::string& path) : before_(::dup(STDIN_FILENO)) {
    const int file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
    ::dup2(file, STDIN_FILENO);
    ::close(file);
  }
  ~StandardInput() {
    ::dup2(before_, STDIN_FILENO);
    ::close(before_);
  }
  StandardInput(const StandardInput&) = delete;
  StandardInput& operator=(const StandardInput&) = delete;

 private:
  int before_;
};

TEST(CalibrateVerb, WritesTheFileThatTheFlightProgramReads) {
  const TemporaryDirectory folder;
  const SimulatedImu made = simulate_imu({.seed = 3, .warming = 8});
  const std::string log = folder.write("log.csv", csv(made.log)).string();
  const std::string file = (folder.path() / "imu_calib.txt").string();
  const SortedJson json = json_of({"calibrate", "imu", "--log", log, "-o", file});
  for (const char* sensor : {"accelerometer", "gyroscope", "magnetometer"}) {
    for (const char* key : {"T", "K", "b", "M", "M_error", "b_error"})
      EXPECT_TRUE(json[sensor].contains(key)) << sensor << key;
    EXPECT_LT(double(json["residual"]["after"][sensor]),
              double(json["residual"]["before"][sensor]));
  }
  EXPECT_EQ(json["poses"], 36);
  EXPECT_TRUE(json["still"][0]["start_up_offset"]["still"]);
  EXPECT_EQ(json["file"], file);
  const ImuCalibrationFile read = read_imu_calibration(file);
  EXPECT_EQ(read.accelerometer.M, matrix(json["accelerometer"]["M"]));
  EXPECT_THAT(read.accelerometer.M, MatrixRelativelyNear(made.accelerometer.M, 2e-3));
  EXPECT_THAT(read.gyroscope.M, MatrixRelativelyNear(made.gyroscope.M, 2e-3));
  EXPECT_THAT(read.magnetometer.M, MatrixRelativelyNear(made.magnetometer.M, 2e-3));
  EXPECT_NEAR(read.accelerometer_z_coefficient, -0.6, 0.1);
  EXPECT_NEAR(read.gyroscope_coefficient(1), 1.4, 0.05);
  EXPECT_EQ(read.gyroscope_constant.norm(), 0);
  EXPECT_NEAR(read.gyroscope_t0, 25, 0.5);
}

// The magnetometer in a separate file, at half the rate and with its own times.
TEST(CalibrateVerb, TakesSensorsOfAnotherFile) {
  const TemporaryDirectory folder;
  const SimulatedImu made = simulate_imu({.seed = 3, .warming = 8});
  const std::string imu = folder.write("imu.csv", csv(made.log, false)).string();
  std::string text = "t[s],mx,my,mz\n";
  for (Eigen::Index i = 0; i + 1 < made.log.t.size(); i += 2)
    text += fmt::format("{},{},{},{}\n", made.log.t(i) + 1e-4, made.log.magnetometer(0, i),
                        made.log.magnetometer(1, i), made.log.magnetometer(2, i));
  const std::string magnetometer = folder.write("mag.csv", text).string();
  const std::string list = "mx@" + magnetometer + ",my@" + magnetometer + ",mz@" + magnetometer;
  const SortedJson json = json_of({"calibrate", "imu", "--log", imu, "--magnetometer", list});
  EXPECT_THAT(matrix(json["magnetometer"]["M"]), MatrixRelativelyNear(made.magnetometer.M, 5e-3));
  EXPECT_THAT(matrix(json["accelerometer"]["M"]), MatrixRelativelyNear(made.accelerometer.M, 2e-3));
  EXPECT_TRUE(json["warnings"].empty());
  const ProgramResult lacking =
      run_program({"calibrate", "imu", "--log", imu, "--magnetometer", "mx,my,mz"});
  EXPECT_EQ(lacking.status, 3);
  EXPECT_THAT(lacking.err, HasSubstr(imu + ": has no channels 'mx', 'my', 'mz'"));
  EXPECT_THAT(lacking.err, HasSubstr("for a channel of another log, write CHANNEL@FILE"));
}

// Columns by number, a rate for the times, no header, the log on standard input.
TEST(CalibrateVerb, TakesColumnsByNumber) {
  const TemporaryDirectory folder;
  const std::string text = csv(simulate_imu({.seed = 3}).log);
  std::string rows = text.substr(text.find('\n') + 1);
  std::replace(rows.begin(), rows.end(), ',', '\t');
  const StandardInput input(folder.write("rows.txt", rows).string());
  const ProgramResult result =
      run_program({"calibrate", "imu", "--log", "-", "--rate", "100", "--accelerometer", "2,3,4",
                   "--gyroscope", "5,6,7", "--magnetometer", "none"});
  EXPECT_EQ(result.status, 0) << result.err;
  EXPECT_THAT(result.out,
              HasSubstr("standard input: 16350 samples over 163.5 s, 36 stationary poses"));
  EXPECT_THAT(result.out, HasSubstr("rms of 35 turns"));
  EXPECT_THAT(result.out, Not(HasSubstr("magnetometer")));
}

// Raw frames contain times, names and a temperature.
TEST(CalibrateVerb, TakesRawFrames) {
  const TemporaryDirectory folder;
  const ImuLog log = simulate_imu({.seed = 3}).log;
  std::string text;
  for (Eigen::Index i = 0; i < log.t.size(); ++i) {
    text += "A 10000";
    for (int k = 0; k < 3; ++k) text += fmt::format(" {}", log.accelerometer(k, i));
    for (int k = 0; k < 3; ++k) text += fmt::format(" {}", log.gyroscope(k, i));
    for (int k = 0; k < 3; ++k) text += fmt::format(" {}", log.magnetometer(k, i));
    text += " 250 100000 Z\n";
  }
  const SortedJson frames =
      json_of({"calibrate", "imu", "--log", folder.write("frames.txt", text).string(),
               "--accelerometer", "acc_x,acc_y,acc_z", "--gyroscope", "gyro_x,gyro_y,gyro_z",
               "--magnetometer", "magn_x,magn_y,magn_z"});
  const SortedJson table =
      json_of({"calibrate", "imu", "--log", folder.write("log.csv", csv(log)).string(),
               "--temperature", "none"});
  EXPECT_THAT(matrix(frames["accelerometer"]["M"]),
              MatrixRelativelyNear(matrix(table["accelerometer"]["M"]), 1e-6));
  EXPECT_THAT(matrix(frames["magnetometer"]["M"]),
              MatrixRelativelyNear(matrix(table["magnetometer"]["M"]), 1e-6));
}

// A sensor that is not in the log keeps the numbers of --base; without it nothing is written.
TEST(CalibrateVerb, KeepsWhatTheLogDoesNotTell) {
  const TemporaryDirectory folder;
  const std::string log =
      folder.write("log.csv", csv(simulate_imu({.seed = 5}).log, false)).string();
  const std::string file = (folder.path() / "new.txt").string();
  const ProgramResult refused = run_program({"calibrate", "imu", "--log", log, "-o", file});
  EXPECT_EQ(refused.status, 2);
  EXPECT_THAT(refused.err, HasSubstr("the logs have no magnetometer; expected --base FILE"));
  EXPECT_FALSE(std::filesystem::exists(file));
  ImuCalibrationFile before;
  before.magnetometer.b = {1, 2, 3};
  before.with_temperature = false;
  const std::string base = folder.write("old.txt", imu_calibration_text(before)).string();
  EXPECT_EQ(run_program({"calibrate", "imu", "--log", log, "-o", file, "--base", base}).status, 0);
  const ImuCalibrationFile after = read_imu_calibration(file);
  EXPECT_EQ(after.magnetometer.b, Eigen::Vector3d(1, 2, 3));
  EXPECT_FALSE(after.with_temperature);
  EXPECT_NE(after.gyroscope.M, before.gyroscope.M);
}

TEST(CalibrateVerb, RefusesPosesThatDoNotTell) {
  const TemporaryDirectory folder;
  const std::string log =
      folder.write("log.csv", csv(simulate_imu({.upright = true}).log)).string();
  const std::string file = (folder.path() / "new.txt").string();
  const ProgramResult result = run_program({"calibrate", "imu", "--log", log, "-o", file});
  EXPECT_EQ(result.status, 4);
  EXPECT_THAT(result.err,
              HasSubstr("accelerometer not observable: 36 poses do not determine scale"));
  EXPECT_THAT(result.err, HasSubstr("missing poses: "));
  EXPECT_THAT(result.err, HasSubstr("y down"));
  EXPECT_FALSE(std::filesystem::exists(file));
}

TEST(CalibrateVerb, RefusesBadCommandLinesAndLogs) {
  const TemporaryDirectory folder;
  const auto refusal = [&](std::vector<std::string> args, int status) {
    const ProgramResult result = run_program(args);
    EXPECT_EQ(result.status, status) << result.err;
    return result.err;
  };
  EXPECT_THAT(refusal({"calibrate", "imo", "--simulate"}, 2), HasSubstr("quadtune calibrate imu"));
  EXPECT_THAT(refusal({"calibrate", "imu"}, 2), HasSubstr("--log is missing"));
  EXPECT_THAT(refusal({"calibrate", "imu", "--simulate", "--log", "x"}, 2),
              HasSubstr("--simulate cannot be combined with --log"));
  EXPECT_THAT(refusal({"calibrate", "imu", "--simulate", "--gyroscope", "none"}, 2),
              HasSubstr("--gyroscope describes a log, expected --log instead of --simulate"));
  EXPECT_THAT(refusal({"calibrate", "imu", "--log", "/nowhere/x"}, 5), HasSubstr("/nowhere/x"));
  const std::string log = folder.write("l.csv", "t,ax,ay,az\n0,1,2,3\n1,1,2,3\n2,1,2,x\n").string();
  const std::string words = refusal({"calibrate", "imu", "--log", log}, 3);
  EXPECT_THAT(words, HasSubstr("warning: 1 of 3 samples of 'ax' in " + log + " have no sample of"));
  EXPECT_THAT(words, HasSubstr("has 2 samples; expected at least"));
  EXPECT_THAT(refusal({"calibrate", "imu", "--log", log, "--accelerometer", "ax,ay,7"}, 3),
              HasSubstr("has no channel '7', expected one of ax ay az"));
  const std::string slow = folder
                               .write("s.csv",
                                      "t,ax,ay,az,gx,gy,gz\n0,1,2,3,,,\n1,1,2,3,4,5,6\n2,1,2,3,,,\n"
                                      "3,1,2,3,4,5,6\n4,1,2,3,,,\n")
                               .string();
  EXPECT_THAT(refusal({"calibrate", "imu", "--log", slow}, 3),
              HasSubstr("only 2 of 5 samples of 'ax' coincide with samples of all other channels "
                        "('gx' has 2 samples), expected sensors with common sample times"));
  EXPECT_THAT(refusal({"calibrate", "imu", "--log", log, "--accelerometer", "ax,ay"}, 2),
              HasSubstr("--accelerometer lists 2 columns, expected 3 (x,y,z)\n"));
  EXPECT_THAT(refusal({"calibrate", "imu", "--log", log, "--accelerometer", "none"}, 2),
              HasSubstr("--accelerometer is 'none', expected three channels"));
  EXPECT_THAT(refusal({"calibrate", "imu", "--log", log, "--accelerometer", "1,2,3"}, 3),
              HasSubstr("has no channel '1', expected one of ax ay az; a number counts the columns "
                        "from 1 and cannot select the column of the times"));
  EXPECT_THAT(refusal({"calibrate", "imu", "--log", log, "--accelerometer", "ax,ay,azz"}, 3),
              HasSubstr("has no channel 'azz'"));
  const std::string back =
      folder.write("b.csv", "t,ax,ay,az\n0,1,2,3\n1,1,2,3\n1,1,2,3\n").string();
  EXPECT_THAT(refusal({"calibrate", "imu", "--log", back}, 3),
              HasSubstr("the time of 'ax' does not increase: sample 3 is at 1 s"));
  EXPECT_THAT(refusal({"calibrate", "imu", "--log", back, "--rate", "100"}, 3),
              HasSubstr("has 3 samples; expected at least 250, ten windows of 0.25 s"));
}

std::string record(int samples, const std::string& header = "") {
  const SimulatedGyroscope made = simulate_gyroscope(2);
  std::string text = header;
  for (int i = 0; i < samples; ++i) text += fmt::format("{},{}\n", i * 10000000LL, made.rate(i));
  return text;
}

TEST(AllanVerb, GivesTheKeysOfTheContract) {
  const SortedJson json = json_of({"allan", "--simulate"});
  for (const char* key : {"tau", "adev", "low", "high", "edf"})
    EXPECT_EQ(json[key].size(), json["tau"].size()) << key;
  EXPECT_EQ(json["tau"][0], 0.01);
  const SortedJson& density = json["noise_density"];
  EXPECT_TRUE(density["seen"]);
  EXPECT_LT(double(density["low"]), 1e-4);
  EXPECT_GT(double(density["high"]), 1e-4 * 0.98);
  EXPECT_EQ(density["unit"], "rad/s/sqrt(Hz)");
  EXPECT_EQ(json["random_walk"]["unit"], "rad/s^2/sqrt(Hz)");
  EXPECT_NEAR(double(json["random_walk"]["value"]), 2e-5, 6e-6);
  EXPECT_TRUE(json["bias_instability"]["seen"]);
  EXPECT_FALSE(json["quantization"]["seen"]);
  EXPECT_TRUE(json["fit"]["explained"]);
  EXPECT_EQ(json_of({"allan", "--simulate", "--seed", "1"}), json);
  EXPECT_NE(json_of({"allan", "--simulate", "--seed", "2"})["adev"], json["adev"]);
}

TEST(AllanVerb, SpellsOutUnits) {
  const std::string out = run_program({"allan", "--simulate"}).out;
  EXPECT_THAT(out, HasSubstr("noise density (angle random walk), slope -1/2, at tau = 1 s"));
  EXPECT_THAT(out, HasSubstr("0.3444 deg/sqrt(h)"));  // 1.002e-4 · 180/π · 60
  EXPECT_THAT(out, HasSubstr("deg/h/sqrt(h)"));
  EXPECT_THAT(run_program({"allan", "--simulate", "--unit", "m/s^2"}).out,
              HasSubstr("ug/sqrt(Hz)"));
  EXPECT_THAT(run_program({"allan", "--simulate", "--unit", "mbar"}).out,
              HasSubstr("mbar/sqrt(Hz)"));
}

// Names and units of the header, nanoseconds of an epoch, a comment for a header.
TEST(AllanVerb, ReadsNamedColumns) {
  const TemporaryDirectory folder;
  for (const char* header : {"#timestamp [ns],wx [rad/s]\n", "timestamp[ns],wx[rad/s]\n",
                             "# a comment\n# of two lines\n\ntimestamp [ns], wx [rad/s]\n"}) {
    const std::string log = folder.write("l.csv", record(2000, header)).string();
    const SortedJson json =
        json_of({"allan", "--log", log, "--column", "wx", "--time", "timestamp"});
    EXPECT_EQ(json["samples"], 2000);
    EXPECT_EQ(json["unit"], "rad/s");
    EXPECT_NEAR(double(json["dt"]), 0.01, 1e-15);
    EXPECT_EQ(json_of({"allan", "--log", log, "--column", "2", "--rate", "100"})["adev"].size(),
              json["adev"].size());
  }
}

// A wrapped angle has the same noise as the unwrapped one.
TEST(AllanVerb, UnwrapsAPhase) {
  const TemporaryDirectory folder;
  const SimulatedGyroscope made = simulate_gyroscope(2);
  std::string free = "t[s],angle[rad]\n", within = "t[s],angle[rad]\n",
              degrees = "t[s],angle[deg]\n";
  double angle = 0;
  for (int i = 0; i < 3000; ++i) {
    const double kept = std::remainder(angle + 3.14159265, 2 * std::numbers::pi);
    free += fmt::format("{:.2f},{}\n", i * 0.01, angle);
    within += fmt::format("{:.2f},{}\n", i * 0.01, kept);
    degrees += fmt::format("{:.2f},{}\n", i * 0.01, kept * 180 / std::numbers::pi);
    angle += 0.01 * made.rate(i);
  }
  const auto analysed = [&](const char* name, const std::string& text) {
    return json_of(
        {"allan", "--log", folder.write(name, text).string(), "--column", "angle", "--phase"});
  };
  const SortedJson right = analysed("free.csv", free);
  EXPECT_EQ(right["warnings"].size(), 0);
  for (const SortedJson& found : {analysed("w.csv", within), analysed("d.csv", degrees)}) {
    const double scale = found["unit"] == "deg/s" ? 180 / std::numbers::pi : 1;
    for (std::size_t i = 0; i < right["adev"].size(); ++i)
      EXPECT_NEAR(double(found["adev"][i]) / scale / double(right["adev"][i]), 1, 1e-6);
    ASSERT_EQ(found["warnings"].size(), 1);
    EXPECT_THAT(std::string(found["warnings"][0]),
                HasSubstr("'angle' jumps by more than half a turn "));
  }
}

// The error of a clock, an angle: the deviation is that of the rate of which it is the integral.
TEST(AllanVerb, TakesAPhase) {
  const TemporaryDirectory folder;
  const SimulatedGyroscope made = simulate_gyroscope(2);
  std::string rates = "t[s],w[rad/s]\n", angles = "t[s],angle[rad]\n";
  double angle = 0.5;
  for (int i = 0; i < 3000; ++i) {
    rates += fmt::format("{:.2f},{}\n", i * 0.01, made.rate(i));
    angles += fmt::format("{:.2f},{}\n", i * 0.01, angle);
    angle += 0.01 * made.rate(i);
  }
  angles += fmt::format("{:.2f},{}\n", 30.0, angle);
  const SortedJson rate =
      json_of({"allan", "--log", folder.write("r.csv", rates).string(), "--column", "w"});
  const std::string file = folder.write("a.csv", angles).string();
  const SortedJson phase = json_of({"allan", "--log", file, "--column", "angle", "--phase"});
  EXPECT_EQ(phase["samples"], 3000);
  EXPECT_EQ(phase["unit"], "rad/s");
  EXPECT_EQ(phase["column"], "angle");
  EXPECT_EQ(phase["phase"], true);
  EXPECT_EQ(rate["phase"], false);
  ASSERT_EQ(phase["adev"].size(), rate["adev"].size());
  for (std::size_t i = 0; i < phase["adev"].size(); ++i)
    EXPECT_NEAR(double(phase["adev"][i]), double(rate["adev"][i]), 1e-9 * double(rate["adev"][i]));
  EXPECT_THAT(run_program({"allan", "--log", file, "--column", "angle", "--phase"}).out,
              HasSubstr("the rate of angle [rad/s], 3000 samples"));
  EXPECT_EQ(
      json_of({"allan", "--log", file, "--column", "angle", "--phase", "--unit", "s"})["unit"],
      "1");
  EXPECT_EQ(run_program({"allan", "--simulate", "--phase"}).status, 2);
}

// The warnings of the reader are also printed by commands that use the log.
TEST(AllanVerb, SaysWhatTheReaderWarnsOf) {
  const TemporaryDirectory folder;
  const SimulatedGyroscope made = simulate_gyroscope(2);
  std::string text = "timestamp,w[rad/s]\n0,7\n";
  for (std::int64_t i = 0; i < 1000; ++i)
    text += fmt::format("{},{}\n", 1403636579758555392 + i * 5000000, made.rate(i));
  const std::string file = folder.write("l.csv", text).string();
  for (const std::vector<std::string>& clock :
       {std::vector<std::string>{}, {"--time", "1"}, {"--time", "timestamp"}}) {
    std::vector<std::string> args = {"allan", "--log", file, "--column", "w", "--json"};
    args.insert(args.end(), clock.begin(), clock.end());
    const ProgramResult result = run_program(args);
    ASSERT_EQ(result.status, 0) << result.err;
    const SortedJson json = SortedJson::parse(result.out);
    EXPECT_NEAR(double(json["dt"]), 0.005, 1e-9);
    EXPECT_EQ(json["samples"], 1000);
    ASSERT_EQ(json["warnings"].size(), 2U);
    EXPECT_THAT(std::string(json["warnings"][0]), HasSubstr("taken as nanoseconds since 1970"));
    EXPECT_THAT(std::string(json["warnings"][1]), HasSubstr("1 of 1001 rows is at time 0"));
    EXPECT_THAT(result.err, HasSubstr("allan: warning: " + file + ": 1 of 1001 rows"));
  }
}

TEST(AllanVerb, SaysWhatTheRecordIsTooShortFor) {
  const TemporaryDirectory folder;
  const std::string log = folder.write("l.csv", record(2000)).string();
  const ProgramResult result =
      run_program({"allan", "--log", log, "--column", "2", "--rate", "100", "--unit", "rad/s"});
  EXPECT_EQ(result.status, 0);
  EXPECT_THAT(result.out, HasSubstr("not visible in this log: too short: no slope of +1/2 up to "
                                    "2.56 s"));
  EXPECT_THAT(result.out, HasSubstr("at most "));
}

TEST(AllanVerb, RefusesGaps) {
  const TemporaryDirectory folder;
  std::string text = "t,w\n";
  for (int i = 0; i < 200; ++i) text += fmt::format("{},{}\n", i < 150 ? i : i + 1, i % 7);
  const std::string log = folder.write("l.csv", text).string();
  const ProgramResult gap = run_program({"allan", "--log", log, "--column", "w", "--time", "t"});
  EXPECT_EQ(gap.status, 3);
  EXPECT_THAT(gap.err, HasSubstr("'w' has a gap: sample 151, at 151 s, is 2 s after the previous "
                                 "one, expected 1 s (the median)"));
  const std::string holes = folder.write("h.csv", "w\n1\n2\nnan\n4\n5\n6\n").string();
  const ProgramResult hole = run_program({"allan", "--log", holes, "--column", "w", "--rate", "1"});
  EXPECT_EQ(hole.status, 3);
  EXPECT_THAT(hole.err, HasSubstr(holes + ": 'w' has a gap: sample 3, at 3 s, is 2 s after"));
  const std::string torn = folder.write("t.csv", "a b\n1 2\n1 2\n1\n1 2\n1 2\n1 2\n").string();
  const ProgramResult broken =
      run_program({"allan", "--log", torn, "--column", "b", "--rate", "1"});
  EXPECT_THAT(broken.err, HasSubstr(torn + ":4: the row has 1 field, expected 2"));
  EXPECT_THAT(broken.err, HasSubstr("'b' has a gap: sample 3"));
}

// A channel of a log that no text holds, with the times and gaps of the log itself.
TEST(AllanVerb, ReadsOtherLogs) {
  const TemporaryDirectory folder;
  const SimulatedGyroscope made = simulate_gyroscope(2);
  testing::UlogWriter log;
  log.flags().format("imu:uint64_t timestamp;double w;");
  log.subscribe(0, 0, "imu");
  std::string text = "t_us,w\n";
  for (int i = 0; i < 2000; ++i) {
    const std::uint64_t t = 1000000 + static_cast<std::uint64_t>(i) * 10000;
    log.data(0, testing::packed(t, made.rate(i)));
    text += fmt::format("{},{}\n", t, made.rate(i));
  }
  const std::string file = folder.write("l.ulg", log.bytes()).string();
  const SortedJson ulog = json_of({"allan", "--log", file, "--column", "imu.w"});
  EXPECT_EQ(ulog["samples"], 2000);
  EXPECT_EQ(ulog["column"], "imu.w");
  const std::string csv = folder.write("l.csv", text).string();
  EXPECT_EQ(json_of({"allan", "--log", csv, "--column", "w"})["adev"], ulog["adev"]);
  const ProgramResult paced =
      run_program({"allan", "--log", file, "--column", "w", "--rate", "100"});
  EXPECT_EQ(paced.status, 3);
  EXPECT_THAT(paced.err, HasSubstr("is read as ulog, which defines its own columns and times"));
}

// Every second row has a value: a sensor at half the rate.
TEST(AllanVerb, TakesTheRowsThatHoldAValue) {
  const TemporaryDirectory folder;
  std::string text = "Zeit[ms],w[rad/s]\n";
  const SimulatedGyroscope made = simulate_gyroscope(2);
  for (int i = 0; i < 1000; ++i)
    text += fmt::format("{},{}\n{},\n", 20 * i, made.rate(i), 20 * i + 10);
  const SortedJson json = json_of(
      {"allan", "--log", folder.write("l.csv", text).string(), "--column", "w", "--time", "Zeit"});
  EXPECT_EQ(json["samples"], 1000);
  EXPECT_NEAR(double(json["dt"]), 0.02, 1e-12);
}

TEST(AllanVerb, RefusesBadCommandLines) {
  const TemporaryDirectory folder;
  const std::string log = folder.write("l.csv", "wx,wy\n1,2\n").string();
  const auto refusal = [&](std::vector<std::string> args, int status = 2) {
    args.insert(args.begin(), "allan");
    const ProgramResult result = run_program(args);
    EXPECT_EQ(result.status, status) << result.err;
    return result.err;
  };
  EXPECT_THAT(refusal({}), HasSubstr("--log is missing"));
  EXPECT_THAT(refusal({"--log", log}), HasSubstr("--column is missing"));
  EXPECT_THAT(refusal({"--log", log, "--column", "wx"}),
              HasSubstr("no sample rate; expected --rate HZ or --time COLUMN"));
  EXPECT_THAT(refusal({"--log", log, "--column", "wz", "--rate", "1"}, 3),
              HasSubstr(log + ": has no channel 'wz', expected one of wx wy"));
  EXPECT_THAT(refusal({"--log", log, "--column", "wx", "--time", "wy", "--rate", "1"}),
              HasSubstr("--rate and --time cannot be combined"));
  EXPECT_THAT(refusal({"--log", log, "--column", "wx", "--time", "wy", "--time-unit", "h"}),
              HasSubstr("--time-unit is 'h', expected s, ms, us or ns"));
  EXPECT_THAT(refusal({"--simulate", "--taus", "octave"}), HasSubstr("did you mean 'octaves'?"));
  EXPECT_THAT(refusal({"--simulate", "--log", log}),
              HasSubstr("--simulate cannot be combined with --log"));
  EXPECT_THAT(refusal({"--simulate", "--plot", "a.pdf"}), HasSubstr(".svg, .png, .csv or .json"));
  EXPECT_THAT(refusal({"--log", log, "--column", "wx", "--rate", "-3"}),
              HasSubstr("expected a number greater than 0"));
}

TEST(AllanVerb, DrawsTheCurve) {
  const TemporaryDirectory folder;
  const std::string file = (folder.path() / "allan.svg").string();
  ASSERT_EQ(run_program({"allan", "--simulate", "--plot", file}).status, 0);
  const std::string picture = folder.read("allan.svg");
  EXPECT_THAT(picture, HasSubstr("Allan deviation of wz"));
  EXPECT_THAT(picture, HasSubstr("random walk"));
  EXPECT_THAT(picture, HasSubstr("tau [s]"));
}

TEST(AllanVerb, OfRealLogs) {
  QUADTUNE_REQUIRE_DATA(data);
  const SortedJson baro =
      json_of({"allan", "--log", (data / "uquad2" / "log_test_IMU_3.txt").string(), "--column",
               "19", "--rate", "20", "--unit", "m"});
  EXPECT_NEAR(double(baro["noise_density"]["value"]), 0.114, 0.005);  // 0.51 m a sample
  const ProgramResult moving =
      run_program({"allan", "--log", (data / "euroc" / "V1_01_easy_imu0.csv").string(), "--column",
                   "w_RS_S_x", "--time", "timestamp"});
  EXPECT_EQ(moving.status, 0);
  EXPECT_THAT(moving.out,
              HasSubstr("the curve is not the sum of these noise components: the sensor moved"));
}

}  // namespace
}  // namespace quadtune
