// SPDX-License-Identifier: Apache-2.0
/// `lqr V --structure matrix`: gains of a given structure for programs that hold matrices alone.
#pragma once

#include <string>

#include "laws/lqr_flown.hpp"
#include "program/program.hpp"
#include "quadtune/internal/json_fwd.hpp"
#include "quadtune/workbench/design/matrix_report.hpp"
#include "quadtune/workbench/flown/flown_gains.hpp"

namespace quadtune::cli {

/// Margins of each group of axes on each plant of the family that gains were designed for.
[[nodiscard]] std::string family_text(const FlownGains& flown);
[[nodiscard]] internal::Json family_json(const FlownGains& flown);

/// The gains with their evidence.
[[nodiscard]] internal::Json to_json(const MatrixReport& report, const Vehicle& vehicle);
[[nodiscard]] std::string to_text(const MatrixReport& report);

/// Runs the verb.
/// @param asks_for_inputs  whether --inputs came; otherwise the inputs are the wrench
void run_matrix_lqr(const LqrArguments& common, const FlownLqrArguments& arguments,
                    bool asks_for_inputs, Context& context);

}  // namespace quadtune::cli
