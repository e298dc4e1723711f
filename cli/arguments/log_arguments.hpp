// SPDX-License-Identifier: Apache-2.0
/// Options that say how a log is to be read, shared by all verbs that read one.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "quadtune/logs/log_channels.hpp"
#include "quadtune/logs/log_reader.hpp"

namespace quadtune::cli {

class CommandLine;
struct Context;

struct LogArguments {
  std::string format, columns;
  std::optional<double> rate_hz;
};

/// Adds --format, --columns and --rate.
void add_log_options(CommandLine& line, LogArguments& arguments);

/// @param verb  For messages.
/// @throws UsageError, InvalidInput  naming the option.
[[nodiscard]] LogOptions log_options(const LogArguments& arguments, const std::string& verb);

/// Where a channel is: "px", of the log itself, or "px@FILE", of another log of the same flight.
struct ChannelPlace {
  std::string channel, file;
};

/// @param log  the log itself
[[nodiscard]] ChannelPlace channel_place(const std::string& word, const std::string& log);

/// The refusal of a channel that a file lacks, with how one of another file is named.
[[nodiscard]] InvalidInput lacks_channel(const UnknownChannel& lacking);

/// As read_log_channels(); what the file lacks is refused as lacks_channel() says.
[[nodiscard]] LogChannels read_channels(const std::string& file,
                                        const std::vector<std::string>& names,
                                        const LogOptions& options,
                                        const std::vector<std::string>& optional = {});

/// Those lines with the file's name before them, as the verbs that use a log list them in their
/// JSON; each goes to Context::note, too.
[[nodiscard]] std::vector<std::string> tell_log_warnings(const LogCondition& condition,
                                                         const std::string& file,
                                                         const std::string& verb,
                                                         const Context& context);

}  // namespace quadtune::cli
