// SPDX-License-Identifier: Apache-2.0
/// The parts of a loop of N flights that do not depend on the number of rotors. They are compiled
/// in parts_single.cpp and parts_packed.cpp, and not again for each instantiation of ClosedLoop.
#pragma once

#include "quadtune/control/cascaded_pid.hpp"
#include "quadtune/control/limited_allocation.hpp"
#include "quadtune/control/state_feedback_law.hpp"
#include "quadtune/simulation/sensor_channel.hpp"
#include "simulation/loop/estimator_slot.hpp"
#include "simulation/loop/packed_laws.hpp"

#define QUADTUNE_LOOP_PARTS(declaration, N)                                                       \
  namespace quadtune {                                                                            \
  declaration class SensorChannel<N, 1>;                                                          \
  declaration class SensorChannel<N, 2>;                                                          \
  declaration class SensorChannel<N, 3>;                                                          \
  declaration Eigen::Matrix<Pack<N>, 4, 1> step(const CascadedPidSettings<Pack<N>>&,              \
                                                CascadedPidState<Pack<N>>&,                       \
                                                const Estimate<Pack<N>>&,                         \
                                                const Reference<Pack<N>>&);                       \
  declaration Eigen::Matrix<Pack<N>, kMaxRotors, 1> step(const StateFeedbackSettings<Pack<N>>&,   \
                                                         StateFeedbackState<Pack<N>>&,            \
                                                         const Estimate<Pack<N>>&,                \
                                                         const Reference<Pack<N>>&);              \
  }                                                                                               \
  namespace quadtune::internal {                                                                  \
  declaration class EstimatorSlot<N>;                                                             \
  declaration CascadedPidSettings<Pack<N>> packed_cascade<N>(                                     \
      const std::array<const FlightSetup*, N>&);                                                  \
  declaration StateFeedbackSettings<Pack<N>> packed_feedback<N>(                                  \
      const std::array<const FlightSetup*, N>&);                                                  \
  declaration Allocation<Pack<N>> packed_allocation<N>(const std::array<const FlightSetup*, N>&); \
  declaration ThrustLimits<Pack<N>> packed_limits<N>(const std::array<const FlightSetup*, N>&,    \
                                                     int);                                        \
  }

QUADTUNE_LOOP_PARTS(extern template, 1)
#if !defined(QUADTUNE_ONE_AT_A_TIME)
QUADTUNE_LOOP_PARTS(extern template, kPackLanes)
#endif
