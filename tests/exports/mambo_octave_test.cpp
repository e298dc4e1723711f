// SPDX-License-Identifier: Apache-2.0
// Runs the exported parameter files in Octave and compares what they define.
#include <gmock/gmock.h>

#include <Eigen/Geometry>
#include <array>
#include <cstdio>
#include <map>
#include <sstream>

#include "matrix_near.hpp"
#include "plants/export_models.hpp"
#include "quadtune/exports/digital_filter.hpp"
#include "quadtune/exports/mambo.hpp"
#include "temporary_directory.hpp"

namespace quadtune {
namespace {

using testing::mambo_content;
using testing::MatrixNear;
using testing::MatrixRelativelyNear;
using testing::TemporaryDirectory;

// Prints every numeric field of the named structures as "path rows cols numbers…", column by
// column.
const char* const dump_script = R"(
function dump(name, value)
  if isstruct(value)
    for [field, key] = value
      dump([name "." key], field);
    end
  elseif isnumeric(value)
    printf("%s %d %d", name, rows(value), columns(value));
    printf(" %.17g", value);
    printf("\n");
  end
end
vehicleVars; controllerVars; estimatorVars; sensorsVars;
dump("g", g); dump("rho", rho);
dump("Vehicle", Vehicle); dump("Controller", Controller); dump("Estimator", Estimator);
dump("Sensors", Sensors);
)";

class MamboOctave : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    if (std::system("octave-cli --version > /dev/null 2>&1") != 0) return;
    const TemporaryDirectory directory;
    write_files(directory.path(), mambo_files(mambo_content()));
    directory.write("quadtune_dump.m", std::string("1;\n") + dump_script);
    const std::string command = "cd " + directory.path().string() +
                                " && octave-cli --no-init-file quadtune_dump.m 2> errors.txt";
    std::FILE* pipe = ::popen(command.c_str(), "r");
    ASSERT_NE(pipe, nullptr);
    std::string out;
    std::array<char, 4096> block{};
    while (const std::size_t n = std::fread(block.data(), 1, block.size(), pipe))
      out.append(block.data(), n);
    ASSERT_EQ(::pclose(pipe), 0) << directory.read("errors.txt");
    std::istringstream lines(out);
    for (std::string line; std::getline(lines, line);) {
      std::istringstream words(line);
      std::string name;
      Eigen::Index rows = 0;
      Eigen::Index cols = 0;
      words >> name >> rows >> cols;
      Eigen::MatrixXd M(rows, cols);
      for (double& entry : M.reshaped()) words >> entry;
      values()[name] = M;
    }
  }

  void SetUp() override {
    if (values().empty()) GTEST_SKIP() << "Octave is not installed";
  }

  static std::map<std::string, Eigen::MatrixXd>& values() {
    static std::map<std::string, Eigen::MatrixXd> all;
    return all;
  }

  static Eigen::MatrixXd get(const std::string& name) {
    EXPECT_EQ(values().count(name), 1U) << name;
    return values()[name];
  }
};

TEST_F(MamboOctave, DefinesEveryListedField) {
  for (const char* field : {"mass", "inertia", "d", "xy", "h", "Cdx", "Cdy", "diameter"})
    EXPECT_GT(get(std::string("Vehicle.Airframe.") + field).size(), 0) << field;
  for (const char* field :
       {"blades", "radius", "chord", "Ct", "Cq", "area", "b", "k", "inertia", "w2ToThrustGain"})
    EXPECT_GT(get(std::string("Vehicle.Rotor.") + field).size(), 0) << field;
  for (const char* field : {"maxLimit", "minLimit", "commandToW2Gain", "thrustToMotorCommand"})
    EXPECT_GT(get(std::string("Vehicle.Motor.") + field).size(), 0) << field;
  for (const char* filter : {"alt.kf.", "pos.kfVelo."})
    for (const char* field : {"G", "H", "Q", "R", "N"})
      EXPECT_GT(get(std::string("Estimator.") + filter + field).size(), 0) << filter << field;
}

// Every number in the files, as read by Octave.
TEST_F(MamboOctave, ReadsEveryNumberAsTheSameDouble) {
  int compared = 0;
  for (const FileContent& file : mambo_files(mambo_content()))
    for (const NamedMatrix& number : parse_m_numbers(file.bytes, file.name)) {
      EXPECT_THAT(get(number.name), MatrixNear(number.value, 0)) << number.name;
      ++compared;
    }
  EXPECT_GT(compared, 60);
}

// Values of the public project, single precision there.
TEST_F(MamboOctave, ComputesThePublishedMixer) {
  Eigen::Matrix4d expected;
  expected << 0.25, 103.573624, -5.66592, -5.66592,  //
      0.25, -103.573624, -5.66592, 5.66592,          //
      0.25, 103.573624, 5.66592, 5.66592,            //
      0.25, -103.573624, 5.66592, -5.66592;
  const Eigen::MatrixXd Q2Ts = get("Controller.Q2Ts");
  EXPECT_THAT(Q2Ts.col(0), MatrixNear(expected.col(0), 1e-15));
  EXPECT_THAT(Q2Ts.col(1), MatrixNear(expected.col(1), 1e-5));
  EXPECT_THAT(Q2Ts.rightCols(2), MatrixNear(expected.rightCols(2), 1e-5));
  EXPECT_THAT(get("Controller.Ts2Q") * Q2Ts, MatrixNear(Eigen::MatrixXd::Identity(4, 4), 1e-14));
  EXPECT_NEAR(get("Controller.Ts2Q")(1, 0), 2.41373e-3, 2e-8);
  EXPECT_NEAR(get("Vehicle.Rotor.b")(0, 0), 4.7199903669e-8, 1e-17);
  EXPECT_NEAR(get("Vehicle.Rotor.k")(0, 0), 1.13928386e-10, 1e-17);
  EXPECT_NEAR(get("Vehicle.Motor.thrustToMotorCommand")(0, 0), 1530.72683, 1e-4);
  EXPECT_NEAR(4 * get("Controller.totalThrustMaxRelative")(0, 0) *
                  get("Controller.motorsThrustPerMotorMax")(0, 0),
              1.20204335, 1e-7);
  EXPECT_EQ(get("Controller.takeoffGain")(0, 0), 0.45);
}

// What Octave computes from Vehicle.* equals what quadtune computes from the same vehicle.
TEST_F(MamboOctave, ComputesTheVehiclesCurvesAndMixer) {
  const Vehicle vehicle = mambo_content().vehicle;
  EXPECT_DOUBLE_EQ(get("Vehicle.Rotor.b")(0, 0), vehicle.rotors[0].thrust_a2);
  EXPECT_DOUBLE_EQ(get("Vehicle.Rotor.k")(0, 0), vehicle.rotors[0].torque_d2);
  // Thrust of rotor i is -Ts(i) along body -z: torque r × F, and drag against the spin.
  Eigen::Matrix4d Ts2Q;
  for (int i = 0; i < 4; ++i) {
    const Rotor& rotor = vehicle.rotors[static_cast<std::size_t>(i)];
    Ts2Q.col(i) << 1, spin_sign(rotor.spin) * rotor.torque_d2 / rotor.thrust_a2,
        -rotor.position.x(), rotor.position.y();
  }
  EXPECT_THAT(get("Controller.Ts2Q"), MatrixNear(Ts2Q, 1e-16));
}

// The state feedback through the mixer: more roll torque is more thrust on the left.
TEST_F(MamboOctave, MapsTheWrenchToTheMixersOrder) {
  const Eigen::MatrixXd to_thrusts =
      get("Controller.Q2Ts") * get("Controller.StateFeedback.toQ2Ts");
  const Vehicle vehicle = mambo_content().vehicle;
  for (int input = 0; input < 4; ++input) {
    Eigen::Vector4d made = Eigen::Vector4d::Zero();
    for (int i = 0; i < 4; ++i) {
      const Rotor& rotor = vehicle.rotors[static_cast<std::size_t>(i)];
      const double thrust = -to_thrusts(i, input);  // magnitude, along body -z
      const Eigen::Vector3d force(0, 0, -thrust);
      const Eigen::Vector3d torque = rotor.position.cross(force);
      made += Eigen::Vector4d(thrust, torque.x(), torque.y(),
                              -spin_sign(rotor.spin) * thrust * rotor.torque_d2 / rotor.thrust_a2);
    }
    EXPECT_THAT(made, MatrixNear(Eigen::Vector4d::Unit(input), 1e-14)) << input;
  }
}

TEST_F(MamboOctave, PairsTheCascadeAsPitchThenRoll) {
  EXPECT_THAT(get("Controller.Cascade.position.Kp"),
              MatrixNear(Eigen::RowVector2d(-0.24, 0.24), 0));
  EXPECT_THAT(get("Controller.Cascade.position.Kd"), MatrixNear(Eigen::RowVector2d(0.1, -0.1), 0));
  EXPECT_THAT(get("Controller.Cascade.attitude.Kp"),
              MatrixNear(Eigen::RowVector2d(0.013, 0.01), 0));
  EXPECT_EQ(get("Controller.Cascade.altitude.Kp")(0, 0), 0.8);
}

}  // namespace
}  // namespace quadtune
