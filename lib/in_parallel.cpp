// SPDX-License-Identifier: Apache-2.0
#include "quadtune/internal/in_parallel.hpp"

#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <system_error>
#include <thread>
#include <utility>
#include <vector>

#include "quadtune/errors.hpp"

namespace quadtune::internal {
namespace {

/// The state that all threads share: the next part, and the failure to report.
class Board {
 public:
  Board(std::size_t parts, const std::function<bool()>& interrupted)
      : parts_(parts), interrupted_(interrupted) {}

  /// The next part, or `parts` if none is left. Parts are assigned in ascending order, so that all
  /// parts below a failed one are executed and the lowest failure is always the same.
  std::size_t take() {
    if (stop_.load()) return parts_;
    if (interrupted_ && interrupted_()) {
      fail(parts_, std::make_exception_ptr(Interrupted()));
      return parts_;
    }
    return std::min(next_.fetch_add(1), parts_);
  }

  void fail(std::size_t part, std::exception_ptr error) {
    const std::lock_guard lock(mutex_);
    stop_.store(true);
    if (error_ && failed_ <= part) return;
    failed_ = part;
    error_ = std::move(error);
  }

  void rethrow() const {
    if (error_) std::rethrow_exception(error_);
  }

  [[nodiscard]] std::size_t parts() const { return parts_; }

 private:
  std::size_t parts_;
  const std::function<bool()>& interrupted_;
  std::atomic<std::size_t> next_{0};
  std::atomic<bool> stop_{false};
  std::mutex mutex_;
  std::size_t failed_ = 0;
  std::exception_ptr error_;
};

/// Whether this thread is one of several that share a computation.
thread_local bool shares_work = false;

void work(Board& board, const std::function<PartWorker()>& make_worker) {
  std::size_t part = board.take();
  try {
    if (part == board.parts()) return;
    const PartWorker worker = make_worker();
    for (; part < board.parts(); part = board.take()) worker(part);
  } catch (...) {
    board.fail(part, std::current_exception());
  }
}

}  // namespace

std::size_t thread_count(std::size_t asked) {
  return asked > 0 ? asked : std::max(1u, std::thread::hardware_concurrency());
}

void in_parallel(std::size_t parts, std::size_t threads,
                 const std::function<PartWorker()>& make_worker,
                 const std::function<bool()>& interrupted) {
  Board board(parts, interrupted);
  {
    std::vector<std::jthread> others;
    const std::size_t count = shares_work ? 1 : std::min(threads, parts);
    others.reserve(count);
    try {
      for (std::size_t i = 1; i < count; ++i)
        others.emplace_back([&board, &make_worker] {
          shares_work = true;
          work(board, make_worker);
        });
    } catch (const std::system_error&) {
      // The system provides no more threads: the existing ones do all parts.
    }
    const bool before = std::exchange(shares_work, shares_work || count > 1);
    work(board, make_worker);  // this thread takes part as well; work() does not throw
    shares_work = before;
  }
  board.rethrow();
}

}  // namespace quadtune::internal
