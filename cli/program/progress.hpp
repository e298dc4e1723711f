// SPDX-License-Identifier: Apache-2.0
/// How far long work is.
#pragma once

#include <chrono>
#include <string>

namespace quadtune::cli {

struct Context;

/// One line on the error stream that is written over while work goes on, and taken away at its end;
/// on a terminal only, and neither with --quiet nor with --json.
class Progress {
 public:
  /// @param pause  at least so long between two lines
  explicit Progress(const Context& context, std::chrono::milliseconds pause = {});
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  void show(const std::string& line);

  /// Since the work began [s].
  [[nodiscard]] double seconds() const;

 private:
  using Clock = std::chrono::steady_clock;
  const Context& context_;
  bool shown_, drawn_ = false;
  std::chrono::milliseconds pause_;
  Clock::time_point begin_, next_;
};

}  // namespace quadtune::cli
