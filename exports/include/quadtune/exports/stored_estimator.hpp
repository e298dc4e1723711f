// SPDX-License-Identifier: Apache-2.0
/// The estimator that a law was designed with, as gains.json holds it.
#pragma once

#include <optional>
#include <string>

#include "quadtune/estimation/general_filter_settings.hpp"

namespace quadtune {

struct StoredEstimator {
  /// "general", "mambo" or "uquad", as `quadtune fly --estimator` has them. Only the general filter
  /// has numbers here; those of the others are in the files of their programs. True states are no
  /// estimator: a file that named them would hide later that nothing is estimated.
  std::string name;
  std::optional<GeneralFilterSettings> general = {};

  friend bool operator==(const StoredEstimator&, const StoredEstimator&) = default;
};

}  // namespace quadtune
