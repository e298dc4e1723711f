// SPDX-License-Identifier: Apache-2.0
/// Progress of long computations.
#pragma once

#include <chrono>
#include <string>

namespace quadtune::cli {

struct Context;

/// A line on the error stream that is overwritten while the computation runs and erased at its end.
/// It is shown on a terminal only, and neither with --quiet nor with --json.
class Progress {
 public:
  /// @param pause  minimum time between two lines
  explicit Progress(const Context& context, std::chrono::milliseconds pause = {});
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  void show(const std::string& line);

  /// Time since construction [s].
  [[nodiscard]] double seconds() const;

 private:
  using Clock = std::chrono::steady_clock;
  const Context& context_;
  bool shown_, drawn_ = false;
  std::chrono::milliseconds pause_;
  Clock::time_point begin_, next_;
};

}  // namespace quadtune::cli
