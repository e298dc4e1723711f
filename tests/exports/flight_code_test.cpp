// SPDX-License-Identifier: Apache-2.0
#include "quadtune/exports/flight_code.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <cstdlib>
#include <random>
#include <regex>
#include <sstream>

#include "exported_c.hpp"
#include "flight_code/board_float.hpp"
#include "flight_code/c_structure.hpp"
#include "flight_code/flight_recording.hpp"
#include "flight_code/parameters.hpp"
#include "flight_code/source_text.hpp"
#include "numbers.hpp"
#include "plants/flight_code_designs.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/exports/content.hpp"
#include "quadtune/exports/export.hpp"
#include "quadtune/exports/flight_code_check.hpp"
#include "quadtune/exports/verify.hpp"
#include "source_folder.hpp"
#include "temporary_directory.hpp"

namespace quadtune {
namespace {

using ::testing::Contains;
using testing::flight_code_content;
using testing::FlightCodeCase;
using testing::has_compiler;
using ::testing::HasSubstr;
using testing::hovering_cascade;
using testing::kInfinity;
using testing::kNaN;
using testing::loops_without_bound;
using testing::make_test;
using testing::TemporaryDirectory;
using ::testing::ThrowsMessage;

class FlightCode : public ::testing::TestWithParam<FlightCodeCase> {};

TEST_P(FlightCode, RepeatsTheFlightOfTheLibrarysTemplatesBitByBit) {
  if (!has_compiler()) GTEST_SKIP() << "cc is not installed here";
  const TemporaryDirectory folder;
  write_files(folder.path(), flight_code_files(flight_code_content(GetParam())));
  EXPECT_EQ(make_test(folder.path()), 0) << folder.read("log");
  EXPECT_THAT(folder.read("log"), HasSubstr("control periods, all equal bit by bit"));
}

TEST_P(FlightCode, HasAConstantBoundForEachLoop) {
  int files = 0;
  for (const FileContent& file : flight_code_files(flight_code_content(GetParam()))) {
    const bool code = file.name.ends_with(".c") || file.name.ends_with(".h");
    if (!code || file.name.starts_with("replay")) continue;
    EXPECT_THAT(loops_without_bound(file.bytes), ::testing::IsEmpty()) << file.name;
    ++files;
  }
  EXPECT_GE(files, 10);
}

TEST(FlightCode, IsSeenToHaveALoopWithoutABound) {
  for (const char* loop :
       {"while (x > 0.0f) {", "do {", "for (;;) {", "for (int i = 0; i < n; ++i) {",
        "for (int i = 0; (i < n) && (i < 3); ++i) {", "for (int i = 0; i < 3; i += 0) {",
        "for (int i = 0; i != QT_ROTORS; ++i) {", "goto again;"})
    EXPECT_EQ(loops_without_bound(loop).size(), 1U) << loop;
  for (const char* loop :
       {"for (int i = 0; i < 3; ++i) {", "for (int j = 0; j <= i; ++j) {",
        "for (int j = QT_PAST - 1; j >= QT_INPUTS; --j) {", "/* while (true) { */",
        "for (int k = 0; (k < QT_HORIZON) && (k < n); ++k) {"})
    EXPECT_EQ(loops_without_bound(loop).size(), 0U) << loop;
}

TEST_P(FlightCode, FliesAsTheLibraryDoes) {
  // The same numbers in the order of the program: both differ only by rounding, which the gates of
  // a filter may amplify.
  const ExportContent content = flight_code_content(GetParam());
  const FlightSetup setup = exports::recorded_setup(content);
  const FlightResult by_library = fly(setup);
  const exports::ProgramSettings settings = exports::program_settings(setup);
  const exports::RecordedFlight by_program =
      exports::record_flight(setup, settings, exports::template_program(settings, true), true);
  ASSERT_EQ(by_library.end, FlightEnd::completed);
  ASSERT_EQ(by_program.flight.end, FlightEnd::completed);
  EXPECT_LT((by_program.flight.final_state - by_library.final_state).cwiseAbs().maxCoeff(), 1e-6);
  const exports::RecordedFlight in_float =
      exports::record_flight(setup, settings, exports::template_program(settings, false), false);
  EXPECT_EQ(in_float.flight.end, FlightEnd::completed);
  EXPECT_LT((in_float.flight.final_state.head<3>() - by_library.final_state.head<3>()).norm(),
            0.05);
}

INSTANTIATE_TEST_SUITE_P(
    Programs, FlightCode,
    ::testing::Values(
        FlightCodeCase{"cascade", "crazyflie", InputKind::wrench, -1, true, true},
        FlightCodeCase{"cascade_in_double", "mambo", InputKind::wrench, -1, true, true, true, true},
        FlightCodeCase{"mambo_filter", "mambo", InputKind::wrench, -1, true, true, true, false,
                       "mambo"},
        FlightCodeCase{"mambo_filter_in_double", "mambo", InputKind::wrench, -1, true, true, true,
                       true, "mambo"},
        FlightCodeCase{"uquad_filter", "uquad", InputKind::wrench, -1, true, true, true, false,
                       "uquad"},
        FlightCodeCase{"uquad_filter_in_double", "uquad", InputKind::wrench, -1, true, true, true,
                       true, "uquad"},
        FlightCodeCase{"uquad_filter_of_speeds", "uquad", InputKind::rotor_speed, 2, true, false,
                       true, false, "uquad"},
        FlightCodeCase{"cascade_alone", "uquad", InputKind::wrench, -1, true, true, false},
        FlightCodeCase{"cascade_with_lead", "crazyflie", InputKind::wrench, -1, true, true, true,
                       false, "general", false, true},
        FlightCodeCase{"cascade_with_lead_in_double", "uquad", InputKind::wrench, -1, true, true,
                       false, true, "general", false, true},
        FlightCodeCase{"steady_filters", "uquad", InputKind::wrench, -1, true, true, false, false,
                       "", true},
        FlightCodeCase{"wrench_of_past_commands", "crazyflie", InputKind::wrench, 3},
        FlightCodeCase{"wrench_of_lags", "crazyflie", InputKind::wrench, 0},
        FlightCodeCase{"wrench_without_state", "mambo", InputKind::wrench, -1, false},
        FlightCodeCase{"wrench_in_double", "uquad", InputKind::wrench, 2, true, false, true, true},
        FlightCodeCase{"speeds", "uquad", InputKind::rotor_speed, 2, true, false, false},
        FlightCodeCase{"thrusts", "mambo", InputKind::rotor_thrust, -1},
        FlightCodeCase{"commands", "mambo", InputKind::command, 1}),
    [](const auto& of) { return of.param.name; });

// Known offsets of the sensors survive a calibration, as in the library's filter.
TEST(FlightCode, KeepsTheOffsetsThatTheUquadsFilterStartedWith) {
  if (!has_compiler()) GTEST_SKIP() << "cc is not installed here";
  ExportContent content =
      flight_code_content({"", "uquad", InputKind::wrench, -1, true, true, true, false, "uquad"});
  content.flight_code.name = "prog";
  content.vehicle.sensors.vision = SensorFaults{.rate = 10, .delay = 0.05};
  const TemporaryDirectory folder;
  write_files(folder.path(), flight_code_files(content));
  const std::string command = fmt::format(
      "cd '{}' && cc -std=c99 -I. -o offsets '{}/tests/exports/stubs/uquad_offsets.c' prog*.c -lm "
      "> log 2>&1 && ./offsets {} > log 2>&1",
      folder.path().string(), testing::source_folder(),
      static_cast<int>(std::lround(2 / content.cascade->gains.dt)));
  ASSERT_EQ(std::system(command.c_str()), 0) << folder.read("log");
  // Without subtraction roll and pitch would be wrong by some 0.005 rad, with an overwritten offset
  // p would be 0.05 rad/s, and the image would move x by 5 m.
  EXPECT_EQ(folder.read("log"), "roll 0.0300 pitch -0.0200\np 0.000\nx 0.000\n");
}

TEST(FlightCode, HasTheUquadsFilterForOtherSensorsAndBodies) {
  if (!has_compiler()) GTEST_SKIP() << "cc is not installed here";
  const auto content_of = [](bool double_precision, const auto& change) {
    ExportContent content = flight_code_content(
        {"", "uquad", InputKind::wrench, -1, true, true, true, double_precision, "uquad"});
    change(content.vehicle);
    return content;
  };
  const auto repeats = [&](bool double_precision, const auto& change) {
    const ExportContent content = content_of(double_precision, change);
    const TemporaryDirectory folder;
    write_files(folder.path(), flight_code_files(content));
    EXPECT_EQ(make_test(folder.path()), 0) << folder.read("log");
  };
  for (const bool double_precision : {false, true}) {
    // 8 states, without those that only GPS observes.
    repeats(double_precision, [](Vehicle& vehicle) { vehicle.sensors.gps.reset(); });
    // With each measurement and each term of the model.
    repeats(double_precision, [](Vehicle& vehicle) {
      vehicle.sensors.vision = SensorFaults{.rate = 10, .delay = 0.05};
      vehicle.inertia(0, 1) = vehicle.inertia(1, 0) = 0.1 * vehicle.inertia(0, 0);
      vehicle.inertia(0, 2) = vehicle.inertia(2, 0) = -0.05 * vehicle.inertia(0, 0);
      vehicle.drag.cda = Eigen::Vector3d(0.01, 0.015, 0.02);
      vehicle.drag.linear = Eigen::Vector3d(0.1, 0.2, 0.3);
      for (Rotor& rotor : vehicle.rotors) {
        rotor.thrust_a1 += 1e-4;
        rotor.torque_d1 += 1e-5;
        rotor.inertia = 1e-4;
      }
    });
  }
  EXPECT_THAT(
      [&] {
        (void)flight_code_files(
            content_of(false, [](Vehicle& vehicle) { vehicle.sensors.barometer.reset(); }));
      },
      ThrowsMessage<InvalidInput>(HasSubstr("do not suffice for the estimator 'uquad'")));
}

TEST(FlightCode, HasTheCovariancesThatAreStoredWithTheDesign) {
  ExportContent content =
      flight_code_content({"", "uquad", InputKind::wrench, -1, true, true, true, false, "uquad"});
  const auto numbers = [&] {
    return exports::parameters_text(exports::program_settings(exports::recorded_setup(content)), {},
                                    false);
  };
  EXPECT_THAT(numbers(), HasSubstr(".tilt_R = 0.25f,"));
  UquadFilterSettings<double>& tuned =
      content.estimator->uquad.emplace(uquad_filter_in_si<double>());
  tuned.dt = 0.005;
  tuned.R_tilt = 0.75;
  EXPECT_THAT(numbers(), HasSubstr(".tilt_R = 0.75f,"));
}

TEST(FlightCode, HasTheSteadyKalmanFiltersOfTheDesign) {
  if (!has_compiler()) GTEST_SKIP() << "cc is not installed here";
  const TemporaryDirectory folder;
  const ExportContent content =
      flight_code_content({"", "uquad", InputKind::wrench, -1, true, true, false, true, "", true});
  (void)write_export(folder.path(), export_kind("c", "test"), content);
  EXPECT_THAT(folder.read("uquad_kalman.h"),
              HasSubstr("0 'height', every 0.005 s:\n *   x = (z [m], vz [m/s])\n"
                        " *   u = (az [m/s^2])\n *   y = (z_sonar [m])\n * 1 'a * / name'"));
  EXPECT_EQ(make_test(folder.path()), 0) << folder.read("log");
  EXPECT_THAT(folder.read("log"), HasSubstr("\n200 control periods, all equal bit by bit"));
  const auto checks = [&] {
    return flight_code_checks(folder.path(), content.vehicle, {FlightCodeTarget::host});
  };
  ASSERT_EQ(checks().size(), 2U) << checks().front().detail;
  EXPECT_TRUE(checks().back().ok) << checks().back().detail;
  EXPECT_THAT(checks().back().detail, HasSubstr("filters: 200 control periods"));
  // One number of a filter.
  std::string numbers = folder.read("uquad_parameters.c");
  const std::size_t at = numbers.find("0.0262414206418703");
  ASSERT_NE(at, std::string::npos);
  folder.write("uquad_parameters.c", numbers.replace(at + 5, 1, "3"));
  EXPECT_NE(make_test(folder.path()), 0);
  EXPECT_THAT(folder.read("log"), HasSubstr("expected"));
  EXPECT_FALSE(checks().front().ok);
}

TEST(FlightCode, RefusesFiltersWhoseMatricesAreNotOfOneFilter) {
  const auto refusal = [](const auto& change, const char* message) {
    ExportContent content = flight_code_content(
        {"", "uquad", InputKind::wrench, -1, true, true, false, false, "", true});
    change(content.filters.front());
    EXPECT_THAT([&] { (void)flight_code_files(content); },
                ThrowsMessage<InvalidInput>(HasSubstr(message)));
  };
  refusal([](KalmanFilter& f) { f.L(0, 0) = kNaN; }, "filter 'height': L has nan at (1,1)");
  refusal([](KalmanFilter& f) { f.M = f.L.transpose().eval(); }, "M is 1x2, expected 2x1");
  refusal([](KalmanFilter& f) { f.model.A(0, 1) = 1e39; }, "A: is 1e+39");
}

TEST(FlightCode, ThatIsChangedDoesNotRepeatIt) {
  if (!has_compiler()) GTEST_SKIP() << "cc is not installed here";
  const TemporaryDirectory folder;
  write_files(folder.path(), flight_code_files(flight_code_content(
                                 {"cascade", "crazyflie", InputKind::wrench, -1, true, true})));
  std::string law = folder.read("crazyflie_law.c");
  const std::string minus = "-p->Kd * rate";
  ASSERT_NE(law.find(minus), std::string::npos);
  folder.write("crazyflie_law.c", law.replace(law.find(minus), 1, "0.999f * -"));
  EXPECT_NE(make_test(folder.path()), 0);
  EXPECT_THAT(folder.read("log"), HasSubstr("expected"));
}

TEST(FlightCode, MayHaveANameLikeThoseOfTheSources) {
  if (!has_compiler()) GTEST_SKIP() << "cc is not installed here";
  const TemporaryDirectory folder;
  ExportContent content = flight_code_content({"thrusts", "mambo", InputKind::rotor_thrust});
  content.flight_code.name = "qt_real";
  content.vehicle.name = "*/ #error */";  // must not end a comment
  content.gains->vehicle = content.vehicle.name;
  write_files(folder.path(), flight_code_files(content));
  EXPECT_EQ(make_test(folder.path()), 0) << folder.read("log");
}

TEST(FlightCode, IsRefusedWhereArithmeticIsNotAsWritten) {
  if (!has_compiler()) GTEST_SKIP() << "cc is not installed here";
  const TemporaryDirectory folder;
  write_files(folder.path(), flight_code_files(flight_code_content({"thrusts", "mambo"})));
  EXPECT_NE(
      std::system(
          fmt::format("cd '{}' && make CFLAGS=-Ofast > log 2>&1", folder.path().string()).c_str()),
      0);
  EXPECT_THAT(folder.read("log"), HasSubstr("expected a compiler without -ffast-math"));
}

TEST(FlightCode, ReplaysNothingThatIsNoFlight) {
  if (!has_compiler()) GTEST_SKIP() << "cc is not installed here";
  const TemporaryDirectory folder;
  write_files(folder.path(), flight_code_files(flight_code_content({"thrusts", "mambo"})));
  ASSERT_EQ(make_test(folder.path()), 0) << folder.read("log");
  const auto replayed = [&](const std::string& text) {
    folder.write("other.txt", text);
    return WEXITSTATUS(std::system(
        fmt::format("cd '{}' && ./replay other.txt > other.log 2>&1", folder.path().string())
            .c_str()));
  };
  const std::string flight = folder.read("flight.txt");
  EXPECT_EQ(replayed(""), 2);
  EXPECT_EQ(replayed("start 0 0\n"), 2);
  EXPECT_EQ(replayed(flight.substr(flight.find("\nstart") + 1)), 0) << folder.read("other.log");
  EXPECT_EQ(replayed(flight.substr(0, flight.size() - 40)), 2);
  EXPECT_EQ(replayed("1 2 3\n"), 2);
}

TEST(FlightCode, SwitchesTheMotorsOffWhereTheEstimateIsNotFinite) {
  if (!has_compiler()) GTEST_SKIP() << "cc is not installed here";
  const TemporaryDirectory folder;
  write_files(folder.path(),
              flight_code_files(flight_code_content(
                  {"cascade_alone", "uquad", InputKind::wrench, -1, true, true, false})));
  ASSERT_EQ(make_test(folder.path()), 0) << folder.read("log");
  const auto commands = [&](const char* yaw) {
    // 16 numbers of the start; the estimate; phase, tracking, 9 numbers of the reference, 4 of
    // idle.
    folder.write("lines", fmt::format("start 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0\n"
                                      "0 0 -1 0 0 {} 0 0 0 0 0 0\n2 1 0 0 -1 0 0 0 0 0 0 0 0 0 0\n",
                                      yaw));
    EXPECT_EQ(
        std::system(
            fmt::format("cd '{}' && ./replay - < lines > answers", folder.path().string()).c_str()),
        0);
    std::istringstream answers(folder.read("answers"));
    std::string of_estimate;
    std::getline(answers, of_estimate);
    Eigen::Vector4d found;
    for (double& command : found) answers >> command;
    return found;
  };
  EXPECT_GT(commands("0").minCoeff(), 100);
  EXPECT_EQ(commands("nan"), Eigen::Vector4d::Zero());
  EXPECT_EQ(commands("inf"), Eigen::Vector4d::Zero());
}

TEST(FlightCode, FliesMissionsAsACompiledProgramBitByBit) {
  if (!has_compiler()) GTEST_SKIP() << "cc is not installed here";
  const TemporaryDirectory folder;
  const ExportContent content =
      flight_code_content({"cascade", "crazyflie", InputKind::wrench, -1, true, true});
  (void)write_export(folder.path(), export_kind("c", "test"), content);
  const CompiledProgram program(folder.path(), content.vehicle);
  for (const char* mission : {"take-off-and-land", "step-yaw"}) {
    FlightSetup setup;
    setup.vehicle = content.vehicle;
    setup.mission = load_mission(mission);
    setup.duration = 6;
    setup.seed = 4;
    const ProgramFlight flown = program.fly(setup);
    const ProgramFlight expected = program.fly_by_templates(setup);
    EXPECT_EQ(flown.flight.end, FlightEnd::completed) << flown.flight.culprit;
    EXPECT_EQ(flown.text, expected.text) << mission;
    EXPECT_EQ(flown.flight.final_state, expected.flight.final_state) << mission;
  }
}

TEST(FlightCode, IsVerifiedByItsText) {
  const TemporaryDirectory folder;
  const ExportContent content =
      flight_code_content({"cascade", "crazyflie", InputKind::wrench, -1, true, true});
  (void)write_export(folder.path(), export_kind("c", "test"), content);
  const auto found = [&] { return flight_code_checks(folder.path(), content.vehicle, {}); };
  ASSERT_EQ(found().size(), 1U);
  EXPECT_TRUE(found().front().ok) << found().front().detail;
  // The sign of one gain, with a matching manifest.
  std::string text = folder.read("crazyflie_parameters.c");
  const std::size_t at = text.find(".Kp = ") + 6;
  folder.write("crazyflie_parameters.c", text.replace(at, 0, text[at] == '-' ? " " : "-"));
  EXPECT_FALSE(found().front().ok);
  EXPECT_THAT(found().front().detail, HasSubstr("crazyflie_parameters.c: line"));
  // The numbers of another program in the same folder.
  folder.write("crazyflie_parameters.c", text.erase(at, 1));
  EXPECT_TRUE(found().front().ok) << found().front().detail;
  folder.write("mambo_parameters.c", "");
  EXPECT_THAT(found().front().detail, HasSubstr("mambo_parameters.c belongs to another program"));
  EXPECT_FALSE(found().front().ok);
  std::filesystem::remove(folder.path() / "mambo_parameters.c");
  // Flight code of another vehicle.
  Vehicle heavier = content.vehicle;
  heavier.mass *= 1.1;
  EXPECT_FALSE(flight_code_checks(folder.path(), heavier, {}).front().ok);
  EXPECT_THAT([&] { CompiledProgram(folder.path(), heavier); },
              ThrowsMessage<InvalidInput>(HasSubstr("differs from what the gains")));
}

TEST(FlightCode, RefusesWhatIsNoProgram) {
  const auto refusal = [](const auto& change, const char* message) {
    ExportContent content = flight_code_content({"thrusts", "mambo", InputKind::rotor_thrust});
    change(content);
    EXPECT_THAT([&] { (void)flight_code_files(content); },
                ThrowsMessage<InvalidInput>(HasSubstr(message)));
  };
  refusal([](ExportContent& c) { c.gains.reset(); }, "the design has no law");
  refusal([](ExportContent& c) { c.gains->dt = 0; }, "the gains are continuous");
  refusal([](ExportContent& c) { c.cascade = hovering_cascade(c.vehicle, PidMethod::tustin); },
          "expected the law cascaded-pid or state-feedback to be selected");
  refusal([](ExportContent& c) { c.flight_code.law = "cascaded-pid"; }, "no law 'cascaded-pid'");
  refusal([](ExportContent& c) { c.flight_code.law = "lqr"; }, "no law 'lqr'");
  for (const char* name :
       {"int", "m", "errno", "A", "9a", "a-b", "a b", "replay", "abcdefghijklmnopqrstuvwxyz"})
    refusal([&](ExportContent& c) { c.flight_code.name = name; },
            "cannot be the prefix of names in C");
  refusal([](ExportContent& c) { c.gains->K(0, 0) = 1e39; }, "law.K: is 1e+39");
}

// In float, a variance of 1e-50 would be 0, and the estimator would trust the sensor completely.
TEST(FlightCode, RefusesEstimatorNumbersThatVanishInFloat) {
  const auto written = [](const char* part, bool double_precision, double x) {
    exports::Structure c(double_precision, 0.005);
    c.open("");
    c.open(part);
    c.numbers("gyro_variance", {1, x});
    return c.text();
  };
  EXPECT_THAT([&] { (void)written("estimator", false, 1e-50); },
              ThrowsMessage<InvalidInput>(
                  "estimator.gyro_variance: is 1e-50, expected 0 or at least 1.2e-38 in magnitude "
                  "because the program computes in float; use double precision"));
  EXPECT_THAT(written("estimator", true, 1e-50), HasSubstr("{1.0, 1e-50}"));
  EXPECT_THAT(written("estimator", false, 0), HasSubstr("{1.0f, 0.0f}"));
  EXPECT_THAT(written("estimator", false, 1e-30), HasSubstr("{1.0f, 1e-30f}"));
  EXPECT_THAT(written("law", false, 1e-50), HasSubstr("{1.0f, 0.0f}"));
}

TEST(FlightCode, WritesNumbersThatReadBackAsTheyAre) {
  using exports::c_number;
  EXPECT_EQ(c_number(3, false, ""), "3.0f");
  EXPECT_EQ(c_number(0.1, false, ""), "0.1f");
  EXPECT_EQ(c_number(0.1, true, ""), "0.1");
  EXPECT_EQ(c_number(-1e-9, false, ""), "-1e-09f");
  EXPECT_EQ(c_number(kInfinity, false, ""), "QT_INFINITY");
  EXPECT_EQ(c_number(-kInfinity, true, ""), "-QT_INFINITY");
  EXPECT_THAT([] { (void)c_number(kNaN, true, "law.K"); },
              ThrowsMessage<InvalidInput>(HasSubstr("law.K: is NaN")));
  EXPECT_THAT([] { (void)c_number(-1e39, false, "law.K"); },
              ThrowsMessage<InvalidInput>(HasSubstr("law.K: is -1e+39")));
  EXPECT_EQ(c_number(-1e39, true, ""), "-1e+39");
}

TEST(FlightCode, KeepsTheLinesThatItsFeaturesSay) {
  const std::string text =
      "a\n#if QT_WITH_X\nb\n#ifdef Y\nc\n#endif\n#else\nd\n#endif\n#if !QT_WITH_X\ne\n#endif\nf\n";
  EXPECT_EQ(exports::with_features(text, {"X"}), "a\nb\n#ifdef Y\nc\n#endif\nf\n");
  EXPECT_EQ(exports::with_features(text, {}), "a\nd\ne\nf\n");
}

TEST(FlightCode, IsNamedAfterTheVehicle) {
  EXPECT_EQ(flight_code_name("quad-450"), "quad_450");
  EXPECT_EQ(flight_code_name("Mambo"), "mambo");
  EXPECT_EQ(flight_code_name("4x"), "vehicle_4x");
  EXPECT_EQ(flight_code_name(""), "vehicle_");
}

// Against double precision: the bounds that functions_float.c states.
TEST(FlightCode, FunctionsInSinglePrecisionAreAccurate) {
  using exports::BoardFloat;
  std::mt19937_64 random(7);
  std::uniform_real_distribution<float> angle(-8192, 8192), side(-10, 10), power(-80, 80);
  const auto ulp = [](double x) {
    const auto f = static_cast<float>(std::abs(x));
    return static_cast<double>(std::nextafter(f, 1e38F)) - static_cast<double>(f);
  };
  for (int i = 0; i < 200'000; ++i) {
    const float a = angle(random), x = side(random), y = side(random), p = power(random);
    EXPECT_NEAR(sin(BoardFloat(a)).value, std::sin(static_cast<double>(a)), 1.5 * 0x1p-24) << a;
    EXPECT_NEAR(cos(BoardFloat(a)).value, std::cos(static_cast<double>(a)), 1.5 * 0x1p-24) << a;
    const double turn = std::atan2(static_cast<double>(y), static_cast<double>(x));
    EXPECT_NEAR(atan2(BoardFloat(y), BoardFloat(x)).value, turn, 3 * ulp(turn)) << y << " " << x;
    const double grown = std::exp(static_cast<double>(p));
    EXPECT_NEAR(exp(BoardFloat(p)).value, grown, 1.001 * ulp(grown)) << p;
    const auto positive = static_cast<float>(grown);
    const double logarithm = std::log(static_cast<double>(positive));
    EXPECT_NEAR(log(BoardFloat(positive)).value, logarithm, 1.001 * ulp(logarithm)) << positive;
  }
  EXPECT_EQ(atan2(BoardFloat(0), BoardFloat(0)).value, 0);
  EXPECT_TRUE(std::isnan(atan2(BoardFloat(kNaN), BoardFloat(1)).value));
}

}  // namespace
}  // namespace quadtune
