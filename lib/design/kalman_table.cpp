// SPDX-License-Identifier: Apache-2.0
#include "design/kalman_table.hpp"

#include <fmt/format.h>

#include "design/table_entries.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/estimation/filter_file.hpp"
#include "quadtune/estimation/tuned_noise.hpp"
#include "quadtune/estimation/uquad_filter.hpp"
#include "quadtune/internal/text_file.hpp"
#include "quadtune/matrix_checks.hpp"

namespace quadtune::internal {
namespace {

std::vector<Signal> read_signals(const TomlTable& table, const std::string& key) {
  std::vector<Signal> signals;
  for (const TomlTable& signal : table.tables(key)) {
    signal.allow({{"name"}, {"unit"}});
    signals.push_back({signal.text("name"), signal.text_or("unit", "")});
  }
  return signals;
}

/// Reads Q and R from a tuned model, whose path is relative to the design's folder.
void read_tuned(const TomlTable& table, const std::filesystem::path& folder, KalmanDesign& kalman) {
  for (const char* key : {"Q", "R"})
    if (table.has(key))
      throw InvalidInput(table.where(key),
                         fmt::format("{} and tuned are both in {}, expected only one "
                                     "of them because tuned provides Q and R",
                                     key, table.title()));
  kalman.tuned = table.text("tuned");
  const std::string path = (folder / kalman.tuned).string();
  kalman.tuned_text = read_text_file(path, kTomlLimit);
  const FilterModel model = parse_filter_model(kalman.tuned_text, path);
  kalman.tuned_verdict = model.verdict;
  const NoisePerStep noise = noise_per_step(model, kalman.model, kalman.G, table.where("tuned"));
  kalman.Q = noise.Q;
  kalman.R = noise.R;
}

}  // namespace

KalmanDesign read_kalman(const TomlTable& table, const std::filesystem::path& folder) {
  table.allow({{"name"},
               {"dt", "s"},
               {"states"},
               {"inputs"},
               {"measurements"},
               {"A"},
               {"B"},
               {"C"},
               {"G"},
               {"Q"},
               {"R"},
               {"N"},
               {"tuned"}});
  KalmanDesign kalman;
  kalman.name = table.word("name");
  DiscreteLti& model = kalman.model;
  model.dt = table.number("dt_s", Range::positive());
  model.states = read_signals(table, "states");
  model.inputs = read_signals(table, "inputs");
  model.outputs = read_signals(table, "measurements");
  const auto nx = static_cast<Eigen::Index>(model.states.size());
  const auto nu = static_cast<Eigen::Index>(model.inputs.size());
  const auto ny = static_cast<Eigen::Index>(model.outputs.size());
  for (const char* key : {"states", "measurements"})
    if (!table.has(key) || table.tables(key).empty())
      throw InvalidInput(table.where(key), fmt::format("{} has no {}, expected at least one {{ "
                                                       "name, unit }}",
                                                       table.title(), key));
  const std::string states = "states: " + names(model.states);
  const std::string measurements = "measurements: " + names(model.outputs);
  model.A = read_shaped(table, "A", nx, nx, states);
  model.B = nu == 0 && !table.has("B")
                ? Eigen::MatrixXd(nx, 0)
                : read_shaped(table, "B", nx, nu, states + "; inputs: " + names(model.inputs));
  model.C = read_shaped(table, "C", ny, nx, measurements + "; " + states);
  model.D = Eigen::MatrixXd::Zero(ny, nu);
  kalman.G = table.matrix("G");
  const Eigen::Index nw = kalman.G.cols();
  require_shape(kalman.G, nx, nw, table.where("G"), dotted(table, "G"), states);
  if (table.has("tuned")) {
    read_tuned(table, folder, kalman);
  } else {
    kalman.Q = read_weight(table, "Q", nw, "columns of G", Range::not_negative());
    kalman.R = read_weight(table, "R", ny, measurements, Range::positive());
  }
  kalman.N = table.has("N") ? read_shaped(table, "N", nw, ny, "columns of G by measurements")
                            : Eigen::MatrixXd(Eigen::MatrixXd::Zero(nw, ny));
  return kalman;
}

EstimatorDesign read_estimator(const TomlTable& table, const std::filesystem::path& folder,
                               const Vehicle& vehicle) {
  table.allow({{"tuned"}});
  EstimatorDesign estimator;
  estimator.tuned = table.text("tuned");
  const std::string path = (folder / estimator.tuned).string();
  estimator.tuned_text = read_text_file(path, kTomlLimit);
  estimator.model = parse_filter_model(estimator.tuned_text, path);
  UquadFilterSettings<double> tried;
  copy_noise(estimator.model, table.where("tuned"), tried);
  const std::string of = load_vehicle(estimator.model.vehicle).name;
  if (of != vehicle.name)
    throw InvalidInput(table.where("tuned"),
                       fmt::format("the tuned model '{}' is for the vehicle '{}', expected '{}'",
                                   estimator.model.name, of, vehicle.name));
  return estimator;
}

}  // namespace quadtune::internal
