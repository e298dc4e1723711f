// SPDX-License-Identifier: Apache-2.0
#include "program/progress.hpp"

#include <unistd.h>

#include <ostream>

#include "program/program.hpp"

namespace quadtune::cli {

Progress::Progress(const Context& context, std::chrono::milliseconds pause)
    : context_(context),
      shown_(!context.quiet && !context.json && isatty(STDERR_FILENO) != 0),
      pause_(pause),
      begin_(Clock::now()),
      next_(begin_) {}

Progress::~Progress() {
  if (drawn_) context_.err << "\r\033[K" << std::flush;
}

void Progress::show(const std::string& line) {
  const Clock::time_point now = Clock::now();
  if (!shown_ || now < next_) return;
  next_ = now + pause_;
  context_.err << "\r\033[K" << line << std::flush;
  drawn_ = true;
}

double Progress::seconds() const {
  return std::chrono::duration<double>(Clock::now() - begin_).count();
}

}  // namespace quadtune::cli
