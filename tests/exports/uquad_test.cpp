// SPDX-License-Identifier: Apache-2.0
#include "quadtune/exports/uquad.hpp"

#include <gmock/gmock.h>

#include <clocale>
#include <cstdio>
#include <limits>
#include <random>

#include "matrix_near.hpp"
#include "plants/export_models.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/estimation/uquad_filter.hpp"
#include "shared_data.hpp"
#include "temporary_directory.hpp"

namespace quadtune {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using testing::hover_gains;
using testing::MatrixNear;
using testing::sampled_uquad;
using testing::TemporaryDirectory;
using ::testing::ThrowsMessage;

// A gain whose entries encode their row and column.
Gains numbered(const std::vector<std::string>& states, const std::vector<std::string>& integrals) {
  Gains gains;
  for (const std::string& name : states) gains.states.push_back({name, ""});
  for (const std::string& name : integrals) gains.integrals.push_back({name, ""});
  gains.inputs = {{"w1", ""}, {"w2", ""}, {"w3", ""}, {"w4", ""}};
  const auto nx = static_cast<Eigen::Index>(states.size());
  const auto ni = static_cast<Eigen::Index>(integrals.size());
  gains.K.resize(4, nx);
  gains.K_int.resize(4, ni);
  for (int i = 0; i < 4; ++i) {
    for (int j = 0; j < nx; ++j) gains.K(i, j) = 100 * (i + 1) + j + 1;
    for (int j = 0; j < ni; ++j) gains.K_int(i, j) = -100 * (i + 1) - j - 1;
  }
  gains.x0 = Eigen::VectorXd::Zero(nx);
  gains.u0 = Eigen::VectorXd::Zero(4);
  gains.convention = "uquad";
  gains.dt = 0.01;
  return gains;
}

std::vector<std::string> names_of(const std::vector<FileContent>& files) {
  std::vector<std::string> names;
  names.reserve(files.size());
  for (const FileContent& file : files) names.push_back(file.name);
  return names;
}

const std::vector<std::string> full = {"x",   "y",   "z",   "psi", "phi", "theta",
                                       "vqx", "vqy", "vqz", "wqx", "wqy", "wqz"};
const std::vector<std::string> reduced = {"z", "psi", "phi", "theta", "vqz", "wqx", "wqy", "wqz"};

TEST(Uquad, PicksTheFilesOfEachBuild) {
  EXPECT_THAT(names_of(uquad_files(numbered(reduced, {}), {}, {})), ElementsAre("K.txt"));
  EXPECT_THAT(names_of(uquad_files(numbered(reduced, {"z", "theta"}), {}, {})),
              ElementsAre("K_prop.txt", "K_int.txt"));
  EXPECT_THAT(names_of(uquad_files(numbered(full, {}), {}, {})), ElementsAre("K_full.txt"));
  EXPECT_THAT(names_of(uquad_files(numbered(full, {"x", "y", "z", "theta"}), {}, {})),
              ElementsAre("K_prop_full.txt", "K_int_full.txt"));
  EXPECT_THAT(names_of(uquad_files(numbered(full, {"psi", "phi", "z", "theta"}), {}, {})),
              ElementsAre("K_prop_full_pptz.txt", "K_int_full_pptz.txt"));
}

// The pptz build integrates z between phi and theta, unlike the order of the states.
TEST(Uquad, PutsColumnsInTheOrderOfTheFile) {
  std::vector<std::string> turned = {"wqz",   "wqy", "wqx", "vqz", "vqy", "vqx",
                                     "theta", "phi", "psi", "z",   "y",   "x"};
  const Gains gains = numbered(turned, {"z", "psi", "phi", "theta"});
  Eigen::MatrixXd Q = Eigen::MatrixXd::Zero(16, 16);
  for (int i = 0; i < 16; ++i) Q(i, i) = i + 1;
  const std::vector<FileContent> files = uquad_files(gains, Q, Eigen::MatrixXd::Identity(4, 4));
  ASSERT_THAT(names_of(files),
              ElementsAre("K_prop_full_pptz.txt", "K_int_full_pptz.txt", "lqr-Q.txt", "lqr-R.txt"));
  const Eigen::MatrixXd K = parse_uquad_matrix(files[0].bytes, 4, 12, "K");
  EXPECT_EQ(K(0, 0), 112);   // x was last
  EXPECT_EQ(K(3, 11), 401);  // wqz was first
  const Eigen::MatrixXd K_int = parse_uquad_matrix(files[1].bytes, 4, 4, "K_int");
  EXPECT_THAT(K_int.row(0), MatrixNear(Eigen::RowVector4d(-102, -103, -101, -104), 0));
  const Eigen::MatrixXd Q_read = parse_uquad_matrix(files[2].bytes, 16, 16, "Q");
  EXPECT_EQ(Q_read(0, 0), 12);
  EXPECT_EQ(Q_read(14, 14), 13);  // z stood first among the integrals
}

// Variances are converted with the axes: in the uquad's own names, T diag(Q) Tᵀ.
TEST(Uquad, TurnsTheFiltersDiagonals) {
  UquadFilterSettings<double> settings;
  for (int i = 0; i < kUquadStates; ++i) settings.Q(i) = i + 1;
  const UquadDiagonals noise = uquad_diagonals(settings);
  const auto& T = convention("uquad", "test").from_ned;
  const Eigen::MatrixXd turned =
      T * Eigen::MatrixXd(settings.Q.head<12>().asDiagonal()) * T.transpose();
  EXPECT_THAT(noise.Q.head(12), MatrixNear(turned.diagonal(), 0));
  // The accelerometer's axes are those of the body's velocity.
  EXPECT_THAT(noise.Q.tail(3), MatrixNear(noise.Q.segment(6, 3).array() + 6, 0));
  EXPECT_THAT(noise.R, MatrixNear((Eigen::VectorXd(16) << 10, 10, 1000, 1e4, 1e4, 1e4, 100, 100,
                                   100, 1000, 100, 100, 100, 100, 100, 100)
                                      .finished(),
                                  0));
}

TEST(Uquad, SaysWhichBuildsExist) {
  const auto refusal = [](const Gains& gains, const std::string& message) {
    EXPECT_THAT([&] { (void)uquad_file_set(gains); },
                ThrowsMessage<InvalidInput>(HasSubstr(message)));
  };
  refusal(
      numbered(reduced, {"z"}),
      "no build of the flight program has the states z psi phi theta vqz wqx wqy wqz with the "
      "integrals 'z', expected the states and integrals of one of K.txt, K_prop.txt, K_full.txt, "
      "K_prop_full.txt");
  Gains gains = numbered(full, {});
  gains.convention = "ned";
  refusal(gains, "the gain is in the convention 'ned', expected 'uquad'");
  gains = numbered(full, {});
  gains.input_kind = InputKind::wrench;
  refusal(gains, "commands 4 inputs of kind wrench, expected 4 of kind rotor-speed");
  gains = numbered(full, {});
  gains.sign_law = SignLaw::state_minus_set_point;
  refusal(gains, "sign law is state-minus-set-point, expected set-point-minus-state");
  gains = numbered(full, {});
  gains.K(1, 2) = std::numeric_limits<double>::quiet_NaN();
  refusal(gains, "K has nan at (2,3), expected finite numbers");
}

// Read like in the flight program: fscanf("%lf") of rows × columns numbers.
TEST(UquadText, ScansBackToTheSameDoubles) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> exponent(-30, 30);
  Eigen::MatrixXd M(4, 12);
  for (double& entry : M.reshaped())
    entry = std::ldexp(std::uniform_real_distribution<double>(-1, 1)(random),
                       static_cast<int>(exponent(random)));
  M(0, 0) = -0.0;
  M(0, 1) = std::numeric_limits<double>::denorm_min();
  M(0, 2) = std::numeric_limits<double>::max();
  const std::string text = uquad_matrix_text(M, "K");
  const char* at = text.c_str();
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 12; ++j) {
      double scanned = 0;
      int length = 0;
      ASSERT_EQ(std::sscanf(at, "%lf%n", &scanned, &length), 1);
      at += length;
      EXPECT_EQ(scanned, M(i, j));
    }
  EXPECT_STREQ(at, "\n");
  EXPECT_THAT(parse_uquad_matrix(text, 4, 12, "K"), MatrixNear(M, 0));
}

TEST(UquadText, AlignsColumnsAndEndsTheLastLine) {
  EXPECT_EQ(uquad_matrix_text(Eigen::Matrix2d{{1, -2.5}, {1e-100, 0}}, "K"),
            "  1.0000000000000000e+00 -2.5000000000000000e+00\n"
            " 1.0000000000000000e-100  0.0000000000000000e+00\n");
}

TEST(UquadText, RefusesWhatTheFlightProgramWouldMisread) {
  const auto refusal = [](const std::string& text, const std::string& message) {
    EXPECT_THAT([&] { (void)parse_uquad_matrix(text, 2, 2, "K.txt"); },
                ThrowsMessage<InvalidInput>(HasSubstr(message)))
        << text;
  };
  refusal("1 2\n3 4 5\n", "K.txt:2: has 3 numbers, expected 2");
  refusal("1 2\n3\n", "K.txt:2: has 1 number, expected 2");
  refusal("1 2\n3 4\n5 6\n", "K.txt:3: has more than 2 rows, expected 2x2");
  refusal("1 2\n", "K.txt: ends after 1 row, expected 2x2");
  refusal("", "K.txt: ends after 0 rows, expected 2x2");
  refusal("1 2\n3 nan\n", "K.txt:2: 'nan' is not a finite number");
  refusal("1 2\n3 -inf\n", "K.txt:2: '-inf' is not a finite number");
  refusal("1 2\n3 1e999\n", "K.txt:2: '1e999' is not a finite number");
  refusal("1 2\n3 4,5\n", "K.txt:2: '4,5' has a comma, expected a decimal point");
  refusal("% K\n1 2\n3 4\n", "K.txt:1: '%' is not a finite number");
  refusal("1 2\n3 4.0000e\n", "K.txt:2: '4.0000e' is not a finite number");
  refusal("1 2 3 4\n", "K.txt:1: has 4 numbers, expected 2");
  refusal("1 +-2\n3 4\n", "K.txt:1: '+-2' is not a finite number");
}

TEST(UquadText, AcceptsWhatScanningAccepts) {
  const Eigen::Matrix2d M{{1, 2}, {3, 4e5}};
  EXPECT_THAT(parse_uquad_matrix("\t+1 2\r\n\r\n3   4e5", 2, 2, "K"), MatrixNear(M, 0));
}

TEST(Uquad, ReadsABuildFromItsDirectoryOrEitherFile) {
  const TemporaryDirectory directory;
  const Gains gains = numbered(full, {"x", "y", "z", "theta"});
  write_files(directory.path(), uquad_files(gains, {}, {}));
  for (const char* name : {"", "K_prop_full.txt", "K_int_full.txt"}) {
    const Gains read = read_uquad_gains(directory.path() / name);
    EXPECT_THAT(read.K, MatrixNear(gains.K, 0));
    EXPECT_THAT(read.K_int, MatrixNear(gains.K_int, 0));
    EXPECT_EQ(names(read.states), names(gains.states));
    EXPECT_EQ(read.integrals.front(), (Signal{"x", "m s"}));
  }
  directory.write("K.txt", "");
  EXPECT_THAT(
      [&] { (void)read_uquad_gains(directory.path()); },
      ThrowsMessage<InvalidInput>(HasSubstr(
          "has the gains of several builds of the flight program (K.txt, K_prop_full.txt)")));
  const TemporaryDirectory empty;
  EXPECT_THAT([&] { (void)read_uquad_gains(empty.path()); },
              ThrowsMessage<InvalidInput>(HasSubstr("has no gain files of uquad")));
}

TEST(Uquad, ReadsThePublishedFiles) {
  QUADTUNE_REQUIRE_DATA(path);
  const Gains full_gains = read_uquad_gains(path / "uquad" / "K_full.txt");
  EXPECT_NEAR(full_gains.K(0, 0), -6.4219919, 1e-7);
  const Gains integral = read_uquad_gains(path / "uquad" / "K_prop_full.txt");
  EXPECT_NEAR(integral.K_int(0, 3), -4.7312816, 1e-7);
  EXPECT_EQ(read_uquad_gains(path / "uquad" / "K.txt").K.cols(), 8);
}

}  // namespace
}  // namespace quadtune
