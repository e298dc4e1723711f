// SPDX-License-Identifier: Apache-2.0
/// Code shared by the methods whose discrete state is not the plant's state at the samples.
#pragma once

#include <string>

#include "quadtune/lti.hpp"

namespace quadtune::internal {

/// The plant's names and its C and D; an empty C becomes the identity and an empty D zero. A and B
/// are empty.
[[nodiscard]] DiscreteLti with_explicit_outputs(const ContinuousLti& plant, double dt);

/// @throws InvalidInput  if an entry exceeds the range of a double.
void refuse_overflow(const DiscreteLti& result, const std::string& where);

}  // namespace quadtune::internal
