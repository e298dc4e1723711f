// SPDX-License-Identifier: Apache-2.0
#include "quadtune/exports/mambo.hpp"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "mambo/m_file.hpp"
#include "mambo/sensor_vars.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/exports/digital_filter.hpp"

namespace quadtune {
namespace {

using exports::MFile;

// Gates of the model project's estimator.
constexpr double kHeightJump = 0.3;         // [m] between two samples of the sonar
constexpr double kHeightDeparture = 0.4;    // [m] of the sonar from the filtered height
constexpr double kFlowMinimumHeight = 0.4;  // [m] below which optical flow is not usable
constexpr double kFlowCorrection = 1.15;    // factor on the optical flow

bool near(double a, double b, double scale) { return std::abs(a - b) <= 1e-9 * std::abs(scale); }

[[noreturn]] void refuse(const std::string& came, const std::string& expected) {
  throw InvalidInput("mambo", came + ", expected " + expected +
                                  ", because the mixer of the model project assumes this");
}

// The model project computes thrust and torque from Ct and Cq, and its mixer assumes a symmetric X.
void require_mambo_layout(const Vehicle& vehicle) {
  if (vehicle.rotors.size() != 4)
    refuse(fmt::format("the vehicle has {} rotors", vehicle.rotors.size()), "4");
  const Rotor& first = vehicle.rotors.front();
  const double a = std::hypot(first.position.x(), first.position.y()) / std::numbers::sqrt2;
  const double x[] = {1, 1, -1, -1};
  const double y[] = {-1, 1, 1, -1};
  for (int i = 0; i < 4; ++i) {
    const Rotor& rotor = vehicle.rotors[static_cast<std::size_t>(i)];
    const std::string name = fmt::format("rotor {}", i + 1);
    if (!near(rotor.position.x(), x[i] * a, a) || !near(rotor.position.y(), y[i] * a, a))
      refuse(fmt::format("{} is at ({}, {}) m", name, rotor.position.x(), rotor.position.y()),
             fmt::format("({}, {}) m (X: 1 front left, 2 front right, 3 back right, 4 back left)",
                         x[i] * a, y[i] * a));
    if (rotor.spin != (i % 2 == 0 ? Spin::clockwise : Spin::counter_clockwise))
      refuse(name + " turns the other way", "1 and 3 clockwise, 2 and 4 counter-clockwise");
    if (!std::isfinite(rotor.Ct) || !std::isfinite(rotor.Cq) || !std::isfinite(rotor.radius))
      refuse(name + " has no Ct, Cq and radius", "them instead of a thrust curve");
    const double b = rotor.Ct * vehicle.air_density * std::numbers::pi * std::pow(rotor.radius, 4);
    const double k = b * rotor.Cq / rotor.Ct * rotor.radius;
    if (!near(rotor.thrust_a2, b, b) || !near(rotor.torque_d2, k, k) || rotor.thrust_a1 != 0 ||
        rotor.torque_d1 != 0)
      refuse(fmt::format("{} has thrust {} w^2 + {} w and torque {} w^2 + {} w", name,
                         rotor.thrust_a2, rotor.thrust_a1, rotor.torque_d2, rotor.torque_d1),
             fmt::format("{} w^2 and {} w^2 from Ct and Cq", b, k));
    if (rotor.Ct != first.Ct || rotor.Cq != first.Cq || rotor.radius != first.radius)
      refuse(name + " differs from rotor 1", "four equal rotors");
  }
  if (vehicle.motor.law != CommandLaw::speed_squared)
    refuse("the motors are commanded in speed", "commands proportional to the square of the speed");
}

// A number of the airframe that may be unknown; it is then written as an empty matrix, which no
// model accepts silently.
void add_if_known(MFile& m, const std::string& name, double value, const std::string& unit) {
  if (std::isnan(value))
    m.expression(name, "[]", "not known");
  else
    m.number(name, value, unit);
}

// The model project's drag coefficient refers to the disc with the airframe's diameter.
void add_drag(MFile& m, const Vehicle& vehicle) {
  const double disc = std::numbers::pi * vehicle.airframe_diameter * vehicle.airframe_diameter / 4;
  const char* names[] = {"Vehicle.Airframe.Cdx", "Vehicle.Airframe.Cdy"};
  for (int i = 0; i < 2; ++i) {
    const double cda = vehicle.drag.cda(i);
    if (cda != 0 && !(disc > 0))
      throw InvalidInput("mambo",
                         fmt::format("drag.cda is {} m^2, but the airframe diameter is unknown; "
                                     "it is required because {} refers to its disc",
                                     cda, names[i]));
    m.number(names[i], cda == 0 ? 0.0 : cda / disc, "of the disc pi*diameter^2/4");
  }
}

std::string vehicle_vars(const Vehicle& vehicle) {
  require_mambo_layout(vehicle);
  const Rotor& rotor = vehicle.rotors.front();
  MFile m;
  m.comment("vehicleVars.m: " + vehicle.name + ", written by quadtune. SI units.");
  m.comment("Run before controllerVars.m and estimatorVars.m.");
  m.number("g", vehicle.gravity, "m/s^2");
  m.number("rho", vehicle.air_density, "kg/m^3");
  m.comment("");
  m.number("Vehicle.Airframe.mass", vehicle.mass, "kg");
  m.matrix("Vehicle.Airframe.inertia", vehicle.inertia, "kg m^2, body forward-right-down");
  m.number("Vehicle.Airframe.d", std::hypot(rotor.position.x(), rotor.position.y()),
           "m, centre to hub");
  m.expression("Vehicle.Airframe.xy", "Vehicle.Airframe.d*sqrt(2)/2", "m, along x and along y");
  add_if_known(m, "Vehicle.Airframe.h", vehicle.airframe_height, "m");
  add_drag(m, vehicle);
  add_if_known(m, "Vehicle.Airframe.diameter", vehicle.airframe_diameter, "m");
  m.comment("");
  if (rotor.blades > 0)
    m.number("Vehicle.Rotor.blades", rotor.blades);
  else
    m.expression("Vehicle.Rotor.blades", "[]", "not known");
  m.number("Vehicle.Rotor.radius", rotor.radius, "m");
  add_if_known(m, "Vehicle.Rotor.chord", rotor.chord, "m");
  m.number("Vehicle.Rotor.Ct", rotor.Ct);
  m.number("Vehicle.Rotor.Cq", rotor.Cq);
  m.number("Vehicle.Rotor.inertia", rotor.inertia, "kg m^2");
  m.expression("Vehicle.Rotor.area", "pi*Vehicle.Rotor.radius^2", "m^2");
  m.expression("Vehicle.Rotor.b", "Vehicle.Rotor.Ct*rho*Vehicle.Rotor.area*Vehicle.Rotor.radius^2",
               "N s^2/rad^2, T = b w^2");
  m.expression("Vehicle.Rotor.k", "Vehicle.Rotor.Cq*rho*Vehicle.Rotor.area*Vehicle.Rotor.radius^3",
               "N m s^2/rad^2, Q = k w^2");
  m.expression("Vehicle.Rotor.w2ToThrustGain", "Vehicle.Rotor.b", "N s^2/rad^2");
  m.comment("");
  m.number("Vehicle.Motor.maxLimit", vehicle.motor.max, vehicle.motor.unit);
  m.number("Vehicle.Motor.minLimit", vehicle.motor.min, vehicle.motor.unit);
  m.number("Vehicle.Motor.commandToW2Gain", vehicle.motor.gain, "rad^2/s^2 per unit");
  m.expression("Vehicle.Motor.thrustToMotorCommand",
               "1/(Vehicle.Rotor.w2ToThrustGain*Vehicle.Motor.commandToW2Gain)",
               "1/N, of the thrust's magnitude");
  if (!vehicle.motor.direction.empty()) {
    Eigen::RowVectorXd direction(static_cast<Eigen::Index>(vehicle.motor.direction.size()));
    for (std::size_t i = 0; i < vehicle.motor.direction.size(); ++i)
      direction(static_cast<Eigen::Index>(i)) = vehicle.motor.direction[i];
    m.matrix("Vehicle.Motor.direction", direction, "sign of each motor's command");
  }
  return m.text();
}

void add_mixer(MFile& m, const Vehicle& vehicle) {
  m.comment("Thrusts along +z, so negative in flight, to [thrust; yaw; pitch; roll].");
  m.expression("Controller.Ts2Q",
               "vertcat([1 1 1 1], "
               "Vehicle.Rotor.Cq/Vehicle.Rotor.Ct*Vehicle.Rotor.radius*[1 -1 1 -1], "
               "Vehicle.Airframe.xy*[-1 -1 1 1], Vehicle.Airframe.xy*[-1 1 1 -1])");
  m.expression("Controller.Q2Ts", "inv(Controller.Ts2Q)");
  m.number("Controller.takeoffGain", vehicle.takeoff_gain, "thrust at take-off is (1 + it) m g");
  m.number("Controller.totalThrustMaxRelative", vehicle.altitude_thrust_fraction,
           "of the maximum thrust, left to the altitude loop");
  m.expression("Controller.motorsThrustPerMotorMax",
               "Vehicle.Motor.maxLimit*Vehicle.Motor.commandToW2Gain*Vehicle.Rotor.Ct*rho*"
               "Vehicle.Rotor.area*Vehicle.Rotor.radius^2",
               "N");
}

void add_state_feedback(MFile& m, const Gains& gains) {
  validate(gains, "mambo");
  if (gains.convention != "mambo" || gains.input_kind != InputKind::wrench)
    throw InvalidInput(
        "mambo", fmt::format("the gain is in convention '{}' with inputs {}, expected 'mambo' with "
                             "wrench, because the mixer takes thrust and torques",
                             gains.convention, to_string(gains.input_kind)));
  if (!(gains.dt > 0))
    throw InvalidInput("mambo",
                       fmt::format("the gain's sample time is {} s, expected a positive one, "
                                   "because the model project runs sampled",
                                   gains.dt));
  if (gains.memory || gains.axes == PositionAxes::heading)
    throw InvalidInput("mambo",
                       fmt::format("the law {}, expected a matrix on the states in world axes, "
                                   "which is all that controllerVars.m can represent",
                                   gains.memory ? "feeds back its past commands"
                                                : "sees the position error in heading axes"));
  if (gains.limits != FeedbackLimits{})
    throw InvalidInput("mambo",
                       "the law limits its position error or its integrals, expected none, because "
                       "controllerVars.m contains only the matrices");
  const std::string prefix = "Controller.StateFeedback.";
  const bool plain = gains.sign_law == SignLaw::set_point_minus_state;
  const std::string error = plain ? "(x_sp - x)" : "(x - x_sp)";
  m.comment("");
  m.comment("u = u0 + K*e + K_int*i, e = " + error + ", i = i + Ts*e(integrals) each sample.");
  m.comment(
      "u = [T tau_x tau_y tau_z], T >= 0 along body -z. Controller.Q2Ts*(toQ2Ts*u) gives the");
  m.comment("thrusts along +z.");
  m.words(prefix + "states", gains.states);
  m.words(prefix + "inputs", gains.inputs);
  m.words(prefix + "integrals", gains.integrals);
  m.expression(prefix + "signLaw", "'" + to_string(gains.sign_law) + "'");
  m.number(prefix + "Ts", gains.dt, "s");
  m.matrix(prefix + "x0", gains.x0, "trim, the set point that K was made for");
  m.matrix(prefix + "u0", gains.u0);
  m.matrix(prefix + "K", gains.K);
  m.matrix(prefix + "K_int", gains.K_int);
  Eigen::Matrix4d to_mixer;
  to_mixer << -1, 0, 0, 0, 0, 0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0;  // [-T tau_z tau_y tau_x]
  m.matrix(prefix + "toQ2Ts", to_mixer);
}

const PidLoop* loop_named(const CascadeGains& cascade, const std::string& name) {
  for (const PidLoop& loop : cascade.loops)
    if (loop.name == name) return &loop;
  return nullptr;
}

// The model project stores the loops of pitch and roll as vectors [pitch roll].
void add_pair(MFile& m, const CascadeGains& cascade, const std::string& name,
              const std::string& pitch, const std::string& roll) {
  const PidLoop* first = loop_named(cascade, pitch);
  const PidLoop* second = loop_named(cascade, roll);
  if (first == nullptr || second == nullptr) return;
  const std::string prefix = "Controller.Cascade." + name;
  m.matrix(prefix + ".Kp", Eigen::RowVector2d(first->Kp, second->Kp), "[pitch roll]");
  m.matrix(prefix + ".Ki", Eigen::RowVector2d(first->Ki, second->Ki));
  m.matrix(prefix + ".Kd", Eigen::RowVector2d(first->Kd, second->Kd));
}

void add_cascade(MFile& m, const CascadeDesign& design) {
  m.comment("");
  m.comment("output = Kp*error + Ki*integral(error) + Kd*measured rate");
  m.number("Controller.Cascade.Ts", design.gains.dt, "s");
  for (const PidLoop& loop : design.gains.loops) {
    if (!exports::is_m_name(loop.name))
      throw InvalidInput("mambo",
                         fmt::format("the loop is called '{}'; expected a name of letters and "
                                     "digits, because it becomes a variable",
                                     loop.name));
    if (loop.rate_lead != 0)
      throw InvalidInput("mambo", fmt::format("the loop '{}' acts on the derivative of the rate, "
                                              "which the model project does not; expected "
                                              "rate_lead_s 0",
                                              loop.name));
    const std::string prefix = "Controller.Cascade." + loop.name;
    m.number(prefix + ".Kp", loop.Kp, loop.unit + ", to " + loop.output);
    m.number(prefix + ".Ki", loop.Ki);
    m.number(prefix + ".Kd", loop.Kd);
  }
  add_pair(m, design.gains, "position", "x", "y");
  add_pair(m, design.gains, "attitude", "pitch", "roll");
  const auto limit = [&](const std::string& name, double value, const char* unit) {
    if (std::isinf(value))
      m.expression("Controller.Cascade." + name, "[]", "not limited");
    else
      m.number("Controller.Cascade." + name, value, unit);
  };
  // The default of the model project; files without it use it, too.
  if (design.method != PidMethod::forward_euler)
    m.expression("Controller.Cascade.integrator", "'" + to_string(design.method) + "'");
  limit("attitudeLimit", design.attitude_limit, "rad");
  limit("integratorLimit", design.integrator_limit, "");
  limit("backCalculation", design.back_calculation, "1/s");
  limit("takeoffTime", design.takeoff_time, "s");
  // The model project has neither of these; without them in the file, the law has neither.
  if (design.velocity_feed_forward)
    m.number("Controller.Cascade.velocityFeedForward", 1,
             "Kd acts on the velocity minus the reference velocity");
  if (design.conditional_integration)
    m.number("Controller.Cascade.conditionalIntegration", 1,
             "an integral stops while the output exceeds its limits");
}

std::string controller_vars(const ExportContent& content) {
  MFile m;
  m.comment("controllerVars.m: " + content.vehicle.name + ", written by quadtune. SI units.");
  m.comment("Run after vehicleVars.m.");
  add_mixer(m, content.vehicle);
  if (content.gains) add_state_feedback(m, *content.gains);
  if (content.cascade) add_cascade(m, *content.cascade);
  return m.text();
}

void add_filter(MFile& m, const KalmanFilter& filter) {
  std::string prefix;
  if (filter.name == "altitude") prefix = "Estimator.alt.kf.";
  if (filter.name == "velocity") prefix = "Estimator.pos.kfVelo.";
  if (prefix.empty())
    throw InvalidInput(
        "mambo", fmt::format("filter '{}' is not supported; expected 'altitude' or 'velocity', "
                             "the filters of the estimator",
                             filter.name));
  m.comment("");
  m.comment("x[k+1] = A*x + B*u + G*w, y = C*x + H*w + v; cov(w) = Q, cov(v) = R, cov(w,v) = N.");
  m.comment("States " + names(filter.model.states) + "; inputs " + names(filter.model.inputs) +
            "; measurements " + names(filter.model.outputs) + ".");
  if (!filter.noise_source.empty())
    m.comment("Q and R were estimated from logs: " + filter.noise_source + ".");
  m.number(prefix + "Ts", filter.model.dt, "s");
  m.matrix(prefix + "A", filter.model.A);
  m.matrix(prefix + "B", filter.model.B);
  const Eigen::Index nx = filter.model.A.rows();
  m.matrix(prefix + "C",
           filter.model.C.size() > 0 ? filter.model.C : Eigen::MatrixXd::Identity(nx, nx).eval());
  m.matrix(prefix + "G", filter.G);
  m.matrix(prefix + "H", Eigen::MatrixXd::Zero(filter.R.rows(), filter.Q.rows()));
  m.matrix(prefix + "Q", filter.Q, "per step");
  m.matrix(prefix + "R", filter.R);
  m.matrix(prefix + "N", filter.N);
  m.matrix(prefix + "M", filter.M, "steady filter gain: x = x + M*(y - C*x)");
  m.matrix(prefix + "L", filter.L, "steady predictor gain, A*M when N is zero");
  m.matrix(prefix + "P", filter.P, "covariance before the measurement");
  m.matrix(prefix + "Z", filter.Z, "covariance after the measurement");
}

void add_filter(MFile& m, const std::string& name, const DigitalFilter& filter,
                const std::string& about) {
  m.matrix(name + ".num", filter.num.transpose(), about);
  m.matrix(name + ".den", filter.den.transpose());
}

std::string estimator_vars(const ExportContent& content) {
  MFile m;
  m.comment("estimatorVars.m: " + content.vehicle.name + ", written by quadtune. SI units.");
  for (const KalmanFilter& filter : content.filters) add_filter(m, filter);
  m.comment("");
  m.comment("Low passes as coefficients of z^-1, so that no toolbox is needed.");
  add_filter(m, "Estimator.alt.filterHeight", butterworth(3, 0.01), "butter(3, 0.01)");
  add_filter(m, "Estimator.imu.filterGyro", chebyshev2(5, 40, 0.8), "cheby2(5, 40, 0.8)");
  add_filter(m, "Estimator.imu.filterAccel", windowed_fir(5, 0.1), "fir1(5, 0.1)");
  m.comment("");
  m.number("Estimator.alt.gateJump", kHeightJump, "m, between two samples of the sonar");
  m.number("Estimator.alt.gateFiltered", kHeightDeparture, "m, sonar from filtered height");
  m.number("Estimator.pos.minimumHeight", kFlowMinimumHeight, "m, for optical flow");
  m.number("Estimator.pos.flowCorrection", kFlowCorrection);
  return m.text();
}

}  // namespace

bool takes_mambo_files(const Vehicle& vehicle) {
  try {
    (void)vehicle_vars(vehicle);
    return true;
  } catch (const InvalidInput&) {
    return false;
  }
}

std::vector<FileContent> mambo_files(const ExportContent& content) {
  std::vector<FileContent> files = {{"vehicleVars.m", vehicle_vars(content.vehicle)},
                                    {"controllerVars.m", controller_vars(content)},
                                    {"estimatorVars.m", estimator_vars(content)}};
  if (content.vehicle.sensors_known)
    files.push_back({"sensorsVars.m", exports::sensor_vars(content.vehicle)});
  return files;
}

}  // namespace quadtune
