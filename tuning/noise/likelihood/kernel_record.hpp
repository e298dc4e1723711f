// SPDX-License-Identifier: Apache-2.0
/// A record in the form that the likelihood kernel reads, and the size limits of the kernel.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <functional>

#include "quadtune/errors.hpp"
#include "quadtune/estimation/filter_record.hpp"

namespace quadtune::internal {

/// Largest number of states of a model, and of outputs of all its sensors.
inline constexpr int kMaxStates = 24;
inline constexpr int kMaxOutputs = 64;

/// Options of a run of a filter over the records.
struct RunOptions {
  bool hold_steady_gains = true;
  std::function<bool()> stop = {};  ///< true ends the run; may be empty

  /// Number of samples between calls of `stop`, so that their cost is negligible.
  static constexpr Eigen::Index kEvery = 1024;
  /// @throws Interrupted  where `stop` says so
  void ask() const {
    if (stop && stop()) throw Interrupted();
  }
};

/// Equal instants: all outputs measured, the same transition.
struct KernelSegment {
  Eigen::Index begin = 0, end = 0;
  bool complete = false;  ///< false: outputs may be missing and transitions may differ
};

struct KernelRecord {
  const double* y = nullptr;  ///< (ny × samples)
  const double* u = nullptr;  ///< (nu × samples)
  Eigen::Index samples = 0, ny = 0, nu = 0;
  const std::uint32_t* transition = nullptr;  ///< from each sample to the next
  const KernelSegment* segments = nullptr;
  std::size_t segment_count = 0;
  const LinearizedInstant* linearized = nullptr;  ///< one per sample; null if the model is linear
  const FilterStart* start = nullptr;             ///< null: that of the model
};

}  // namespace quadtune::internal
