// SPDX-License-Identifier: Apache-2.0
/// Input that is valid but most likely a mistake: it is rejected if its result would be useless, and
/// otherwise causes a warning or a note.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <sstream>
#include <string>

#include "run_program.hpp"
#include "source_folder.hpp"
#include "temporary_directory.hpp"

namespace quadtune::testing {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

class LikelyMistakes : public ::testing::Test {
 protected:
  /// A file with the text of one of the sources, in which the first `from` is replaced.
  std::string changed(const std::string& source, const std::string& from, const std::string& to,
                      const std::string& name) {
    std::ifstream file(source_folder() + "/" + source);
    std::ostringstream bytes;
    bytes << file.rdbuf();
    std::string text = bytes.str();
    const std::size_t at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    return folder_.write(name, text.replace(at, from.size(), to)).string();
  }

  [[nodiscard]] std::string path(const std::string& name) const {
    return (folder_.path() / name).string();
  }

  TemporaryDirectory folder_;
};

// The moments of the Mambo in g cm2: a design for them is useless.
TEST_F(LikelyMistakes, CommandsWarnOfAnImplausibleVehicle) {
  const std::string vehicle = changed("vehicles/mambo.toml", "inertia_kg_m2 = [",
                                      "inertia_kg_m2 = [582.0, 712.0, 900.0]\n#", "grams.toml");
  const std::string warning = vehicle +
                              ": largest principal moment over mass times the square of "
                              "the arm is ";
  const ProgramResult model = run_program({"linearize", vehicle});
  EXPECT_EQ(model.status, 0) << model.err;
  EXPECT_THAT(model.err, HasSubstr("linearize: warning: " + warning));
  EXPECT_THAT(model.err, HasSubstr("inertia_kg_m2 seems to be in g cm2"));
  EXPECT_EQ(run_program({"linearize", vehicle, "--quiet"}).err, "");
  // A design file for this vehicle.
  const std::string design = changed("designs/mambo-hover.toml", "vehicle = \"mambo\"",
                                     "vehicle = \"grams.toml\"", "d.toml");
  EXPECT_THAT(run_program({"design", design}).err,
              HasSubstr("design: warning: " + folder_.path().string()));
  // `vehicle` prints the warnings itself.
  EXPECT_EQ(run_program({"vehicle", "check", vehicle}).err, "");
  // The built-in vehicles are plausible.
  EXPECT_THAT(run_program({"linearize", "uquad"}).err, Not(HasSubstr("warning")));
}

TEST_F(LikelyMistakes, NewVehiclesAreChecked) {
  const ProgramResult grams = run_program(
      {"vehicle", "new", "q", "--mass", "1.24g", "--arm", "225mm", "--propeller", "9in"});
  EXPECT_EQ(grams.status, 0);
  EXPECT_THAT(grams.err, HasSubstr("vehicle: warning: arm (mean distance of the rotors from"));
  const ProgramResult right = run_program(
      {"vehicle", "new", "q", "--mass", "1240g", "--arm", "225mm", "--propeller", "9in"});
  EXPECT_THAT(right.err, Not(HasSubstr("warning")));
}

TEST_F(LikelyMistakes, AVehicleWithoutGyroscopeHasNoEstimator) {
  const std::string vehicle =
      changed("vehicles/uquad.toml", "[sensors.gyroscope]", "[sensors.none]", "v.toml");
  std::ifstream file(vehicle);
  std::string text, line;
  for (bool skipped = false; std::getline(file, line);) {
    if (line.starts_with('[')) skipped = line == "[sensors.none]";
    if (!skipped) text += line + "\n";
  }
  std::ofstream(vehicle) << text;
  const ProgramResult check = run_program({"vehicle", "check", vehicle});
  EXPECT_EQ(check.status, 0) << check.err;
  EXPECT_THAT(check.out, HasSubstr("warning: the sensors do not suffice for any estimator: no "
                                   "gyroscope"));
}

// Gains on the flown plant are computed for 20 % more mass, too.
TEST_F(LikelyMistakes, AVehicleWithLittleThrustCanHoverButGetsNoGains) {
  const ProgramResult made =
      run_program({"vehicle", "new", "q", "--mass", "3kg", "--arm", "300mm", "--propeller", "13in",
                   "--thrust-to-weight", "1.15", "--quiet", "-o", path("q.toml")});
  ASSERT_EQ(made.status, 0) << made.err;
  const ProgramResult check = run_program({"vehicle", "check", path("q.toml")});
  EXPECT_EQ(check.status, 0);
  EXPECT_THAT(check.out,
              HasSubstr("warning: `design`, `pid` and `lqr` require a hover with 120 % of "
                        "its mass: hover needs 35.3"));
  const ProgramResult gains = run_program({"pid", path("q.toml"), "--quiet"});
  EXPECT_EQ(gains.status, 4) << gains.err;
  EXPECT_THAT(gains.err,
              HasSubstr(path("q.toml") + ": gains on the flown plant must also hold the "
                                         "vehicle with 120 % of its mass, which cannot"));
}

// Without a sensor of the horizontal velocity, the loop has a neutral mode. It is not unstable.
TEST_F(LikelyMistakes, AVehicleWithoutASensorOfTheVelocity) {
  std::ifstream file(source_folder() + "/vehicles/quad-450.toml");
  std::string text, line;
  for (bool skipped = false; std::getline(file, line);) {
    if (line.starts_with('[')) skipped = line == "[sensors.gps]";
    if (!skipped) text += line + "\n";
  }
  const std::string vehicle = folder_.write("v.toml", text).string();
  const ProgramResult lqr = run_program({"lqr", vehicle});
  EXPECT_EQ(lqr.status, 0) << lqr.err;
  EXPECT_THAT(lqr.out, HasSubstr("neutral, largest |z| 1.000000"));
  EXPECT_THAT(lqr.out, Not(HasSubstr("UNSTABLE")));
  EXPECT_THAT(lqr.err, Not(HasSubstr("is unstable when it is closed")));
  const ProgramResult pid = run_program({"pid", vehicle});
  EXPECT_EQ(pid.status, 4);
  EXPECT_THAT(pid.err, HasSubstr("; the sensors have no optical flow, GPS or vision"));
}

TEST_F(LikelyMistakes, AVehicleFileThatWasChangedAfterTheExport) {
  const std::string vehicle =
      changed("vehicles/uquad.toml", "name = \"uquad\"", "name = \"mine\"", "mine.toml");
  ASSERT_EQ(run_program({"export", vehicle, "--to", "json", "--quiet", "-o", path("out")}).status,
            0);
  EXPECT_EQ(run_program({"verify", path("out"), "--quiet"}).status, 0);
  EXPECT_THAT(run_program({"fly", vehicle, "--gains", path("out")}).err, Not(HasSubstr("changed")));
  std::ofstream(vehicle, std::ios::app) << "# heavier now\n";
  EXPECT_THAT(run_program({"fly", vehicle, "--gains", path("out")}).err,
              HasSubstr(vehicle + " was changed after the export to " + path("out")));
  const ProgramResult verified = run_program({"verify", path("out"), "--quiet"});
  EXPECT_EQ(verified.status, 2);
  EXPECT_THAT(verified.err, HasSubstr("mine.toml was changed after the export"));
}

TEST_F(LikelyMistakes, TwoRotorsAtAlmostTheSamePlace) {
  const std::string vehicle = changed("vehicles/uquad.toml", "position_m = [0.29, 0, 0]",
                                      "position_m = [0.01, 0.29, 0]", "v.toml");
  EXPECT_THAT(run_program({"vehicle", "show", vehicle}).out,
              HasSubstr("smallest distance between two rotors over the arm is "));
}

TEST_F(LikelyMistakes, AVehicleThatCannotHoverIsNotFlown) {
  const std::string vehicle =
      changed("vehicles/mambo.toml", "mass_kg = 0.063", "mass_kg = 63.0", "v.toml");
  for (const std::vector<std::string>& args :
       {std::vector<std::string>{"fly", vehicle, "--gains", "published"},
        {"compare", "integrators", vehicle},
        {"pid", vehicle}}) {
    const ProgramResult result = run_program(args);
    EXPECT_EQ(result.status, 4) << args[0];
    EXPECT_THAT(result.err, HasSubstr(vehicle + ": no hover trim: hover needs 618")) << args[0];
    EXPECT_THAT(result.err, HasSubstr("mass_kg seems to be in g")) << args[0];
  }
}

TEST_F(LikelyMistakes, AFlightNotesWindThatDoesNotAct) {
  const auto notes = [](const std::string& wind) {
    return run_program({"fly", "mambo", "--duration", "5", "--wind", wind}).err;
  };
  EXPECT_THAT(notes("gust_north=1,gust_at=50"),
              HasSubstr("the gust begins at 50 s, after the flight, which ends at 5 s"));
  EXPECT_THAT(notes("gust_at=2"), HasSubstr("have no effect without gust_north, gust_east or "));
  EXPECT_THAT(notes("turbulence_height=50"), HasSubstr("has no effect without turbulence"));
  EXPECT_THAT(notes("gust_north=1,gust_at=2"), Not(HasSubstr("gust")));
  const ProgramResult before = run_program({"fly", "mambo", "--wind", "gust_north=1,gust_at=-5"});
  EXPECT_EQ(before.status, 2);
  EXPECT_EQ(before.err, "quadtune fly: --wind: gust_at is -5 s, expected 0 or more\n");
}

// No limit is exceeded, but the settling time is undefined, so that no flight can pass.
TEST_F(LikelyMistakes, AFlightThatIsTooShortToSettleIsNoted) {
  const std::string note =
      "every flight fails the limit of the settling time, which requires a constant reference for "
      "10 s; the flight lasts 5 s";
  EXPECT_THAT(run_program({"fly", "mambo", "--duration", "5"}).err,
              HasSubstr("fly: note: " + note));
  EXPECT_THAT(run_program({"fly", "mambo"}).err, Not(HasSubstr("every flight fails")));
}

TEST_F(LikelyMistakes, DiscretePidsWarnOfALongPeriod) {
  const ProgramResult plant =
      run_program({"pid", "--num", "1", "--den", "1,3,3,1", "--rule", "simc", "--dt", "5"});
  EXPECT_EQ(plant.status, 0);
  EXPECT_THAT(plant.err, HasSubstr("pid: warning: --dt 5 adds a delay of 2.5 s, "));
  EXPECT_THAT(plant.err, HasSubstr(" % of the delay margin of the continuous loop"));
  EXPECT_THAT(run_program({"pid", "--Ku", "8", "--Tu", "0.01", "--dt", "0.1"}).err,
              HasSubstr("pid: warning: --dt 0.1 adds a delay of 0.05 s, "));
  EXPECT_EQ(run_program({"pid", "--Ku", "8", "--Tu", "0.01", "--dt", "0.0005"}).err, "");
}

TEST_F(LikelyMistakes, SlowMotorsGetTheAdviceOfALead) {
  EXPECT_THAT(run_program({"pid", "crazyflie"}).err,
              HasSubstr("the lag of the motors, 0.072 s, limits the loops of roll and pitch; "
                        "--rate-lead 0.036, which `quadtune design V` uses"));
  EXPECT_THAT(run_program({"pid", "crazyflie", "--rate-lead", "0.036"}).err,
              Not(HasSubstr("limits the loops")));
  EXPECT_THAT(run_program({"pid", "mambo"}).err, Not(HasSubstr("limits the loops")));
}

TEST_F(LikelyMistakes, AnotherUnitThanThatOfTheLogIsNoted) {
  std::string log = "t,gz[deg/s]\n";
  for (int k = 0; k < 2000; ++k)
    log += std::to_string(0.01 * k) + "," + std::to_string(std::sin(12.9898 * k * k)) + "\n";
  const std::string path = folder_.write("gz.csv", log).string();
  EXPECT_THAT(
      run_program({"allan", "--log", path, "--column", "gz", "--unit", "rad/s"}).err,
      HasSubstr("'gz' is in deg/s according to the log, but unit is rad/s; the values are not "
                "converted"));
  EXPECT_THAT(run_program({"allan", "--log", path, "--column", "gz"}).err,
              Not(HasSubstr("according")));
  EXPECT_THAT(run_program({"allan", "--log", path, "--column", "gz", "--unit", "deg/s"}).err,
              Not(HasSubstr("according")));
}

TEST_F(LikelyMistakes, TheSameLogTwiceIsRejected) {
  const std::string log = source_folder() + "/docs/examples/bobbing.csv";
  const ProgramResult twice =
      run_program({"tune", "kalman", "--model", "altitude", "--log", log, "--log", log});
  EXPECT_EQ(twice.status, 2);
  EXPECT_THAT(twice.err, HasSubstr("quadtune tune kalman: --log lists " + log + " twice"));
  std::ifstream file(log);
  std::ostringstream text;
  text << file.rdbuf();
  const std::string copy = folder_.write("copy.csv", text.str()).string();
  EXPECT_THAT(
      run_program({"tune", "kalman", "--model", "altitude", "--log", log, "--log", copy}).err,
      HasSubstr("have the same content"));
}

TEST_F(LikelyMistakes, ChannelsOfTwoAxesOrSensorsAreRejected) {
  const auto error = [](const char* option, const char* list) {
    const ProgramResult result =
        run_program({"calibrate", "imu", "--log", "none.csv", option, list});
    EXPECT_EQ(result.status, 2);
    return result.err;
  };
  EXPECT_THAT(error("--accelerometer", "ax,ax,az"), HasSubstr("--accelerometer lists 'ax' twice"));
  EXPECT_THAT(error("--gyroscope", "ax,gy,gz"),
              HasSubstr("--gyroscope lists 'ax', a channel of the accelerometer"));
}

TEST_F(LikelyMistakes, GravityOfNoPlaceOnEarthIsNoted) {
  EXPECT_THAT(run_program({"calibrate", "imu", "--simulate", "--gravity", "981"}).err,
              HasSubstr("gravity is 981 m/s^2, expected 9.76 to 9.84"));
  EXPECT_EQ(run_program({"calibrate", "imu", "--simulate", "--gravity", "9.81"}).err, "");
}

TEST_F(LikelyMistakes, AYawOfManyTurnsIsNoted) {
  EXPECT_THAT(run_program({"linearize", "uquad", "--yaw", "90"}).err,
              HasSubstr("--yaw is 90 rad, which is 5.16e+03 degrees"));
  EXPECT_THAT(run_program({"linearize", "uquad", "--yaw", "-3.14"}).err, Not(HasSubstr("degrees")));
}

TEST_F(LikelyMistakes, MatricesNameWhatIsNotFinite) {
  for (const char* word : {"inf", "-Inf", "NaN"}) {
    const ProgramResult result =
        run_program({"lqr", "--A", "0", "--B", "1", "--Q", "1", "--R", word});
    EXPECT_EQ(result.status, 2);
    EXPECT_EQ(result.err, std::string("quadtune lqr: --R is '") + word +
                              "', expected finite numbers or a matrix file\n");
  }
}

// Two equal sensors whose noise is the same: no gain is determined.
TEST_F(LikelyMistakes, MeasurementsThatAreEqualAreNamed) {
  const ProgramResult result = run_program({"kalman", "--A", "0 1; 0 0", "--C", "1 0; 1 0", "--Q",
                                            "1 0; 0 1", "--R", "1 1; 1 1", "--sampled", "0.01"});
  EXPECT_EQ(result.status, 4);
  EXPECT_THAT(result.err, HasSubstr("R + C P C' is singular: a combination of the measurements has "
                                    "no noise and does not depend on the states"));
}

TEST_F(LikelyMistakes, IntegralsOfStatesThatAreZeroInHover) {
  const ProgramResult result = run_program({"lqr", "mambo", "--integral", "roll"});
  EXPECT_EQ(result.status, 2);
  EXPECT_EQ(result.err,
            "quadtune lqr: --integral: the integral of roll cannot be controlled, because roll is "
            "0 in hover; "
            "expected names from px py pz yaw, or none\n");
}

TEST_F(LikelyMistakes, FrequencyDataMayHaveTheirUnitsInBrackets) {
  const std::string plain = folder_.write("plain.csv", "f,re,im\n1,-1,-1\n2,-0.1,-0.2\n").string();
  const std::string units =
      folder_.write("units.csv", "f[Hz],re,im\n1,-1,-1\n2,-0.1,-0.2\n").string();
  const ProgramResult a = run_program({"margins", "--frd", plain, "--quiet"});
  EXPECT_EQ(a.status, 0) << a.err;
  EXPECT_EQ(run_program({"margins", "--frd", units, "--quiet"}).out, a.out);
  // Options that would have no effect.
  EXPECT_EQ(run_program({"margins", "--frd", plain, "--cut", "outputs"}).err,
            "quadtune margins: --cut requires a model of the loop\n");
  EXPECT_EQ(run_program({"margins", "--frd", plain, "--dt", "0.01"}).err,
            "quadtune margins: --dt with --frd is the period of a controller, expected --pid or "
            "another one\n");
}

TEST_F(LikelyMistakes, AnOutputDoesNotReplaceAnInput) {
  const std::string log = folder_.write("log.csv", "t_s,gx\n0,1\n0.1,2\n0.2,3\n").string();
  const ProgramResult result = run_program({"log", log, "-o", folder_.path() / "." / "log.csv"});
  EXPECT_EQ(result.status, 2);
  EXPECT_EQ(result.err,
            "quadtune log: -o is " + log + ", which the command reads; expected another file\n");
  std::ifstream file(log);
  std::ostringstream kept;
  kept << file.rdbuf();
  EXPECT_THAT(kept.str(), HasSubstr("0.2,3\n"));
  EXPECT_EQ(run_program({"log", log, "-o", path("other.txt")}).status, 0);
}

TEST_F(LikelyMistakes, NumbersOfAListInSeparateWords) {
  EXPECT_THAT(run_program({"margins", "--num", "25", "--den", "1", "10", "10"}).err,
              HasSubstr("unexpected argument '10' (the numbers of a list are one word, such as "
                        "1,10,10), expected: quadtune margins "));
}

// Position is in world axes: gains for the yaw 1.57 rad mix north and east at the yaw 0.
TEST_F(LikelyMistakes, AStateFeedbackForAnotherYawIsNoted) {
  const std::string east =
      changed("designs/uquad-hover.toml", "yaw_rad = 0", "yaw_rad = 1.57", "east.toml");
  const std::string mission =
      folder_
          .write("east-hover.toml",
                 "name = \"east\"\nduration_s = 5\n[start]\nyaw_rad = 1.57\n[hover]\nheight_m = "
                 "1\n")
          .string();
  const std::vector<std::string> fly = {"fly",          "uquad", "--gains",    east,
                                        "--controller", "lqr",   "--duration", "1",
                                        "--estimator",  "truth"};
  std::vector<std::string> there = fly;
  there.insert(there.end(), {"--mission", mission});
  EXPECT_THAT(run_program(fly).err,
              HasSubstr("fly: note: the gains are for the yaw 1.57 rad, and the mission begins at "
                        "the yaw 0 rad"));
  const ProgramResult right = run_program(there);
  EXPECT_LE(right.status, 1) << right.err;
  EXPECT_THAT(right.err, Not(HasSubstr("the gains are for the yaw")));
  // These errors are along the heading: the gains hold at every yaw.
  const std::string one = (folder_.path() / "one.json").string();
  const std::string schedule = (folder_.path() / "schedule.json").string();
  ASSERT_EQ(run_program({"lqr", "uquad", "--plant", "ideal", "--R", "0.01", "-o", one}).status, 0);
  ASSERT_EQ(
      run_program({"lqr", "uquad", "--schedule", "speed=0:1:1", "--R", "0.01", "-o", schedule})
          .status,
      0);
  for (const std::string& gains : {one, schedule})
    EXPECT_THAT(run_program({"fly", "uquad", "--gains", gains, "--mission", mission}).err,
                Not(HasSubstr("the gains are for the yaw")));
}

TEST_F(LikelyMistakes, ALineWithoutSpeedIsAHover) {
  EXPECT_THAT(run_program({"linearize", "uquad", "--at", "line"}).err,
              HasSubstr("--at line without --speed and --climb is a hover"));
  EXPECT_THAT(run_program({"linearize", "uquad", "--at", "line", "--speed", "2"}).err,
              Not(HasSubstr("is a hover")));
}

TEST_F(LikelyMistakes, CampaignsRejectRatiosFarFrom1AndVariancesOfOtherUnits) {
  const std::string head =
      "name = \"c\"\nvehicle = \"mambo\"\nflights = 2\n[[design]]\nname = \"d\"\ngains = "
      "\"designed\"\n[[mission]]\nmission = \"hover\"\nduration_s = 1\n[[vary]]\n";
  const auto plan = [&](const std::string& vary) {
    return run_program(
        {"campaign", "init", folder_.write("c.toml", head + vary).string(), path("plan")});
  };
  const ProgramResult mass =
      plan("quantity = \"mass\"\nnormal = { mean = 0.063, deviation = 0.002 }\n");
  EXPECT_EQ(mass.status, 3);
  EXPECT_THAT(mass.err,
              HasSubstr("has the centre 0.063, expected 0.2 to 5, because mass is a ratio "
                        "to the value of the vehicle file"));
  (void)changed("filters/attitude.toml", "unit = \"rad2\"\n",
                "unit = \"rad2\"\ninterval = [1e-4, 1e-2]\n", "attitude.toml");
  const ProgramResult sonar = plan(
      "quantity = \"sonar_deviation\"\nfitted = { file = "
      "\"attitude.toml\", parameter = \"R.tilt\" }\n");
  EXPECT_EQ(sonar.status, 3);
  EXPECT_THAT(sonar.err, HasSubstr("is in rad2, expected a variance in m2 for sonar_deviation"));
}

TEST_F(LikelyMistakes, TheSeedOfACampaignIsThatOfItsPlan) {
  const std::string file =
      folder_
          .write("c.toml",
                 "name = \"c\"\nvehicle = \"mambo\"\nflights = 2\nseed = 1\n[[design]]\nname = "
                 "\"d\"\ngains = \"published\"\n[[mission]]\nmission = \"hover\"\nduration_s = 1\n")
          .string();
  EXPECT_EQ(run_program({"campaign", "init", file, path("five"), "--seed", "5"}).status, 0);
  std::ifstream plan(path("five/plan.json"));
  std::ostringstream text;
  text << plan.rdbuf();
  EXPECT_THAT(text.str(), ::testing::ContainsRegex("\"seed\": *5"));
  const ProgramResult late =
      run_program({"campaign", "work", path("five"), "--shard", "0", "--seed", "6"});
  EXPECT_EQ(late.status, 2);
  EXPECT_EQ(late.err,
            "quadtune campaign work: --seed has no effect, because the plan contains the seed; "
            "expected it in `campaign init`\n");
}

TEST_F(LikelyMistakes, ImportedValuesOutsideThePublishedRangesAreNoted) {
  const std::string file = folder_.write("a.param", "ANGLE_MAX 30\nATC_RAT_RLL_P 0.135\n").string();
  const std::string vehicle = source_folder() + "/vehicles/quad-450.toml";
  EXPECT_THAT(run_program({"import", "ardupilot", file, "--vehicle", vehicle}).err,
              HasSubstr("outside the published range: ANGLE_MAX is 30 (1000 to 8000)"));
  const std::string hexa = folder_.write("h.param", "FRAME_CLASS 2\n").string();
  const ProgramResult frame = run_program({"import", "ardupilot", hexa, "--vehicle", vehicle});
  EXPECT_EQ(frame.status, 3);
  EXPECT_THAT(frame.err,
              HasSubstr("FRAME_CLASS is 2, expected 1, because quad-450 has four rotors"));
}

TEST_F(LikelyMistakes, AnExportWithoutTheFilterOfADerivativeIsNoted) {
  const ProgramResult pid = run_program({"pid", "crazyflie", "--rate-lead", "0.03", "--json"});
  const std::string gains = folder_.write("gains.json", pid.out).string();
  EXPECT_THAT(run_program({"export", gains, "--to", "crazyflie", "--vehicle", "crazyflie", "-o",
                           path("board")})
                  .err,
              HasSubstr("rate_filter_s is not written: the firmware has no parameter"));
}

TEST_F(LikelyMistakes, ACutoffAboveAFullBattery) {
  const std::string vehicle =
      folder_
          .write(
              "v.toml",
              [] {
                std::ifstream file(source_folder() + "/vehicles/uquad.toml");
                std::ostringstream text;
                text << file.rdbuf();
                return text.str();
              }() +
                  "\n[battery]\ncapacity_A_h = 5\nfull_voltage_V = 12.6\nempty_voltage_V = 10.5\n"
                  "cutoff_voltage_V = 13\n")
          .string();
  EXPECT_THAT(run_program({"vehicle", "check", vehicle}).err,
              HasSubstr("cutoff_voltage_V in [battery] is 13, expected less than full_voltage_V, "
                        "12.6"));
}

// A height that is positive upwards, where the model expects one that is positive downwards: a large
// process noise makes the filter follow it.
TEST_F(LikelyMistakes, AChannelOfTheOppositeSignFailsATuning) {
  std::ifstream file(source_folder() + "/docs/examples/bobbing.csv");
  std::string line, flipped;
  std::getline(file, line);
  flipped = line + "\n";
  while (std::getline(file, line)) {
    const std::size_t value = line.rfind(',') + 1;
    const std::string height = line.substr(value);
    flipped += line.substr(0, value) +
               (height.empty()            ? ""
                : height.starts_with('-') ? height.substr(1)
                                          : "-" + height) +
               "\n";
  }
  const ProgramResult result =
      run_program({"tune", "kalman", "--model", "altitude", "--starts", "1", "--log",
                   folder_.write("flipped.csv", flipped).string(), "-o", path("tuned.toml")});
  EXPECT_EQ(result.status, 1);
  EXPECT_THAT(result.err, HasSubstr("so " + path("tuned.toml") + " is not written; --force"));
  EXPECT_THAT(result.err,
              HasSubstr("with the opposite sign of sonar or of az the log-likelihood is "
                        "larger by "));
  const ProgramResult right =
      run_program({"tune", "kalman", "--model", "altitude", "--starts", "1", "--log",
                   source_folder() + "/docs/examples/bobbing.csv"});
  EXPECT_EQ(right.status, 0) << right.err;
}

// Masses in kg and yaw rates in degrees per second on the axes of a schedule.
TEST_F(LikelyMistakes, UnitsOfTheAxesOfASchedule) {
  const auto lqr = [&](const std::string& grid) {
    return run_program({"lqr", "uquad", "--schedule", grid, "--R", "0.01", "-o", path("s.toml")});
  };
  EXPECT_THAT(lqr("mass=1.1:0.1:1.2").err,
              HasSubstr("note: mass is a ratio to that of the vehicle, and 1.1 to 1.2 does not "
                        "contain 1"));
  EXPECT_THAT(lqr("yaw_rate=0:45:45").err,
              HasSubstr("yaw_rate is in rad/s: 45 rad/s is 2578 deg/s"));
  EXPECT_THAT(lqr("mass=1.741").err, HasSubstr("and 1.741 to 1.741 does not contain 1"));
  const ProgramResult right = lqr("speed=0:1:1, mass=0.9:0.1:1.1, yaw_rate=0:1:1");
  EXPECT_EQ(right.status, 0) << right.err;
  EXPECT_THAT(right.err, Not(HasSubstr("ratio")));
  EXPECT_THAT(right.err, Not(HasSubstr("deg/s")));
  EXPECT_THAT(run_program({"export", path("s.toml"), "--to", "c", "-o", path("s")}).err,
              HasSubstr("note: the gains are continuous"));
}

}  // namespace
}  // namespace quadtune::testing
