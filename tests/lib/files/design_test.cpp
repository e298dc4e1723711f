// SPDX-License-Identifier: Apache-2.0
#include "quadtune/design.hpp"

#include <gmock/gmock.h>

#include <array>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "matrix_near.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/text_matrix.hpp"
#include "shared_data.hpp"
#include "source_folder.hpp"

namespace quadtune {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using testing::MatrixNear;
using ::testing::StrEq;
using ::testing::ThrowsMessage;

const std::filesystem::path kDesigns = std::filesystem::path(testing::source_folder()) / "designs";

const std::vector<std::string> kHover = {
    "name = 'hover'",
    "vehicle = 'uquad'",
    "[trim]",
    "at = 'hover'",
    "[lqr]",
    "convention = 'uquad'",
    "inputs = 'rotor-speed'",
    "states = 'no-position'",
    "Q = [1, 1, 1, 1, 1, 1, 1, 1]",
    "R = [1, 1, 1, 1]",
    "integral = ['z', 'theta']",
    "Q_integral = [1, 1]",
    "method = 'discrete'",
    "dt_s = 0.01",
    "[[export]]",
    "to = 'uquad'",
};

std::string hover_with(std::size_t line, const std::string& replacement) {
  std::string text;
  for (std::size_t i = 0; i < kHover.size(); ++i)
    text += (i + 1 == line ? replacement : kHover[i]) + "\n";
  return text;
}

Design parse(const std::string& text) { return parse_design(text, "d.toml"); }

TEST(Design, ReadsTheUquadHover) {
  const Design design = load_design(kDesigns / "uquad-hover.toml");
  EXPECT_EQ(design.vehicle.name, "uquad");
  ASSERT_TRUE(design.lqr.has_value());
  const LqrDesign& lqr = *design.lqr;
  EXPECT_THAT(lqr.states, ElementsAre("x", "y", "z", "psi", "phi", "theta", "vqx", "vqy", "vqz",
                                      "wqx", "wqy", "wqz"));
  EXPECT_THAT(lqr.inputs, ElementsAre("w1", "w2", "w3", "w4"));
  EXPECT_THAT(lqr.integrals, ElementsAre("x", "y", "z", "theta"));
  EXPECT_EQ(lqr.Q.trace(), 3009);
  EXPECT_EQ(lqr.Q(5, 5), 1000);
  EXPECT_THAT(lqr.R, MatrixNear(0.01 * Eigen::MatrixXd::Identity(4, 4), 0));
  EXPECT_EQ(lqr.method, LqrMethod::discrete);
  EXPECT_EQ(lqr.dt, 0.01);
  ASSERT_EQ(design.exports.size(), 1u);
  EXPECT_EQ(design.exports[0].to, "uquad");
  EXPECT_FALSE(design.text.empty());
}

// The design quotes the published files to the digit, but for rounded zeros.
TEST(Design, QuotesThePublishedGains) {
  QUADTUNE_REQUIRE_DATA(path);
  const Design design = load_design(kDesigns / "uquad-hover.toml");
  ASSERT_TRUE(design.published.has_value());
  const auto read = [&](const char* name) {
    return read_text_matrix((path / "uquad" / name).string());
  };
  EXPECT_THAT(design.published->K, MatrixNear(read("K_prop_full.txt"), 1e-12));
  EXPECT_THAT(design.published->K_int, MatrixNear(read("K_int_full.txt"), 1e-12));
}

TEST(Design, ReadsTheMamboHover) {
  const Design design = load_design(kDesigns / "mambo-hover.toml");
  ASSERT_TRUE(design.lqr.has_value());
  EXPECT_EQ(design.lqr->states.front(), "phi");
  EXPECT_THAT(design.lqr->inputs, ElementsAre("T", "tau_x", "tau_y", "tau_z"));
  EXPECT_EQ(design.lqr->method, LqrMethod::sampled);
  EXPECT_TRUE(design.lqr->integrals.empty());
  ASSERT_EQ(design.kalman.size(), 2u);
  const KalmanDesign& altitude = design.kalman[0];
  EXPECT_EQ(altitude.name, "altitude");
  EXPECT_THAT(altitude.model.A, MatrixNear((Eigen::Matrix2d() << 1, 0.005, 0, 1).finished(), 0));
  EXPECT_THAT(altitude.model.B, MatrixNear(Eigen::Vector2d(0, 0.005), 0));
  EXPECT_THAT(altitude.G, MatrixNear(Eigen::Vector2d(0, 1), 0));
  EXPECT_EQ(altitude.Q(0, 0), 5e-4);
  EXPECT_EQ(altitude.R(0, 0), 0.1);
  EXPECT_EQ(altitude.N.size(), 1);
  EXPECT_EQ(design.kalman[1].R(1, 1), 5);
  ASSERT_TRUE(design.cascade.has_value());
  ASSERT_TRUE(design.cascade->specification.has_value());
  EXPECT_TRUE(design.cascade->gains.loops.empty());
  EXPECT_EQ(design.cascade->specification->dt, 0.005);
  EXPECT_EQ(design.cascade->specification->method, PidMethod::forward_euler);
  EXPECT_EQ(design.cascade->specification->requirements[0].Ms_max, 1.4);
  EXPECT_EQ(design.cascade->integrator_limit, 2);
}

const std::string kCascadeHead = "name = \"c\"\nvehicle = \"mambo\"\n[cascade]\ndt_s = 0.01\n";

TEST(Design, ReadsACascadeAsWritten) {
  const Design design = parse(kCascadeHead +
                              "x = { Kp = -0.24 }\ny = { Kp = 0.24, Kd = -0.1 }\n"
                              "pitch = { Kp = 0.013, Ki = 0.01, Kd = -0.002 }\n"
                              "roll = { Kp = 0.01, Ki = 0.01, Kd = -0.003 }\n"
                              "yaw = { Kp = 0.004, Kd = -0.0012 }\n"
                              "altitude = { Kp = 0.8, Ki = 0.1, Kd = -0.5 }\n");
  EXPECT_FALSE(design.cascade->specification.has_value());
  EXPECT_EQ(design.cascade->method, PidMethod::forward_euler);
  ASSERT_EQ(design.cascade->gains.loops.size(), kCascadeAxes);
  const PidLoop& pitch = design.cascade->gains.loops[2];
  EXPECT_EQ(pitch.output, "tau_y");
  EXPECT_EQ(pitch.Kp, 0.013);
  EXPECT_EQ(pitch.Ki, 0.01);
  EXPECT_EQ(pitch.Kd, -0.002);
  // Gains that are not given are 0.
  const PidLoop& x = design.cascade->gains.loops[0];
  EXPECT_EQ(x.Kp, -0.24);
  EXPECT_EQ(x.Ki, 0);
  EXPECT_EQ(x.Kd, 0);
  EXPECT_EQ(x.rate_lead, 0);
  EXPECT_EQ(x.rate_filter, 0);
}

// What is not said is as `quadtune pid V` has it: there is nothing to specify.
TEST(Design, ReadsACascadeOfWhichNothingIsAsked) {
  const CascadeDesign cascade = *parse(kCascadeHead + "[cascade.design]\n").cascade;
  EXPECT_FALSE(cascade.specification.has_value());
  EXPECT_TRUE(cascade.gains.loops.empty());
  EXPECT_EQ(cascade.gains.dt, 0.01);
  EXPECT_TRUE(cascade.velocity_feed_forward);
  EXPECT_TRUE(cascade.conditional_integration);
}

TEST(Design, ReadsWhatIsAskedOfACascade) {
  const Design design =
      parse(kCascadeHead +
            "[cascade.design]\nintegrator = \"tustin\"\nmotor_lag_s = 0.02\n"
            "sensor_delay_s = { roll = 0.005, x = 0.02 }\nbandwidth_rad_per_s = { roll = 40 }\n"
            "Ms_max = 1.6\ntracking_max = 1.2\nintegral = [\"roll\", \"altitude\"]\n"
            "published = false\n");
  const CascadeSpecification& asked = *design.cascade->specification;
  EXPECT_EQ(design.cascade->method, PidMethod::tustin);
  EXPECT_EQ(asked.dt, 0.01);
  EXPECT_EQ(asked.method, PidMethod::tustin);
  EXPECT_EQ(asked.lag, 0.02);
  EXPECT_EQ(asked.delay[index_of(CascadeAxis::roll)], 0.005);
  EXPECT_EQ(asked.delay[index_of(CascadeAxis::x)], 0.02);
  EXPECT_EQ(asked.delay[index_of(CascadeAxis::yaw)], 0);
  EXPECT_EQ(asked.requirements[index_of(CascadeAxis::roll)].bandwidth, 40);
  EXPECT_FALSE(asked.requirements[index_of(CascadeAxis::pitch)].bandwidth.has_value());
  EXPECT_TRUE(asked.requirements[index_of(CascadeAxis::roll)].integral);
  EXPECT_FALSE(asked.requirements[index_of(CascadeAxis::yaw)].integral);
  EXPECT_EQ(asked.requirements[3].Ms_max, 1.6);
  EXPECT_EQ(asked.requirements[3].tracking_max, 1.2);
  EXPECT_FALSE(asked.use_published);
  EXPECT_FALSE(design.cascade->rate_lead.has_value());
}

TEST(Design, KeepsTheFlownPlantWithALead) {
  const Design design = parse(kCascadeHead + "[cascade.design]\nrate_lead_s = 0.02\n");
  EXPECT_EQ(design.cascade->rate_lead, 0.02);
  EXPECT_FALSE(design.cascade->specification.has_value());
}

TEST(Design, RefusesACascadeThatIsAskedWrongly) {
  const auto said = [&](const std::string& text) -> std::string {
    try {
      (void)parse(kCascadeHead + text);
    } catch (const InvalidInput& error) {
      return error.what();
    }
    return "nothing";
  };
  EXPECT_THAT(said("x = { Kp = 1 }\n[cascade.design]\n"),
              HasSubstr("has gains of x in addition to"));
  EXPECT_THAT(said("integrator = \"tustin\"\n[cascade.design]\n"),
              HasSubstr("[cascade] has an integrator in addition to [cascade.design]"));
  EXPECT_THAT(said("[cascade.design]\nMs_max = 1\n"), HasSubstr("more than 1"));
  EXPECT_THAT(said("attitude_limit_rad = 30\n[cascade.design]\n"),  // degrees
              HasSubstr("attitude_limit_rad in [cascade] is 30, expected more than 0"));
  EXPECT_THAT(said("[cascade.design]\nintegrator = \"tusin\"\n"),
              HasSubstr("did you mean 'tustin'"));
  EXPECT_THAT(said("[cascade.design]\nintegral = [\"z\"]\n"), HasSubstr("no loop 'z'"));
  EXPECT_THAT(said("[cascade.design]\npublished = 1\n"), HasSubstr("expected true or false"));
  EXPECT_THAT(said("[cascade.design]\nbandwidth_rad_per_s = { roll = 0 }\n"),
              HasSubstr("more than 0"));
  EXPECT_THAT(said("[cascade.design]\nsensor_delay_s = { rol = 0.1 }\n"), HasSubstr("roll"));
  EXPECT_THAT(said("[cascade.design]\nintegral = [\"x\", \"x\"]\n"), HasSubstr("twice"));
  EXPECT_THAT(said("[cascade.design]\nbandwidth_rad_per_s = { roll = 315 }\n"),
              HasSubstr("314.159"));
  EXPECT_THAT(said("[cascade.design]\nbandwidth = 4\n"), HasSubstr("bandwidth_rad_per_s"));
  EXPECT_THAT(said("[cascade.design]\nrate_lead_s = 0.02\nMs_max = 1.6\n"),
              HasSubstr("rate_lead_s requires a design on the flown plant, expected no other key"));
  EXPECT_THAT(said("[cascade.design]\nrate_lead_s = -0.02\n"),
              HasSubstr("expected 0 or more and 1 or less"));
}

TEST(Design, ReadsAStateFeedbackForTheFlownPlant) {
  const std::string head = "name = 'f'\nvehicle = 'mambo'\n[lqr]\nplant = 'flown'\n";
  const Design usual = parse(head);
  EXPECT_FALSE(usual.lqr);
  ASSERT_TRUE(usual.lqi);
  EXPECT_TRUE(has_feedback(usual));
  EXPECT_EQ(usual.lqi->dt, 0.005);
  EXPECT_THAT(usual.lqi->integrals, ElementsAre("px", "py", "pz", "yaw"));
  EXPECT_FALSE(usual.lqi->Q || usual.lqi->Q_integral || usual.lqi->R || usual.lqi->R_change ||
               usual.lqi->past);

  const LqiDesign all = *parse(head +
                               "Q = [1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12]\n"
                               "R = [1, 2, 3, 4]\nchange = [0, 1, 2, 3]\nintegral = ['pz', 'yaw']\n"
                               "Q_integral = [5, 6]\npast = 3\ndt_s = 0.01\n")
                             .lqi;
  EXPECT_EQ((*all.Q)(11), 12);
  EXPECT_EQ((*all.R)(3), 4);
  EXPECT_EQ((*all.R_change)(1), 1);
  EXPECT_EQ((*all.Q_integral)(1), 6);
  EXPECT_THAT(all.integrals, ElementsAre("pz", "yaw"));
  EXPECT_EQ(all.past, 3);
  EXPECT_EQ(all.dt, 0.01);

  const auto refused = [&](const std::string& text, const char* message) {
    EXPECT_THAT([&] { (void)parse(text); }, ThrowsMessage<InvalidInput>(HasSubstr(message)));
  };
  refused("name = 'f'\nvehicle = 'mambo'\n[lqr]\nplant = 'real'\n",
          "d.toml:4: lqr.plant is 'real', expected 'flown' or 'ideal'");
  refused(head + "method = 'sampled'\n", "d.toml:5: key 'method' in [lqr] is not known");
  refused(head + "R = [1, 2, 3]\n",
          "lqr.R has 3 entries, expected 4 (inputs: T tau_x tau_y tau_z)");
  refused(head + "R = [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0.5], [0, 0, 0.5, 1]]\n",
          "d.toml:5: lqr.R is a matrix, expected 4 numbers (inputs: T tau_x tau_y tau_z), because "
          "the weights on the flown plant are diagonal");
  refused(head + "past = 41\n", "past");
  refused(head + "past = 0\nchange = [1, 1, 1, 1]\n", "expected a whole number from 1 to 40");
  refused(head + "[[export]]\nto = 'mambo'\n",
          "d.toml:6: export to 'mambo' cannot hold the past commands");
  refused(head + "structure = 'matrices'\n",
          "d.toml:5: lqr.structure is 'matrices', expected 'dynamic' or 'matrix'; did you mean "
          "'matrix'?");
  refused(head + "[trim]\nat = 'line'\nspeed_m_per_s = 1\n",
          "lqr.plant is 'flown' in a design whose trim is a line, expected a hover");
  refused(head + "[published]\nsource = 'x'\nK = [[1]]\n",
          "[published] has no gains to be compared");
}

TEST(Design, ReadsAMatrixForTheFlownPlant) {
  const std::string head =
      "name = 'f'\nvehicle = 'uquad'\n[lqr]\nplant = 'flown'\nstructure = 'matrix'\n";
  const Design usual = parse(head);
  ASSERT_TRUE(usual.lqi && usual.lqi->matrix);
  EXPECT_EQ(usual.lqi->matrix->convention, "ned");
  EXPECT_EQ(usual.lqi->matrix->input_kind, InputKind::wrench);
  const Design uquad = parse(head +
                             "convention = 'uquad'\ninputs = 'rotor-speed'\ndt_s = 0.01\n"
                             "[[export]]\nto = 'uquad'\n");
  EXPECT_EQ(uquad.lqi->matrix->convention, "uquad");
  EXPECT_EQ(uquad.lqi->matrix->input_kind, InputKind::rotor_speed);
  EXPECT_EQ(uquad.lqi->dt, 0.01);
  const auto refused = [&](const std::string& text, const char* message) {
    EXPECT_THAT([&] { (void)parse(head + text); }, ThrowsMessage<InvalidInput>(HasSubstr(message)));
  };
  refused("past = 2\n", "d.toml:6: key 'past' in [lqr] is not known");
  refused("Q_integral = [1, 1, 0, 1]\n", "d.toml:6: ");
  refused("[trim]\nat = 'hover'\nyaw_rad = 0.3\n",
          "lqr.plant is 'flown' in a design whose trim has the yaw 0.3 rad, expected 0");
  refused("integral = ['px']\n", "key 'integral' in [lqr] is not known");
  refused("convention = 'px4'\n", "no convention 'px4'");
  refused("inputs = 'torque'\n", "no inputs 'torque'");
}

TEST(Design, ReadsASpin) {
  const auto with_trim = [](const std::string& trim) {
    return parse("name = \"s\"\nvehicle = \"mambo\"\n[trim]\n" + trim +
                 "[lqr]\ninputs = \"wrench\"\nmethod = \"continuous\"\nQ = "
                 "[1,1,1,1,1,1,1,1,1,1,1,1]\nR = [1,1,1,1]\n");
  };
  const Design design = with_trim("at = \"spin\"\nyaw_rate_rad_per_s = -2\nclimb_m_per_s = 1\n");
  EXPECT_EQ(design.condition.kind, FlightKind::spin);
  EXPECT_EQ(design.condition.yaw_rate, -2);
  EXPECT_EQ(design.condition.climb, 1);
  EXPECT_THROW((void)with_trim("at = \"spin\"\nyaw_rate_rad_per_s = 0\n"), InvalidInput);
  EXPECT_THROW((void)with_trim("at = \"spin\"\n"), InvalidInput);
  EXPECT_THROW((void)with_trim("at = \"spin\"\nyaw_rate_rad_per_s = 1\nspeed_m_per_s = 1\n"),
               InvalidInput);
}

TEST(Design, LeavesOutHorizontalPosition) {
  EXPECT_THAT(parse(hover_with(0, "")).lqr->states,
              ElementsAre("z", "psi", "phi", "theta", "vqz", "wqx", "wqy", "wqz"));
}

TEST(Design, TakesFullWeights) {
  const Design design =
      parse(hover_with(10, "R = [[1, 0.1, 0, 0], [0.1, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]"));
  EXPECT_EQ(design.lqr->R(0, 1), 0.1);
}

TEST(Design, FindsAVehicleFileBesideIt) {
  const std::filesystem::path folder = std::filesystem::path(::testing::TempDir()) / "design_test";
  std::filesystem::create_directories(folder);
  Vehicle uquad = load_vehicle("uquad");
  std::ofstream(folder / "mine.toml") << uquad.text;
  std::ofstream(folder / "design.toml") << hover_with(2, "vehicle = 'mine.toml'");
  const Design design = load_design(folder / "design.toml");
  EXPECT_EQ(design.vehicle.file, folder / "mine.toml");
  std::filesystem::remove_all(folder);
}

struct Refusal {
  const char* name;
  std::size_t line;
  const char* replacement;
  const char* message;
};

class DesignRefusals : public ::testing::TestWithParam<Refusal> {};

TEST_P(DesignRefusals, NameFileLineAndReason) {
  EXPECT_THAT([] { (void)parse(hover_with(GetParam().line, GetParam().replacement)); },
              ThrowsMessage<InvalidInput>(HasSubstr(GetParam().message)));
}

INSTANTIATE_TEST_SUITE_P(
    All, DesignRefusals,
    ::testing::Values(
        Refusal{"ShortR", 10, "R = [1, 1, 1]",
                "d.toml:10: lqr.R has 3 entries, expected 4 (inputs: w1 w2 w3 w4)"},
        Refusal{"LongQ", 9, "Q = [1, 1, 1, 1, 1, 1, 1, 1, 1]",
                "d.toml:9: lqr.Q has 9 entries, expected 8 (states: z psi phi theta vqz wqx wqy "
                "wqz)"},
        Refusal{"NegativeWeight", 9, "Q = [1, 1, 1, -1, 1, 1, 1, 1]",
                "d.toml:9: entry 4 of Q in [lqr] is -1, expected 0 or more"},
        Refusal{"ZeroR", 10, "R = [1, 1, 1, 0]",
                "d.toml:10: entry 4 of R in [lqr] is 0, expected "
                "more than 0"},
        Refusal{"AsymmetricR", 10, "R = [[1, 2, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]",
                "d.toml:10: lqr.R is not symmetric"},
        Refusal{"ShapeOfR", 10, "R = [[1, 0], [0, 1]]",
                "d.toml:10: lqr.R is 2x2, expected 4x4 (inputs: w1 w2 w3 w4)"},
        Refusal{
            "UnknownIntegral", 11, "integral = ['z', 'thetta']",
            "d.toml:11: lqr.integral has 'thetta', expected names from z psi phi theta vqz wqx wqy "
            "wqz; did you mean 'theta'?"},
        Refusal{"IntegralTwice", 11, "integral = ['z', 'z']",
                "d.toml:11: lqr.integral lists 'z' twice"},
        Refusal{"WeightOfNoIntegral", 11, "",
                "d.toml:12: lqr.Q_integral has no integrals to weight"},
        Refusal{"UnknownState", 8, "states = ['x', 'roll']",
                "d.toml:8: lqr.states has 'roll', expected names from x y z psi"},
        Refusal{"StatesWord", 8, "states = 'no-postion'", "did you mean 'no-position'?"},
        Refusal{"SampleTime", 14, "dt_s = 0",
                "d.toml:14: dt_s in [lqr] is 0, expected 0.0001 or more and 1 or less"},
        Refusal{"SampleTimeUnit", 14, "dt_ms = 10",
                "d.toml:14: key 'dt_ms' in [lqr] is not known, "
                "expected 'dt_s' (the unit is part of the key)"},
        Refusal{"NoSampleTime", 14, "", "d.toml:5: [lqr] has no key 'dt_s'"},
        Refusal{"Method", 13, "method = 'digital'",
                "d.toml:13: no method 'digital', expected continuous, discrete, sampled"},
        Refusal{"Convention", 6, "convention = 'enu'",
                "d.toml:6: no convention 'enu', expected ned, uquad, mambo"},
        Refusal{"Inputs", 7, "inputs = 'rotor-sped'", "d.toml:7: no inputs 'rotor-sped'"},
        Refusal{"Vehicle", 2, "vehicle = 'uqad'",
                "d.toml:2: no vehicle 'uqad' and no such file, expected mambo, rolling-spider, "
                "uquad, crazyflie or a vehicle file in the design's folder; did you mean 'uquad'?"},
        Refusal{"Trim", 4, "at = 'hoover'",
                "d.toml:4: 'hoover', expected hover, line, circle or spin"},
        Refusal{"SpeedInHover", 4, "at = 'hover'\nspeed_m_per_s = 1",
                "d.toml:5: key 'speed_m_per_s' in [trim] is not known"},
        Refusal{"NoRadius", 4, "at = 'circle'\nspeed_m_per_s = 1",
                "d.toml:3: [trim] has no key 'radius_m'"},
        Refusal{
            "Export", 16, "to = 'uqad'",
            "d.toml:16: no export to 'uqad', expected uquad, "
            "mambo, json, mat, c, px4, ardupilot, betaflight, crazyflie; did you mean 'uquad'?"},
        Refusal{"FlightCodeName", 16, "to = 'c'\nname = '9x'",
                "d.toml:17: '9x' cannot be the prefix of names in C"},
        Refusal{"FlightCodeLaw", 16, "to = 'c'\nlaw = 'lqr'",
                "d.toml:17: no law 'lqr', expected cascaded-pid or state-feedback"},
        Refusal{"FlightCodePrecision", 16, "to = 'c'\nprecision = 'half'",
                "d.toml:17: no precision 'half', expected float or double"},
        Refusal{"KeysOfFlightCode", 16, "to = 'json'\nname = 'x'",
                "d.toml:17: export.name applies only to an export to 'c', expected no such key for "
                "'json'"},
        Refusal{"Published", 3, "[published]\nsource = 'x'\nK = [[1, 2]]\n[trim]",
                "d.toml:5: published.K is 1x2, expected up to 4 rows"}),
    [](const auto& test) { return std::string(test.param.name); });

TEST(Design, RefusesAFileThatAsksForNothing) {
  EXPECT_THAT([] { (void)parse("name = 'x'\nvehicle = 'mambo'\n"); },
              ThrowsMessage<InvalidInput>(StrEq("d.toml:1: the file requests no design, expected "
                                                "[lqr], [[kalman]] or [cascade]")));
}

TEST(Design, RefusesFiltersOfTheWrongShape) {
  const std::string head =
      "name = 'x'\nvehicle = 'mambo'\n[[kalman]]\nname = 'f'\ndt_s = 0.1\n"
      "states = [{ name = 'x' }]\nmeasurements = [{ name = 'y' }]\n";
  EXPECT_NO_THROW((void)parse(head + "A = [[1]]\nC = [[1]]\nG = [[1]]\nQ = [1]\nR = [1]\n"));
  EXPECT_THAT([&] { (void)parse(head + "A = [[1, 2]]\nC = [[1]]\nG = [[1]]\nQ = [1]\nR = [1]\n"); },
              ThrowsMessage<InvalidInput>(
                  HasSubstr("d.toml:8: A in [[kalman]] 1 is 1x2, expected 1x1 (states: x)")));
  EXPECT_THAT(
      [&] { (void)parse(head + "A = [[1]]\nC = [[1]]\nG = [[1]]\nQ = [1]\nR = [0]\n"); },
      ThrowsMessage<InvalidInput>(HasSubstr("d.toml:12: entry 1 of R in [[kalman]] 1 is 0")));
}

TEST(Design, EveryPrefixIsADesignOrBadInput) {
  for (const char* name : {"uquad-hover.toml", "mambo-hover.toml"}) {
    const std::string text = load_design(kDesigns / name).text;
    for (std::size_t length = 0; length <= text.size(); length += 3) {
      try {
        (void)parse(text.substr(0, length));
      } catch (const InvalidInput& error) {
        ASSERT_EQ(std::string(error.what()).find('\n'), std::string::npos) << error.what();
      }
    }
  }
}

// First fenced block of `language` after `heading` in docs/formats.md.
std::string example(const std::string& heading, const std::string& language) {
  std::ostringstream bytes;
  bytes << std::ifstream(std::filesystem::path(testing::source_folder()) / "docs" / "formats.md")
               .rdbuf();
  const std::string text = bytes.str();
  const std::string fence = "```" + language + "\n";
  const std::size_t start = text.find(fence, text.find(heading)) + fence.size();
  return text.substr(start, text.find("```", start) - start);
}

TEST(FormatsPage, HasExamplesThatAreRead) {
  EXPECT_EQ(parse_vehicle(example("\n## Vehicle files", "toml"), "formats.md").rotors.size(), 4u);
  EXPECT_EQ(parse(example("\n## Design files", "toml")).lqr->integrals.size(), 4u);
  EXPECT_EQ(parse_text_matrix(example("\n## Matrix text", ""), "formats.md").rows(), 2);
}

TEST(LqrMethod, ReadsBack) {
  for (const LqrMethod method : {LqrMethod::continuous, LqrMethod::discrete, LqrMethod::sampled})
    EXPECT_EQ(lqr_method(to_string(method), "test"), method);
}

}  // namespace
}  // namespace quadtune
