// SPDX-License-Identifier: Apache-2.0
/// Channels of a flight that are stored in several logs.
#pragma once

#include <string>
#include <vector>

#include "quadtune/logs/log_channels.hpp"

namespace quadtune {

/// A channel reference: "px" in the log itself, or "px@FILE" in another log of the same flight.
struct ChannelPlace {
  std::string channel, file;
};

/// @param log  path of the log itself
[[nodiscard]] ChannelPlace channel_place(const std::string& word, const std::string& log);

/// The error for a channel that a file lacks; explains how to name a channel of another file.
[[nodiscard]] InvalidInput lacks_channel(const UnknownChannel& lacking);

/// As read_log_channels(), with lacks_channel() as the error for a missing channel.
[[nodiscard]] LogChannels read_channels(const std::string& file,
                                        const std::vector<std::string>& names,
                                        const LogOptions& options,
                                        const std::vector<std::string>& optional = {});

}  // namespace quadtune
