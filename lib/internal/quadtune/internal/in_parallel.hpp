// SPDX-License-Identifier: Apache-2.0
/// Work in numbered parts on several threads, such that the result depends on the parts alone.
#pragma once

#include <cstddef>
#include <functional>

namespace quadtune::internal {

/// Number of threads that is meant: as asked for, at least 1, or one for each processor if 0.
[[nodiscard]] std::size_t thread_count(std::size_t asked);

/// One thread's worker: does the part of the given number.
using PartWorker = std::function<void(std::size_t part)>;

/// Does parts 0 … parts - 1, each once, in no certain order. When the caller is itself one of
/// several threads of such work, that thread does all parts alone, so that threads do not multiply.
///
/// @param make_worker  called once on each thread, before its first part
/// @param interrupted  asked before each part, by any thread; true abandons the work. May be empty.
/// @throws what a part throws, that of the lowest number; Interrupted when `interrupted` says so.
void in_parallel(std::size_t parts, std::size_t threads,
                 const std::function<PartWorker()>& make_worker,
                 const std::function<bool()>& interrupted);

}  // namespace quadtune::internal
