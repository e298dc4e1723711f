// SPDX-License-Identifier: Apache-2.0
/// Forward declaration of Json, for headers.
#pragma once

namespace quadtune::internal {

class Json;

}  // namespace quadtune::internal
