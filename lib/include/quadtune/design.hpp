// SPDX-License-Identifier: Apache-2.0
/// What `quadtune design FILE` is asked to do: the content of a design file, read and checked.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "quadtune/cascade.hpp"
#include "quadtune/convention.hpp"
#include "quadtune/estimation/filter_model.hpp"
#include "quadtune/firmware_options.hpp"
#include "quadtune/flight_code_options.hpp"
#include "quadtune/flight_condition.hpp"
#include "quadtune/lti.hpp"
#include "quadtune/model/vehicle.hpp"

namespace quadtune {

/// In which time the weights are meant.
enum class LqrMethod {
  continuous,  ///< cost ∫ xᵀQx + uᵀRu dt of the continuous plant; the gain is used as it is
  discrete,  ///< cost Σ xᵀQx + uᵀRu per step, on the zero-order-hold plant (integrals sampled too)
  sampled,  ///< the continuous cost, exactly, for inputs that are held between samples
};

/// "continuous", "discrete" or "sampled", and back.
[[nodiscard]] std::string to_string(LqrMethod method);
[[nodiscard]] LqrMethod lqr_method(const std::string& name, const std::string& where);

/// An LQR problem about the trim, in the words of a convention.
struct LqrDesign {
  std::string convention = "ned";                 ///< name of the convention
  InputKind input_kind = InputKind::rotor_speed;  ///< what the law commands
  std::vector<std::string> states;                ///< nx names of the convention
  std::vector<std::string> inputs;                ///< nu names
  Eigen::MatrixXd Q;                   ///< (nx × nx) symmetric, in the order of `states`
  Eigen::MatrixXd R;                   ///< (nu × nu) symmetric
  std::vector<std::string> integrals;  ///< ni names of integrated states; may be empty
  Eigen::MatrixXd Q_integral;          ///< (ni × ni) symmetric
  LqrMethod method = LqrMethod::continuous;
  double dt = 0;  ///< sample period of the law [s]; 0 only with LqrMethod::continuous
};

/// The words of a flight program that holds one matrix on the 12 states and one on integrals.
struct MatrixWords {
  std::string convention = "ned";
  InputKind input_kind = InputKind::wrench;
};

/// State feedback for the plant that flies, in the 12 states and the wrench of ned_convention():
/// LQI with the lag of the rotors and past commands. What is none is chosen by the design.
struct LqiDesign {
  double dt = 0.005;                                               ///< control period [s], > 0
  std::vector<std::string> integrals = {"px", "py", "pz", "yaw"};  ///< ni names of states
  std::optional<Eigen::VectorXd> Q;           ///< (12) weights of the states, ≥ 0
  std::optional<Eigen::VectorXd> Q_integral;  ///< (ni) of their integrals, ≥ 0
  std::optional<Eigen::VectorXd> R;           ///< (4) of the commands, > 0
  std::optional<Eigen::VectorXd> R_change;    ///< (4) of the commands' changes, ≥ 0
  std::optional<int> past;                    ///< control periods by which the law predicts
  /// Instead of the LQI a matrix on the 12 states and the usual integrals, without any memory of
  /// commands, in the words of a flight program. The weights stay those of ned_convention().
  std::optional<MatrixWords> matrix = {};
};

/// A steady-state Kalman filter to design: x[k+1] = A x + B u + G w, y = C x + v.
struct KalmanDesign {
  std::string name;   ///< e.g. "altitude"
  DiscreteLti model;  ///< A, B, C, D (zero), dt and the names of states, inputs and measurements
  Eigen::MatrixXd G;  ///< (nx × nw)
  Eigen::MatrixXd Q;  ///< (nw × nw) covariance of w per step
  Eigen::MatrixXd R;  ///< (ny × ny) covariance of v
  Eigen::MatrixXd N;  ///< (nw × ny) covariance of w and v; zero where the file has none
  std::string tuned;  ///< the tuned model that Q and R come from, as named; empty for none
  std::string tuned_text;     ///< its file's bytes, for the manifest's hash
  std::string tuned_verdict;  ///< FilterModel::verdict
};

/// The variances of the uquad's filter, as found in logs.
struct EstimatorDesign {
  std::string tuned;       ///< the tuned model's file, as named
  std::string tuned_text;  ///< its bytes, for the manifest's hash
  FilterModel model;       ///< a rigid_body_model() of the design's vehicle
};

/// A PID cascade: its gains as written, or what is asked of them.
///
/// x and y give pitch and roll references [rad] from position errors [m]; pitch, roll and yaw give
/// torques [N m] from angles [rad]; altitude gives the force along +z (down, so
/// negative in flight) beside -m g [N] from the error in pz [m].
struct CascadeDesign {
  /// Loops x, y, pitch, roll, yaw, altitude, in this order; none while they wait to be designed.
  CascadeGains gains;
  std::optional<CascadeSpecification>
      specification;                            ///< of the gains, where the file asks for them
  PidMethod method = PidMethod::forward_euler;  ///< of the integrals, also of what is asked for
  double attitude_limit = std::numeric_limits<double>::infinity();    ///< of the references [rad]
  double integrator_limit = std::numeric_limits<double>::infinity();  ///< of |∫error| [error · s]
  double back_calculation = 0;         ///< anti-windup gain of the integrators [1/s]
  double takeoff_time = 0;             ///< constant thrust (1 + takeoff_gain) m g at the start [s]
  bool velocity_feed_forward = false;  ///< CascadedPidSettings::velocity_feed_forward
  bool conditional_integration = false;  ///< CascadedPidSettings::conditional_integration
};

/// Files that the design writes.
struct ExportRequest {
  std::string to;                   ///< the name of an ExportTarget
  FlightCodeOptions flight_code{};  ///< of an export to "c"
  FirmwareOptions firmware{};       ///< of an export to a firmware's parameters
};

/// A mission that the gains must fly before they are exported.
struct MissionRequest {
  std::string mission;           ///< name of a built-in one, or a file beside the design's
  std::string controller = {};   ///< "cascaded-pid" or "state-feedback"
  std::string estimator = {};    ///< as `quadtune fly --estimator`; empty: by the sensors
  std::string sensors = "real";  ///< or "ideal"
  std::string flow = "full";     ///< as `quadtune fly --flow`
  std::string wind = "calm";     ///< as `quadtune fly --wind`
  std::string where = {};        ///< "file:line", for messages
};

/// Gains published elsewhere, to say how far the design is from them and why.
struct PublishedGains {
  std::string source;     ///< where they were published
  std::string note;       ///< what is known of how they came to be; may be empty
  Eigen::MatrixXd K;      ///< (m × nx) the first m ≤ nu rows, in the order of LqrDesign::states
  Eigen::MatrixXd K_int;  ///< (m × ni); empty where nothing is integrated
};

/// A design file.
struct Design {
  std::string name;
  std::string description;
  Vehicle vehicle;
  FlightCondition condition;
  std::optional<LqrDesign> lqr;
  std::optional<LqiDesign> lqi;  ///< not beside lqr
  std::vector<KalmanDesign> kalman;
  std::optional<EstimatorDesign> estimator;
  std::optional<CascadeDesign> cascade;
  std::vector<MissionRequest> missions;
  std::vector<ExportRequest> exports;
  std::optional<PublishedGains> published;
  std::filesystem::path file;  ///< it was read from; empty when parsed from text
  std::string text;            ///< the file's bytes, for the manifest's hash
};

/// Whether a design has a state feedback.
[[nodiscard]] inline bool has_feedback(const Design& design) {
  return design.lqr.has_value() || design.lqi.has_value();
}

/// Reads a design file (docs/formats.md). A vehicle file that it names is found beside it.
/// @throws InvalidInput  "file:line: …" for whatever is wrong in it or in its vehicle.
/// @throws FileError     if a file cannot be read.
[[nodiscard]] Design load_design(const std::filesystem::path& path);

/// Parses a design from the text of a file.
/// @param origin  what messages call the file.
/// @param folder  where a vehicle file that the design names lies.
[[nodiscard]] Design parse_design(const std::string& text, const std::string& origin,
                                  const std::filesystem::path& folder = {});

}  // namespace quadtune
