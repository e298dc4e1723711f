// SPDX-License-Identifier: Apache-2.0
/// Names of arrays within arrays of a MAT v5 file, which matio stumbles over.
#pragma once

#include <string>
#include <string_view>

namespace quadtune::internal {

/// A variable without the names of the arrays that its structs and cells hold. Their fields name
/// them already, so most programs leave these names empty; Simulink's generated code does not, and
/// matio 1.5.23 then loses the place within them.
/// @param element  An uncompressed variable with its tag that require_mat_v5() has accepted.
[[nodiscard]] std::string without_inner_names(std::string_view element);

}  // namespace quadtune::internal
