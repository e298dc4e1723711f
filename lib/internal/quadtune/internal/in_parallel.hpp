// SPDX-License-Identifier: Apache-2.0
/// Runs numbered parts of a computation on several threads; the result does not depend on their
/// number.
#pragma once

#include <cstddef>
#include <functional>

namespace quadtune::internal {

/// The number of threads to use: `asked`, or one per processor if it is 0; at least 1.
[[nodiscard]] std::size_t thread_count(std::size_t asked);

/// The worker of one thread: executes the part with the given number.
using PartWorker = std::function<void(std::size_t part)>;

/// Executes parts 0 … parts - 1 once each, in unspecified order. If the calling thread already
/// belongs to such a computation, it executes all parts itself, so that the number of threads does
/// not multiply.
///
/// @param make_worker  called once on each thread before its first part
/// @param interrupted  called before each part by any thread; true cancels the remaining parts. May
///                     be empty.
/// @throws the exception of the failed part with the lowest number; Interrupted if `interrupted`
/// returned true.
void in_parallel(std::size_t parts, std::size_t threads,
                 const std::function<PartWorker()>& make_worker,
                 const std::function<bool()>& interrupted);

}  // namespace quadtune::internal
