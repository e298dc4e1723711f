// SPDX-License-Identifier: Apache-2.0
#include "arguments/trusted_covariances.hpp"

#include <fmt/format.h>

#include "program/program.hpp"
#include "program/refusal.hpp"

namespace quadtune::cli {

void require_tuned(const DesignOutcome& outcome, bool force, const Context& context) {
  const std::string file = outcome.design.file.string();
  for (const std::string& doubt : unconfirmed_covariances(outcome.design)) {
    if (!force) throw Refusal(fmt::format("{}: {}; use --force to accept it", file, doubt), file);
    context.note("warning: " + doubt);
  }
}

}  // namespace quadtune::cli
