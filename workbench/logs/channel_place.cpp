// SPDX-License-Identifier: Apache-2.0
#include "quadtune/workbench/logs/channel_place.hpp"

namespace quadtune {

ChannelPlace channel_place(const std::string& word, const std::string& log) {
  const std::size_t at = word.rfind('@');
  if (at == std::string::npos || at == 0 || at + 1 == word.size()) return {word, log};
  return {word.substr(0, at), word.substr(at + 1)};
}

InvalidInput lacks_channel(const UnknownChannel& lacking) {
  return {lacking.where(),
          lacking.problem() + "; for a channel of another log, write CHANNEL@FILE"};
}

LogChannels read_channels(const std::string& file, const std::vector<std::string>& names,
                          const LogOptions& options, const std::vector<std::string>& optional) {
  try {
    return read_log_channels(file, names, options, optional);
  } catch (const UnknownChannel& lacking) {
    throw lacks_channel(lacking);
  }
}

}  // namespace quadtune
