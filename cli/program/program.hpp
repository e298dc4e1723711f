// SPDX-License-Identifier: Apache-2.0
/// The program as a function: arguments and streams in, exit status out.
#pragma once

#include <cstdint>
#include <functional>
#include <iosfwd>
#include <memory>
#include <set>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "program/stop_signals.hpp"
#include "quadtune/errors.hpp"

namespace quadtune::report {}
namespace quadtune::internal {
class Json;
}

namespace quadtune::cli {

// Functions that format results as text, JSON and pages.
using namespace report;

class CommandLine;

/// Exit statuses of the process, documented in docs/cli.md.
enum ExitStatus : int {
  kDone = 0,
  kAnswerIsNo = 1,
  kUsage = 2,
  kBadInput = 3,
  kNoSolution = 4,
  kFile = 5,
  kInternal = 6,
  kInterrupted = 130,
};

/// The command line is invalid. Inside a command, what() does not name the command.
class UsageError : public std::runtime_error {
 public:
  /// @param where  the option or argument concerned, e.g. "--dt", for scripts.
  UsageError(const std::string& message, std::string where)
      : std::runtime_error(message), where_(std::move(where)) {}

  [[nodiscard]] const std::string& where() const { return where_; }

 private:
  std::string where_;
};

/// A verification or a check failed. The failure has been printed already. Inside a command, what()
/// does not name the command.
class AnswerIsNo : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Exports, logs, pictures and tables that are complete; an error that follows lists them.
class WrittenFiles {
 public:
  void push_back(const std::string& name);
  [[nodiscard]] auto begin() const { return names_.begin(); }
  [[nodiscard]] auto end() const { return names_.end(); }

 private:
  std::vector<std::string> names_;
};

/// The streams and common options of a command.
struct Context {
  std::istream& in;
  std::ostream& out;
  std::ostream& err;
  bool json = false;
  bool quiet = false;
  WrittenFiles written = {};
  std::string file = {};     ///< value of -o if `out` is written to it; else empty
  std::size_t threads = 0;   ///< number of threads; 0: one for each processor
  std::uint64_t seed = 1;    ///< of all random numbers
  std::string command = {};  ///< the command line, without options that do not affect files
  std::string verb = {};     ///< name of the command, e.g. "tune lqr"
  bool answered = false;     ///< the JSON object was written to `out`; an error that follows adds
                             ///< no second one
  mutable std::set<std::string> noted = {};

  /// Writes one line that is not an error to the error stream, preceded by the name of the command.
  /// Does nothing with --quiet, and writes each line only once.
  void note(const std::string& text) const;
  /// Calls note() for each of `texts`, preceded by `start`, e.g. "note: ".
  void notes(const std::string& start, const std::vector<std::string>& texts) const;
  void notes(const std::vector<std::string>& texts) const { notes("", texts); }

  /// As write_file(), and records that the file is complete.
  void write(const std::string& name, const std::string& bytes,
             const std::function<bool()>& stop = interrupted);

  /// Writes a result to `out`: its JSON and a line feed with --json, otherwise its text. The other
  /// one is not computed.
  void print(const std::function<internal::Json()>& json, const std::function<std::string()>& text);
};

/// Runs a command whose options have been parsed.
using Action = std::function<void(Context&)>;

/// One command: a row of the table from which help, man page and completion are generated.
struct Verb {
  std::string name;     ///< one word, or two, e.g. "tune lqr"
  std::string usage;    ///< what follows the name, e.g. "V [options]"
  std::string summary;  ///< one line
  std::string example;  ///< a command that works as printed from the project's root
  std::function<Action(CommandLine&)> define;  ///< adds the options and returns the action
};

/// Verb::define of a command with its own options.
/// @param add  adds them to the command line
/// @param run  called after parse() with the options and the context, or with the command line, the
///             options and the context
template <class Options, class Run>
std::function<Action(CommandLine&)> with_options(void (*add)(CommandLine&, Options&), Run run) {
  return [add, run](CommandLine& line) -> Action {
    const auto options = std::make_shared<Options>();
    add(line, *options);
    return [options, run, &line](Context& context) {
      if constexpr (std::is_invocable_v<Run, Options&, Context&>)
        run(*options, context);
      else
        run(line, *options, context);
    };
  };
}

/// An option of every command, in addition to -o.
struct CommonOption {
  const char *name, *type, *description;  ///< the type with a leading blank; "": a flag
};
inline constexpr CommonOption kCommonOptions[] = {
    {"--json", "", "print one JSON object instead of text"},
    {"--quiet", "", "print no notes on the error stream"},
    {"--seed", " N", "seed of all random numbers; default 1"},
    {"--threads", " N", "number of threads; default: one for each processor"}};

/// All commands, in the order of a typical workflow.
[[nodiscard]] const std::vector<Verb>& verbs();

/// The second words of the two-word commands that begin with `first`; empty if there are none.
[[nodiscard]] std::vector<std::string> kinds_of(const std::string& first);

/// Runs `quadtune ARGS…` and returns its exit status. It throws no exception. Its output is safe
/// for a terminal, see visible_text().
/// @param width  of the terminal that `out` writes to [characters], to which text is folded; 0: not
///               a terminal
int run(const std::vector<std::string>& args, std::istream& in, std::ostream& out,
        std::ostream& err, std::size_t width = 0);

/// For main(): an event that would call std::terminate() is reported like any other error and ends
/// the process with kInternal.
void install_last_handler();

/// Writes one file completely or not at all, and creates missing directories. A symbolic link is
/// kept and its target is replaced; a device or a pipe is written to directly.
/// @param stop  polled before the file is put in place; if empty, the file is written even after a
///              signal
/// @throws FileError, Interrupted  as write_files()
void write_file(const std::string& file, const std::string& bytes,
                const std::function<bool()>& stop = interrupted);

Verb design_verb();
Verb vehicle_verb();
Verb linearize_verb();
Verb lqg_verb();
Verb lqr_verb();
Verb kalman_verb();
Verb discretize_verb();
Verb margins_verb();
Verb analyze_verb();
Verb place_verb();
Verb pid_verb();
Verb fly_verb();
Verb compare_verb();
std::vector<Verb> campaign_verbs();
Verb log_verb();
Verb tune_kalman_verb();
Verb tune_pid_verb();
Verb tune_lqr_verb();
Verb calibrate_verb();
Verb allan_verb();
Verb export_verb();
Verb import_verb();
Verb verify_verb();
Verb certify_verb();
Verb diff_verb();
std::vector<Verb> link_verbs();
Verb help_verb();

}  // namespace quadtune::cli
