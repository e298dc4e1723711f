// SPDX-License-Identifier: Apache-2.0
/// Long calls: without the lock of the interpreter (GIL), and ended by Ctrl-C.
#pragma once

#include <functional>
#include <optional>
#include <type_traits>
#include <utility>

namespace quadtune::python {

/// What C++ calls ask from time to time; true ends them.
using Stop = std::function<bool()>;

/// Runs `work` on a thread of its own while the calling thread waits without the GIL. Twenty times
/// a second the caller takes the GIL and runs the signal handlers of Python; if one of them raises,
/// as that of SIGINT does, `stop` is true from then on. `work` may ask it from any thread.
/// @throws what `work` throws, or after a signal the exception of its handler (KeyboardInterrupt)
void run_interruptibly(const std::function<void(const Stop& stop)>& work);

/// The same with a result.
template <class Work>
auto long_call(Work&& work) {
  using Result = std::invoke_result_t<Work, const Stop&>;
  std::optional<Result> result;
  run_interruptibly([&](const Stop& stop) { result.emplace(work(stop)); });
  return std::move(*result);
}

}  // namespace quadtune::python
