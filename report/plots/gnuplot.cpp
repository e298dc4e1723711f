// SPDX-License-Identifier: Apache-2.0
#include "report/plots/gnuplot.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <spawn.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <string_view>
#include <utility>

#include "quadtune/errors.hpp"

namespace quadtune::report {
namespace {

[[noreturn]] void fail(const std::string& file, const std::string& why) {
  throw FileError(file, "not drawn: " + why);
}

/// Two connected ends, closed by the destructor at the latest.
class Channel {
 public:
  /// A socket and not a pipe: writing to a gnuplot that has ended is then an error and not a
  /// signal.
  explicit Channel(const std::string& file) {
    if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends_.data()) != 0)
      fail(file, std::strerror(errno));
  }
  ~Channel() {
    close_ours();
    close_theirs();
  }
  Channel(const Channel&) = delete;
  Channel& operator=(const Channel&) = delete;

  [[nodiscard]] int ours() const { return ends_[0]; }
  [[nodiscard]] int theirs() const { return ends_[1]; }
  [[nodiscard]] bool open() const { return ends_[0] >= 0; }
  void close_ours() { close_end(ends_[0]); }
  void close_theirs() { close_end(ends_[1]); }

 private:
  static void close_end(int& end) {
    if (end >= 0) ::close(std::exchange(end, -1));
  }

  std::array<int, 2> ends_{-1, -1};
};

/// gnuplot as a child process, terminated by the destructor at the latest.
class Child {
 public:
  Child(const Channel& in, const Channel& out, const Channel& err, const std::string& file) {
    posix_spawn_file_actions_t actions;
    posix_spawnattr_t attributes;
    ::posix_spawn_file_actions_init(&actions);
    ::posix_spawnattr_init(&attributes);
    ::posix_spawn_file_actions_adddup2(&actions, in.theirs(), STDIN_FILENO);
    ::posix_spawn_file_actions_adddup2(&actions, out.theirs(), STDOUT_FILENO);
    ::posix_spawn_file_actions_adddup2(&actions, err.theirs(), STDERR_FILENO);
    sigset_t defaults;  // gnuplot must not inherit ignored signals
    ::sigemptyset(&defaults);
    ::sigaddset(&defaults, SIGPIPE);
    ::sigaddset(&defaults, SIGXFSZ);
    ::posix_spawnattr_setsigdefault(&attributes, &defaults);
    ::posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGDEF);
    std::string name = "gnuplot";
    std::string no_start_up_files = "-d";
    std::string standard_input = "-";
    const std::array<char*, 4> arguments = {name.data(), no_start_up_files.data(),
                                            standard_input.data(), nullptr};
    const int error =
        ::posix_spawnp(&pid_, "gnuplot", &actions, &attributes, arguments.data(), environ);
    ::posix_spawnattr_destroy(&attributes);
    ::posix_spawn_file_actions_destroy(&actions);
    if (error == 0) return;
    pid_ = -1;
    if (error == ENOENT)
      fail(file, "gnuplot is not installed; install it, e.g. Debian's package gnuplot-nox");
    fail(file, fmt::format("gnuplot does not start: {}", std::strerror(error)));
  }
  ~Child() {
    if (pid_ <= 0) return;
    ::kill(pid_, SIGKILL);
    (void)wait();
  }
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;

  /// The status of the ended process, as from waitpid().
  [[nodiscard]] int wait() {
    int status = 0;
    while (::waitpid(pid_, &status, 0) < 0 && errno == EINTR) {
    }
    pid_ = -1;
    return status;
  }

 private:
  pid_t pid_ = -1;
};

/// Appends the available output; closes the channel at its end.
void receive(Channel& channel, std::string& text) {
  std::array<char, 65536> buffer;
  const ssize_t n = ::read(channel.ours(), buffer.data(), buffer.size());
  if (n > 0)
    text.append(buffer.data(), static_cast<std::size_t>(n));
  else if (n == 0 || (errno != EINTR && errno != EAGAIN))
    channel.close_ours();
}

/// Sends as much as possible; closes the channel when all is sent or the reader is gone.
void send(Channel& channel, std::string_view& left) {
  const ssize_t n = ::send(channel.ours(), left.data(), left.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
  if (n > 0) left.remove_prefix(static_cast<std::size_t>(n));
  if (left.empty() || (n < 0 && errno != EINTR && errno != EAGAIN)) channel.close_ours();
}

/// The last line with a message: gnuplot shows the command and an arrow before its reason.
std::string reason(const std::string& said) {
  std::string_view text = said;
  while (!text.empty()) {
    const std::size_t start = text.find_last_of('\n');
    std::string_view line = start == std::string_view::npos ? text : text.substr(start + 1);
    text = start == std::string_view::npos ? std::string_view() : text.substr(0, start);
    while (!line.empty() && (line.front() == ' ' || line.front() == '\t')) line.remove_prefix(1);
    if (!line.empty()) return std::string(line);
  }
  return "it gave no reason";
}

}  // namespace

std::string run_gnuplot(const std::string& script, const std::string& file,
                        const std::function<bool()>& stop) {
  Channel in(file);
  Channel out(file);
  Channel err(file);
  Child child(in, out, err, file);
  in.close_theirs();
  out.close_theirs();
  err.close_theirs();
  std::string_view left = script;
  std::string picture;
  std::string said;
  while (out.open() || err.open()) {
    std::array<pollfd, 3> ready = {{{in.open() ? in.ours() : -1, POLLOUT, 0},
                                    {out.open() ? out.ours() : -1, POLLIN, 0},
                                    {err.open() ? err.ours() : -1, POLLIN, 0}}};
    constexpr int kMilliseconds = 200;  // between two calls of `stop`
    if (::poll(ready.data(), ready.size(), kMilliseconds) < 0 && errno != EINTR)
      fail(file, std::strerror(errno));
    if (stop && stop()) throw Interrupted();
    if (ready[0].revents != 0) send(in, left);
    if (ready[1].revents != 0) receive(out, picture);
    if (ready[2].revents != 0) receive(err, said);
  }
  const int status = child.wait();
  if (WIFSIGNALED(status))
    fail(file, fmt::format("gnuplot was ended by signal {}", WTERMSIG(status)));
  if (WEXITSTATUS(status) != 0) fail(file, "gnuplot: " + reason(said));
  if (picture.empty()) fail(file, "gnuplot drew nothing: " + reason(said));
  return picture;
}

}  // namespace quadtune::report
