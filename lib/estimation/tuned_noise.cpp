// SPDX-License-Identifier: Apache-2.0
#include "quadtune/estimation/tuned_noise.hpp"

#include <fmt/format.h>

#include <cmath>
#include <map>

#include "quadtune/errors.hpp"
#include "quadtune/estimation/uquad_filter.hpp"

namespace quadtune {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

[[noreturn]] void refuse(const std::string& where, const FilterModel& model,
                         const std::string& why) {
  throw InvalidInput(where, fmt::format("the tuned model '{}' {}", model.name, why));
}

bool same(const MatrixXd& a, const MatrixXd& b) {
  return a.rows() == b.rows() && a.cols() == b.cols() &&
         (a - b).cwiseAbs().maxCoeff() <= 1e-12 * (1 + b.cwiseAbs().maxCoeff());
}

/// +1 if the rows are equal, -1 if one is the negative of the other; 0 otherwise.
double sign_between(const MatrixXd& a, const MatrixXd& b) {
  if (same(a, b)) return 1;
  return same(a, -b) ? -1 : 0;
}

}  // namespace

NoisePerStep noise_per_step(const FilterModel& model, const DiscreteLti& filter, const MatrixXd& G,
                            const std::string& where) {
  if (!model.linear()) refuse(where, model, "is not linear, expected a linear one");
  if (names(model.states) != names(filter.states))
    refuse(where, model,
           fmt::format("has the states {}, expected {} as in the filter", names(model.states),
                       names(filter.states)));
  if (!same(model.G, G))
    refuse(where, model,
           "has noise on other states than the filter, expected the same G because Q refers to its "
           "columns");
  if (model.dt > 0 && std::abs(model.dt - filter.dt) > 1e-9 * filter.dt)
    refuse(where, model,
           fmt::format("is discrete with a period of {} s, expected {} s as in the "
                       "filter",
                       model.dt, filter.dt));
  const Eigen::VectorXd theta = start_of(model);
  NoisePerStep noise;
  noise.Q = covariance(model.Q, theta) * (model.dt > 0 ? 1 : filter.dt);
  const Index ny = model.outputs();
  if (ny != filter.C.rows())
    refuse(where, model,
           fmt::format("has {} measurements, expected {} as in the filter", ny, filter.C.rows()));
  noise.R = MatrixXd::Zero(ny, ny);
  Eigen::VectorXd signs(ny);
  Index first = 0;
  for (const FilterSensor& sensor : model.sensors) {
    const Index m = sensor.C.rows();
    for (Index i = 0; i < m; ++i) {
      signs(first + i) = sign_between(sensor.C.row(i), filter.C.row(first + i));
      if (signs(first + i) == 0)
        refuse(where, model,
               fmt::format("measures '{}' differently from the filter, expected the same row of C "
                           "up to its sign",
                           sensor.outputs[static_cast<std::size_t>(i)].name));
    }
    noise.R.block(first, first, m, m) = covariance(sensor.R, theta);
    first += m;
  }
  noise.R = (signs.asDiagonal() * noise.R * signs.asDiagonal()).eval();
  return noise;
}

void copy_noise(const FilterModel& model, const std::string& where,
                UquadFilterSettings<double>& settings) {
  if (model.vehicle.empty())
    refuse(where, model,
           "is not a model of the uquad's filter, expected dynamics = \"rigid-body\"");
  const Eigen::VectorXd theta = start_of(model);
  settings.Q = covariance(model.Q, theta).diagonal() * settings.dt;
  const std::map<std::string, double*> known = {{"tilt", &settings.R_tilt},
                                                {"yaw", &settings.R_yaw},
                                                {"force", &settings.R_force},
                                                {"rates", &settings.R_rates},
                                                {"height", &settings.R_height},
                                                {"position", &settings.R_gps_position},
                                                {"velocity", &settings.R_gps_velocity},
                                                {"vision", &settings.R_vision}};
  for (const FilterSensor& sensor : model.sensors) {
    const Eigen::VectorXd R = covariance(sensor.R, theta).diagonal();
    if (R.minCoeff() != R.maxCoeff())
      refuse(where, model,
             fmt::format("has different variances of '{}' on its axes, expected kind = \"shared\", "
                         "because the filter has one for all axes",
                         sensor.name));
    *known.at(sensor.name) = R(0);
  }
}

}  // namespace quadtune
