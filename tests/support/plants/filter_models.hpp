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

/// nx states, nu inputs, two sensors of one and two outputs, all drawn: continuous or discrete,
/// stable or not by a little. Parameters: one variance a noise, one that the first sensor has, and
/// either two variances or a full block for the second.
FilterModel random_model(std::mt19937_64& random, int nx, int nu, bool continuous, bool full);

/// What such a model makes, N samples: x0 from P0, diffuse states from N(0, 1); inputs white.
/// @param theta    of the truth
/// @param missing  share of samples of each sensor that do not come
/// @param jitter   share of dt by which instants of a continuous model move
FilterRecord simulated(const FilterModel& model, const Eigen::VectorXd& theta, int N, double dt,
                       std::mt19937_64& random, double missing = 0, double jitter = 0);

/// The record of a discrete model whose samples are one period apart, as if the model had been
/// linearized at each instant.
FilterRecord linearized(const FilterModel& model, FilterRecord record);

}  // namespace quadtune::testing
