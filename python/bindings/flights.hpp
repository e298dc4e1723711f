// SPDX-License-Identifier: Apache-2.0
/// A flight as Python has it.
#pragma once

#include <optional>

#include "quadtune/workbench/design/chosen_law.hpp"
#include "quadtune/workbench/flight/diagnosis.hpp"
#include "quadtune/workbench/flight/fly.hpp"
#include "support/arguments.hpp"
#include "support/results.hpp"

namespace quadtune::python {

struct Flight {
  FlownFlight flown;
  std::optional<Diagnosis> diagnosis;  ///< of one that failed, where it was asked for
};

/// The figures that a flight has, by name.
[[nodiscard]] pybind11::dict metrics_of(const MetricValues& values);

}  // namespace quadtune::python
