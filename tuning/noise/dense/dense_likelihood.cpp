// SPDX-License-Identifier: Apache-2.0
#include "noise/dense/dense_likelihood.hpp"

#include <algorithm>

namespace quadtune::internal {

std::unique_ptr<DenseLikelihood> make_dense_likelihood(const PreparedModel& prepared) {
  const auto& sensors = prepared.model.sensors;
  const bool tailed = std::any_of(sensors.begin(), sensors.end(),
                                  [](const FilterSensor& sensor) { return sensor.student != 0; });
  if (prepared.correlated || tailed) return nullptr;
  const Eigen::Index nx = prepared.model.A.rows();
  if (nx <= 4) return make_dense_likelihood_of<4>(prepared);
  if (nx <= 8) return make_dense_likelihood_of<8>(prepared);
  if (nx <= 12) return make_dense_likelihood_of<12>(prepared);
  if (nx <= 16) return make_dense_likelihood_of<16>(prepared);
  return make_dense_likelihood_of<24>(prepared);
}

}  // namespace quadtune::internal
