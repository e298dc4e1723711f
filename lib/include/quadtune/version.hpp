// SPDX-License-Identifier: Apache-2.0
/// The version of quadtune. The build and the installed package take theirs from this line.
#pragma once

namespace quadtune {

/// Semantic version, "major.minor.patch".
inline constexpr const char kVersion[] = "0.1.0";

}  // namespace quadtune
