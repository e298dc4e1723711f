// SPDX-License-Identifier: Apache-2.0
/// Commands of a link and their delivery, as text and as JSON.
#pragma once

#include <optional>
#include <string>

#include "quadtune/exports/link.hpp"
#include "quadtune/internal/json_fwd.hpp"
#include "quadtune/workbench/link/send_link.hpp"

namespace quadtune::report {

/// "firmware", "command", "hex" and "fields".
[[nodiscard]] internal::Json to_json(const LinkCommand& command);
[[nodiscard]] std::string to_text(const LinkCommand& command);

/// A message that was sent, or that would be sent without --dry-run.
struct LinkSending {
  LinkTarget to;
  LinkMessage message;
  std::optional<LinkDelivery> delivery;  ///< no value: it was not sent
};

/// "to", "transport", "firmware", "command", "frames", "status", "sent", "acknowledged" and
/// "answer".
[[nodiscard]] internal::Json to_json(const LinkSending& sending);
[[nodiscard]] std::string to_text(const LinkSending& sending);

}  // namespace quadtune::report
