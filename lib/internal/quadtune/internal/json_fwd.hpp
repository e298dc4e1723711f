// SPDX-License-Identifier: Apache-2.0
/// The name of a JSON value, for headers.
#pragma once

namespace quadtune::internal {

class Json;

}  // namespace quadtune::internal
