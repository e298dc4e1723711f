// SPDX-License-Identifier: Apache-2.0
#include "quadtune/workbench/export/export_content.hpp"

#include <filesystem>

#include "quadtune/estimation/tuned_noise.hpp"
#include "quadtune/estimation/uquad_filter.hpp"
#include "quadtune/workbench/design/cascade_report.hpp"
#include "quadtune/workbench/flight/flight_plan.hpp"

namespace quadtune {

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
  if (outcome.lqi && outcome.lqi->design.weights.R_change.size() == 0) {
    const ActuatorLqiWeights& weights = outcome.lqi->design.weights;
    const Eigen::Index ni = weights.Q_integral.rows();
    content.Q = Eigen::MatrixXd::Zero(12 + ni, 12 + ni);
    content.Q.topLeftCorner(12, 12) = weights.Q;
    content.Q.bottomRightCorner(ni, ni) = weights.Q_integral;
    content.R = weights.R;
    const RiccatiResult& riccati = outcome.lqi->design.lqi.riccati;
    content.evidence = {kFlownLqiMethod, to_string(riccati.status), riccati.residual,
                        riccati.rcond,   riccati.iterations,        riccati.poles};
  }
  content.plant = outcome.sampled;
  for (const DesignedFilter& designed : outcome.filters) content.filters.push_back(designed.filter);
  if (design.estimator) {
    UquadFilterSettings<double> settings = uquad_filter_in_si<double>();
    copy_noise(design.estimator->model, design.file.string(), settings);
    content.uquad_filter = uquad_diagonals(settings);
  }
  content.cascade = design.cascade;
  if (outcome.cascade) {
    content.cascade->gains = outcome.cascade->cascade.gains;
    content.cascade_plant = cascade_plant(design.vehicle, *content.cascade, design.file.string());
  }
  const double dt = outcome.gains && outcome.gains->dt > 0 ? outcome.gains->dt
                    : content.cascade                      ? content.cascade->gains.dt
                                                           : 0;
  if (dt > 0) content.estimator = stored_estimator(design.vehicle, program_estimator(design), dt);
  if (content.estimator && content.estimator->name == "uquad" && design.estimator) {
    content.estimator->uquad = uquad_filter_in_si<double>();
    content.estimator->uquad->dt = dt;
    copy_noise(design.estimator->model, design.file.string(), *content.estimator->uquad);
  }
  content.versions = library_versions();
  // A design in memory has no bytes by which it could be identified later.
  if (!design.file.empty())
    content.inputs.push_back({design.file.filename().string(), design.text});
  if (!design.vehicle.text.empty())
    content.inputs.push_back({vehicle_file_name(design.vehicle), design.vehicle.text});
  const auto add_tuned = [&content](const std::string& file, const std::string& text) {
    content.inputs.push_back({std::filesystem::path(file).filename().string(), text});
  };
  for (const KalmanDesign& filter : design.kalman)
    if (!filter.tuned.empty()) add_tuned(filter.tuned, filter.tuned_text);
  if (design.estimator) add_tuned(design.estimator->tuned, design.estimator->tuned_text);
  return content;
}

}  // namespace quadtune
