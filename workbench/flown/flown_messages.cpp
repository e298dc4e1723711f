// SPDX-License-Identifier: Apache-2.0
#include "quadtune/workbench/flown/flown_messages.hpp"

namespace quadtune {

std::vector<std::string> flown_messages(const std::vector<std::string>& notes,
                                        const FlownLoop& flown) {
  std::vector<std::string> messages;
  const auto tell = [&](const char* what, const std::vector<std::string>& texts) {
    for (const std::string& text : texts) messages.push_back(what + text);
  };
  tell("note: ", notes);
  tell("note: ", flown_notes(flown));
  tell("note: ", margin_notes(flown.margins));
  if (flown.grows()) messages.push_back("warning: the flown loop is unstable; " + describe(flown));
  tell("warning: ", margin_warnings(flown.margins));
  return messages;
}

}  // namespace quadtune
