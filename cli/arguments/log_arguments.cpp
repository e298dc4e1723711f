// SPDX-License-Identifier: Apache-2.0
#include "arguments/log_arguments.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "program/command_line.hpp"
#include "program/program.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/internal/suggest.hpp"
#include "report/logs/log_report.hpp"
#include "quadtune/internal/text_file.hpp"

namespace quadtune::cli {
namespace {

void require_format(const std::string& format, const std::string& verb) {
  std::vector<std::string> known;
  std::string names;
  for (const LogFormat& one : log_formats()) {
    known.push_back(one.name);
    names += (names.empty() ? "" : ", ") + one.name;
  }
  if (std::find(known.begin(), known.end(), format) == known.end())
    throw UsageError(fmt::format("quadtune {}: --format is '{}', expected one of {}{}", verb,
                                 format, names, internal::did_you_mean(format, known)),
                     "--format");
}

}  // namespace

void add_log_options(CommandLine& line, LogArguments& arguments) {
  line.add_option("--format", arguments.format,
                  "text, replay, ulog, mat, uquad-frames or uquad-log; found by the content")
      ->type_name("NAME");
  line.add_option("--columns", arguments.columns,
                  "of a text, such as 't_s:1, t_us:2, height[m]:19'; * takes all others")
      ->type_name("LIST");
  line.add_positive("--rate", arguments.rate_hz, "of a text without time, rows a second")
      ->type_name("HZ");
}

ChannelPlace channel_place(const std::string& word, const std::string& log) {
  const std::size_t at = word.rfind('@');
  if (at == std::string::npos || at == 0 || at + 1 == word.size()) return {word, log};
  return {word.substr(0, at), word.substr(at + 1)};
}

InvalidInput lacks_channel(const UnknownChannel& lacking) {
  std::string message = lacking.what();
  message.erase(0, lacking.where().size() + 2);
  return {lacking.where(), message + "; a channel of another file is called CHANNEL@FILE"};
}

LogChannels read_channels(const std::string& file, const std::vector<std::string>& names,
                          const LogOptions& options, const std::vector<std::string>& optional) {
  try {
    return read_log_channels(file, names, options, optional);
  } catch (const UnknownChannel& lacking) {
    throw lacks_channel(lacking);
  }
}

LogOptions log_options(const LogArguments& arguments, const std::string& verb) {
  LogOptions options;
  if (!arguments.format.empty()) require_format(arguments.format, verb);
  options.format = arguments.format;
  if (!arguments.columns.empty())
    options.columns = parse_log_columns(arguments.columns, "--columns");
  options.rate_hz = arguments.rate_hz.value_or(0);
  return options;
}

std::vector<std::string> tell_log_warnings(const LogCondition& condition, const std::string& file,
                                           const std::string& verb, const Context& context) {
  std::vector<std::string> lines = log_warnings(condition);
  for (std::string& line : lines) {
    line.insert(0, internal::printable(file) + ": ");
    context.note(fmt::format("{}: warning: {}", verb, line));
  }
  return lines;
}

}  // namespace quadtune::cli
