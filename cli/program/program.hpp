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

// What results look like: text, JSON, pages.
using namespace report;

class CommandLine;

/// What the process ends with; documented in docs/cli.md.
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

/// The command line is wrong.
class UsageError : public std::runtime_error {
 public:
  /// @param where  the option or argument concerned, e.g. "--dt", for scripts.
  UsageError(const std::string& message, std::string where)
      : std::runtime_error(message), where_(std::move(where)) {}

  [[nodiscard]] const std::string& where() const { return where_; }

 private:
  std::string where_;
};

/// The answer is no: a verification or a gate failed. What failed has been printed already.
class AnswerIsNo : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Exports, logs, pictures and tables that are complete, as an error that follows names them.
class WrittenFiles {
 public:
  void push_back(const std::string& name);
  [[nodiscard]] auto begin() const { return names_.begin(); }
  [[nodiscard]] auto end() const { return names_.end(); }

 private:
  std::vector<std::string> names_;
};

/// Where a verb reads and writes, and how.
struct Context {
  std::istream& in;
  std::ostream& out;
  std::ostream& err;
  bool json = false;
  bool quiet = false;
  WrittenFiles written = {};
  std::string file = {};     ///< that -o names, where `out` goes into it; else empty
  std::size_t threads = 0;   ///< to use; 0: one for each processor
  std::uint64_t seed = 1;    ///< of everything random
  std::string command = {};  ///< the command line that decides what is written
  bool answered = false;     ///< the JSON object is on `out`: an error that follows adds no second
  mutable std::set<std::string> noted = {};

  /// One line on the error stream that is not an error; silent with --quiet, and said once.
  void note(const std::string& line) const;
  /// One such line for each of `texts`, with `start` before it: "fly: note: ".
  void notes(const std::string& start, const std::vector<std::string>& texts) const;

  /// As write_file(), and keeps in mind that the file is complete.
  void write(const std::string& name, const std::string& bytes,
             const std::function<bool()>& stop = interrupted);

  /// Writes a result to `out`: with --json its JSON and a line feed, else its text as it is. The
  /// other of the two is not asked for.
  void print(const std::function<internal::Json()>& json, const std::function<std::string()>& text);
};

/// Runs a verb whose options have been parsed.
using Action = std::function<void(Context&)>;

/// One verb: a row of the table from which help, man page and completion are made.
struct Verb {
  std::string name;     ///< one word, or two: "tune lqr" is one kind of tuning
  std::string usage;    ///< what follows the name, e.g. "V [options]"
  std::string summary;  ///< one line
  std::string example;  ///< a command that works as printed from the project's root
  std::function<Action(CommandLine&)> define;  ///< adds the options, gives what to run
};

/// Verb::define of a verb with options of its own.
/// @param add  adds them to the command line
/// @param run  called after parse() with the options and the context, or with the line before them
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

/// An option of every verb, beside -o.
struct CommonOption {
  const char *name, *type, *description;  ///< the type with the blank before it; "": a flag
};
inline constexpr CommonOption kCommonOptions[] = {
    {"--json", "", "print one JSON object instead of the text"},
    {"--quiet", "", "no notes on the error stream"},
    {"--seed", " N", "fixes everything random; 1"},
    {"--threads", " N", "at most so many at once; one for each processor"}};

/// All verbs in the order in which the work flows.
[[nodiscard]] const std::vector<Verb>& verbs();

/// The second words of the verbs of two words that begin with `first`; none where there is no such.
[[nodiscard]] std::vector<std::string> kinds_of(const std::string& first);

/// Runs `quadtune ARGS…` and returns its exit status. No exception leaves it. What it prints is fit
/// for a terminal: visible_text().
/// @param width  of the terminal that `out` is [characters], for which text is folded; 0: none
int run(const std::vector<std::string>& args, std::istream& in, std::ostream& out,
        std::ostream& err, std::size_t width = 0);

/// For main(): what would end the process by std::terminate() is told as any other error, and ends
/// it with kInternal.
void install_last_handler();

/// Writes one file whole or not at all; a missing directory is made. A link stays one, and a device
/// or a pipe is written to as it is.
/// @param stop  asked before it is put in place; none: it is written although a signal came
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
