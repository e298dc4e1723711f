// SPDX-License-Identifier: Apache-2.0
/// Covariances that logs did not prove are refused, or taken where the user insists.
#pragma once

#include "quadtune/workbench/design/design.hpp"

namespace quadtune::cli {

struct Context;

/// Refuses covariances from a tuning whose verdict is another than pass, or with `force` notes it.
/// @throws AnswerIsNo
void require_tuned(const DesignOutcome& outcome, bool force, const Context& context);

}  // namespace quadtune::cli
