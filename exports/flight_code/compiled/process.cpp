// SPDX-License-Identifier: Apache-2.0
#include "flight_code/compiled/process.hpp"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <sstream>

#include "quadtune/errors.hpp"

extern char** environ;  // NOLINT(readability-redundant-declaration): no POSIX header declares it

namespace quadtune::exports {
namespace {

/// Blocks SIGPIPE, so that writing to a program that has ended does not terminate this one.
class NoBrokenPipeSignal {
 public:
  NoBrokenPipeSignal() {
    sigemptyset(&pipe_);
    sigaddset(&pipe_, SIGPIPE);
    pthread_sigmask(SIG_BLOCK, &pipe_, &before_);
  }
  ~NoBrokenPipeSignal() {
    const timespec none = {0, 0};
    while (sigtimedwait(&pipe_, nullptr, &none) > 0) {
    }
    pthread_sigmask(SIG_SETMASK, &before_, nullptr);
  }
  NoBrokenPipeSignal(const NoBrokenPipeSignal&) = delete;
  NoBrokenPipeSignal& operator=(const NoBrokenPipeSignal&) = delete;

 private:
  sigset_t pipe_, before_;
};

}  // namespace

Process::Process(const std::vector<std::string>& words) {
  std::array<int, 2> to{}, from{};
  if (pipe2(to.data(), O_CLOEXEC) != 0) throw FileError(words.front(), std::strerror(errno));
  if (pipe2(from.data(), O_CLOEXEC) != 0) {
    close(to[0]);
    close(to[1]);
    throw FileError(words.front(), std::strerror(errno));
  }
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, to[0], STDIN_FILENO);
  posix_spawn_file_actions_adddup2(&actions, from[1], STDOUT_FILENO);
  posix_spawn_file_actions_adddup2(&actions, from[1], STDERR_FILENO);
  std::vector<char*> arguments;
  for (const std::string& word : words)
    arguments.push_back(const_cast<char*>(word.c_str()));  // NOLINT: exec() does not write to them
  arguments.push_back(nullptr);
  const int error = posix_spawnp(&id_, arguments[0], &actions, nullptr, arguments.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  close(to[0]);
  close(from[1]);
  in_ = to[1];
  out_ = from[0];
  if (error == 0) return;
  id_ = -1;
  close(in_);
  close(out_);
  throw FileError(words.front(), std::strerror(error));
}

Process::~Process() {
  close_input();
  if (out_ >= 0) close(out_);
  if (id_ < 0) return;
  kill(id_, SIGTERM);
  (void)wait();
}

void Process::close_input() {
  if (in_ >= 0) close(in_);
  in_ = -1;
}

bool Process::write(const std::string& text) {
  const NoBrokenPipeSignal none;
  for (std::size_t done = 0; done < text.size();) {
    const ssize_t count = ::write(in_, text.data() + done, text.size() - done);
    if (count < 0 && errno != EINTR) return false;
    if (count > 0) done += static_cast<std::size_t>(count);
  }
  return true;
}

bool Process::fill() {
  std::array<char, 4096> part{};
  ssize_t count = 0;
  do {
    count = read(out_, part.data(), part.size());
  } while (count < 0 && errno == EINTR);
  if (count <= 0) return false;
  buffer_.append(part.data(), static_cast<std::size_t>(count));
  return true;
}

std::optional<std::string> Process::read_line() {
  std::size_t end = 0;
  while ((end = buffer_.find('\n')) == std::string::npos)
    if (!fill()) return {};
  std::string line = buffer_.substr(0, end);
  buffer_.erase(0, end + 1);
  return line;
}

int Process::wait() {
  constexpr int kUnknown = 255;  // no status is available if SIGCHLD is ignored
  int status = 0;
  pid_t ended = 0;
  do {
    ended = waitpid(id_, &status, 0);
  } while (ended < 0 && errno == EINTR);
  id_ = -1;
  if (ended < 0) return kUnknown;
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

int Process::finish(std::string& said) {
  close_input();
  while (fill()) {
  }
  said = buffer_;
  return wait();
}

bool has_program(const std::string& name) {
  const char* path = std::getenv("PATH");
  std::istringstream folders(path != nullptr ? path : "/usr/bin:/bin");
  for (std::string file; std::getline(folders, file, ':');)
    if (access(file.append("/").append(name).c_str(), X_OK) == 0) return true;
  return false;
}

}  // namespace quadtune::exports
