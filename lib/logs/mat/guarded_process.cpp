// SPDX-License-Identifier: Apache-2.0
#include "logs/mat/guarded_process.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <csignal>
#include <cstring>
#include <utility>

#include "quadtune/errors.hpp"

namespace quadtune::internal {
namespace {

// AddressSanitizer reserves terabytes of addresses.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr bool kKeepsAddresses = false;
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
constexpr bool kKeepsAddresses = false;
#else
constexpr bool kKeepsAddresses = true;
#endif
#else
constexpr bool kKeepsAddresses = true;
#endif

// Of the processor time that it may take, how often a silent child may have passed on the clock: a
// loaded machine gives it a share.
constexpr double kSilence = 5;

void limit(__rlimit_resource_t what, rlim_t most) {
  rlimit now{};
  if (::getrlimit(what, &now) != 0) return;
  now.rlim_cur = std::min(now.rlim_max, most);
  now.rlim_max = now.rlim_cur;
  ::setrlimit(what, &now);
}

// What the libraries print is no business of the user's, and a core dump helps nobody.
void confine(const ProcessLimits& limits) {
  if (kKeepsAddresses) limit(RLIMIT_AS, limits.memory);
  limit(RLIMIT_CPU, static_cast<rlim_t>(std::ceil(limits.time_s)));
  limit(RLIMIT_CORE, 0);
  const int nowhere = ::open("/dev/null", O_WRONLY | O_CLOEXEC);
  if (nowhere >= 0) {
    ::dup2(nowhere, STDOUT_FILENO);
    ::dup2(nowhere, STDERR_FILENO);
  }
  for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGXCPU}) ::signal(signal, SIG_DFL);
}

}  // namespace

bool write_fully(int pipe, const void* bytes, std::size_t size) {
  const auto* at = static_cast<const char*>(bytes);
  while (size > 0) {
    const ssize_t done = ::write(pipe, at, size);
    if (done < 0 && errno == EINTR) continue;
    if (done <= 0) return false;
    at += done;
    size -= static_cast<std::size_t>(done);
  }
  return true;
}

GuardedProcess::GuardedProcess(const ProcessLimits& limits,
                               const std::function<void(int pipe)>& work)
    : limits_(limits) {
  std::array<int, 2> ends{};
  if (::pipe2(ends.data(), O_CLOEXEC) != 0) throw FileError("a pipe", std::strerror(errno));
  const pid_t parent = ::getpid();
  child_ = ::fork();
  if (child_ < 0) {
    const int error = errno;
    ::close(ends[0]);
    ::close(ends[1]);
    throw FileError("a process to read the file in", std::strerror(error));
  }
  if (child_ == 0) {
    ::close(ends[0]);
    // Nobody waits for it once the parent is gone, which a signal may end at any time.
    ::prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (::getppid() != parent) ::_exit(1);
    ::signal(SIGPIPE, SIG_IGN);
    confine(limits);
    work(ends[1]);
    ::_exit(0);
  }
  ::close(ends[1]);
  pipe_ = ends[0];
}

GuardedProcess::~GuardedProcess() {
  if (pipe_ >= 0) ::close(pipe_);
  if (child_ < 0) return;
  ::kill(child_, SIGKILL);
  while (::waitpid(child_, nullptr, 0) < 0 && errno == EINTR) {
  }
}

bool GuardedProcess::wait_for_bytes() {
  pollfd wanted{pipe_, POLLIN, 0};
  const int most_ms = static_cast<int>(std::min(1e9, std::ceil(kSilence * limits_.time_s * 1e3)));
  while (true) {
    const int ready = ::poll(&wanted, 1, most_ms);
    if (ready < 0 && errno == EINTR) continue;
    silent_ = ready == 0;
    return ready > 0;
  }
}

bool GuardedProcess::read(void* bytes, std::size_t size) {
  auto* at = static_cast<char*>(bytes);
  while (size > 0) {
    if (!wait_for_bytes()) return false;
    const ssize_t got = ::read(pipe_, at, size);
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) return false;
    at += got;
    size -= static_cast<std::size_t>(got);
  }
  return true;
}

std::string GuardedProcess::why_ended() {
  if (silent_) return fmt::format("took longer than {} s", kSilence * limits_.time_s);
  // A child that still writes ends by that.
  ::close(std::exchange(pipe_, -1));
  int status = 0;
  while (::waitpid(child_, &status, 0) < 0)
    if (errno != EINTR) return "ended";
  child_ = -1;
  if (WIFSIGNALED(status) && (WTERMSIG(status) == SIGXCPU || WTERMSIG(status) == SIGKILL))
    return fmt::format("ran into its limits of {} s and {} MiB", limits_.time_s,
                       limits_.memory >> 20U);
  if (WIFSIGNALED(status)) return fmt::format("was ended by signal {}", WTERMSIG(status));
  return fmt::format("ended with status {}", WEXITSTATUS(status));
}

}  // namespace quadtune::internal
