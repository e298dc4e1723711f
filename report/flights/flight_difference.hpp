// SPDX-License-Identifier: Apache-2.0
/// Where two flights of one mission part, as text and JSON.
#pragma once

#include <string>

#include "quadtune/internal/json_fwd.hpp"
#include "quadtune/workbench/flight/flight_difference.hpp"
#include "report/flights/flight_text.hpp"

namespace quadtune::report {

[[nodiscard]] internal::Json to_json(const ComparedFlights& compared);
[[nodiscard]] std::string to_text(const ComparedFlights& compared);

}  // namespace quadtune::report
