// SPDX-License-Identifier: Apache-2.0
/// Rejects covariances whose tuning did not pass, unless the user insists.
#pragma once

#include "quadtune/workbench/design/design.hpp"

namespace quadtune::cli {

struct Context;

/// Rejects covariances from a tuning whose verdict is not "pass"; with `force`, prints a warning
/// instead.
/// @throws AnswerIsNo
void require_tuned(const DesignOutcome& outcome, bool force, const Context& context);

}  // namespace quadtune::cli
