// SPDX-License-Identifier: Apache-2.0
#include "design_flow.hpp"

#include <fmt/format.h>

#include <cmath>
#include <iterator>

#include "plant_arguments.hpp"
#include "program.hpp"
#include "quadtune/discretize/zoh.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/estimation/tuned_noise.hpp"
#include "quadtune/estimation/uquad_filter.hpp"
#include "quadtune/exports/verify.hpp"
#include "quadtune/internal/text_file.hpp"
#include "quadtune/model/rotation.hpp"
#include "quadtune/synthesis/lqr.hpp"
#include "refusal.hpp"

namespace quadtune::cli {
namespace {

/// Entry by entry over K and K_int. Each row has its own unit, so it is its own scale.
class DifferenceSearch {
 public:
  explicit DifferenceSearch(Eigen::VectorXd row_scale) : row_scale_(std::move(row_scale)) {}

  void add(const char* matrix, const Eigen::MatrixXd& published, const Eigen::MatrixXd& here,
           const std::vector<Signal>& rows, const std::vector<Signal>& columns) {
    for (Eigen::Index i = 0; i < published.rows(); ++i)
      for (Eigen::Index j = 0; j < published.cols(); ++j) {
        const double scale = row_scale_(i);
        const double difference = std::abs(here(i, j) - published(i, j));
        worst_.max_relative = std::max(worst_.max_relative, difference / scale);
        // Entries that are zero up to rounding carry no relative difference.
        if (std::abs(published(i, j)) < 1e-9 * scale) continue;
        const double relative = difference / std::abs(published(i, j));
        if (relative <= worst_.max_entry) continue;
        worst_.max_entry = relative;
        worst_.worst = fmt::format("{}({}, {})", matrix, rows[static_cast<std::size_t>(i)].name,
                                   columns[static_cast<std::size_t>(j)].name);
        worst_.published = published(i, j);
        worst_.converged = here(i, j);
      }
  }

  [[nodiscard]] const PublishedDifference& worst() const { return worst_; }

 private:
  Eigen::VectorXd row_scale_;
  PublishedDifference worst_;
};

PublishedDifference compare(const PublishedGains& published, const Gains& gains) {
  Eigen::VectorXd scale = published.K.cwiseAbs().rowwise().maxCoeff();
  if (published.K_int.size())
    scale = scale.cwiseMax(published.K_int.cwiseAbs().rowwise().maxCoeff());
  DifferenceSearch search(scale);
  search.add("K", published.K, gains.K, gains.inputs, gains.states);
  if (published.K_int.size())
    search.add("K_int", published.K_int, gains.K_int, gains.inputs, gains.integrals);
  return search.worst();
}

void solve_feedback(DesignOutcome& outcome) {
  const Design& design = outcome.design;
  if (!(design.lqr->dt > 0) && !design.exports.empty())
    throw InvalidInput(design.file.string(),
                       "lqr.dt_s is missing, expected the flight computer's sample period because "
                       "the gains are exported");
  outcome.model = linearize_or_refuse(design.vehicle, design.condition,
                                      linearize_options(*design.lqr), design.file.string());
  outcome.feedback = state_feedback(outcome.model.plant, *design.lqr);
  const RiccatiResult& riccati = outcome.feedback->riccati;
  if (!riccati.solved())
    throw NoSolution(fmt::format("{}: lqr: {}: {}", design.file.string(), to_string(riccati.status),
                                 riccati.culprit),
                     design.file.string());
  outcome.gains = make_gains(design.vehicle, outcome.model, *design.lqr, *outcome.feedback);
  outcome.poles = flying_poles(outcome.model, *outcome.gains, riccati);
  outcome.margins = flying_margins(outcome.model, *outcome.gains, riccati);
  if (design.lqr->dt > 0) outcome.sampled = discretize_zoh(outcome.model.plant, design.lqr->dt);
  if (design.published) outcome.published = compare(*design.published, *outcome.gains);
}

DesignedFilter solve_filter(const KalmanDesign& design, const std::string& where) {
  DesignedFilter result;
  result.evidence = kalman(design.model, {design.G, design.Q, design.R, design.N});
  if (!result.evidence.solved())
    throw NoSolution(fmt::format("{}: kalman {}: {}: {}", where, design.name,
                                 to_string(result.evidence.status), result.evidence.culprit),
                     where);
  result.filter = {design.name,       design.model,     design.G,          design.Q,
                   design.R,          design.N,         result.evidence.M, result.evidence.L,
                   result.evidence.P, result.evidence.Z};
  if (!design.tuned.empty())
    result.filter.noise_source =
        fmt::format("{}{}", design.tuned,
                    design.tuned_verdict.empty() ? "" : ", verdict " + design.tuned_verdict);
  return result;
}

/// Where a state of quadtune's own stands in the gains' trim; 0 if the gains do not have it.
class NedTrim {
 public:
  explicit NedTrim(const Gains& gains) {
    const Convention& words = convention(gains.convention, "gains");
    Eigen::VectorXd full = Eigen::VectorXd::Zero(12);
    for (std::size_t i = 0; i < words.states.size(); ++i)
      for (std::size_t j = 0; j < gains.states.size(); ++j)
        if (words.states[i].name == gains.states[j].name)
          full(static_cast<Eigen::Index>(i)) = gains.x0(static_cast<Eigen::Index>(j));
    x_ = words.from_ned.transpose() * full;
  }

  /// The steady flight that this trim belongs to.
  [[nodiscard]] FlightCondition condition() const {
    const Eigen::Vector3d ground = rotation_of_euler(x_(3), x_(4), x_(5)) * x_.segment<3>(6);
    const double turn = (x_(10) * std::sin(x_(3)) + x_(11) * std::cos(x_(3))) / std::cos(x_(4));
    // Trims are solved to 1e-10: less than this is rest, less turn is straight.
    const auto or_zero = [](double value) { return std::abs(value) < 1e-8 ? 0 : value; };
    return steady_flight(or_zero(ground.head<2>().norm()), or_zero(-ground.z()), or_zero(turn),
                         x_(5));
  }

 private:
  Eigen::Matrix<double, 12, 1> x_;
};

}  // namespace

Gains make_gains(const Vehicle& vehicle, const Linearization& model, const LqrDesign& lqr,
                 const StateFeedback& feedback) {
  Gains gains;
  gains.K = feedback.K;
  gains.K_int = feedback.K_int;
  gains.states = model.plant.states;
  gains.inputs = model.plant.inputs;
  gains.integrals = integral_signals(gains.states, lqr.integrals);
  gains.x0 = model.x0;
  gains.u0 = model.u0;
  gains.vehicle = vehicle.name;
  gains.convention = lqr.convention;
  gains.input_kind = lqr.input_kind;
  gains.sign_law = convention(lqr.convention, "design").sign_law;
  gains.dt = lqr.dt;
  return gains;
}

Eigen::VectorXcd flying_poles(const Linearization& model, const Gains& gains,
                              const RiccatiResult& riccati) {
  return gains.dt > 0 ? closed_loop_poles(discretize_zoh(model.plant, gains.dt), gains)
                      : riccati.poles;
}

MarginsReport flying_margins(const Linearization& model, const Gains& gains,
                             const RiccatiResult& riccati, MarginsEvidence evidence) {
  std::vector<std::string> inputs = names_or_numbers(gains.inputs, std::ssize(gains.inputs));
  if (gains.dt > 0)
    return margins_report(OpenLoop(open_loop(discretize_zoh(model.plant, gains.dt), gains)),
                          std::move(inputs), evidence);
  const ContinuousLti augmented =
      with_integrals(model.plant, names_or_numbers(gains.integrals, std::ssize(gains.integrals)));
  return margins_report(loop_at_inputs(augmented, riccati.K), std::move(inputs), evidence);
}

DesignOutcome solve_laws(const std::string& path) {
  DesignOutcome outcome;
  outcome.design = load_design(path);
  if (outcome.design.lqr)
    solve_feedback(outcome);
  else
    outcome.model = linearize_or_refuse(outcome.design.vehicle, outcome.design.condition, {}, path);
  if (outcome.design.cascade) {
    const CascadeDesign& cascade = *outcome.design.cascade;
    outcome.cascade =
        cascade.specification
            ? design_cascade(outcome.design.vehicle, *cascade.specification, path)
            : assess_written_cascade(outcome.design.vehicle, cascade.gains, cascade.method, path);
  }
  return outcome;
}

DesignOutcome run_design(const std::string& path) {
  DesignOutcome outcome = solve_laws(path);
  for (const KalmanDesign& filter : outcome.design.kalman)
    outcome.filters.push_back(solve_filter(filter, path));
  return outcome;
}

void require_tuned(const DesignOutcome& outcome, bool force, Context& context) {
  const auto require = [&](const std::string& tuned, const std::string& filter,
                           const std::string& verdict) {
    if (verdict.empty() || verdict == "pass") return;
    const std::string what =
        fmt::format("the verdict on {} of {} is '{}'", internal::printable(tuned), filter,
                    internal::printable(verdict));
    if (!force)
      throw Refusal(fmt::format("{}: {}; quadtune design --force takes it all the same",
                                outcome.design.file.string(), what),
                    outcome.design.file.string());
    context.note("design: warning: " + what);
  };
  for (const KalmanDesign& filter : outcome.design.kalman)
    require(filter.tuned, "filter " + filter.name, filter.tuned_verdict);
  if (const auto& estimator = outcome.design.estimator)
    require(estimator->tuned, "the estimator", estimator->model.verdict);
}

Linearization linearization_of(const Vehicle& vehicle, const Gains& gains) {
  LinearizeOptions options;
  options.convention = gains.convention;
  options.inputs = gains.input_kind;
  std::vector<std::string> states;
  for (const Signal& state : gains.states) states.push_back(state.name);
  options.states = {StateSelection::Kind::list, states};
  return linearize_or_refuse(vehicle, NedTrim(gains).condition(), options, vehicle.name);
}

VerifyModel model_of(const Vehicle& vehicle, const Gains& gains) {
  const Linearization model = linearization_of(vehicle, gains);
  return {discretize_zoh(model.plant, gains.dt), model.x0, model.u0};
}

std::vector<std::pair<std::string, std::string>> library_versions() {
  return {{"tomlplusplus", QUADTUNE_TOMLPLUSPLUS_VERSION}, {"ceres", QUADTUNE_CERES_VERSION}};
}

std::string vehicle_file_name(const Vehicle& vehicle) {
  return vehicle.file.empty() ? vehicle.name + ".toml" : vehicle.file.filename().string();
}

ExportContent export_content(const DesignOutcome& outcome) {
  const Design& design = outcome.design;
  ExportContent content;
  content.vehicle = design.vehicle;
  content.gains = outcome.gains;
  if (design.lqr) {
    const Eigen::Index nx = design.lqr->Q.rows();
    const Eigen::Index ni = design.lqr->Q_integral.rows();
    content.Q = Eigen::MatrixXd::Zero(nx + ni, nx + ni);
    content.Q.topLeftCorner(nx, nx) = design.lqr->Q;
    content.Q.bottomRightCorner(ni, ni) = design.lqr->Q_integral;
    content.R = design.lqr->R;
    const RiccatiResult& riccati = outcome.feedback->riccati;
    content.evidence = {to_string(design.lqr->method) + " LQR",
                        to_string(riccati.status),
                        riccati.residual,
                        riccati.rcond,
                        riccati.iterations,
                        riccati.poles};
  }
  content.plant = outcome.sampled;
  for (const DesignedFilter& designed : outcome.filters) content.filters.push_back(designed.filter);
  if (design.estimator) {
    UquadFilterSettings<double> settings = uquad_filter_in_si<double>();
    take_noise(design.estimator->model, design.file.string(), settings);
    content.uquad_filter = uquad_diagonals(settings);
  }
  content.cascade = design.cascade;
  if (outcome.cascade) {
    content.cascade->gains = outcome.cascade->cascade.gains;
    content.cascade_plant = cascade_plant(design.vehicle, *content.cascade, design.file.string());
  }
  content.versions = library_versions();
  content.inputs = {{design.file.filename().string(), design.text},
                    {vehicle_file_name(design.vehicle), design.vehicle.text}};
  const auto add_tuned = [&content](const std::string& file, const std::string& text) {
    content.inputs.push_back({std::filesystem::path(file).filename().string(), text});
  };
  for (const KalmanDesign& filter : design.kalman)
    if (!filter.tuned.empty()) add_tuned(filter.tuned, filter.tuned_text);
  if (design.estimator) add_tuned(design.estimator->tuned, design.estimator->tuned_text);
  return content;
}

}  // namespace quadtune::cli
