// SPDX-License-Identifier: Apache-2.0
#include "program/program.hpp"

#include <fmt/format.h>
#include <glog/logging.h>  // used by Ceres, which logs warnings of its line search

#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <istream>
#include <ostream>
#include <sstream>

#include "program/command_line.hpp"
#include "program/missing_file.hpp"
#include "program/option_place.hpp"
#include "program/refusal.hpp"
#include "program/standard_streams.hpp"
#include "program/tell_errors.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/exports/file_set.hpp"
#include "quadtune/instruction_set.hpp"
#include "quadtune/internal/joined.hpp"
#include "quadtune/internal/json.hpp"
#include "quadtune/internal/suggest.hpp"
#include "quadtune/internal/text_file.hpp"
#include "quadtune/internal/utf8.hpp"
#include "quadtune/version.hpp"
#include "quadtune/workbench/campaign/campaign_scripts.hpp"
#include "quadtune/workbench/logs/missing_option.hpp"
#include "quadtune/workbench/vehicle/vehicle_check.hpp"

namespace quadtune::cli {
namespace {

const Verb* find(const std::string& name) {
  const auto& all = verbs();
  const auto found =
      std::find_if(all.begin(), all.end(), [&](const Verb& verb) { return verb.name == name; });
  return found == all.end() ? nullptr : &*found;
}

/// ": No space left on device", the reason of the operating system for the last error, if known.
std::string reason() { return errno == 0 ? "" : std::string(": ") + std::strerror(errno); }

/// The first words of all commands.
std::vector<std::string> verb_names() {
  std::vector<std::string> names;
  for (const Verb& verb : verbs()) names.push_back(verb.name.substr(0, verb.name.find(' ')));
  return names;
}

/// Runs an action whose output is written to a file, completely or not at all.
void run_into_file(const Action& action, const std::string& file, Context& context) {
  std::ostringstream text;
  const bool json = context.json || file.ends_with(".json");  // readers recognize JSON by the file
                                                              // name
  Context into{context.in,      text, context.err,     json,         context.quiet,
               context.written, file, context.threads, context.seed, context.command,
               context.verb};
  // A negative answer has been printed, so it is written as well.
  const auto write = [&] {
    context.written = into.written;
    write_file(file, text.str());
  };
  try {
    action(into);
  } catch (const Refusal&) {
    throw;
  } catch (const AnswerIsNo&) {
    write();
    throw;
  }
  write();
}

/// The options that name files and directories to write.
std::vector<std::string> output_options(const std::string& verb) {
  std::vector<std::string> names = {"-o", "--report", "--plot"};
  if (verb == "fly" || verb == "campaign replay") names.emplace_back("--log");  // others read it
  if (verb == "campaign init" || verb == "campaign run") names.emplace_back("DIR");
  return names;
}

/// Rejects "-" for files that are written in addition to the printed text, which goes to standard
/// output.
void refuse_standard_output(const CommandLine& line, const std::string& verb) {
  for (const std::string& name : output_options(verb)) {
    const Option* const option = line.find(name);
    if (option == nullptr || !option->was_given() || option->values().back() != "-") continue;
    throw UsageError(fmt::format("{} is -, expected a file name, because standard output is used "
                                 "for the printed text; write ./- for a file of that name",
                                 name),
                     name);
  }
}

/// Rejects an output that is a file which another word of the command line names, because the
/// command would replace its own input.
void refuse_replaced_input(const CommandLine& line, const std::string& verb) {
  namespace fs = std::filesystem;
  const std::vector<std::string> outputs = output_options(verb);
  const auto is_output = [&](const Option& option) {
    return std::find(outputs.begin(), outputs.end(), option.name()) != outputs.end();
  };
  for (const Option* written : line.options()) {
    std::error_code ignored;
    if (!is_output(*written) || !written->was_given() ||
        !fs::is_regular_file(written->values().back(), ignored))
      continue;
    for (const Option* other : line.options())
      for (const std::string& word : other->values())
        if (!is_output(*other) && fs::equivalent(written->values().back(), word, ignored))
          refuse(written->name(), "{} is {}, which the command reads; expected another file",
                 written->name(), word);
  }
}

/// Standard input can be read only once; a second reader would find it empty.
void refuse_two_readers(const CommandLine& line) {
  std::string first;
  for (const Option* option : line.options()) {
    if (option->values().size() != 1 || option->values()[0] != "-") continue;
    if (option->name() == "-o") continue;
    if (!first.empty())
      throw UsageError(fmt::format("{} and {} are both '-', expected standard input "
                                   "for one of them, because it can be read only once",
                                   first, option->name()),
                       option->name());
    first = option->name();
  }
}

/// Throws an error that names the option in place of the current one, which names a parameter of a
/// library. Any other exception is thrown again.
[[noreturn]] void throw_for_user(const Verb& verb, const CommandLine& line) {
  try {
    throw;
  } catch (const FileError& error) {
    if (!is_missing(error)) throw;
    throw told_missing(error, line, output_options(verb.name));
  } catch (const OptionError& error) {
    refuse("--" + error.option(), "--{}", error.what());
  } catch (const MissingOption& error) {
    refuse("--" + error.option(), "{}", error.what());
  } catch (const InvalidInput& error) {
    // A control period that is too short for the estimator.
    const Option* const dt = line.find("--dt");
    if (dt != nullptr && dt->was_given() && error.where() == "estimator general")
      refuse("--dt", "--dt is too short for the estimator: {}", error.message());
    if (const auto told = told_by_option(error, line)) throw UsageError(*told);
    throw;
  }
}

/// Warns about implausible vehicles among the words of the command line. `vehicle` prints them.
void warn_of_vehicles(const Verb& verb, const CommandLine& line, const Context& context) {
  if (context.quiet || verb.name == "vehicle") return;
  for (const Option* option : line.options())
    for (const std::string& word : option->values())
      context.notes("warning: ", vehicle_warnings(word));
}

void run_action(const Action& action, const std::string& file, Context& context) {
  if (file.empty())
    action(context);
  else
    run_into_file(action, file, context);
}

void run_verb(const Verb& verb, const std::vector<std::string>& args, Context& context) {
  CommandLine line(verb.name, verb.usage);
  bool help = false;
  line.add_flag("--json", context.json, "print one JSON object");
  line.add_flag("--quiet", context.quiet, "no notes on the error stream");
  line.add_flag("-h,--help", help, "show this help");
  // Part of the contract of every command.
  std::uint64_t threads = 0;
  line.add_count("--threads", threads, 1, "number of threads; default: one for each processor");
  line.add_count("--seed", context.seed, 0, "seed of all random numbers");
  const Action action = verb.define(line);
  std::string file;
  const bool prints = line.find("-o") == nullptr;
  if (prints) line.add_option("-o", file, "file to write instead");
  if (std::find(args.begin(), args.end(), "--help") != args.end() ||
      std::find(args.begin(), args.end(), "-h") != args.end()) {
    run_verb(*find("help"), {verb.name}, context);
    return;
  }
  context.verb = verb.name;
  try {
    line.parse(args);
    refuse_two_readers(line);
    refuse_replaced_input(line, verb.name);
    if (prints && file == "-")
      file.clear();  // equivalent to no -o
    else
      refuse_standard_output(line, verb.name);
    context.threads = threads;
    try {
      warn_of_vehicles(verb, line, context);
      run_action(action, file, context);
    } catch (...) {
      throw_for_user(verb, line);
    }
  } catch (const UsageError& error) {
    throw UsageError(fmt::format("quadtune {}: {}", verb.name, error.what()), error.where());
  } catch (const Refusal& error) {
    throw Refusal(fmt::format("{}: {}", verb.name, error.what()), error.where());
  } catch (const AnswerIsNo& error) {
    throw AnswerIsNo(fmt::format("{}: {}", verb.name, error.what()));
  }
}

/// "a", "a or b" or "a, b or c".
std::string alternatives(const std::vector<std::string>& words) {
  std::string text;
  for (std::size_t i = 0; i < words.size(); ++i)
    text += (i == 0 ? "" : i + 1 == words.size() ? " or " : ", ") + words[i];
  return text;
}

void run_program(const std::vector<std::string>& args, Context& context) {
  if (args.empty() || args[0] == "--help" || args[0] == "-h") {
    run_verb(*find("help"), {}, context);
    return;
  }
  if (args[0] == "--version") {
    context.out << fmt::format("quadtune {}\nkernels: {}\n", kVersion, instruction_set());
    return;
  }
  const Verb* verb = find(args[0]);
  std::size_t words = 1;
  if (const auto kinds = kinds_of(args[0]); !verb && !kinds.empty()) {
    const std::string kind = args.size() > 1 ? args[1] : "";
    if (kind == "--help" || kind == "-h") {
      run_verb(*find("help"), {args[0]}, context);
      return;
    }
    verb = find(args[0] + " " + kind);
    words = 2;
    if (!verb)
      throw UsageError(fmt::format("quadtune {}: {}, expected {}{}", args[0],
                                   kind.empty() ? "the second word is missing"
                                                : "'" + internal::printable(kind) + "' is unknown",
                                   alternatives(kinds), internal::did_you_mean(kind, kinds)),
                       args[0]);
  }
  if (!verb) {
    const std::string what = args[0][0] == '-' ? "option" : "command";
    throw UsageError(fmt::format("quadtune: no {} '{}'{}", what, args[0],
                                 args[0] == "synthesise" || args[0] == "synthesize"
                                     ? "; did you mean 'lqr'?"
                                     : internal::did_you_mean(args[0], verb_names())),
                     args[0]);
  }
  run_verb(*verb, {args.begin() + static_cast<std::ptrdiff_t>(words), args.end()}, context);
}

/// The command line as it is recorded in files. Options that must not change a byte of them are
/// left out: the number of threads, and those of the printed text.
std::string recorded_command(const std::vector<std::string>& args) {
  std::string command = "quadtune";
  for (std::size_t i = 0; i < args.size(); ++i) {
    const std::string& arg = args[i];
    if (arg == "--threads") ++i;  // and skips its value
    if (arg == "--threads" || arg.starts_with("--threads=") || arg == "--quiet" || arg == "--json")
      continue;
    command += " " + shell_word(arg);
  }
  return command;
}

}  // namespace

void write_file(const std::string& file, const std::string& bytes,
                const std::function<bool()>& stop) {
  std::filesystem::path path = std::filesystem::absolute(file);
  std::error_code ignored;  // write_files() reports a path that cannot be examined
  const std::filesystem::file_status status = std::filesystem::status(path, ignored);
  if (std::filesystem::is_directory(status))
    throw FileError(file, "is a directory, expected the name of a file to write");
  if (std::filesystem::exists(status) && !std::filesystem::is_regular_file(status)) {
    // A device or a pipe is written to directly and not replaced.
    std::ofstream stream(path, std::ios::binary);
    errno = 0;
    stream << bytes << std::flush;
    if (!stream) throw FileError(file, "could not be written" + reason());
    return;
  }
  // The target of a symbolic link is replaced, not the link.
  if (std::filesystem::is_symlink(std::filesystem::symlink_status(path, ignored)) &&
      std::filesystem::exists(status))
    path = std::filesystem::canonical(path, ignored);
  const WritingFiles writing;
  write_files(path.parent_path(), {{path.filename().string(), bytes}}, {}, stop);
}

void Context::note(const std::string& text) const {
  const std::string line = verb + ": " + text;
  if (quiet || !noted.insert(line).second) return;
  out.flush();
  err << internal::visible_text(line) << "\n";
}

void Context::notes(const std::string& start, const std::vector<std::string>& texts) const {
  for (const std::string& text : texts) note(start + text);
}

void Context::write(const std::string& name, const std::string& bytes,
                    const std::function<bool()>& stop) {
  write_file(name, bytes, stop);
  written.push_back(name);
}

void Context::print(const std::function<internal::Json()>& to_json,
                    const std::function<std::string()>& to_text) {
  if (json)
    out << internal::readable(to_json()) << "\n";
  else
    out << to_text();
}

int run(const std::vector<std::string>& args, std::istream& in, std::ostream& out,
        std::ostream& err, std::size_t width) {
  const auto asks = [&](const char* option) {
    return std::find(args.begin(), args.end(), option) != args.end();
  };
  const bool for_programs = asks("--json") || asks("--man") || asks("--completion");
  FLAGS_minloglevel = google::GLOG_FATAL;  // only the program itself writes to the error stream
  VisibleText visible(out, for_programs ? 0 : width);
  std::ostream shown(&visible);
  Context context{in, shown, err};
  const int status = [&] {
    try {
      context.json = asks("--json");
      begin_telling_errors(context);
      context.command = recorded_command(args);
      run_program(args, context);
      shown.flush();
      if (shown) return int{kDone};
      throw FileError("standard output", "could not be written");
    } catch (...) {
      return tell_exception(context, args);
    }
  }();
  end_telling_errors();
  return status;
}

std::vector<std::string> kinds_of(const std::string& first) {
  std::vector<std::string> kinds;
  for (const Verb& verb : verbs())
    if (verb.name.starts_with(first + " ")) kinds.push_back(verb.name.substr(first.size() + 1));
  return kinds;
}

const std::vector<Verb>& verbs() {
  static const std::vector<Verb> all = [] {
    std::vector<Verb> list = {
        design_verb(),   vehicle_verb(),  linearize_verb(), lqr_verb(),        lqg_verb(),
        kalman_verb(),   place_verb(),    analyze_verb(),   discretize_verb(), margins_verb(),
        pid_verb(),      fly_verb(),      compare_verb(),   log_verb(),        tune_kalman_verb(),
        tune_pid_verb(), tune_lqr_verb(), calibrate_verb(), allan_verb(),      export_verb(),
        import_verb(),   verify_verb(),   certify_verb(),   diff_verb(),       help_verb()};
    const std::vector<Verb> campaign = campaign_verbs();
    const auto log =
        std::find_if(list.begin(), list.end(), [](const Verb& verb) { return verb.name == "log"; });
    list.insert(log, campaign.begin(), campaign.end());
    const std::vector<Verb> link = link_verbs();
    list.insert(list.end() - 1, link.begin(), link.end());  // before `help`
    return list;
  }();
  return all;
}

}  // namespace quadtune::cli
