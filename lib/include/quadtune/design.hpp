// SPDX-License-Identifier: Apache-2.0
/// The content of a design file, the input of `quadtune design FILE`, read and validated.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "quadtune/cascade.hpp"
#include "quadtune/convention.hpp"
#include "quadtune/design/firmware_options.hpp"
#include "quadtune/design/flight_code_options.hpp"
#include "quadtune/estimation/filter_model.hpp"
#include "quadtune/flight_condition.hpp"
#include "quadtune/lti.hpp"
#include "quadtune/model/vehicle.hpp"

namespace quadtune {

/// The time domain in which the weights of the cost are defined.
enum class LqrMethod {
  continuous,  ///< cost ∫ xᵀQx + uᵀRu dt of the continuous plant; the gain is used unchanged
  /// Cost Σ xᵀQx + uᵀRu per step, on the zero-order-hold plant (integrals are sampled as well).
  discrete,
  sampled,  ///< the continuous cost, evaluated exactly for inputs held between samples
};

/// "continuous", "discrete" or "sampled".
[[nodiscard]] std::string to_string(LqrMethod method);

/// The method of a name, the inverse of to_string().
/// @throws InvalidInput  with the unknown name and the known ones.
[[nodiscard]] LqrMethod lqr_method(const std::string& name, const std::string& where);

/// An LQR problem about the trim, in the states and inputs of a convention.
struct LqrDesign {
  std::string convention = "ned";                 ///< name of the convention
  InputKind input_kind = InputKind::rotor_speed;  ///< the quantity that the law commands
  std::vector<std::string> states;                ///< nx names of the convention
  std::vector<std::string> inputs;                ///< nu names
  Eigen::MatrixXd Q;                         ///< (nx × nx) symmetric, in the order of `states`
  Eigen::MatrixXd R;                         ///< (nu × nu) symmetric
  std::vector<std::string> integrals;        ///< ni names of integrated states; may be empty
  Eigen::MatrixXd Q_integral;                ///< (ni × ni) symmetric
  LqrMethod method = LqrMethod::continuous;  ///< which problem is solved
  double dt = 0;  ///< sample period of the law [s]; 0 only with LqrMethod::continuous
};

/// Convention and inputs of flight code that applies one matrix to the 12 states and one to the
/// integrals.
struct MatrixConvention {
  std::string convention = "ned";            ///< name of a registered convention
  InputKind input_kind = InputKind::wrench;  ///< quantities that the matrix commands
};

/// State feedback for the flown loop, in the 12 states and the wrench of ned_convention(): LQI
/// whose plant includes the motor lag and past commands. The design chooses every value that is
/// empty.
struct LqiDesign {
  double dt = 0.005;                                               ///< control period [s], > 0
  std::vector<std::string> integrals = {"px", "py", "pz", "yaw"};  ///< ni names of states
  std::optional<Eigen::VectorXd> Q;           ///< (12) weights of the states, ≥ 0
  std::optional<Eigen::VectorXd> Q_integral;  ///< (ni) weights of the integrals, ≥ 0
  std::optional<Eigen::VectorXd> R;           ///< (4) weights of the commands, > 0
  std::optional<Eigen::VectorXd> R_change;    ///< (4) weights of the changes of the commands, ≥ 0
  /// Number of control periods by which the law predicts, 0 to 40; ≥ 1 with R_change.
  std::optional<int> past;
  /// If set, the design is a matrix on the 12 states and one on the integrals of px, py, pz and
  /// yaw, without memory of past commands, in this convention. The weights remain those of
  /// ned_convention().
  std::optional<MatrixConvention> matrix = {};
};

/// A steady-state Kalman filter to design: x[k+1] = A x + B u + G w, y = C x + v.
struct KalmanDesign {
  std::string name;   ///< e.g. "altitude"
  DiscreteLti model;  ///< A, B, C, D (zero), dt and the names of states, inputs and measurements
  Eigen::MatrixXd G;  ///< (nx × nw)
  Eigen::MatrixXd Q;  ///< (nw × nw) covariance of w per step
  Eigen::MatrixXd R;  ///< (ny × ny) covariance of v
  Eigen::MatrixXd N;  ///< (nw × ny) covariance of w and v; zero if the file has none
  /// The tuned model that provides Q and R, as written in the file; empty: none.
  std::string tuned;
  std::string tuned_text;     ///< the bytes of that file, for the manifest's hash
  std::string tuned_verdict;  ///< FilterModel::verdict
};

/// The noise variances of the uquad's filter, tuned from logs.
struct EstimatorDesign {
  std::string tuned;       ///< file of the tuned model, as written in the design
  std::string tuned_text;  ///< its bytes, for the manifest's hash
  FilterModel model;       ///< a rigid_body_model() of the design's vehicle
};

/// A PID cascade: either given gains or the requirements from which gains are designed.
///
/// The loops x and y command pitch and roll references [rad] from position errors [m]; pitch, roll
/// and yaw command torques [N m] from angles [rad]; altitude commands, from the error in pz [m],
/// the force along +z [N] that is added to -m g (+z points down, so the sum is negative in flight).
struct CascadeDesign {
  /// Loops x, y, pitch, roll, yaw, altitude, in this order; empty until gains are designed.
  CascadeGains gains;
  /// Requirements; set if the file requests that gains be designed.
  std::optional<CascadeSpecification> specification;
  PidMethod method = PidMethod::forward_euler;  ///< of the integrals, given or designed
  double attitude_limit = std::numeric_limits<double>::infinity();    ///< of the references [rad]
  double integrator_limit = std::numeric_limits<double>::infinity();  ///< of |∫error| [error · s]
  double back_calculation = 0;         ///< anti-windup gain of the integrators [1/s]
  double takeoff_time = 0;             ///< constant thrust (1 + takeoff_gain) m g at the start [s]
  bool velocity_feed_forward = false;  ///< CascadedPidSettings::velocity_feed_forward
  bool conditional_integration = false;  ///< CascadedPidSettings::conditional_integration
  /// Lead of the rate in the roll and pitch loops [s] for gains that are designed on the flown
  /// plant; none: chosen by the design.
  std::optional<double> rate_lead = {};
};

/// Files to export from the design.
struct ExportRequest {
  std::string to;                   ///< the name of an ExportTarget
  FlightCodeOptions flight_code{};  ///< options of an export to "c"
  FirmwareOptions firmware{};       ///< options of an export to firmware parameters
};

/// A mission that the design must fly successfully before its gains are exported.
struct MissionRequest {
  std::string mission;          ///< a built-in mission, or a file in the design's folder
  std::string controller = {};  ///< "cascaded-pid" or "state-feedback"
  /// As `quadtune fly --estimator`; empty: chosen by the vehicle's sensors.
  std::string estimator = {};
  std::string sensors = "real";  ///< "real" or "ideal"
  std::string flow = "full";     ///< as `quadtune fly --flow`
  std::string wind = "calm";     ///< as `quadtune fly --wind`
  std::string where = {};        ///< "file:line", for messages
};

/// Published gains with which the design is compared.
struct PublishedGains {
  std::string source;     ///< where they were published
  std::string note;       ///< what is known about their derivation; may be empty
  Eigen::MatrixXd K;      ///< (m × nx) the first m ≤ nu rows, in the order of LqrDesign::states
  Eigen::MatrixXd K_int;  ///< (m × ni); empty if no state is integrated
};

/// A design file.
struct Design {
  std::string name;                          ///< of the design
  std::string description;                   ///< one line; may be empty
  Vehicle vehicle;                           ///< for which gains are designed
  FlightCondition condition;                 ///< the trim of the state feedback
  std::optional<LqrDesign> lqr;              ///< state feedback; empty if the file requests none
  std::optional<LqiDesign> lqi;              ///< set instead of lqr for lqr.plant = "flown"
  std::vector<KalmanDesign> kalman;          ///< Kalman filters, e.g. "altitude" and "velocity"
  std::optional<EstimatorDesign> estimator;  ///< tuned noise of the estimator; empty: its defaults
  std::optional<CascadeDesign> cascade;      ///< PID cascade; empty if the file requests none
  std::vector<MissionRequest> missions;      ///< flights that the design must pass
  std::vector<ExportRequest> exports;        ///< exports that are written if the design passes
  /// Gains that are compared with the computed ones; empty if there are none.
  std::optional<PublishedGains> published;
  std::filesystem::path file;  ///< the file that was read; empty if parsed from text
  std::string text;            ///< the bytes of that file, for the manifest's hash
};

/// Whether a design includes state feedback.
[[nodiscard]] inline bool has_feedback(const Design& design) {
  return design.lqr.has_value() || design.lqi.has_value();
}

/// Reads a design file (docs/formats.md). A relative vehicle path is resolved in the design's
/// folder.
/// @throws InvalidInput  "file:line: …" for an error in the design or in its vehicle.
/// @throws FileError     if a file cannot be read.
[[nodiscard]] Design load_design(const std::filesystem::path& path);

/// Parses a design from the text of a file.
/// @param text    content of the file
/// @param origin  the file's name in messages.
/// @param folder  base of a relative vehicle path.
/// @throws        as load_design()
[[nodiscard]] Design parse_design(const std::string& text, const std::string& origin,
                                  const std::filesystem::path& folder = {});

}  // namespace quadtune
