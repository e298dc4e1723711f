// SPDX-License-Identifier: Apache-2.0
#include "run_cases.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/resource.h>
#include <sys/time.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <csignal>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <string_view>
#include <typeinfo>

#include "program/program.hpp"

namespace quadtune::mutations {
namespace {

namespace fs = std::filesystem;

constexpr int kDeaf = 97;
constexpr std::uint64_t kBatch = 200;  // cases per child process, so that leaked resources end with
                                       // it

std::string read_file(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  std::ostringstream text;
  text << stream.rdbuf();
  return text.str();
}

std::string first_lines(const std::string& text, int max) {
  std::istringstream lines(text);
  std::string result;
  for (std::string line; max > 0 && std::getline(lines, line); --max) result += line + "\n";
  return result;
}

// --- in the child ---

volatile std::sig_atomic_t alarms = 0;
volatile std::sig_atomic_t pipe_to_parent = -1;

/// A signal may end the process anywhere in the program, so this is reported before.
extern "C" void on_alarm(int) {
  alarms = alarms + 1;
  if (alarms > 1) ::_exit(kDeaf);
  constexpr std::string_view line = "asked 0\n";
  [[maybe_unused]] const ssize_t ignored = ::write(pipe_to_parent, line.data(), line.size());
  ::kill(::getpid(), SIGTERM);
}

/// The processor time of the process from now on.
void set_alarm(double first_s, double again_s) {
  const auto time = [](double s) {
    const double whole = std::floor(s);
    return timeval{static_cast<time_t>(whole), static_cast<suseconds_t>((s - whole) * 1e6)};
  };
  const itimerval timer{time(again_s), time(first_s)};
  ::setitimer(ITIMER_PROF, &timer, nullptr);
}

void limit(__rlimit_resource_t what, rlim_t max) {
  rlimit now{};
  ::getrlimit(what, &now);
  now.rlim_cur = std::min(now.rlim_max, max);
  now.rlim_max = now.rlim_cur;
  ::setrlimit(what, &now);
}

class Child {
 public:
  Child(const Run& run, int pipe) : run_(run), pipe_(pipe) {
    pipe_to_parent = pipe;
    cli::install_signal_handlers();
    struct sigaction action = {};
    action.sa_handler = on_alarm;
    action.sa_flags = SA_RESTART;
    ::sigaction(SIGPROF, &action, nullptr);
    limit(RLIMIT_CORE, 0);
    limit(RLIMIT_FSIZE, rlim_t{256} << 20U);
    if (run.limits.memory > 0) limit(RLIMIT_AS, run.limits.memory);
    const int noise = ::open((run.place / "noise").c_str(), O_CREAT | O_TRUNC | O_WRONLY, 0600);
    ::dup2(noise, STDOUT_FILENO);
    ::dup2(noise, STDERR_FILENO);
    const int nothing = ::open("/dev/null", O_RDONLY);
    ::dup2(nothing, STDIN_FILENO);
  }

  /// Reports the current case before and after it, so that the parent knows which case ended the
  /// process.
  void run(std::uint64_t number) {
    tell(fmt::format("case {}\n", number));
    const Case one = run_.make(number);
    const fs::path folder = run_.place / "case";
    for (std::size_t i = 0; i < one.commands.size(); ++i) {
      tell(fmt::format("command {}\n", i));
      fs::remove_all(folder);
      fs::create_directories(folder);
      for (const auto& [name, bytes] : one.files) {
        fs::create_directories((folder / name).parent_path());
        std::ofstream(folder / name, std::ios::binary) << bytes;
      }
      if (::chdir(folder.c_str()) != 0) throw std::runtime_error("chdir");
      run(one.commands[i], one.files, folder);
      if (alarms > 0) break;  // the flag of the program cannot be cleared
    }
    if (::chdir(run_.place.c_str()) != 0) throw std::runtime_error("chdir");
    fs::remove_all(folder);
    tell("done 0\n");
  }
  [[nodiscard]] bool worn() const { return alarms > 0; }

  void tell(const std::string& line) {
    for (std::size_t at = 0; at < line.size();) {
      const ssize_t n = ::write(pipe_, line.data() + at, line.size() - at);
      if (n < 0 && errno == EINTR) continue;
      if (n <= 0) ::_exit(96);
      at += static_cast<std::size_t>(n);
    }
  }

 private:
  void run(const Command& command, const Files& files, const fs::path& folder) {
    testing::ProgramResult result;
    set_alarm(run_.limits.patience_s, run_.limits.grace_s);
    try {
      result = run_.program(command, folder.string());
    } catch (const std::exception& error) {
      set_alarm(0, 0);
      complain(fmt::format("an exception leaves it: {}: {}", typeid(error).name(), error.what()));
      return;
    }
    set_alarm(0, 0);
    tell(fmt::format("status {}\n", result.status));
    const std::string what = complaint(command, result, alarms > 0, files);
    if (!what.empty()) complain(what + ": " + result.err);
    if (::lseek(STDERR_FILENO, 0, SEEK_CUR) > 0) {
      complain("writes past its streams: " + read_file(run_.place / "noise"));
      if (::ftruncate(STDERR_FILENO, 0) == 0) ::lseek(STDERR_FILENO, 0, SEEK_SET);
    }
    for (const auto& entry : fs::recursive_directory_iterator(folder))
      if (entry.path().string().ends_with(".quadtune-tmp"))
        complain("leaves " + entry.path().filename().string());
    // An export, a table, a report: complete or absent.
    if (result.status >= 2 && result.status <= 4 && command[0] != "campaign" &&
        std::find(command.begin(), command.end(), "--force") == command.end() &&
        std::find(command.begin(), command.end(), "@/out") != command.end() &&
        fs::exists(folder / "out"))
      complain(fmt::format("ends with {} and has written", result.status));
  }

  void complain(std::string what) {
    std::replace(what.begin(), what.end(), '\n', '\r');
    tell("found " + what.substr(0, 3000) + "\n");
  }
  const Run& run_;
  int pipe_;
};

// --- in the parent ---

/// One child and its output.
class Supervisor {
 public:
  Supervisor(const Run& run, Tally& tally) : run_(run), tally_(tally) {}

  /// Runs cases from `from` on in a child. Returns the next case.
  std::uint64_t run(std::uint64_t from, std::uint64_t to) {
    std::array<int, 2> ends{};
    if (::pipe2(ends.data(), O_CLOEXEC) != 0) throw std::runtime_error("no pipe");
    const pid_t child = ::fork();
    if (child < 0) throw std::runtime_error("no process");
    if (child == 0) {
      ::close(ends[0]);
      be_child(ends[1], from, to);
    }
    ::close(ends[1]);
    next_ = from;
    busy_ = false;
    asked_ = false;
    const bool silent = !listen(ends[0]);
    ::close(ends[0]);
    if (silent) ::kill(child, SIGKILL);
    int status = 0;
    while (::waitpid(child, &status, 0) < 0 && errno == EINTR) {
    }
    if (asked_ && WIFEXITED(status) && WEXITSTATUS(status) == 130) {
      if (busy_) hear("done 0");
    } else if (busy_) {
      report(how_it_ended(status, silent));
      next_ = number_ + 1;
    } else if (!WIFEXITED(status) || WEXITSTATUS(status) != 0) {
      throw std::runtime_error("a child ended between cases: " + read_file(run_.place / "noise"));
    }
    return next_;
  }

 private:
  [[noreturn]] void be_child(int pipe, std::uint64_t from, std::uint64_t to) {
    try {
      Child child(run_, pipe);
      for (std::uint64_t i = 0; i < kBatch && from < to && !child.worn() && !run_.enough(); ++from)
        if (run_.wanted(from)) {
          child.run(from);
          ++i;
        }
      child.tell(fmt::format("next {}\n", from));
    } catch (const std::exception& error) {
      (void)!::write(STDERR_FILENO, error.what(), std::char_traits<char>::length(error.what()));
      ::_exit(98);
    }
    ::_exit(0);
  }

  /// False if it was silent for too long.
  bool listen(int pipe) {
    std::string text;
    std::array<char, 65536> buffer{};
    while (true) {
      pollfd ready{pipe, POLLIN, 0};
      const int count = ::poll(&ready, 1, static_cast<int>(1000 * run_.limits.wall_s));
      if (count < 0 && errno == EINTR) continue;
      if (count <= 0) return false;
      const ssize_t n = ::read(pipe, buffer.data(), buffer.size());
      if (n < 0 && errno == EINTR) continue;
      if (n <= 0) return true;
      text.append(buffer.data(), static_cast<std::size_t>(n));
      for (std::size_t end = text.find('\n'); end != std::string::npos; end = text.find('\n')) {
        hear(text.substr(0, end));
        text.erase(0, end + 1);
      }
    }
  }

  void hear(const std::string& line) {
    const std::size_t blank = line.find(' ');
    const std::string word = line.substr(0, blank), rest = line.substr(blank + 1);
    if (word == "case") {
      number_ = std::stoull(rest);
      command_ = 0;
      busy_ = true;
    } else if (word == "command") {
      command_ = std::stoull(rest);
    } else if (word == "status") {
      ++tally_.statuses[std::stoi(rest)];
      ++tally_.commands;
    } else if (word == "asked") {
      ++tally_.stopped;
      asked_ = true;
    } else if (word == "found") {
      std::string what = rest;
      std::replace(what.begin(), what.end(), '\r', '\n');
      report(what);
    } else if (word == "next") {
      next_ = std::stoull(rest);
    } else if (word == "done") {
      ++tally_.cases;
      busy_ = false;
      next_ = number_ + 1;
    }
  }

  void report(const std::string& what) {
    ++tally_.findings;
    Finding finding{run_.make(number_), {}, what};
    if (command_ < finding.of.commands.size()) finding.command = finding.of.commands[command_];
    run_.found(finding);
  }

  [[nodiscard]] std::string how_it_ended(int status, bool silent) const {
    const std::string noise = first_lines(read_file(run_.place / "noise"), 40);
    if (silent) return fmt::format("gives no sign of life for {} s: {}", run_.limits.wall_s, noise);
    if (WIFEXITED(status) && WEXITSTATUS(status) == kDeaf)
      return fmt::format("goes on for {} s of the processor after SIGTERM", run_.limits.grace_s);
    if (WIFSIGNALED(status))
      return fmt::format("is ended by signal {}: {}", WTERMSIG(status), noise);
    return fmt::format("ends the process with {}: {}", WEXITSTATUS(status), noise);
  }

  const Run& run_;
  Tally& tally_;
  std::uint64_t number_ = 0, next_ = 0;
  std::size_t command_ = 0;
  bool busy_ = false;
  bool asked_ = false;  ///< to stop
};

}  // namespace

Tally run_cases(const Run& run, std::uint64_t from, std::uint64_t to) {
  fs::create_directories(run.place);
  Tally tally;
  while (from < to && !run.enough()) {
    Supervisor supervisor(run, tally);
    from = supervisor.run(from, to);
  }
  fs::remove_all(run.place);
  return tally;
}

}  // namespace quadtune::mutations
