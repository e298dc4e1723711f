// SPDX-License-Identifier: Apache-2.0
/// The matrices of a Kalman filter by their names in files.
#pragma once

#include "quadtune/filter.hpp"

namespace quadtune::exports {

/// Calls f("A", matrix) for each matrix, in the order of the files. Shapes: KalmanFilter.
/// @tparam Filter  KalmanFilter or const KalmanFilter
template <class Filter, class Function>
void each_matrix(Filter& filter, const Function& f) {
  f("A", filter.model.A);
  f("B", filter.model.B);
  f("C", filter.model.C);
  f("G", filter.G);
  f("Q", filter.Q);
  f("R", filter.R);
  f("N", filter.N);
  f("M", filter.M);
  f("L", filter.L);
  f("P", filter.P);
  f("Z", filter.Z);
}

}  // namespace quadtune::exports
