// SPDX-License-Identifier: Apache-2.0
#include "browser.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <sstream>
#include <thread>

#include "temporary_directory.hpp"

namespace quadtune::testing {
namespace {

using namespace std::chrono_literals;

/// Options of every run: no window, no sandbox for root, no background services.
const std::vector<std::string> kAlways = {
    "--headless",
    "--no-sandbox",
    "--disable-dev-shm-usage",
    "--use-gl=angle",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-default-apps",
    "--disable-extensions",
    "--disable-sync",
    "--disable-breakpad",
    "--no-first-run",
    "--hide-scrollbars",
    "--force-device-scale-factor=1",
    "--host-resolver-rules=MAP * ~NOTFOUND",
    "--virtual-time-budget=4000",
};

// A loaded machine without a graphics processor is slow, and sometimes the browser hangs.
constexpr auto kPatience = 100s;
constexpr int kStarts = 3;

/// The environment with another home directory, where the browser may write.
std::vector<std::string> environment(const std::string& home) {
  std::vector<std::string> result = {"HOME=" + home, "XDG_CONFIG_HOME=" + home,
                                     "XDG_CACHE_HOME=" + home};
  for (char** entry = environ; *entry; ++entry) {
    const std::string text = *entry;
    if (!text.starts_with("HOME=") && !text.starts_with("XDG_")) result.push_back(text);
  }
  return result;
}

std::vector<char*> pointers(std::vector<std::string>& texts) {
  std::vector<char*> result;
  result.reserve(texts.size() + 1);
  for (std::string& text : texts) result.push_back(text.data());
  result.push_back(nullptr);
  return result;
}

BrowserResult start_browser(const std::string& file, const std::vector<std::string>& arguments) {
  const TemporaryDirectory place;
  const std::string program = find_browser();
  std::vector<std::string> command = {program};
  command.insert(command.end(), kAlways.begin(), kAlways.end());
  command.push_back("--user-data-dir=" + (place.path() / "profile").string());
  command.insert(command.end(), arguments.begin(), arguments.end());
  command.push_back("file://" + file);
  std::vector<std::string> variables = environment(place.path().string());

  // Output goes to files and not to pipes, because helper processes that outlive the browser would
  // keep a pipe open.
  const std::string out = (place.path() / "out").string();
  posix_spawn_file_actions_t actions;
  ::posix_spawn_file_actions_init(&actions);
  ::posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  ::posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, out.c_str(), O_WRONLY | O_CREAT,
                                     0600);
  ::posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, "/dev/null", O_WRONLY, 0);
  posix_spawnattr_t attributes;
  ::posix_spawnattr_init(&attributes);
  ::posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP);
  ::posix_spawnattr_setpgroup(&attributes, 0);  // so that its helpers end with it
  pid_t pid = 0;
  const int error = ::posix_spawn(&pid, program.c_str(), &actions, &attributes,
                                  pointers(command).data(), pointers(variables).data());
  ::posix_spawnattr_destroy(&attributes);
  ::posix_spawn_file_actions_destroy(&actions);
  BrowserResult result;
  if (error != 0) return result;

  int status = 0;
  const auto end = std::chrono::steady_clock::now() + kPatience;
  while (std::chrono::steady_clock::now() < end) {
    if (::waitpid(pid, &status, WNOHANG) == pid) {
      result.in_time = WIFEXITED(status);
      result.status = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
      break;
    }
    std::this_thread::sleep_for(20ms);
  }
  ::kill(-pid, SIGKILL);
  if (!result.in_time) (void)::waitpid(pid, &status, 0);
  result.out = place.read("out");
  return result;
}

}  // namespace

std::string find_browser() {
  const char* path = std::getenv("PATH");
  for (const char* name : {"chromium", "chromium-browser", "google-chrome"}) {
    std::istringstream folders(path ? path : "");
    for (std::string folder; std::getline(folders, folder, ':');) {
      std::string file = (std::filesystem::path(folder) / name).string();
      if (::access(file.c_str(), X_OK) == 0) return file;
    }
  }
  return "";
}

BrowserResult open_in_browser(const std::string& file, const std::vector<std::string>& arguments) {
  BrowserResult result;
  for (int i = 0; i < kStarts && !result.in_time; ++i) result = start_browser(file, arguments);
  return result;
}

BrowserResult dump_page(const std::string& file, const std::vector<std::string>& arguments) {
  std::vector<std::string> all = {"--window-size=1400,1000", "--dump-dom"};
  all.insert(all.end(), arguments.begin(), arguments.end());
  return open_in_browser(file, all);
}

BrowserResult take_picture(const std::string& file, const std::string& png, int width, int height,
                           const std::vector<std::string>& arguments) {
  std::vector<std::string> all = {fmt::format("--window-size={},{}", width, height),
                                  "--screenshot=" + png};
  all.insert(all.end(), arguments.begin(), arguments.end());
  return open_in_browser(file, all);
}

}  // namespace quadtune::testing
