// SPDX-License-Identifier: Apache-2.0
/// A note for commands that use an export without verifying it.
#pragma once

#include <string>

namespace quadtune {

/// Names the first file of an export that is not the one that its manifest lists.
/// @param directory  of an export; anything else has no manifest and gives no note
/// @return  empty if all files match the manifest, or if there is none that can be read
[[nodiscard]] std::string changed_export(const std::string& directory);

}  // namespace quadtune
