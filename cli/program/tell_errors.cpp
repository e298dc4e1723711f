// SPDX-License-Identifier: Apache-2.0
#include "program/tell_errors.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <atomic>
#include <exception>
#include <filesystem>
#include <new>
#include <ostream>

#include "program/file_kinds.hpp"
#include "program/program.hpp"
#include "program/refusal.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/internal/json.hpp"
#include "report/text/error_line.hpp"

namespace quadtune::cli {
namespace {

/// The run whose errors are reported; a signal or std::terminate() may end it at any time.
std::atomic<const Context*> running{nullptr};
std::atomic<bool> json_asked{false};

/// After an error the user must know which directories have been replaced.
std::string what_is_written(const WrittenFiles& written) {
  std::string text;
  for (const std::string& directory : written)
    text += fmt::format("; {} is written and complete", directory);
  return text;
}

std::string error_json(int status, const std::string& message, const std::string& where) {
  return internal::json_text(internal::Json{
      {"error",
       {{"code", status}, {"message", error_line(message)}, {"where", error_line(where)}}}});
}

/// Writes one line to the error stream and, for scripts, one object to the output.
int fail(const Context& context, int status, const std::string& message, const std::string& where) {
  if (status == kInterrupted) take_last_words();
  context.err << error_line(message) << "\n";
  if (context.json && !context.answered) context.out << error_json(status, message, where) << "\n";
  context.out.flush();
  return status;
}

void tell_if_interrupted(const WrittenFiles& written) {
  const std::string message = Interrupted().what() + what_is_written(written);
  set_last_words(error_line(message), json_asked ? error_json(kInterrupted, message, "") : "");
}

int fail_inside(const Context& context, const std::string& what) {
  return fail(context, kInternal,
              fmt::format("quadtune: an error in quadtune itself: {}; please report it together "
                          "with the command and its input{}",
                          what, what_is_written(context.written)),
              "");
}

[[noreturn]] void end_after_last_words() {
  static std::atomic<bool> begun{false};
  if (begun.exchange(true)) ::_exit(kInternal);  // reporting the error failed as well
  const Context* const context = running.load();
  if (context == nullptr) ::_exit(kInternal);
  std::string what = "std::terminate() was called";
  try {
    if (std::current_exception()) throw;
  } catch (const std::exception& error) {
    what = error.what();
  } catch (...) {
    what = "an exception of unknown type";
  }
  const int status = fail_inside(*context, what);
  context->out.flush();
  context->err.flush();
  ::_exit(status);
}

}  // namespace

void begin_telling_errors(const Context& context) {
  running.store(&context);
  json_asked = context.json;
  tell_if_interrupted(context.written);
}

void end_telling_errors() { running.store(nullptr); }

int tell_exception(const Context& context, const std::vector<std::string>& args) {
  context.out.flush();  // an error follows the output that it concerns
  try {
    throw;
  } catch (const Refusal& error) {
    return fail(context, kAnswerIsNo, error.what(), error.where());
  } catch (const AnswerIsNo& error) {
    context.err << error_line(error.what()) << "\n";
    return kAnswerIsNo;
  } catch (const std::exception&) {
    // A failure after a signal is usually caused by it: a child process ended, a read was
    // interrupted.
    if (interrupted())
      return fail(context, kInterrupted, Interrupted().what() + what_is_written(context.written),
                  "");
  } catch (...) {
    // Not a std::exception; reported below.
  }
  try {
    throw;
  } catch (const UsageError& error) {
    return fail(context, kUsage, error.what(), error.where());
  } catch (const InvalidInput& error) {
    // An invalid option is an error of the command line; an invalid file is an error of the input.
    const bool option = error.where().starts_with("--");
    return fail(context, option ? kUsage : kBadInput, error.what() + who_takes(args, error.where()),
                error.where());
  } catch (const FileError& error) {
    return fail(context, kFile,
                error.what() + what_is_written(context.written) + who_takes(args, error.path()),
                error.path());
  } catch (const NoSolution& error) {
    return fail(context, kNoSolution, error.what(), error.where());
  } catch (const Interrupted& error) {
    return fail(context, kInterrupted, error.what() + what_is_written(context.written), "");
  } catch (const std::bad_alloc&) {
    return fail(context, kBadInput, "not enough memory for a problem of this size", "");
  } catch (const std::filesystem::filesystem_error& error) {
    return fail(context, kFile,
                fmt::format("{}: {}{}", error.path1().string(), error.code().message(),
                            what_is_written(context.written)),
                error.path1().string());
  } catch (const std::exception& error) {
    return fail_inside(context, error.what());
  } catch (...) {
    return fail_inside(context, "an exception of unknown type");
  }
}

void WrittenFiles::push_back(const std::string& name) {
  names_.push_back(name);
  tell_if_interrupted(*this);
}

void install_last_handler() { std::set_terminate(end_after_last_words); }

}  // namespace quadtune::cli
