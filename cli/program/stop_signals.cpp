// SPDX-License-Identifier: Apache-2.0
#include "program/stop_signals.hpp"

#include <poll.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstdint>
#include <ctime>
#include <deque>
#include <mutex>
#include <string_view>

#include "program/program.hpp"

namespace quadtune::cli {
namespace {

// The time between a signal and the end of the process, and the time until the next attempt if
// files are being written [ns].
constexpr long kAfterSignal = 400'000'000;
constexpr long kLookAgain = 20'000'000;
// A second signal within this time counts as the first one: `timeout` sends one to the process and
// one to its process group [ns].
constexpr std::int64_t kSameSignal = 200'000'000;

// All state that the handlers use: lock-free atomics. They call only async-signal-safe functions.
std::atomic<bool> stop_asked{false};
std::atomic<bool> asked_again{false};
std::atomic<bool> told_to_wait{false};
std::atomic<bool> output_begun{false};
enum class Says { nobody, program, timer };
std::atomic<Says> last_said{Says::nobody};
std::atomic<bool> ending_waited_for{false};
std::atomic<std::int64_t> first_asked{0};  // [ns]
std::atomic<int> keepers{0};
/// Number of objects that write files; kEnding once the process is ending, when none may start.
constexpr int kEnding = -1;
std::atomic<int> writers{0};
struct LastWords {
  std::string line, json;
};
std::atomic<const LastWords*> last_words{nullptr};
static_assert(std::atomic<int>::is_always_lock_free);
static_assert(std::atomic<std::int64_t>::is_always_lock_free);
static_assert(std::atomic<const LastWords*>::is_always_lock_free);

timer_t timer;  // created before the handlers are installed
bool on_terminal = false;

void start_timer(long ns) {
  itimerspec when = {};
  when.it_value.tv_nsec = ns;
  ::timer_settime(timer, 0, &when, nullptr);
}

/// Writes nothing if the stream is not ready, e.g. a full pipe that nobody reads.
void say(int stream, std::string_view text) {
  pollfd ready = {stream, POLLOUT, 0};
  if (::poll(&ready, 1, 0) != 1 || (ready.revents & POLLOUT) == 0) return;
  // A single write, so that the text is not mixed with other output.
  [[maybe_unused]] const ssize_t ignored = ::write(stream, text.data(), text.size());
}

void say_line(std::string_view line) {
  // Erases a progress line.
  if (on_terminal) say(STDERR_FILENO, "\r\033[K");
  say(STDERR_FILENO, line);
}

std::int64_t now() {
  timespec time = {};
  ::clock_gettime(CLOCK_MONOTONIC, &time);
  return std::int64_t{time.tv_sec} * 1'000'000'000 + time.tv_nsec;
}

extern "C" void ask_to_stop(int) {
  const int saved = errno;
  if (!stop_asked.exchange(true)) {
    first_asked.store(now());
    start_timer(kAfterSignal);
  } else if (now() - first_asked.load() > kSameSignal) {
    asked_again.store(true);
    start_timer(kLookAgain);
  }
  errno = saved;
}

extern "C" void end_unless_writing(int) {
  const int saved = errno;
  int none = 0;
  Says nobody = Says::nobody;
  if (keepers.load() > 0 && !asked_again.load()) {
    if (!told_to_wait.exchange(true))
      say_line(
          "interrupted: finishing with the best result so far; press Ctrl-C again to quit at "
          "once\n");
    start_timer(kLookAgain);
  } else if (!writers.compare_exchange_strong(none, kEnding) && none != kEnding) {
    start_timer(kLookAgain);
  } else if (last_said.compare_exchange_strong(nobody, Says::timer)) {
    const LastWords* const words = last_words.load();
    say_line(words != nullptr ? words->line : "interrupted\n");
    if (words != nullptr && !output_begun.load()) say(STDOUT_FILENO, words->json);
    ::_exit(kInterrupted);
  } else if (!ending_waited_for.exchange(true)) {
    start_timer(kAfterSignal);  // the program itself is printing its last words
  } else {
    ::_exit(kInterrupted);
  }
  errno = saved;
}

}  // namespace

void install_signal_handlers() {
  on_terminal = ::isatty(STDERR_FILENO) != 0;
  sigevent event = {};
  event.sigev_notify = SIGEV_SIGNAL;
  event.sigev_signo = SIGALRM;
  const bool timed = ::timer_create(CLOCK_MONOTONIC, &event, &timer) == 0;
  struct sigaction action = {};
  action.sa_handler = end_unless_writing;
  ::sigfillset(&action.sa_mask);
  ::sigaction(SIGALRM, &action, nullptr);
  sigset_t alarm;
  ::sigemptyset(&alarm);
  ::sigaddset(&alarm, SIGALRM);
  ::sigprocmask(SIG_UNBLOCK, &alarm, nullptr);
  // Without a timer, the default action of a signal is better than none.
  if (timed) {
    action.sa_handler = ask_to_stop;
    for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
      struct sigaction old = {};
      // nohup ignores SIGHUP.
      if (signal == SIGHUP && ::sigaction(signal, nullptr, &old) == 0 && old.sa_handler == SIG_IGN)
        continue;
      ::sigaction(signal, &action, nullptr);
    }
  }
  // With these signals ignored, a file beyond the size limit or a closed pipe becomes a write
  // error, which is handled, and does not end the process.
  struct sigaction ignore = {};
  ignore.sa_handler = SIG_IGN;
  for (const int signal : {SIGXFSZ, SIGPIPE}) ::sigaction(signal, &ignore, nullptr);
}

bool interrupted() { return stop_asked.load(); }

WritingFiles::WritingFiles() {
  for (int count = writers.load();;) {
    if (count == kEnding) ::pause();  // the process ends now
    if (count == kEnding)
      count = writers.load();
    else if (writers.compare_exchange_weak(count, count + 1))
      return;
  }
}
WritingFiles::~WritingFiles() {
  // Leaves time to report what was written.
  if (interrupted()) start_timer(kAfterSignal);
  --writers;
}

KeepsTheBest::KeepsTheBest() { ++keepers; }
KeepsTheBest::~KeepsTheBest() {
  if (interrupted()) start_timer(kAfterSignal);
  --keepers;
}

void set_last_words(const std::string& line, const std::string& json) {
  // A handler may read any of them at any time until the process ends, so all are kept.
  static std::mutex& mutex = *new std::mutex;
  static std::deque<LastWords>& all = *new std::deque<LastWords>;
  const std::lock_guard lock(mutex);
  all.push_back({line + "\n", json.empty() ? json : json + "\n"});
  last_words.store(&all.back());
}

void take_last_words() {
  Says says = Says::nobody;
  last_said.compare_exchange_strong(says, Says::program);
  while (says == Says::timer) ::pause();  // the process ends now
}

void standard_output_has_begun() { output_begun.store(true); }

}  // namespace quadtune::cli
