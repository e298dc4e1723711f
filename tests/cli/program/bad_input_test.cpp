// SPDX-License-Identifier: Apache-2.0
/// The response to invalid input: one line, the documented exit status, no output file.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "run_program.hpp"
#include "source_folder.hpp"
#include "temporary_directory.hpp"

namespace quadtune {
namespace {

using ::testing::HasSubstr;
using testing::ProgramResult;
using testing::run_program;
using testing::TemporaryDirectory;

std::string read_source(const std::string& name) {
  std::ifstream file(testing::source_folder() + "/" + name);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

/// `text` with the first `from` replaced.
std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << "'" << from << "' is not in the file to be broken";
  return at == std::string::npos ? text : text.replace(at, from.size(), to);
}

/// One invalid input. "@" in an argument is replaced by the temporary directory.
struct Mistake {
  std::string name;
  std::vector<std::string> args;
  int status;
  std::vector<std::string> said;  ///< parts of the one line
  std::vector<std::pair<std::string, std::string>> files = {};
};

/// The name of a case in Google Test and CTest.
void PrintTo(const Mistake& mistake, std::ostream* out) { *out << mistake.name; }

std::string mambo_with(const std::string& from, const std::string& to) {
  return replaced(read_source("vehicles/mambo.toml"), from, to);
}

std::string hover_with(const std::string& from, const std::string& to) {
  return replaced(read_source("designs/uquad-hover.toml"), from, to);
}

Mistake vehicle_mistake(const std::string& name, const std::string& from, const std::string& to,
                        int status, const std::vector<std::string>& said) {
  return {name, {"vehicle", "check", "@/v.toml"}, status, said, {{"v.toml", mambo_with(from, to)}}};
}

Mistake design_mistake(const std::string& name, const std::string& from, const std::string& to,
                       int status, const std::vector<std::string>& said) {
  return {name,
          {"design", "@/d.toml", "-o", "@/out"},
          status,
          said,
          {{"d.toml", hover_with(from, to)}}};
}

/// lqr with matrix files, which are valid except those that the mistake replaces.
Mistake matrix_mistake(const std::string& name, int status, const std::vector<std::string>& said,
                       const std::vector<std::pair<std::string, std::string>>& bad,
                       const std::vector<std::string>& extra = {}) {
  std::vector<std::pair<std::string, std::string>> files = {
      {"A", "0 1\n0 0\n"}, {"B", "0\n1\n"}, {"Q", "1 0\n0 1\n"}, {"R", "1\n"}};
  for (const auto& [file, text] : bad)
    for (auto& [good, content] : files)
      if (good == file) content = text;
  std::vector<std::string> args = {"lqr", "--A", "@/A", "--B", "@/B", "--Q", "@/Q", "--R", "@/R"};
  args.insert(args.end(), extra.begin(), extra.end());
  return {name, args, status, said, files};
}

std::string huge_matrix() {
  std::string text;
  text.reserve(17u << 20);
  while (text.size() <= (16u << 20)) text += "1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16\n";
  return text;
}

std::vector<Mistake> file_mistakes() {
  return {
      {"MissingFile", {"vehicle", "check", "@/none.toml"}, 5, {"none.toml", "No such file"}},
      {"MissingMatrixFile",
       {"discretize", "--A", "@/none", "--B", "@/none", "--dt", "1"},
       5,
       {"none", "No such file"}},
      {"VehicleIsADirectory", {"vehicle", "check", "@"}, 5, {"directory"}},
      {"EmptyVehicle", {"vehicle", "check", "@/v.toml"}, 3, {"v.toml"}, {{"v.toml", ""}}},
      {"BinaryVehicle",
       {"vehicle", "check", "@/v.toml"},
       3,
       {"v.toml"},
       {{"v.toml", std::string("\x7f"
                               "ELF\0\1\2\3",
                               8)}}},
      matrix_mistake("EmptyMatrix", 3, {"A", "no numbers"}, {{"A", "# nothing\n"}}),
      {"OutputIsAFile",
       {"design", testing::source_folder() + "/designs/uquad-hover.toml", "-o", "@/taken"},
       5,
       {"taken", "irectory"},
       {{"taken", "a file\n"}}},
      {"VerifyWithoutExport", {"verify", "@"}, 5, {"manifest.json"}},
  };
}

std::vector<Mistake> vehicle_mistakes() {
  return {
      vehicle_mistake("UnknownKey", "mass_kg", "masss_kg", 3,
                      {"v.toml:", "masss_kg", "did you mean 'mass_kg'"}),
      vehicle_mistake("WrongUnit", "mass_kg", "mass_g", 3, {"v.toml:", "mass_g", "mass_kg"}),
      vehicle_mistake("MissingKey", "mass_kg = 0.063", "", 3, {"v.toml:", "mass_kg"}),
      vehicle_mistake("DuplicateKey", "mass_kg = 0.063", "mass_kg = 0.063\nmass_kg = 0.1", 3,
                      {"v.toml:", "mass_kg"}),
      vehicle_mistake("StringForNumber", "mass_kg = 0.063", "mass_kg = \"0.063\"", 3,
                      {"v.toml:", "mass_kg", "string"}),
      vehicle_mistake("NegativeMass", "mass_kg = 0.063", "mass_kg = -0.063", 3,
                      {"v.toml:", "mass", "-0.063"}),
      vehicle_mistake("NanMass", "mass_kg = 0.063", "mass_kg = nan", 3, {"v.toml:", "mass", "nan"}),
      vehicle_mistake("DecimalComma", "mass_kg = 0.063", "mass_kg = 0,063", 3, {"v.toml:"}),
      vehicle_mistake("InertiaNoBodyHas", "[5.82857e-5, 7.16914e-5, 1.0e-4]", "[1e-5, 1e-5, 9e-5]",
                      3, {"v.toml:", "inertia", "triangle"}),
      vehicle_mistake("ZeroRotors",
                      read_source("vehicles/mambo.toml")
                          .substr(read_source("vehicles/mambo.toml").find("# Arm of"),
                                  read_source("vehicles/mambo.toml").find("[motor]") -
                                      read_source("vehicles/mambo.toml").find("# Arm of")),
                      "", 3, {"v.toml", "rotor"}),
      {"CannotBalanceYaw",
       {"vehicle", "check", "@/v.toml"},
       3,
       {"v.toml", "yaw"},
       {{"v.toml",
         [] {
           std::string text = read_source("vehicles/mambo.toml");
           for (std::size_t at; (at = text.find("\"ccw\"")) != std::string::npos;)
             text.replace(at, 5, "\"cw\"");
           return text;
         }()}}},
      vehicle_mistake("CannotHover", "mass_kg = 0.063", "mass_kg = 6.3", 4, {"v.toml", "short"}),
  };
}

std::vector<Mistake> matrix_mistakes() {
  return {
      matrix_mistake("NonSquareA", 2, {"quadtune lqr: --A is 1x2, expected a square matrix"},
                     {{"A", "0 1\n"}}),
      matrix_mistake("MismatchedB", 2, {"--B is 3x1, expected 2 rows (A is 2x2)"},
                     {{"B", "0\n1\n2\n"}}),
      matrix_mistake("AsymmetricQ", 2, {"--Q is not symmetric", "0.5"}, {{"Q", "1 0.5\n0 1\n"}}),
      matrix_mistake("IndefiniteR", 2, {"--R has eigenvalue -1"}, {{"R", "-1\n"}}),
      matrix_mistake("IndefiniteRThatIsSampled", 2, {"--R has eigenvalue -1, expected --R >= 0"},
                     {{"R", "-1\n"}}, {"--sampled", "0.01"}),
      {"AsymmetricRThatIsSampled",
       {"lqr", "--A", "0", "--B", "1 1", "--Q", "1", "--R", "1 0; 5 1", "--sampled", "0.01"},
       2,
       {"--R is not symmetric"}},
      matrix_mistake("FlightOfMatrices", 2, {"--at applies to a vehicle only\n"}, {},
                     {"--at", "hover"}),
      matrix_mistake("IntegralOfMatrices", 2, {"--integral applies to a vehicle only; use --C"}, {},
                     {"--integral", "px"}),
      {"EmptyStandardInput",
       {"lqr", "--A", "-", "--B", "1", "--Q", "1", "--R", "1"},
       3,
       {"standard input: has no numbers, expected a row of numbers on each line"}},
      {"IndefiniteNoiseThatIsSampled",
       {"lqg", "--A", "0 1; 0 0", "--B", "0; 1", "--C", "1 0", "--Q", "1 0; 0 1", "--R", "1",
        "--noise-Q", "1 0; 0 1", "--noise-R", "-1", "--sampled", "0.01"},
       2,
       {"--noise-R has eigenvalue -1, expected none below 0 because it is a covariance"}},
      {"MeasurementsInAColumn",
       {"kalman", "--A", "0 1; 0 0", "--C", "1; 0", "--Q", "1 0; 0 1", "--R", "1", "--discrete"},
       2,
       {"--C is 2x1, expected 2 columns (A is 2x2)"}},
      {"CrossedNoiseThatIsSampled",
       {"lqg", "--A", "0 1; 0 0", "--B", "0; 1", "--C", "1 0", "--Q", "1 0; 0 1", "--R", "1",
        "--noise-Q", "1 0; 0 1", "--noise-R", "1", "--noise-N", "0.1; 0", "--sampled", "0.01"},
       2,
       {"--noise-N is not zero, expected zero for a sampled problem"}},
      matrix_mistake("ZeroR", 2, {"quadtune lqr: --R has eigenvalue 0, expected --R > 0"},
                     {{"R", "0\n"}}),
      {"ZeroWeightOfTheTextbooksPlant",
       {"lqr", "uquad", "--plant", "ideal", "--R", "0"},
       2,
       {"quadtune lqr: --R has eigenvalue 0, expected --R > 0"}},
      matrix_mistake("SampledTooSlowly", 2,
                     {"quadtune lqr: --sampled is 1000 s, expected a shorter period"},
                     {{"A", "1 1\n0 1\n"}}, {"--sampled", "1000"}),
      matrix_mistake("MismatchedR", 2, {"--R is 2x2", "1x1"}, {{"R", "1 0\n0 1\n"}}),
      matrix_mistake("NanInA", 3, {"A:1", "nan"}, {{"A", "0 nan\n0 0\n"}}),
      matrix_mistake("InfinityInQ", 3, {"Q:2", "inf"}, {{"Q", "1 0\n0 inf\n"}}),
      matrix_mistake("NumberTooLarge", 3, {"B:1", "1e999"}, {{"B", "1e999\n1\n"}}),
      matrix_mistake("RaggedMatrix", 3, {"A:2", "expected 2"}, {{"A", "0 1\n0 0 0\n"}}),
      matrix_mistake("DecimalCommaInMatrix", 3, {"A:1", "decimal"}, {{"A", "0,5 1\n0 0\n"}}),
      matrix_mistake("WordInMatrix", 3, {"A:1", "one"}, {{"A", "0 one\n0 0\n"}}),
      matrix_mistake("NegativeSampleTime", 2, {"--sampled is -0.01"}, {}, {"--sampled", "-0.01"}),
      matrix_mistake("ZeroSampleTime", 2, {"--sampled is 0"}, {}, {"--sampled", "0"}),
      matrix_mistake("CannotBeSteered", 4, {"not stabilizable", "cannot be controlled"},
                     {{"B", "1\n0\n"}}),
      matrix_mistake("NotSeen", 4, {"not observable through Q"}, {{"Q", "0 0\n0 0\n"}}),
  };
}

std::vector<Mistake> design_mistakes() {
  return {
      design_mistake("DesignSampleTimeOfSeconds", "dt_s = 0.01", "dt_s = 5", 3,
                     {"d.toml:", "dt_s in [lqr] is 5, expected 0.0001 or more and 1 or less"}),
      design_mistake("NegativeDesignSampleTime", "dt_s = 0.01", "dt_s = -0.01", 3,
                     {"d.toml:", "dt_s", "-0.01"}),
      design_mistake("UnknownState", "\"theta\"]", "\"thata\"]", 3, {"d.toml:", "thata", "theta"}),
      design_mistake("UnknownVehicle", "vehicle = \"uquad\"", "vehicle = \"uqad\"", 3,
                     {"d.toml:", "uqad", "uquad"}),
      design_mistake("UnknownConvention", "convention = \"uquad\"", "convention = \"enu\"", 3,
                     {"d.toml:", "enu", "ned"}),
  };
}

std::vector<Mistake> command_line_mistakes() {
  return {
      {"UnknownVerb",
       {"synthesise"},
       2,
       {"quadtune: no command 'synthesise'", "did you mean 'lqr'?"}},
      {"MisspelledVerb", {"lineariz", "uquad"}, 2, {"did you mean 'linearize'?"}},
      {"UnknownOption",
       {"linearize", "uquad", "--conventoin", "uquad"},
       2,
       {"--conventoin", "did you mean '--convention'?"}},
      {"SurplusArgument", {"linearize", "uquad", "mambo"}, 2, {"unexpected argument 'mambo'"}},
      {"MissingVehicle", {"linearize"}, 2, {"expected a built-in vehicle"}},
      {"UnknownBuiltIn", {"vehicle", "show", "manbo"}, 3, {"manbo", "mambo"}},
      {"WordForNumber",
       {"linearize", "uquad", "--yaw", "north"},
       2,
       {"quadtune linearize: --yaw: 'north' is not a finite number, expected"}},
      {"NumberWithItsUnit",
       {"linearize", "uquad", "--climb", "1m/s"},
       2,
       {"--climb: '1m/s' is not a finite number, expected a number in m/s such as 0.01"}},
      {"UnknownFirmware",
       {"import", "px5", "--defaults", "--vehicle", "uquad"},
       2,
       {"quadtune import: FIRMWARE: no firmware 'px5', expected px4"}},
      {"ControlPeriodTooLong",
       {"lqr", "uquad", "--dt", "5"},
       2,
       {"quadtune lqr: --dt is 5 s, expected a control period of 0.0001 to 1 s"}},
      {"UnboundedIntegralGain",
       {"pid", "--num", "1", "--den", "1,1", "--Ms-max", "1.4"},
       4,
       {"Ki of a PID is unbounded"}},
      {"UnboundedIntegralGainOfTwoLags",
       {"pid", "--num", "1", "--den", "1,2,1", "--Ms-max", "1.4"},
       4,
       {"Ki of a PID is unbounded"}},
      {"PeakBelowOne",
       {"pid", "--num", "1", "--den", "1,3,3,1", "--Ms-max", "0.4"},
       2,
       {"quadtune pid: --Ms-max is 0.4, expected more than 1"}},
      {"TooFewPoles",
       {"place", "--A", "@/A", "--B", "@/B", "--poles=-1"},
       2,
       {"quadtune place: --poles has 1 entry, expected 2 finite numbers, one per state"},
       {{"A", "0 1\n0 0\n"}, {"B", "0\n1\n"}}},
      {"HexNumber", {"linearize", "uquad", "--yaw", "0x10"}, 2, {"--yaw: '0x10' is not"}},
      {"HexInList", {"lqr", "uquad", "--R", "0x10"}, 2, {"--R: '0x10' is not"}},
      {"NumberWithABlank", {"linearize", "uquad", "--yaw", "1 "}, 2, {"--yaw: '1 ' is not"}},
      {"NanForNumber", {"linearize", "uquad", "--climb", "nan"}, 2, {"--climb: 'nan' is not"}},
      {"NumberBeyondADouble", {"linearize", "uquad", "--yaw", "1e999"}, 2, {"--yaw: '1e999'"}},
      {"NegativeThreads",
       {"linearize", "uquad", "--threads", "-1"},
       2,
       {"--threads: '-1' is invalid; expected an integer of at least 1"}},
      {"NoThreads", {"linearize", "uquad", "--threads", "0"}, 2, {"--threads: '0' is invalid"}},
      {"FractionalSeed", {"linearize", "uquad", "--seed", "1.5"}, 2, {"--seed: '1.5' is invalid"}},
      {"OptionTwice",
       {"linearize", "uquad", "--yaw", "0", "--yaw=1"},
       2,
       {"quadtune linearize: --yaw is given 2 times; expected once"}},
      {"OptionWithoutValue",
       {"linearize", "uquad", "--yaw"},
       2,
       {"quadtune linearize: --yaw requires a value"}},
      {"OptionForAValue",
       {"linearize", "uquad", "-o", "--quiet"},
       2,
       {"quadtune linearize: -o requires a value"}},
      {"FlagWithAValue",
       {"linearize", "uquad", "--quiet=maybe"},
       2,
       {"quadtune linearize: --quiet was given a value; expected --quiet alone"}},
      {"UnknownFlight", {"linearize", "uquad", "--at", "loop"}, 2, {"--at", "loop", "hover"}},
      {"UnknownStateInList",
       {"linearize", "uquad", "--states", "px,altitude"},
       2,
       {"--states: no state 'altitude'", "px py pz roll"}},
      {"StateTwiceInList",
       {"linearize", "uquad", "--states", "px,px"},
       2,
       {"--states: state 'px' is listed twice"}},
      {"UnknownIntegral",
       {"lqr", "uquad", "--integral", "pich"},
       2,
       {"--integral: unknown state 'pich'", "px py pz roll", "did you mean 'pitch'?"}},
      {"IntegralOfADroppedState",
       {"lqr", "uquad", "--states", "no-position", "--integral", "px"},
       2,
       {"--integral: unknown state 'px'; expected names from pz roll"}},
      {"IntegralTwice",
       {"lqr", "uquad", "--integral", "pz,pz"},
       2,
       {"--integral: state 'pz' is listed twice"}},
      {"WrongNumberOfWeights",
       {"lqr", "uquad", "--plant", "ideal", "--Q", "1,2,3"},
       2,
       {"--Q has 3 entries, expected 12"}},
      {"NegativeWeight", {"lqr", "uquad", "--Q", "-1"}, 2, {"--Q", "-1", "weights"}},
      {"TooFast",
       {"linearize", "mambo", "--at", "circle", "--speed", "50", "--radius", "1"},
       4,
       {"mambo"}},
      {"ZeroRadius",
       {"linearize", "mambo", "--at", "circle", "--speed", "1", "--radius", "0"},
       2,
       {"--radius"}},
      {"UnknownMethod",
       {"discretize", "--A", "@/A", "--B", "@/A", "--dt", "1", "--method", "tustn"},
       2,
       {"--method", "tustn", "tustin"},
       {{"A", "1\n"}}},
      {"NoLoop", {"margins"}, 2, {"a vehicle", "--num and --den", "--gains"}},
      {"TwoLoops",
       {"margins", "uquad", "--num", "1", "--den", "1,1"},
       2,
       {"expected one of these loops: --num and --den; "}},
      {"NoDenominator", {"margins", "--num", "1"}, 2, {"--den is missing"}},
      {"LeadingZero",
       {"margins", "--num", "1", "--den", "0,1,1"},
       2,
       {"--num, --den", "first coefficient of den is 0"}},
      {"ImproperFraction",
       {"margins", "--num", "1,2,3", "--den", "1,1"},
       2,
       {"--num has degree 2, den 1", "no more zeros than poles"}},
      {"BareGain", {"margins", "--num", "3", "--den", "2"}, 2, {"--den is a constant"}},
      {"CoefficientThatIsNoNumber", {"margins", "--num", "1", "--den", "1,x"}, 2, {"--den", "'x'"}},
      {"NegativeDelay",
       {"margins", "--num", "1", "--den", "1,1", "--delay", "-1"},
       2,
       {"--delay is -1 s", "0 or more"}},
      {"DelayBetweenSamples",
       {"margins", "--num", "1", "--den", "1,1", "--dt", "0.1", "--delay", "0.25"},
       2,
       {"--delay is 0.25 s", "whole number of samples of 0.1 s"}},
      {"NoGains", {"margins", "uquad"}, 2, {"--gains is missing"}},
      {"UnknownPlant",
       {"margins", "mambo", "--gains", "@/none", "--plant", "real"},
       2,
       {"--plant is 'real'", "flown or ideal"}},
      {"HeightOfNoVehicle",
       {"margins", "--num", "1", "--den", "1,1", "--height", "2"},
       2,
       {"--height requires a vehicle"}},
      {"HeightOfTheTextbooksPlant",
       {"margins", "mambo", "--gains", "@/none", "--plant", "ideal", "--height", "2"},
       2,
       {"--height applies to the flown loop"}},
      {"HeightOfZero",
       {"margins", "mambo", "--gains", "@/none", "--height", "0"},
       2,
       {"--height is 0", "positive"}},
      {"UnknownCut",
       {"margins", "--A", "@/A", "--B", "@/A", "--K", "@/A", "--cut", "outputs"},
       2,
       {"--cut is 'outputs'", "inputs or states"},
       {{"A", "1\n"}}},
      {"GainOfAnotherShape",
       {"margins", "--A", "@/A", "--B", "@/A", "--K", "@/K"},
       2,
       {"quadtune margins: --K is 1x2, expected 1x1"},
       {{"A", "1\n"}, {"K", "1 2\n"}}},
      {"PictureWithoutEnding",
       {"margins", "--num", "1", "--den", "1,1", "--plot", "@/out"},
       2,
       {"quadtune margins: --plot is '",
        "/out', expected a name that ends in .svg, .png, .csv or .json"}},
      {"PictureOfAnotherFormat",
       {"pid", "--num", "1", "--den", "1,1", "--rule", "simc", "--plot", "@/out.jpg"},
       2,
       {"quadtune pid: --plot is '", "/out.jpg'"}},
      // The name is validated before any work: the loop is invalid, too.
      {"PictureFormatComesFirst",
       {"margins", "--num", "1,0,0", "--den", "1,1", "--plot", "@/out.SVG"},
       2,
       {"--plot is '"}},
      {"PictureWithoutValue",
       {"margins", "--num", "1", "--den", "1,1", "--plot"},
       2,
       {"--plot requires a value"}},
      {"PictureBelowAFile",
       {"margins", "--num", "1", "--den", "1,1", "--plot", "@/taken/out.svg"},
       5,
       {"taken", "directory"},
       {{"taken", "a file\n"}}},
      {"PictureIsADirectory",
       {"margins", "--num", "1", "--den", "1,1", "--plot", "@/d.svg"},
       5,
       {"d.svg", "is a directory"},
       {{"d.svg/file", ""}}},
      {"PictureOfAWrongLoop",
       {"margins", "--num", "1,0,0", "--den", "1,1", "--plot", "@/out"},
       2,
       {"--plot"}},
      {"NoRequirement", {"pid", "--num", "1", "--den", "1,1"}, 2, {"--crossover", "--rule"}},
      {"NoPlant", {"pid"}, 2, {"quadtune pid: the plant is missing, expected a vehicle"}},
      {"NoSensor", {"calibrate"}, 2, {"the kind of sensor is missing, expected imu"}},
      {"NoFrame",
       {"link", "decode", "0e", "--firmware", "simulink"},
       2,
       {"quadtune link decode: frame: has 1 byte; expected at least"}},
      {"CrossoverAlone",
       {"pid", "--num", "1", "--den", "1,1", "--crossover", "1"},
       2,
       {"--crossover and --phase-margin belong together"}},
      {"ImpossiblePhaseMargin",
       {"pid", "--num", "1", "--den", "1,1", "--crossover", "1", "--phase-margin", "180"},
       2,
       {"--phase-margin is 180 deg", "less than 180"}},
      {"UnknownRule",
       {"pid", "--num", "1", "--den", "1,1", "--rule", "amico"},
       2,
       {"--rule is 'amico'", "did you mean 'amigo'"}},
      {"UnknownPidType",
       {"pid", "--num", "1", "--den", "1,1", "--rule", "simc", "--type", "pi"},
       2,
       {"--type is 'pi'", "P, PI, PD or PID"}},
      {"RuleWithoutLag",
       {"pid", "--num", "1", "--den", "1,0", "--rule", "amigo"},
       4,
       {"the rule requires a first-order model"}},
      {"TauForAnotherRule",
       {"pid", "--num", "1", "--den", "1,1", "--rule", "amigo", "--tau-c", "1"},
       2,
       {"--tau-c is only for the rules simc and lambda"}},
      {"CrossoverBeyondDelay",
       {"pid", "--num", "1", "--den", "1,1", "--delay", "1", "--type", "PI", "--crossover", "5",
        "--phase-margin", "60"},
       4,
       {"pid: ", "rad/s"}},
      {"UnknownLoop",
       {"pid", "mambo", "--bandwidth", "rolll=4"},
       2,
       {"--bandwidth", "no loop 'rolll'", "did you mean 'roll'"}},
      {"BandwidthWithoutNumber",
       {"pid", "mambo", "--bandwidth", "roll=fast"},
       2,
       {"--bandwidth has 'roll=fast'", "a list like roll=40,x=2"}},
      {"BandwidthAtNyquist",
       {"pid", "mambo", "--bandwidth", "roll=630"},
       2,
       {"--bandwidth of roll is 630 rad/s", "less than pi/dt = 628.319"}},
      {"BandwidthOutOfReach",
       {"pid", "mambo", "--bandwidth", "roll=300"},
       4,
       {"roll: crossover out of reach", "less than 115.9"}},
      {"NegativeSensorDelay",
       {"pid", "mambo", "--sensor-delay", "-0.01"},
       2,
       {"--sensor-delay has '-0.01'", "0 or more"}},
      {"SensorDelayTooLong",
       {"pid", "mambo", "--sensor-delay", "roll=1"},
       2,
       {"--sensor-delay of roll is 1 s", "at most 40 samples, 0.2 s"}},
      {"BandwidthTwice",
       {"pid", "mambo", "--bandwidth", "roll=4,roll=5"},
       2,
       {"--bandwidth has loop 'roll' twice"}},
      {"IntegralOfALoopTwice",
       {"pid", "mambo", "--integral", "x,x"},
       2,
       {"--integral has loop 'x' twice"}},
      {"NegativeMotorLag", {"pid", "mambo", "--motor-lag", "-1"}, 2, {"--motor-lag is -1 s"}},
      {"LongMotorLag",
       {"pid", "mambo", "--motor-lag", "1.5"},
       2,
       {"--motor-lag is 1.5 s, expected 0 to 1 s"}},
      {"MsBelowOne", {"pid", "mambo", "--Ms-max", "0.9"}, 2, {"--Ms-max is 0.9", "more than 1"}},
      {"UnknownIntegrator",
       {"pid", "mambo", "--integrator", "tusin"},
       2,
       {"--integrator", "did you mean 'tustin'"}},
      {"PeriodOfACascade", {"pid", "mambo", "--dt", "0"}, 2, {"--dt is 0"}},
      {"VehicleAndTransferFunction",
       {"pid", "mambo", "--num", "1", "--den", "1,1"},
       2,
       {"--num belongs to a transfer function"}},
      {"BandwidthOfATransferFunction",
       {"pid", "--num", "1", "--den", "1,1", "--bandwidth", "3"},
       2,
       {"--bandwidth belongs to a vehicle"}},
      {"CompareWithoutVehicle",
       {"discretize", "--compare", "--dt", "0.01"},
       2,
       {"--compare requires a vehicle"}},
      {"CompareOneMethod",
       {"discretize", "mambo", "--compare", "--dt", "0.01", "--method", "zoh"},
       2,
       {"--method cannot be combined with --compare"}},
      {"VehicleWithoutCompare",
       {"discretize", "mambo", "--dt", "0.01"},
       2,
       {"V requires --compare"}},
      {"PlotWithoutCompare",
       {"discretize", "--num", "1", "--den", "1,1", "--dt", "0.01", "--plot", "@/a.svg"},
       2,
       {"--plot requires --compare"}},
      {"ComparePeriod", {"discretize", "mambo", "--compare", "--dt", "-1"}, 2, {"--dt is -1"}},
      {"ComparePlant",
       {"discretize", "mambo", "--compare", "--dt", "0.01", "--plant", "real"},
       2,
       {"--plant is 'real'", "flown or ideal"}},
      {"PlantWithoutCompare",
       {"discretize", "--num", "1", "--den", "1,1", "--dt", "0.01", "--plant", "ideal"},
       2,
       {"--plant requires --compare"}},
      {"CompareUnknownVehicle",
       {"discretize", "mamba", "--compare", "--dt", "0.01"},
       3,
       {"no vehicle 'mamba'", "did you mean 'mambo'"}},
      vehicle_mistake("PublishedLoopMissing",
                      "yaw = { Kp = 0.004, Kd = -0.0012 }               # to tau_z\n", "", 3,
                      {"v.toml:", "yaw"}),
      vehicle_mistake("PublishedLoopMisspelt", "altitude = { Kp = 0.8", "altitud = { Kp = 0.8", 3,
                      {"v.toml:", "altitud", "altitude"}),
      vehicle_mistake("PublishedGainNotANumber", "yaw = { Kp = 0.004", "yaw = { Kp = nan", 3,
                      {"v.toml:", "Kp", "nan"}),
      {"TustinPole",
       {"discretize", "--A", "@/A", "--B", "@/B", "--dt", "1", "--method", "tustin"},
       2,
       {"--A has a pole at 2 1/s"},
       {{"A", "2\n"}, {"B", "1\n"}}},
      {"StandardInputTwice",
       {"lqr", "--A", "-", "--B", "-"},
       2,
       {"quadtune lqr: --A and --B are both '-', expected standard input for one"}},
      {"VehicleAndMatrices", {"lqr", "uquad", "--A", "@/A"}, 2, {"one or the other"}},
  };
}

/// discretize with valid matrix files A (2x2), B, C (2x2) and one sample period.
Mistake sampling_mistake(const std::string& name, int status, const std::vector<std::string>& said,
                         const std::vector<std::string>& extra,
                         const std::string& A = "0 1\n0 0\n") {
  std::vector<std::string> args = {"discretize", "--A", "@/A", "--B", "@/B", "--dt", "0.1"};
  args.insert(args.end(), extra.begin(), extra.end());
  return {name, args, status, said, {{"A", A}, {"B", "0\n1\n"}, {"D", "0\n1\n"}}};
}

/// discretize of a transfer function.
Mistake fraction_mistake(const std::string& name, int status, const std::vector<std::string>& said,
                         const std::string& num, const std::string& den,
                         const std::vector<std::string>& extra = {}) {
  std::vector<std::string> args = {"discretize", "--num", num, "--den", den, "--dt", "0.1"};
  args.insert(args.end(), extra.begin(), extra.end());
  return {name, args, status, said};
}

std::vector<Mistake> sampling_mistakes() {
  return {
      sampling_mistake("PrewarpAboveNyquist", 2,
                       {"--prewarp is 32 rad/s", "less than 31.4159 rad/s (pi/dt)"},
                       {"--method", "tustin", "--prewarp", "32"}),
      sampling_mistake("PrewarpAtZero", 2, {"--prewarp is 0 rad/s, expected more than 0"},
                       {"--method", "tustin", "--prewarp", "0"}),
      sampling_mistake("PrewarpOfAHold", 2,
                       {"--prewarp does not apply to --method zoh, expected tustin"},
                       {"--prewarp", "3"}),
      sampling_mistake("PrewarpedPole", 2, {"--A has a pole at 18.3049 1/s", "w/tan(w dt/2)"},
                       {"--method", "tustin", "--prewarp", "10"}, "18.304877217124517 0\n0 -1\n"),
      sampling_mistake("BackwardEulerPole", 2, {"--A has a pole at 10 1/s", "1/dt"},
                       {"--method", "backward-euler"}, "10 0\n0 -1\n"),
      sampling_mistake("MatchedOfManyChannels", 2,
                       {"discretize: the plant has 1 input and 2 outputs, expected one of each"},
                       {"--method", "matched"}),
      sampling_mistake("ImpulseOfAFeedthrough", 2, {"--D has 1 at (2,1), expected 0"},
                       {"--method", "impulse", "--D", "@/D"}),
      sampling_mistake(
          "FractionalDelayOfTustin", 2,
          {"the delay of input 1 is 0.05 s", "only zoh is exact for fractions of a sample"},
          {"--method", "tustin", "--input-delay", "0.05"}),
      sampling_mistake("NegativeDelay", 2, {"--output-delay has -0.1 s, expected 0 or more"},
                       {"--output-delay", "0,-0.1"}),
      sampling_mistake("DelaysForOtherChannels", 2,
                       {"--output-delay has 3 entries, expected 2 or one for all outputs"},
                       {"--output-delay", "0,0,0"}),
      sampling_mistake("DelayOfAWeek", 2, {"samples, expected at most 2000 because"},
                       {"--input-delay", "604800"}),
      sampling_mistake("DelayOfMatrices", 2, {"--delay requires --num and --den"},
                       {"--delay", "0.1"}),
      sampling_mistake("InverseWithDelays", 2, {"--input-delay cannot be combined with --inverse"},
                       {"--inverse", "--input-delay", "0.1"}),
      sampling_mistake("InverseOfAnotherMethod", 2,
                       {"--inverse cannot be combined with --method foh"},
                       {"--inverse", "--method", "foh"}),
      sampling_mistake("InverseOfANegativePole", 2,
                       {"--A has a pole at -0.5, expected none on the negative real axis"},
                       {"--inverse"}, "-0.5 1\n0 0.5\n"),
      sampling_mistake("InverseOfAPoleAtZero", 2, {"--A has a pole at 0, expected none"},
                       {"--inverse"}, "0 1\n0 0.5\n"),
      sampling_mistake("InverseOfAPoleAtMinusOne", 2, {"--A has a pole at -1, expected none"},
                       {"--inverse", "--method", "tustin"}, "-1 1\n0 0.5\n"),
      sampling_mistake("MatricesAndFraction", 2, {"--A cannot be combined with --num and --den"},
                       {"--num", "1", "--den", "1,1"}),
      fraction_mistake("ImproperFraction", 2,
                       {"--num has degree 2, den 1, expected no more zeros than poles"}, "1,0,0",
                       "1,1"),
      fraction_mistake("LeadingZeroOfDen", 2, {"the first coefficient of den is 0"}, "1", "0,1,1"),
      fraction_mistake("WordInNum", 2, {"--num: 'one' is not a finite number"}, "one", "1,1"),
      fraction_mistake("FractionTustinPole", 2, {"--den has a pole at 20 1/s", "2/dt"}, "1",
                       "1,-20", {"--method", "tustin"}),
      fraction_mistake("NegativeDelayOfAFraction", 2, {"--delay is -1 s, expected 0 or more"}, "1",
                       "1,1", {"--delay", "-1"}),
      fraction_mistake("FractionalDelayMatched", 2,
                       {"discretize: the delay is 0.05 s, expected a whole number of samples"}, "1",
                       "1,1", {"--delay", "0.05", "--method", "matched"}),
      fraction_mistake("FractionalDelayInverse", 2,
                       {"--delay is 0.05 s, expected a whole number of samples of 0.1 s"}, "1",
                       "1,-0.5", {"--delay", "0.05", "--inverse"}),
      {"NumWithoutDen",
       {"discretize", "--num", "1", "--dt", "0.1"},
       2,
       {"--den is missing, expected coefficients"}},
      {"NegativePeriod",
       {"discretize", "--num", "1", "--den", "1,1", "--dt", "-0.1"},
       2,
       {"--dt is -0.1, expected a positive number of seconds"}},
      {"MethodNearlyKnown",
       {"discretize", "--num", "1", "--den", "1,1", "--dt", "0.1", "--method", "backwards-euler"},
       2,
       {"--method", "backwards-euler", "did you mean 'backward-euler'?"}},
  };
}

/// lqr of a vehicle over a grid.
Mistake schedule_mistake(const std::string& name, const std::string& grid,
                         const std::vector<std::string>& said,
                         const std::vector<std::string>& extra = {}, int status = 2) {
  std::vector<std::string> args = {"lqr", "uquad", "--schedule", grid};
  args.insert(args.end(), extra.begin(), extra.end());
  return {name, args, status, said};
}

std::vector<Mistake> schedule_mistakes() {
  return {
      schedule_mistake("UnknownAxis", "sped=0:1:2",
                       {"--schedule: no axis 'sped', expected one of", "did you mean 'speed'?"}),
      schedule_mistake("AxisWithoutValues", "speed",
                       {"--schedule: 'speed' is malformed; expected axes"}),
      schedule_mistake("EmptyAxis", "speed=1,,mass=1", {"--schedule: an axis is empty"}),
      schedule_mistake("BlankGrid", " ", {"--schedule: an axis is empty"}),
      schedule_mistake("AxisTwice", "speed=1, speed=2", {"axis speed is given twice"}),
      schedule_mistake("StepOfZero", "speed=0:0:2",
                       {"axis speed has step 0, expected more than 0"}),
      schedule_mistake("StepBackwards", "speed=2:-1:0", {"axis speed has step -1"}),
      schedule_mistake("RangeBackwards", "climb=2:1:0", {"axis climb goes from 2 to 0"}),
      schedule_mistake("StepThatMissesTheLast", "speed=0:0.3:1",
                       {"axis speed goes from 0 to 1 in 3.33333 steps of 0.3", "a whole number"}),
      schedule_mistake("NanInGrid", "speed=0:nan:1",
                       {"'nan' in axis speed is not a finite number"}),
      schedule_mistake("InfiniteGrid", "speed=0:1:inf", {"'inf' in axis speed"}),
      schedule_mistake("WordInGrid", "speed=0:x:1", {"'x' in axis speed"}),
      schedule_mistake("TwoNumbers", "speed=0:1",
                       {"axis speed has 2 numbers, expected first:step"}),
      schedule_mistake("FourNumbers", "speed=0:1:2:3", {"axis speed has 4 numbers"}),
      schedule_mistake("NegativeSpeed", "speed=-1:1:1", {"speed has -1 m/s, expected 0 or more"}),
      schedule_mistake("NoMass", "mass=0:0.5:1", {"mass has 0, expected more than 0"}),
      schedule_mistake("TooManySteps", "speed=0:1e-9:1", {"1e+09 points, expected at most"}),
      schedule_mistake("TooManyPoints", "speed=0:0.01:10, climb=0:0.01:10",
                       {"has more than 100000 points with axis climb"}),
      schedule_mistake("ScheduleOfAFlight", "speed=1",
                       {"--at cannot be combined with --schedule", "as axes"}, {"--at", "line"}),
      schedule_mistake("ScheduleBadWeights", "speed=1", {"--Q has 3 entries, expected 12"},
                       {"--Q", "1,2,3"}),
      schedule_mistake("ScheduleWithoutPeriod", "speed=1", {"--dt is missing"},
                       {"--method", "discrete"}),
      schedule_mistake("ScheduleOfAnUnknownState", "speed=1", {"--states", "pich"},
                       {"--states", "pich"}),
      schedule_mistake("ScheduleBeyondTheThrust", "speed=8, yaw_rate=2",
                       {"no point of the schedule has a gain", "needs a tilt of"}, {}, 4),
      schedule_mistake("ScheduleSeenByNoWeight", "speed=1",
                       {"no gain", "not detectable", "not observable through Q"}, {"--Q", "0"}, 4),
      schedule_mistake("ScheduleFileOfNoFormat", "speed=1",
                       {"-o: cannot determine the format from 'k.txt'", ".toml or .json"},
                       {"-o", "@/k.txt"}),
      {"ScheduleOfMatrices",
       {"lqr", "--A", "@/A", "--B", "@/A", "--schedule", "speed=1"},
       2,
       {"--schedule applies to a vehicle only"},
       {{"A", "1\n"}}},
      {"SpinWithoutRate",
       {"linearize", "uquad", "--at", "spin"},
       2,
       {"--at spin requires --yaw-rate"}},
      {"CircleWithoutSpeed",
       {"linearize", "uquad", "--at", "circle", "--radius", "2"},
       2,
       {"--at circle requires --speed"}},
  };
}

std::vector<Mistake> flight_mistakes() {
  const auto fly = [](const std::string& name, std::vector<std::string> extra,
                      const std::vector<std::string>& said, int status = 2) {
    extra.insert(extra.begin(), {"fly", "mambo"});
    return Mistake{name, extra, status, said};
  };
  const auto mission = [](const std::string& name, const std::string& text,
                          const std::vector<std::string>& said) {
    return Mistake{name, {"fly", "mambo", "--mission", "@/m.toml"}, 3, said, {{"m.toml", text}}};
  };
  return {
      {"FlyNothing", {"fly"}, 2, {"expected a vehicle"}},
      {"FlyUnknownVehicle", {"fly", "mamba"}, 3, {"mamba", "did you mean 'mambo'"}},
      fly("UnknownMission", {"--mission", "hoover"}, {"hoover", "did you mean 'hover'"}, 3),
      fly("UnknownController", {"--controller", "pif"},
          {"--controller", "'pif'", "cascaded-pid (or pid)"}),
      fly("UnknownEstimator", {"--estimator", "manbo"}, {"--estimator", "did you mean 'mambo'"}),
      fly("EstimatorWithoutItsSensors", {"--estimator", "uquad"}, {"--estimator", "has no"}),
      fly("UnknownFlow", {"--flow", "half"}, {"--flow", "full, simplified, off"}),
      fly("NoFlowRate", {"--flow-rate", "0"}, {"--flow-rate", "'0'", "greater than 0"}),
      fly("NoStep", {"--step", "0"}, {"--step", "'0'", "greater than 0"}),
      fly("StepTooSmall", {"--step", "1e-12"}, {"--step", "a millionth"}),
      fly("DurationTooLong", {"--duration", "1e9"}, {"--duration", "at most"}),
      fly("RecordTooLong", {"--duration", "20000", "--log", "@/f.csv"},
          {"--duration", "at most 10000 s", "memory"}),
      fly("FlowRateTooHigh", {"--flow-rate", "10001"}, {"--flow-rate", "at most 10000 Hz"}),
      fly("FlowRateOfNoFlow", {"--flow", "off", "--flow-rate", "30"}, {"--flow-rate", "off"}),
      {"FlowRateWithoutSensor",
       {"fly", "uquad", "--flow-rate", "30"},
       2,
       {"--flow-rate", "no optical flow sensor"}},
      {"SimplifiedFlowWithoutSensor",
       {"fly", "uquad", "--flow", "simplified"},
       2,
       {"--flow", "no optical flow sensor"}},
      fly("EveryEstimatorIsNamed", {"--estimator", "kalman"}, {"mambo-original, mambo-raw"}),
      fly("WindTwice", {"--wind", "north=1,north=2"}, {"--wind", "'north' is given twice"}),
      fly("OneFileForTwo", {"--log", "@/f.csv", "-o", "@/f.csv"}, {"--log", "-o", "two files"}),
      {"DesignOfAnotherVehicle",
       {"fly", "uquad", "--gains", testing::source_folder() + "/designs/mambo-hover.toml"},
       3,
       {"mambo-hover.toml", "for the vehicle 'mambo'", "'uquad'"}},
      {"CascadeOfADesignWithoutOne",
       {"fly", "uquad", "--controller", "cascaded-pid", "--gains",
        testing::source_folder() + "/designs/uquad-hover.toml"},
       3,
       {"uquad-hover.toml", "has a state feedback, but no PID cascade"}},
      {"CompareFlowWithoutSensor", {"compare", "flow", "uquad"}, 2, {"no optical flow sensor"}},
      {"CompareIntegratorsOfAStateFeedback",
       {"compare", "integrators", "mambo", "--controller", "lqr", "--duration", "2"},
       2,
       {"compare: comparison 'integrators': integrator does not apply to a state feedback"}},
      {"CompareFlowOfTooManyFrames",
       {"compare", "flow", "mambo", "--flow-rate", "1e9"},
       2,
       {"compare: --flow-rate is 1e+09, expected at most 10000 Hz"}},
      {"CompareFlowWithoutSensorButTruth",
       {"compare", "flow", "uquad", "--estimator", "truth"},
       2,
       {"flow: 'uquad' has no optical flow sensor, expected a vehicle with one"}},
      {"CompareFilterWithoutSensor",
       {"compare", "filter", "uquad"},
       2,
       {"filter: 'uquad' has no optical flow sensor, expected a vehicle with one"}},
      fly("NegativeFlowRate", {"--flow-rate", "-60"}, {"--flow-rate", "-60", "greater than 0"}),
      fly("UnknownSensors", {"--sensors", "reel"}, {"--sensors", "did you mean 'real'"}),
      fly("StrongWind", {"--wind", "north=80,east=80"},
          {"--wind: the wind (north, east, down) has a speed of 113.137 m/s, expected at most "
           "100"}),
      fly("StrongGust", {"--wind", "gust_east=200"}, {"--wind: the gust (", "200 m/s"}),
      fly("UnknownWind", {"--wind", "stormy"}, {"--wind", "stormy", "calm, light"}),
      fly("WindWithoutNumber", {"--wind", "north=strong"}, {"--wind", "north", "'strong'"}),
      fly("WindOfNoLength", {"--wind", "gust_east=1,gust_length=0"}, {"--wind", "gust_length"}),
      fly("UnknownSolver", {"--solver", "ode45"}, {"--solver", "ode45", "bogacki-shampine-3"}),
      fly("UnknownIntegrator", {"--integrator", "eular"}, {"--integrator", "did you mean 'euler'"}),
      fly("IntegratorOfAStateFeedback",
          {"--controller", "state-feedback", "--integrator", "tustin"},
          {"--integrator", "cascaded PID"}),
      fly("DurationOfNothing", {"--duration", "-1"}, {"--duration", "-1", "greater than 0"}),
      fly("LogOfAnotherKind", {"--log", "@/f.xlsx"}, {"--log", ".csv", ".mat"}),
      fly("ReportOfAnotherKind", {"--report", "@/f.pdf"}, {"--report", ".html"}),
      fly("MissingGains", {"--gains", "@/none.json"}, {"none.json"}, 5),
      {"PublishedGainsOfNobody",
       {"fly", "uquad", "--gains", "published"},
       2,
       {"--gains", "uquad", "no published cascade"}},
      mission("MissionWithUnknownKey", "name = \"m\"\nduration = 3\n[hover]\nheight_m = 1\n",
              {"m.toml:2", "duration", "duration_s"}),
      mission("MissionWithATiltInDegrees",
              "name = \"m\"\nduration_s = 3\n[hover]\nheight_m = 1\n[limits]\ntilt_max_rad = 40\n",
              {"m.toml:6: tilt_max_rad is 40 rad, expected at most 3.14159 rad",
               "40 degrees are 0.698"}),
      mission("MissionWithoutADeed", "name = \"m\"\nduration_s = 3\n", {"m.toml"}),
      {"CompareNothing", {"compare"}, 2, {"integrators, flow, filter or gains"}},
      {"CompareFlowOfFlow", {"compare", "flow", "mambo", "--flow", "full"}, 2, {"--flow", "flow"}},
      {"CompareFilterOfEstimator",
       {"compare", "filter", "mambo", "--estimator", "truth"},
       2,
       {"--estimator", "filter"}},
      {"CompareGainsOfGains",
       {"compare", "gains", "mambo", "designed", "published", "--gains", "designed"},
       2,
       {"--gains", "follow the vehicle"}},
      {"CompareUnknown", {"compare", "flows", "mambo"}, 2, {"flows", "did you mean 'flow'"}},
      {"CompareGainsOfOne", {"compare", "gains", "mambo", "designed"}, 2, {"expected two"}},
      {"CompareTooMuch", {"compare", "flow", "mambo", "designed"}, 2, {"designed", "vehicle"}},
      design_mistake("MissionOfADesignUnknown", "name = \"hover\"\nsensors",
                     "name = \"hovr\"\nsensors", 3, {"hovr", "did you mean 'hover'"}),
      design_mistake("MissionOfADesignWithBadWord", "sensors = \"ideal\"", "sensors = \"perfect\"",
                     3, {"d.toml:", "sensors", "perfect"}),
      design_mistake("MissionOfALawThatIsNotThere", "sensors = \"ideal\"",
                     "controller = \"cascaded-pid\"", 3, {"d.toml:", "no [cascade]"}),
  };
}

class BadInput : public ::testing::TestWithParam<Mistake> {};

/// `where` of the JSON error of a command that ends with `status`.
std::string where_of(std::vector<std::string> args, int status = 2) {
  args.push_back("--json");
  const ProgramResult result = run_program(args);
  EXPECT_EQ(result.status, status) << result.err;
  return nlohmann::json::parse(result.out)["error"]["where"];
}

TEST(JsonError, NamesTheOptionOrFileConcerned) {
  EXPECT_EQ(where_of({"lqr", "uquad", "--method", "discrete"}), "--dt");
  EXPECT_EQ(where_of({"lqr", "uquad", "--integral", "altitude"}), "--integral");
  EXPECT_EQ(where_of({"lqr", "uquad", "--Q", "1,2"}), "--Q");
  EXPECT_EQ(where_of({"linearize", "uquad", "--conventoin", "uquad"}), "--conventoin");
  EXPECT_EQ(where_of({"linearize"}), "V");
  EXPECT_EQ(where_of({"linearize", "uquad", "--at", "line", "--speed", "-1"}), "--at line");
  EXPECT_EQ(where_of({"diff", "a"}), "B");
  EXPECT_EQ(where_of({"export", "a", "--to", "json"}), "-o");
  EXPECT_EQ(where_of({"synthesise"}), "synthesise");
}

TEST(JsonError, NamesWhatHasNoSolution) {
  const TemporaryDirectory folder;
  const std::string A = folder.write("A", "0 1\n0 0\n").string();
  const std::string B = folder.write("B", "1\n0\n").string();
  const std::string one = folder.write("one", "1 0\n0 1\n").string();
  const std::string none = folder.write("none", "0 0\n0 0\n").string();
  const std::string R = folder.write("R", "1\n").string();
  const std::string C = folder.write("C", "0 1\n").string();
  const std::string design =
      folder.write("d.toml", hover_with("Q_integral = [1,", "Q_integral = [0,")).string();
  const std::string vehicle =
      folder.write("v.toml", mambo_with("mass_kg = 0.063", "mass_kg = 6.3")).string();
  EXPECT_EQ(where_of({"lqr", "--A", A, "--B", B, "--Q", one, "--R", R}, 4), "--A");
  EXPECT_EQ(where_of({"lqr", "--A", A, "--B", one, "--Q", none, "--R", one}, 4), "--Q");
  EXPECT_EQ(where_of({"lqr", "uquad", "--Q", "0"}, 4), "--Q");
  EXPECT_EQ(where_of({"kalman", "--A", A, "--C", C, "--Q", one, "--R", R, "--continuous"}, 4),
            "--A");
  EXPECT_EQ(where_of({"linearize", "mambo", "--at", "circle", "--speed", "50", "--radius", "1"}, 4),
            "mambo");
  EXPECT_EQ(where_of({"vehicle", "check", vehicle}, 4), vehicle);
  EXPECT_EQ(where_of({"design", design}, 4), design);
}

void expect_one_line_and_status(const Mistake& mistake) {
  const TemporaryDirectory folder;
  for (const auto& [name, text] : mistake.files) folder.write(name, text);
  std::vector<std::string> args = mistake.args;
  for (std::string& arg : args)
    if (!arg.empty() && arg[0] == '@') arg.replace(0, 1, folder.path().string());

  const ProgramResult text = run_program(args);
  EXPECT_EQ(text.status, mistake.status) << text.err;
  EXPECT_EQ(std::count(text.err.begin(), text.err.end(), '\n'), 1) << text.err;
  for (const std::string& part : mistake.said) EXPECT_THAT(text.err, HasSubstr(part));
  EXPECT_EQ(text.out, "");
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "out"));

  args.push_back("--json");
  const ProgramResult json = run_program(args);
  EXPECT_EQ(json.status, mistake.status);
  const nlohmann::json error = nlohmann::json::parse(json.out).at("error");
  EXPECT_EQ(error.at("code"), mistake.status);
  EXPECT_EQ(error.at("message").get<std::string>() + "\n", text.err);
  EXPECT_TRUE(error.contains("where"));
}

TEST_P(BadInput, GetsOneLineAndTheDocumentedStatus) { expect_one_line_and_status(GetParam()); }

// Not among the cases of BadInput, which are created at every start of the test program.
TEST(HugeInput, GetsOneLineAndTheDocumentedStatus) {
  expect_one_line_and_status({"HugeVehicle",
                              {"vehicle", "check", "@/v.toml"},
                              3,
                              {"v.toml", "1048576"},
                              {{"v.toml", std::string(2u << 20, '#')}}});
  expect_one_line_and_status(
      matrix_mistake("HugeMatrix", 3, {"A", "16777216"}, {{"A", huge_matrix()}}));
}

std::string name_of(const ::testing::TestParamInfo<Mistake>& info) { return info.param.name; }

INSTANTIATE_TEST_SUITE_P(Files, BadInput, ::testing::ValuesIn(file_mistakes()), name_of);
INSTANTIATE_TEST_SUITE_P(Vehicles, BadInput, ::testing::ValuesIn(vehicle_mistakes()), name_of);
INSTANTIATE_TEST_SUITE_P(Matrices, BadInput, ::testing::ValuesIn(matrix_mistakes()), name_of);
INSTANTIATE_TEST_SUITE_P(Designs, BadInput, ::testing::ValuesIn(design_mistakes()), name_of);
INSTANTIATE_TEST_SUITE_P(Sampling, BadInput, ::testing::ValuesIn(sampling_mistakes()), name_of);
INSTANTIATE_TEST_SUITE_P(Flights, BadInput, ::testing::ValuesIn(flight_mistakes()), name_of);
INSTANTIATE_TEST_SUITE_P(Schedules, BadInput, ::testing::ValuesIn(schedule_mistakes()), name_of);
INSTANTIATE_TEST_SUITE_P(CommandLine, BadInput, ::testing::ValuesIn(command_line_mistakes()),
                         name_of);

}  // namespace
}  // namespace quadtune
