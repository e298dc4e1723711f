// SPDX-License-Identifier: Apache-2.0
#include "quadtune/linearize/linearize.hpp"

#include <gmock/gmock.h>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <cmath>
#include <complex>
#include <random>
#include <unsupported/Eigen/MatrixFunctions>

#include "integrate.hpp"
#include "matrix_near.hpp"
#include "plants/hover_model.hpp"
#include "plants/sample_vehicles.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/model/rigid_body.hpp"

namespace quadtune {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using testing::integrate;
using ::testing::IsEmpty;
using testing::MatrixNear;
using testing::plus_quadrotor;
using testing::random_vehicle;
using ::testing::ThrowsMessage;
using testing::uquad_hover;

using State = StateVector<double>;
using Speeds = RotorSpeeds<double>;

const FlightCondition kHover = {.kind = FlightKind::hover};

LinearizeOptions in(const std::string& convention, InputKind inputs = InputKind::rotor_speed) {
  return {.convention = convention, .inputs = inputs, .states = {}};
}
StateSelection list(const std::vector<std::string>& names) {
  return {StateSelection::Kind::list, names};
}

// The published model without an offset of the centre of mass, in closed form.
TEST(Linearize, UquadHoverIsThePublishedModel) {
  const Linearization model = linearize(load_vehicle("uquad"), kHover, in("uquad"));
  ASSERT_TRUE(model.solved()) << model.trim.culprit;
  const ContinuousLti published = uquad_hover();
  EXPECT_THAT(model.plant.A, MatrixNear(published.A, 1e-12));
  EXPECT_THAT(model.plant.B, MatrixNear(published.B, 1e-12));
  EXPECT_THAT(model.u0, MatrixNear(Eigen::Vector4d::Constant(316.103650939028), 1e-10));
  EXPECT_THAT(model.x0, MatrixNear(Eigen::VectorXd::Zero(12), 1e-12));
  EXPECT_THAT(model.x0_rate, MatrixNear(Eigen::VectorXd::Zero(12), 1e-12));
  EXPECT_EQ(model.plant.states, published.states);
  EXPECT_EQ(model.plant.inputs, published.inputs);
  EXPECT_THAT(model.notes, IsEmpty());
}

// phi'' = τx/Ixx, vx' = -g theta, vy' = g phi, T along -z.
TEST(Linearize, RefusesNumbersThatAreTooFarApart) {
  Vehicle vehicle = load_vehicle("mambo");
  vehicle.inertia *= 1e-20;
  for (Rotor& rotor : vehicle.rotors) rotor.position *= 1e300;
  EXPECT_THAT([&] { (void)linearize(vehicle, kHover); },
              ThrowsMessage<InvalidInput>(HasSubstr("B of mambo has")));
}

TEST(Linearize, MamboHoverByWrenchIsTheClosedForm) {
  const Vehicle vehicle = load_vehicle("mambo");
  const Linearization model = linearize(vehicle, kHover, in("mambo", InputKind::wrench));
  ASSERT_TRUE(model.solved()) << model.trim.culprit;
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(12, 12);
  A.block<3, 3>(0, 3).setIdentity();
  A.block<3, 3>(6, 9).setIdentity();
  A(9, 1) = -9.81;
  A(10, 0) = 9.81;
  Eigen::MatrixXd B = Eigen::MatrixXd::Zero(12, 4);
  B(3, 1) = 1 / 5.82857e-5;
  B(4, 2) = 1 / 7.16914e-5;
  B(5, 3) = 1 / 1.0e-4;
  B(11, 0) = -1 / 0.063;
  EXPECT_THAT(model.plant.A, MatrixNear(A, 1e-12));
  EXPECT_THAT(model.plant.B, MatrixNear(B, 1e-10));
  EXPECT_THAT(model.u0, MatrixNear(Eigen::Vector4d(0.063 * 9.81, 0, 0, 0), 1e-12));
  EXPECT_EQ(names(model.plant.inputs), "T tau_x tau_y tau_z");
}

TEST(Linearize, YawTurnsOnlyTheRowsOfThePosition) {
  const Vehicle vehicle = plus_quadrotor();
  const Linearization north = linearize(vehicle, kHover);
  const double yaw = 0.8;
  const Linearization turned = linearize(vehicle, {.kind = FlightKind::hover, .yaw = yaw});
  EXPECT_THAT(turned.plant.A.bottomRows(9), MatrixNear(north.plant.A.bottomRows(9), 1e-13));
  EXPECT_THAT(turned.plant.B, MatrixNear(north.plant.B, 1e-13));
  const Eigen::Matrix3d Rz = rotation_of_euler(0.0, 0.0, yaw);
  EXPECT_THAT(turned.plant.A.block(0, 6, 3, 3), MatrixNear(Rz, 1e-13));
}

TEST(Linearize, EqualsCentralDifferencesInEveryFlight) {
  std::mt19937_64 random(21);
  for (const FlightCondition& flight : {kHover, FlightCondition{FlightKind::line, 0.5, 6, 1, 0},
                                        FlightCondition{FlightKind::circle, -1.0, 5, 0.5, 8}}) {
    const Vehicle vehicle = random_vehicle(random, 6);
    const RigidBody body(vehicle);
    const Linearization model = linearize(vehicle, flight);
    ASSERT_TRUE(model.solved()) << model.trim.culprit;
    const State x = model.trim.x;
    const Speeds w = model.trim.u;
    Eigen::MatrixXd J(12, 18);
    for (int j = 0; j < 18; ++j) {
      const double h = j < 12 ? 1e-5 : 1e-2;
      const auto at = [&](double step) -> State {
        State xs = x;
        Speeds ws = w;
        (j < 12 ? xs(j) : ws(j - 12)) += step;
        return state_derivative(body, xs, rotor_loads(body, ws));
      };
      J.col(j) = (at(h) - at(-h)) / (2 * h);
    }
    J(0, 1) += model.trim.yaw_rate;  // axes of the position turn with the heading
    J(1, 0) -= model.trim.yaw_rate;
    // At rest the differences of the quadratic drag |v| v are of first order in h: rho cda h / (2
    // m).
    EXPECT_THAT(model.plant.A, MatrixNear(J.leftCols(12), 5e-7));
    EXPECT_THAT(model.plant.B, MatrixNear(J.rightCols(6), 1e-8));
  }
}

// A flight off the trim by e, against the linear prediction, in the turning axes of a circle: what
// is left is of second order, so half the e leaves a quarter.
TEST(Linearize, PredictsFlightsNearTheTrimToSecondOrder) {
  std::mt19937_64 random(22);
  Vehicle vehicle = random_vehicle(random, 4);
  const RigidBody body(vehicle);
  for (const FlightCondition& flight : {kHover, FlightCondition{FlightKind::line, 0.5, 6, 1, 0},
                                        FlightCondition{FlightKind::circle, -1.0, 5, 0.5, 8},
                                        FlightCondition{FlightKind::circle, 2.0, 4, 0, -5}}) {
    const Linearization model = linearize(vehicle, flight);
    ASSERT_TRUE(model.solved()) << model.trim.culprit;
    const double t = 0.5, turn = model.trim.yaw_rate;
    State direction;
    direction << 1, -2, 1, 0.1, -0.1, 0.2, 0.5, -0.5, 0.3, 0.1, 0.2, -0.1;
    const Eigen::Vector4d push(0.5, -1, 2, 1);  // rad/s, held
    Eigen::MatrixXd augmented = Eigen::MatrixXd::Zero(13, 13);
    augmented << model.plant.A, model.plant.B * push, Eigen::RowVectorXd::Zero(13);
    Eigen::VectorXd start(13);
    start << direction, 1;
    const Eigen::VectorXd predicted = Eigen::MatrixXd((augmented * t).exp()) * start;
    const auto flown = [&](double e) -> State {
      const Speeds w = model.trim.u + e * push;
      return integrate(
          [&](const State& x) -> State { return state_derivative(body, x, rotor_loads(body, w)); },
          State(model.trim.x + e * direction), t / 2000, 2000);
    };
    const State trim_end = flown(0);
    const auto error = [&](double e) {
      State deviation = flown(e) - trim_end;
      deviation.head<3>() = rotation_of_euler(0.0, 0.0, turn * t).transpose() * deviation.head<3>();
      return (deviation - e * predicted.head(12)).norm();
    };
    const double ratio = error(2e-3) / error(1e-3);
    EXPECT_NEAR(ratio, 4, 0.1) << to_string(flight.kind);
    EXPECT_LT(error(1e-3), 1e-3);
  }
}

TEST(Linearize, ConventionsHoldTheSameSystem) {
  std::mt19937_64 random(23);
  Vehicle vehicle = random_vehicle(random, 4);
  const FlightCondition line = {FlightKind::line, 0.3, 4, 0.5, 0};
  const Linearization ned = linearize(vehicle, line);
  for (const std::string name : {"uquad", "mambo"}) {
    const Linearization other = linearize(vehicle, line, in(name));
    const Eigen::MatrixXd M = convention(name, "test").from_ned;
    EXPECT_THAT(M.transpose() * other.plant.A * M, MatrixNear(ned.plant.A, 1e-15));
    EXPECT_THAT(M.transpose() * other.plant.B, MatrixNear(ned.plant.B, 1e-15));
    EXPECT_THAT(other.x0, MatrixNear(M * ned.x0, 0));
    EXPECT_THAT(other.x0_rate, MatrixNear(M * ned.x0_rate, 0));
    // Similar matrices have the same characteristic polynomial, evaluated at a few points.
    for (const std::complex<double> s : {std::complex<double>(1, 2), {-3, 1}, {0.5, 0}}) {
      const Eigen::MatrixXcd I = Eigen::MatrixXcd::Identity(12, 12);
      const std::complex<double> a = (s * I - ned.plant.A).determinant();
      EXPECT_LT(std::abs((s * I - other.plant.A).determinant() - a), 1e-10 * std::abs(a));
    }
  }
}

// The wrench of the convention has its own signs: z up turns pitch and yaw torque around.
TEST(Linearize, WrenchOfTheUquadHasItsAxes) {
  const Linearization model = linearize(plus_quadrotor(), kHover, in("uquad", InputKind::wrench));
  Eigen::MatrixXd B = Eigen::MatrixXd::Zero(12, 4);
  B(8, 0) = 1 / 1.741;  // thrust lifts, z up
  B(9, 1) = B(10, 2) = 1 / 2.32e-2;
  B(11, 3) = 1 / 4.37e-2;
  EXPECT_THAT(model.plant.A, MatrixNear(uquad_hover().A, 1e-12));
  EXPECT_THAT(model.plant.B, MatrixNear(B, 1e-12));
}

TEST(Linearize, InputsFollowTheChainRule) {
  const Vehicle uquad = plus_quadrotor();
  const Linearization speed = linearize(uquad, kHover);
  const Linearization thrust = linearize(uquad, kHover, in("ned", InputKind::rotor_thrust));
  const double w0 = speed.u0(0), dT = 2 * 4.60160135072435e-5 * w0 - 0.00103822726273726;
  EXPECT_THAT(thrust.plant.B * dT, MatrixNear(speed.plant.B, 1e-14));
  EXPECT_THAT(thrust.u0, MatrixNear(Eigen::Vector4d::Constant(1.741 * 9.81 / 4), 1e-12));
  EXPECT_EQ(names(thrust.plant.inputs), "T1 T2 T3 T4");
  const Linearization same = linearize(uquad, kHover, in("ned", InputKind::command));
  EXPECT_THAT(same.plant.B, MatrixNear(speed.plant.B, 0));  // the command is the speed

  const Vehicle mambo = load_vehicle("mambo");
  const Linearization by_speed = linearize(mambo, kHover);
  const Linearization counts = linearize(mambo, kHover, in("ned", InputKind::command));
  EXPECT_THAT(counts.plant.B, MatrixNear(by_speed.plant.B * 13840.8 / (2 * by_speed.u0(0)), 1e-12));
  EXPECT_NEAR(counts.u0(0), 236.5088, 5e-5);
  EXPECT_EQ(counts.plant.inputs.front().unit, "count");
}

TEST(Linearize, ThinAirEntersTheThrustInput) {
  const Vehicle vehicle = plus_quadrotor();
  const TrimOptions thin = {.density_ratio = 0.9};
  const Linearization model = linearize(vehicle, kHover, in("ned", InputKind::rotor_thrust), thin);
  ASSERT_TRUE(model.solved()) << model.trim.culprit;
  EXPECT_THAT(model.plant.B.row(8), MatrixNear(Eigen::RowVector4d::Constant(-1 / 1.741), 1e-13));
}

TEST(Linearize, WithoutPositionKeepsTheEightStatesOfTheUquad) {
  LinearizeOptions options = in("uquad");
  options.states.kind = StateSelection::Kind::no_position;
  const Linearization model = linearize(plus_quadrotor(), kHover, options);
  EXPECT_EQ(names(model.plant.states), "z psi phi theta vqz wqx wqy wqz");
  EXPECT_THAT(model.notes, IsEmpty());
  const std::vector<int> kept = {2, 3, 4, 5, 8, 9, 10, 11};
  EXPECT_THAT(model.plant.A, MatrixNear(uquad_hover().A(kept, kept), 1e-12));
  EXPECT_EQ(model.plant.B.rows(), 8);
  options.convention = "mambo";
  EXPECT_EQ(names(linearize(plus_quadrotor(), kHover, options).plant.states),
            "phi theta psi phidot thetadot psidot pz pzdot");
}

TEST(Linearize, AListKeepsItsOrderAndNotesOmittedStates) {
  LinearizeOptions options = in("uquad");
  options.states = list({"wqz", "theta"});
  const Linearization yaw = linearize(plus_quadrotor(), kHover, options);
  EXPECT_THAT(yaw.plant.A, MatrixNear((Eigen::Matrix2d() << 0, 0, 1, 0).finished(), 1e-13));
  EXPECT_THAT(yaw.notes, IsEmpty());
  options.states = list({"x", "vqx"});
  EXPECT_THAT(linearize(plus_quadrotor(), kHover, options).notes,
              ElementsAre("vqx depends on phi, which is not among the states"));
}

TEST(Linearize, ACircleNotesThatItsAxesRotate) {
  const FlightCondition circle = {FlightKind::circle, 0, 2, 0, 4};
  EXPECT_THAT(linearize(plus_quadrotor(), circle).notes,
              ElementsAre("deviations of px, py are along axes that turn with the heading, at 0.5 "
                          "rad/s clockwise seen from above"));
}

TEST(Linearize, ALineWithoutDragNotesThatItCostsNothing) {
  const FlightCondition line = {FlightKind::line, 0, 500};
  EXPECT_THAT(linearize(plus_quadrotor(), line).notes,
              ElementsAre("the vehicle file gives no drag, so that flight at 500 m/s requires no "
                          "tilt and no additional thrust, and has no speed limit"));
  Vehicle with_drag = plus_quadrotor();
  with_drag.drag.cda.setConstant(1e-6);
  EXPECT_THAT(linearize(with_drag, {FlightKind::line, 0, 5}).notes, IsEmpty());
  EXPECT_THAT(linearize(plus_quadrotor(), kHover).notes, IsEmpty());
}

TEST(Linearize, WithoutATrimThereAreNoNumbers) {
  Vehicle vehicle = plus_quadrotor();
  vehicle.mass = 5;
  const Linearization model = linearize(vehicle, kHover, in("uquad"));
  EXPECT_FALSE(model.solved());
  EXPECT_THAT(model.trim.culprit, HasSubstr("N short"));
  EXPECT_TRUE(model.plant.A.array().isNaN().all());
  EXPECT_TRUE(model.plant.B.array().isNaN().all());
  EXPECT_EQ(model.plant.A.rows(), 12);
  EXPECT_EQ(names(model.plant.inputs), "w1 w2 w3 w4");
}

TEST(Linearize, RefusesBadSelections) {
  const auto refusal = [](const std::vector<std::string>& states) {
    return [states] {
      LinearizeOptions options = in("uquad");
      options.states = list(states);
      (void)linearize(plus_quadrotor(), kHover, options);
    };
  };
  EXPECT_THAT(
      refusal({"z", "thetta"}),
      ThrowsMessage<InvalidInput>(HasSubstr(
          "linearize: no state 'thetta' in convention 'uquad', expected names from x y z psi "
          "phi theta vqx vqy vqz wqx wqy wqz; did you mean 'theta'?")));
  EXPECT_THAT(refusal({"z", "z"}),
              ThrowsMessage<InvalidInput>(HasSubstr("state 'z' is listed twice")));
  EXPECT_THAT(refusal({}), ThrowsMessage<InvalidInput>(HasSubstr("the list of states is empty")));
  EXPECT_THAT([] { (void)linearize(plus_quadrotor(), kHover, in("uqad")); },
              ThrowsMessage<InvalidInput>(HasSubstr("no convention 'uqad'")));
}

TEST(StateSelection, ReadsWordsAndLists) {
  EXPECT_EQ(state_selection("full", "--states").kind, StateSelection::Kind::full);
  EXPECT_EQ(state_selection("no-position", "--states").kind, StateSelection::Kind::no_position);
  EXPECT_THAT(state_selection("z, vqz theta", "--states").names, ElementsAre("z", "vqz", "theta"));
  EXPECT_THAT([] { (void)state_selection(" ,", "--states"); },
              ThrowsMessage<InvalidInput>(HasSubstr("--states: ' ,' does not name a state")));
}

}  // namespace
}  // namespace quadtune
