// SPDX-License-Identifier: Apache-2.0
/// Texts that try to break out of a page, and a report that is full of them.
#pragma once

#include <string>
#include <vector>

#include "report/page/flight_report.hpp"

namespace quadtune::testing {

/// Each would set data-broken on the page's root element if it could.
[[nodiscard]] const std::vector<std::string>& hostile_texts();

/// A report with all of them in every text field, and with numbers that are not finite.
[[nodiscard]] report::FlightReport hostile_flight();

}  // namespace quadtune::testing
