// SPDX-License-Identifier: Apache-2.0
/// Channels of a flight that stand in several logs.
#pragma once

#include <string>
#include <vector>

#include "quadtune/logs/log_channels.hpp"

namespace quadtune {

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

}  // namespace quadtune
