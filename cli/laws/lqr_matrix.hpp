// SPDX-License-Identifier: Apache-2.0
/// `lqr V --structure matrix`: gains of a given structure for programs that hold matrices alone.
#pragma once

#include <string>

#include "laws/lqr_flown.hpp"
#include "program/program.hpp"
#include "quadtune/workbench/design/matrix_report.hpp"
#include "quadtune/workbench/flown/flown_gains.hpp"

namespace quadtune::cli {

/// Runs the verb.
/// @param asks_for_inputs  whether --inputs came; otherwise the inputs are the wrench
void run_matrix_lqr(const LqrArguments& common, const FlownLqrArguments& arguments,
                    bool asks_for_inputs, Context& context);

}  // namespace quadtune::cli
