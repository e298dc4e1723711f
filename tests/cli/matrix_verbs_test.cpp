// SPDX-License-Identifier: Apache-2.0
/// Commands on matrices and data: loops A, B, C, D, controllers, measured responses, LQI, LQG, pole
/// placement, zeros and norms, discrete PID controllers, curves as numbers.
#include <gmock/gmock.h>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <complex>
#include <nlohmann/json.hpp>
#include <numbers>
#include <sstream>
#include <string>

#include "run_program.hpp"
#include "temporary_directory.hpp"

namespace quadtune {
namespace {

using Json = nlohmann::ordered_json;
using ::testing::HasSubstr;
using testing::ProgramResult;
using testing::run_program;
using testing::TemporaryDirectory;

Json printed_json(std::vector<std::string> args) {
  args.emplace_back("--json");
  const ProgramResult result = run_program(args);
  EXPECT_EQ(result.status, 0) << result.err;
  return Json::parse(result.out);
}

/// One line on the error stream, with the status of a wrong command line.
void expect_refused(const std::vector<std::string>& args, const std::string& message) {
  const ProgramResult result = run_program(args);
  EXPECT_EQ(result.status, 2) << result.out;
  EXPECT_THAT(result.err, HasSubstr(message));
  EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
}

// The controllable canonical form of 25/(s³ + 10 s² + 10 s + 10).
const std::vector<std::string> kMatrixLoop = {
    "margins", "--A", "0 1 0; 0 0 1; -10 -10 -10", "--B", "0; 0; 1", "--C", "25 0 0"};

void expect_same_margins(const Json& a, const Json& b) {
  for (const char* key : {"gain_margin_db", "phase_margin_deg", "delay_margin_s", "Ms", "Mt",
                          "disk_alpha", "Ms_frequency"})
    if (a["loops"][0][key].is_null())  // infinite
      EXPECT_TRUE(b["loops"][0][key].is_null()) << key;
    else
      EXPECT_NEAR(a["loops"][0][key], b["loops"][0][key], 1e-6) << key;
}

TEST(MatrixMargins, OfALoopOfMatricesAreThoseOfItsTransferFunction) {
  const Json fraction = printed_json({"margins", "--num", "25", "--den", "1,10,10,10"});
  const Json matrices = printed_json(kMatrixLoop);
  expect_same_margins(matrices, fraction);
  EXPECT_EQ(matrices["loops"][0]["name"], "y1");
  // As a plant 1/(…) with the controller 25, and as 5/(…) with a dynamic one, (5 s + 5)/(s + 1).
  expect_same_margins(
      printed_json({"margins", "--num", "1", "--den", "1,10,10,10", "--controller-D", "25"}),
      fraction);
  expect_same_margins(printed_json({"margins", "--num", "5", "--den", "1,10,10,10",
                                    "--controller-num", "5,5", "--controller-den", "1,1"}),
                      fraction);
}

TEST(MatrixMargins, OfControllerTimesPlantAtInputsAndOutputs) {
  const std::vector<std::string> plant = {"margins",    "--A", "-1 0; 0 -2", "--B",
                                          "1 0.5; 0 1", "--C", "1 0; 1 1",   "--controller-D",
                                          "2 0; 0 1"};
  std::vector<std::string> outputs = plant;
  outputs.insert(outputs.end(), {"--cut", "outputs"});
  const Json at_inputs = printed_json(plant), at_outputs = printed_json(outputs);
  EXPECT_EQ(at_inputs["loops"][0]["name"], "u1");
  EXPECT_EQ(at_outputs["loops"][1]["name"], "y2");
  EXPECT_TRUE(at_inputs["loops"][0]["stable"]);
  EXPECT_TRUE(at_outputs["loops"][0]["stable"]);
}

// A PID controller in a discrete loop is the element that flies.
TEST(MatrixMargins, OfAPidControllerWithASampledPlant) {
  const Json loop = printed_json({"margins", "--A", "0 1; 0 -1", "--B", "0; 1", "--C", "1 0",
                                  "--sampled", "0.01", "--pid", "4,1,2,0.02"});
  EXPECT_EQ(loop["time"], "discrete");
  EXPECT_TRUE(loop["loops"][0]["stable"]);
  EXPECT_GT(loop["loops"][0]["phase_margin_deg"], 20);
  const Json late = printed_json({"margins", "--A", "0 1; 0 -1", "--B", "0; 1", "--C", "1 0",
                                  "--sampled", "0.01", "--pid", "4,1,2,0.02", "--delay", "0.02"});
  EXPECT_LT(late["loops"][0]["phase_margin_deg"], loop["loops"][0]["phase_margin_deg"]);
  EXPECT_NEAR(late["loops"][0]["delay_margin_s"], double(loop["loops"][0]["delay_margin_s"]) - 0.02,
              1e-6);
}

TEST(MatrixMargins, OfAnotherSkew) {
  const Json skewed =
      printed_json({"margins", "--num", "25", "--den", "1,10,10,10", "--skew", "1"});
  const Json& loop = skewed["loops"][0];
  EXPECT_EQ(skewed["skew"], 1);
  EXPECT_NEAR(loop["disk_alpha"], 1 / double(loop["Ms"]), 1e-9);  // the modulus margin
  EXPECT_NEAR(loop["disk_frequency"], loop["Ms_frequency"], 1e-4);
  EXPECT_NEAR(skewed["multivariable"]["disk_alpha"], loop["disk_alpha"], 1e-6);
  EXPECT_THAT(run_program({"margins", "--num", "25", "--den", "1,10,10,10"}).out,
              HasSubstr("peaks       Ms "));
}

TEST(MatrixMargins, WrongCombinationsAreRefused) {
  std::vector<std::string> args = kMatrixLoop;
  args.insert(args.end(), {"--K", "1 1 1"});
  expect_refused(args, "--C and --D cannot be combined with --K");
  args = kMatrixLoop;
  args.insert(args.end(), {"--pid", "1", "--controller-D", "1"});
  expect_refused(args, "more than one controller was given");
  expect_refused({"margins", "--num", "1", "--den", "1,1", "--measured", "T"},
                 "--measured requires --frd");
  expect_refused({"margins", "--num", "1", "--den", "1,1", "--integrator", "euler"},
                 "--integrator requires --pid");
  expect_refused({"margins", "--num", "1", "--den", "1,1", "--pid", "1,2", "--integrator", "euler"},
                 "--integrator requires a discrete loop");
  expect_refused({"margins", "--num", "1", "--den", "1,1", "--cut", "states"}, "--cut");
  expect_refused({"margins", "mambo", "--gains", "x", "--skew", "1"}, "--skew");
  args = kMatrixLoop;
  args.insert(args.end(), {"--pid", "1,2,3,4,5"});
  expect_refused(args, "--pid has 5 numbers");
  expect_refused({"margins", "--A", "0 1; 0 0", "--B", "0; 1"}, "--K or --C is missing");
  expect_refused(
      {"margins", "--A", "0 1; 0 0", "--B", "0; 1", "--C", "1 0", "--controller-D", "1 1"},
      "the controller has 2 inputs and 1 output, expected 1 and 1, because the plant has 1 output "
      "and 1 input");
  expect_refused(
      {"lqr", "--A", "1", "--B", "1", "--Q", "1", "--R", "1", "--sampled", "0.1", "--dt", "0.1"},
      "--dt cannot be combined with --sampled");
}

/// Rows of 25/(s³ + 10 s² + 10 s + 10), or of T = L/(1 + L).
std::string rows_of_example(bool closed, bool in_hertz) {
  std::ostringstream text;
  text.precision(17);
  text << "# measured in flight\n" << (in_hertz ? "f,mag_db,phase_deg,coherence\n" : "w re im\n");
  for (int i = 0; i <= 400; ++i) {
    const double w = 0.05 * std::pow(1000, i / 400.0);
    const std::complex<double> s(0, w);
    std::complex<double> G = 25.0 / (((s + 10.0) * s + 10.0) * s + 10.0);
    if (closed) G /= 1.0 + G;
    if (in_hertz)
      text << w / (2 * std::numbers::pi) << "," << 20 * std::log10(std::abs(G)) << ","
           << std::arg(G) * 180 / std::numbers::pi << ",0.9\n";
    else
      text << w << " " << G.real() << "\t" << G.imag() << "\n";
  }
  return text.str();
}

TEST(MeasuredMargins, OfDataAreThoseOfTheLoop) {
  const TemporaryDirectory folder;
  const Json exact = printed_json({"margins", "--num", "25", "--den", "1,10,10,10"});
  for (const bool closed : {false, true}) {
    const std::string file = folder.write("data.csv", rows_of_example(closed, closed)).string();
    const Json data = printed_json({"margins", "--frd", file, "--measured", closed ? "T" : "loop"});
    for (const char* key : {"gain_margin_db", "phase_margin_deg", "Ms", "disk_alpha"})
      EXPECT_NEAR(data["loops"][0][key], exact["loops"][0][key], 2e-2) << key;
    EXPECT_EQ(data["samples"], 401);
    EXPECT_THAT(std::string(data["notes"][0]),
                HasSubstr("the closed loop is assumed to be stable"));
  }
  // The plant was measured, the controller is known.
  const std::string file = folder.write("plant.csv", rows_of_example(false, false)).string();
  const Json half = printed_json({"margins", "--frd", file, "--pid", "0.5"});
  EXPECT_NEAR(half["loops"][0]["gain_margin_db"],
              double(exact["loops"][0]["gain_margin_db"]) + 20 * std::log10(2), 2e-2);
}

TEST(MeasuredMargins, WhatTheDataLeaveOpenIsNull) {
  const TemporaryDirectory folder;
  const std::string file =
      folder.write("short.csv", "w,mag,phase_rad\n1,0.5,-1\n2,0.3,-1.5\n").string();
  const ProgramResult text = run_program({"margins", "--frd", file});
  EXPECT_EQ(text.status, 0) << text.err;
  EXPECT_THAT(text.err, HasSubstr("|L| does not pass 1 within the data"));
  const Json json = printed_json({"margins", "--frd", file});
  EXPECT_TRUE(json["loops"][0]["gain_margin_db"].is_null());
  EXPECT_TRUE(json["loops"][0]["phase_margin_deg"].is_null());
  EXPECT_FALSE(json["loops"][0]["Ms"].is_null());
}

TEST(MeasuredMargins, DefectsOfTheFileAreNamedByLine) {
  const TemporaryDirectory folder;
  const auto message = [&](const std::string& text) {
    const std::string file = folder.write("bad.csv", text).string();
    const ProgramResult result = run_program({"margins", "--frd", file});
    EXPECT_EQ(result.status, 3) << text;
    return result.err;
  };
  EXPECT_THAT(message("w,re\n1,2\n"),
              HasSubstr("bad.csv:1: the columns are w, re, expected re and im"));
  EXPECT_THAT(message("w,re,im,mag,phase_deg\n1,1,0,1,0\n"),
              HasSubstr("bad.csv:1: the response is given twice"));
  EXPECT_THAT(message("re,im\n"),
              HasSubstr("bad.csv:1: the columns are re, im, expected one named w (in rad/s) or f"));
  EXPECT_THAT(message("w,re,im\n1,2,3\n1,2,3\n"),
              HasSubstr("bad.csv:3: the frequency is 1 after 1, expected"));
  EXPECT_THAT(message("f,re,im\n0,2,3\n"), HasSubstr("bad.csv:2: the frequency is 0, expected"));
  EXPECT_THAT(message("w,f,re,im\n"),
              HasSubstr("bad.csv:1: the columns are w, f, re, im, expected only one named w"));
  EXPECT_THAT(message("w,mag,phase_deg\n1,-2,3\n"),
              HasSubstr("bad.csv:2: mag is -2, expected 0 or more; a column in decibels"));
  EXPECT_THAT(message("w,re,im\n1,2\n"), HasSubstr("bad.csv:2: 2 entries, expected 3"));
  EXPECT_THAT(message("w,re,im\n1,x,3\n"), HasSubstr("'x' is not a finite number"));
  EXPECT_THAT(message("w,re,im\n1,nan,3\n"), HasSubstr("'nan' is not a finite number"));
  EXPECT_THAT(message("w,re,im\n1,1,3\n"), HasSubstr("at least two"));
  EXPECT_THAT(message("w,re,im\n1,0,0\n2,1,1\n"), HasSubstr("other than 0"));
  EXPECT_THAT(message(""), HasSubstr("at least two"));
}

// x' = u with the integral of x: s² + √2 s + 1.
TEST(MatrixLqr, WithIntegralsOfOutputs) {
  const Json lqi =
      printed_json({"lqr", "--A", "0", "--B", "1", "--C", "1", "--Q", "0 0; 0 1", "--R", "1"});
  EXPECT_NEAR(lqi["K"][0][0], std::sqrt(2), 1e-12);
  EXPECT_NEAR(lqi["K_int"][0][0], 1, 1e-12);  // u = -K x + K_int ∫(r - y): K_int = K_i
}

// The law is closed as the documentation states it: u = -K x + K_int i - K_past u[k-1], where i is
// the integral of r - y. With r = 0 the loop has the poles that are printed with it, and with
// constant r its output becomes r.
TEST(MatrixLqr, LawWithIntegralsHasThePrintedPolesAndFollowsTheSetPoint) {
  const auto real_matrix = [](const Json& rows) {
    Eigen::MatrixXd M(rows.size(), rows[0].size());
    for (Eigen::Index i = 0; i < M.rows(); ++i)
      for (Eigen::Index j = 0; j < M.cols(); ++j)
        M(i, j) = rows[static_cast<std::size_t>(i)][static_cast<std::size_t>(j)];
    return M;
  };
  const std::vector<std::string> plant = {
      "lqr", "--A", "0 1; 0 -0.5",           "--B", "0; 4", "--C",
      "1 0", "--Q", "1 0 0; 0 0.1 0; 0 0 2", "--R", "0.2"};
  const Eigen::Matrix2d A{{0, 1}, {0, -0.5}};
  const Eigen::Vector2d B(0, 4);
  {
    const Json lqi = printed_json(plant);
    const Eigen::RowVector2d K = real_matrix(lqi["K"]).leftCols(2);
    const double K_int = lqi["K_int"][0][0];
    Eigen::Matrix3d closed = Eigen::Matrix3d::Zero();  // states x, i with i' = r - x1
    closed.topLeftCorner(2, 2) = A - B * K;
    closed.topRightCorner(2, 1) = B * K_int;
    closed(2, 0) = -1;
    EXPECT_LT(closed.eigenvalues().real().maxCoeff(), -0.5);
    const Eigen::Vector3d rest = closed.fullPivLu().solve(Eigen::Vector3d(0, 0, -1));  // r = 1
    EXPECT_NEAR(rest(0), 1, 1e-12);
  }
  {
    const double dt = 0.05;
    std::vector<std::string> args = plant;
    args.insert(args.end(), {"--sampled", "0.05", "--delay", "1"});
    const Json lqi = printed_json(args);
    const Eigen::MatrixXd Ad = real_matrix(lqi["sampled"]["A"]),
                          Bd = real_matrix(lqi["sampled"]["B"]);
    const Eigen::RowVector2d K = real_matrix(lqi["K"]).leftCols(2);
    const double K_int = lqi["K_int"][0][0], K_past = lqi["K_past"][0][0];
    double i = 0, past = 0;
    Eigen::Vector2d x(0.3, 0);
    for (int k = 0; k < 1000; ++k) {
      const double u = -K * x + K_int * i - K_past * past;
      i += dt * (1 - x(0));
      x = Ad * x + Bd * past;
      past = u;
    }
    EXPECT_NEAR(x(0), 1, 1e-9);
    EXPECT_NEAR(x(1), 0, 1e-9);
  }
}

TEST(MatrixLqr, DelayAndSampledMatrices) {
  const std::vector<std::string> plain = {"lqr",      "--A", "0 1; 0 0", "--B",       "0; 1", "--Q",
                                          "1 0; 0 1", "--R", "1",        "--sampled", "0.1"};
  const Json prompt = printed_json(plain);
  EXPECT_FALSE(prompt.contains("K_past"));
  const Json& sampled = prompt["sampled"];
  EXPECT_NEAR(sampled["A"][0][1], 0.1, 1e-15);
  EXPECT_NEAR(sampled["B"][0][0], 0.005, 1e-15);
  EXPECT_NEAR(sampled["Q"][1][1], 0.1 + 0.001 / 3, 1e-12);  // ∫ t² + 1
  EXPECT_NEAR(sampled["N"][1][0], 0.1 * 0.1 / 2 + 0.1 * 0.1 * 0.1 * 0.1 / 8, 1e-12);
  std::vector<std::string> args = plain;
  args.insert(args.end(), {"--delay", "1"});
  const Json late = printed_json(args);
  // K_x = K A, K_1 = K B.
  const double k1 = prompt["K"][0][0], k2 = prompt["K"][0][1];
  EXPECT_NEAR(late["K"][0][0], k1, 1e-9);
  EXPECT_NEAR(late["K"][0][1], 0.1 * k1 + k2, 1e-9);
  EXPECT_NEAR(late["K_past"][0][0], 0.005 * k1 + 0.1 * k2, 1e-9);
  args = plain;
  args.push_back("--show-sampled");
  EXPECT_THAT(run_program(args).out, HasSubstr("sampled N"));
  expect_refused({"lqr", "--A", "0", "--B", "1", "--Q", "1", "--R", "1", "--delay", "1"},
                 "--delay is in samples");
  expect_refused({"lqr", "--A", "0", "--B", "1", "--Q", "1", "--R", "1", "--D", "1"},
                 "--D requires --C");
  expect_refused({"lqr", "--A", "0", "--B", "1", "--Q", "1", "--R", "1", "--show-sampled"},
                 "--show-sampled requires --sampled");
}

TEST(MatrixKalman, SampledMatrices) {
  const Json filter = printed_json(
      {"kalman", "--A", "0", "--C", "1", "--Q", "2", "--R", "0.5", "--sampled", "0.1"});
  EXPECT_NEAR(filter["sampled"]["Q"][0][0], 0.2, 1e-15);
  EXPECT_NEAR(filter["sampled"]["R"][0][0], 5, 1e-14);
}

// x' = u + w, y = x + v with unit weights and densities: K = L = S = P = 1, J = tr(S W) + K² R P =
// 2.
TEST(MatrixLqg, OfAnIntegratorIsAClosedForm) {
  const Json lqg = printed_json({"lqg", "--A", "0", "--B", "1", "--C", "1", "--Q", "1", "--R", "1",
                                 "--noise-Q", "1", "--noise-R", "1", "--continuous"});
  EXPECT_NEAR(lqg["K"][0][0], 1, 1e-12);
  EXPECT_NEAR(lqg["L"][0][0], 1, 1e-12);
  EXPECT_NEAR(lqg["cost"], 2, 1e-10);
  EXPECT_NEAR(lqg["controller"]["A"][0][0], -2, 1e-12);
  EXPECT_NEAR(lqg["rms"]["states"][0], std::sqrt(1.5), 1e-10);
  // The loop of that controller, by `margins`.
  const Json loop = printed_json({"margins", "--A", "0", "--B", "1", "--C", "1", "--controller-A",
                                  "-2", "--controller-B", "1", "--controller-C", "1"});
  expect_same_margins(lqg["margins"], loop);
  const Json late =
      printed_json({"lqg", "--A", "1", "--B", "1", "--C", "1", "--Q", "1", "--R", "1", "--noise-Q",
                    "1", "--noise-R", "1", "--discrete", "--estimate", "delayed"});
  const Json prompt = printed_json({"lqg", "--A", "1", "--B", "1", "--C", "1", "--Q", "1", "--R",
                                    "1", "--noise-Q", "1", "--noise-R", "1", "--discrete"});
  EXPECT_GT(late["cost"], prompt["cost"]);
  expect_refused({"lqg", "--A", "0", "--B", "1", "--C", "1", "--Q", "1", "--R", "1", "--noise-Q",
                  "1", "--noise-R", "1"},
                 "expected --discrete, --continuous or --sampled DT; the matrices alone");
  expect_refused({"lqg", "mambo", "--noise-Q", "1"}, "--noise-Q applies to matrices only");
  EXPECT_EQ(run_program({"lqg", "--A", "2", "--B", "0", "--C", "1", "--Q", "1", "--R", "1",
                         "--noise-Q", "1", "--noise-R", "1", "--discrete"})
                .status,
            4);
}

TEST(Place, OfADoubleIntegrator) {
  const Json placed =
      printed_json({"place", "--A", "0 1; 0 0", "--B", "0; 1", "--poles", "-1+2i,-1-2i"});
  EXPECT_NEAR(placed["K"][0][0], 5, 1e-12);
  EXPECT_NEAR(placed["K"][0][1], 2, 1e-12);
  EXPECT_EQ(run_program({"place", "--A", "1", "--B", "0", "--poles", "-1"}).status, 4);
  expect_refused({"place", "--A", "1", "--B", "1", "--poles", "x"}, "'x' is not a pole");
  expect_refused({"place", "--A", "1", "--B", "1"}, "--poles is missing");
  EXPECT_THAT(run_program({"place", "--A", "1", "--B", "1", "--poles", "2"}).err,
              HasSubstr("the pole 2 is not in the left half-plane"));
  EXPECT_THAT(run_program({"place", "--A", "1", "--B", "1", "--poles=-2", "--dt", "0.1"}).err,
              HasSubstr("the pole -2 is not inside the unit circle"));
  EXPECT_EQ(run_program({"place", "--A", "1", "--B", "1", "--poles=-2"}).err, "");
  const Json swing = printed_json({"place", "--A", "0 1; 0 0", "--B", "0; 1", "--poles", "2j,-2j"});
  EXPECT_NEAR(swing["K"][0][0], 4, 1e-12);
}

// 1/(s² + 2 ζ s + 1): the peak 1/(2 ζ √(1 - ζ²)) at √(1 - 2 ζ²), the H2 norm 1/(2 √ζ).
TEST(Analyze, OfAnOscillatorIsAClosedForm) {
  const double zeta = 0.1;
  const Json system = printed_json({"analyze", "--num", "1", "--den", "1,0.2,1"});
  EXPECT_NEAR(system["hinf_norm"], 1 / (2 * zeta * std::sqrt(1 - zeta * zeta)), 1e-8);
  EXPECT_NEAR(system["hinf_frequency"], std::sqrt(1 - 2 * zeta * zeta), 1e-4);
  EXPECT_NEAR(system["h2_norm"], 1 / (2 * std::sqrt(zeta)), 1e-10);
  EXPECT_NEAR(system["dc_gain"][0][0], 1, 1e-12);
  EXPECT_TRUE(system["zeros"].empty());
  const Json unstable = printed_json({"analyze", "--num", "1,-2", "--den", "1,0,0"});
  EXPECT_FALSE(unstable["stable"]);
  EXPECT_TRUE(unstable["dc_gain"].is_null());
  EXPECT_TRUE(unstable["hinf_norm"].is_null());
  EXPECT_NEAR(unstable["zeros"][0][0], 2, 1e-12);
  expect_refused({"analyze", "--num", "1", "--den", "1,1", "--A", "1"}, "expected either --A");
}

TEST(DiscretePid, CoefficientsAreThoseOfTheRule) {
  // Kp + Ki dt (1 + z⁻¹)/2 / (1 - z⁻¹) with Kp 2, Ki 1, dt 0.1: (2.05 z - 1.95)/(z - 1).
  const Json pi = printed_json({"pid", "--gains", "2,1", "--dt", "0.1"});
  EXPECT_NEAR(pi["discrete"]["num"][0], 2.05, 1e-12);
  EXPECT_NEAR(pi["discrete"]["num"][1], -1.95, 1e-12);
  EXPECT_NEAR(pi["discrete"]["den"][1], -1, 1e-12);
  EXPECT_THAT(run_program({"pid", "--gains", "2,1", "--dt", "0.1"}).out,
              HasSubstr("u[k] = u[k-1] + 2.05 e[k] - 1.95 e[k-1]"));
  EXPECT_THAT(run_program({"pid", "--gains", "2,1", "--dt", "0.1", "--integrator", "euler"}).out,
              HasSubstr("u[k] = u[k-1] + 2 e[k] - 1.9 e[k-1]"));
  expect_refused({"pid", "--gains", "2,1"}, "--dt is missing");
  expect_refused({"pid", "--num", "1", "--den", "1,1", "--rule", "simc", "--integrator", "euler"},
                 "--integrator requires --dt");
}

TEST(PidRulesOfAPlant, RejectAPlantWithoutDelay) {
  const std::vector<std::string> plant = {"pid", "--num", "1", "--den", "1,1"};
  const auto with = [&](std::vector<std::string> more) {
    more.insert(more.begin(), plant.begin(), plant.end());
    return more;
  };
  for (const char* rule : {"amigo", "ziegler-nichols", "cohen-coon"})
    expect_refused(with({"--rule", rule}), "divides by the delay, and the plant has none");
  expect_refused(with({"--rule", "simc", "--type", "PI"}), "--tau-c is missing");
  EXPECT_NEAR(printed_json(with({"--rule", "simc", "--type", "PI", "--tau-c", "0.5"}))["Kp"], 2,
              1e-12);
  const ProgramResult result = run_program(with({"--rule", "simc"}));
  EXPECT_EQ(result.status, 4);
  EXPECT_THAT(result.err, HasSubstr("a PI requires only one lag"));
  expect_refused(with({}), "the plant has no requirement");
  expect_refused(with({"--rule", "lambda", "--Ms-max", "1.5"}),
                 "--rule and the bounds of --Ms-max are given together");
}

TEST(UltimateRules, FromKuAndTu) {
  const Json zn = printed_json({"pid", "--Ku", "8", "--Tu", "2", "--type", "PI"});
  EXPECT_NEAR(zn["Kp"], 3.6, 1e-12);
  EXPECT_NEAR(zn["Ki"], 3.6 * 1.2 / 2, 1e-12);
  // The same plant, whose ultimate gain is 8.
  const Json plant = printed_json(
      {"pid", "--num", "1", "--den", "1,3,3,1", "--rule", "tyreus-luyben", "--type", "PI"});
  EXPECT_NEAR(plant["Kp"], 8 / 3.2, 1e-8);
  expect_refused({"pid", "--Ku", "8"}, "--Ku and --Tu belong together");
  expect_refused({"pid", "--Ku", "8", "--Tu", "1", "--rule", "simc"}, "expected one of");
  expect_refused(
      {"pid", "--Ku", "8", "--Tu", "3", "--type", "PD"},
      "quadtune pid: --type is PD, expected P or PI or PID for the rule ziegler-nichols");
  expect_refused({"pid", "--num", "1", "--den", "1,3,3,1", "--rule", "amigo", "--type", "P"},
                 "quadtune pid: --rule amigo with --type P: type is P, expected PI or PID because "
                 "the rule has no other types");
  expect_refused({"pid", "--gains", "1,2,3,0.0001", "--dt", "0.01", "--integrator", "euler"},
                 "quadtune pid: --gains: Tf is 0.0001 s, expected more than dt/2");
  EXPECT_EQ(run_program({"pid", "--num", "1", "--den", "1,1", "--rule", "pessen"}).status, 4);
}

TEST(CurveData, OfAPictureAsCsvAndJson) {
  const TemporaryDirectory folder;
  const std::string csv = (folder.path() / "loop.csv").string();
  const std::string json = (folder.path() / "loop.json").string();
  EXPECT_EQ(run_program({"margins", "--num", "25", "--den", "1,10,10,10", "--plot", csv}).status,
            0);
  EXPECT_THAT(folder.read("loop.csv"), ::testing::StartsWith("panel,curve,x,y\n\"Step of"));
  EXPECT_EQ(run_program({"margins", "--num", "25", "--den", "1,10,10,10", "--plot", json}).status,
            0);
  const Json figure = Json::parse(folder.read("loop.json"));
  EXPECT_EQ(figure["panels"].size(), 6U);
  // The last sample of the step is near T(0) = 25/35.
  const Json& step = figure["panels"][0]["curves"][0]["y"];
  EXPECT_NEAR(step[step.size() - 1], 25.0 / 35, 0.02);
}

}  // namespace
}  // namespace quadtune
