// SPDX-License-Identifier: Apache-2.0
/// Filter models and their logs for tests: small ones by hand, and random ones.
#pragma once

#include <random>
#include <vector>

#include "quadtune/estimation/filter_model.hpp"
#include "quadtune/estimation/filter_record.hpp"

namespace quadtune::testing {

/// A random walk seen with noise: Q.level, R.y per step of 1 s; diffuse.
FilterModel local_level();

/// Height and vertical speed, discrete as in Oliveira 2020, table 3.1: Q.vz, R.sonar; diffuse.
FilterModel discrete_altitude();

/// nx states, nu inputs, two sensors with one and two outputs, all random: continuous or discrete,
/// barely stable or barely unstable. Parameters: one variance for each noise, one for the first
/// sensor, and either two variances or a full block for the second.
FilterModel random_model(std::mt19937_64& random, int nx, int nu, bool continuous, bool full);

/// N samples that such a model generates: x0 from P0, diffuse states from N(0, 1); inputs white.
/// @param theta    true parameters
/// @param missing  fraction of the samples of each sensor that are missing
/// @param jitter   fraction of dt by which instants of a continuous model are shifted
FilterRecord simulated(const FilterModel& model, const Eigen::VectorXd& theta, int N, double dt,
                       std::mt19937_64& random, double missing = 0, double jitter = 0);

/// The record of a discrete model whose samples are one period apart, as if the model had been
/// linearized at each instant.
FilterRecord linearized(const FilterModel& model, FilterRecord record);

}  // namespace quadtune::testing
