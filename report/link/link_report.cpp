// SPDX-License-Identifier: Apache-2.0
#include "report/link/link_report.hpp"

#include <fmt/format.h>

#include "quadtune/internal/json.hpp"
#include "report/text/print.hpp"
#include "report/text/rows.hpp"

namespace quadtune::report {
namespace {

using internal::Json;

const char* transport_of(LinkFirmware firmware) {
  return firmware == LinkFirmware::simulink ? "TCP" : "UDP";
}

/// The meaning of a field: in words, or else as a number with its unit.
std::string meaning_of(const LinkField& field) {
  if (!field.meaning.empty()) return field.meaning;
  return fmt::format("{}{}{}", field.value, field.unit.empty() ? "" : " ", field.unit);
}

std::string command_line_of(const LinkCommand& command) {
  return fmt::format("{}, firmware {}: {}", command.name, to_string(command.firmware),
                     link_entry(command.firmware, command.name).summary);
}

std::string plural(std::size_t count) {
  return fmt::format("{} frame{}", count, count == 1 ? "" : "s");
}

/// "2 frames, answered".
std::string sent_text(const LinkSending& sending) {
  if (!sending.delivery) return "nothing, because of --dry-run";
  const LinkDelivery& delivery = *sending.delivery;
  std::string text = plural(delivery.sent);
  switch (delivery.status) {
    case LinkStatus::answered:
      return text + ", answered";
    case LinkStatus::sent:
      return text + "; no answer is expected";
    case LinkStatus::interrupted:
      text += ", then interrupted";
      break;
    case LinkStatus::unanswered:
      break;
  }
  if (sending.message.command.firmware == LinkFirmware::native)
    return fmt::format("{}; {} of {} acknowledged", text, delivery.acknowledged,
                       sending.message.parts.size());
  return text + "; no answer";
}

}  // namespace

Json to_json(const LinkCommand& command) {
  Json fields = Json::array();
  for (const LinkField& field : link_fields(command))
    fields.push_back({{"name", field.name},
                      {"hex", link_hex(field.bytes)},
                      {"value", field.value},
                      {"unit", field.unit},
                      {"meaning", field.meaning}});
  return {{"firmware", to_string(command.firmware)},
          {"command", command.name},
          {"hex", link_hex(link_frame(command))},
          {"fields", fields}};
}

std::string to_text(const LinkCommand& command) {
  Cells cells = {{"field", "bytes", "meaning"}};
  for (const LinkField& field : link_fields(command))
    cells.push_back({field.name, link_hex(field.bytes), meaning_of(field)});
  return section("command", command_line_of(command)) +
         section("frame", link_hex(link_frame(command))) + section("fields", aligned(cells, "<"));
}

Json to_json(const LinkSending& sending) {
  const LinkCommand& command = sending.message.command;
  Json frames = Json::array();
  for (const LinkCommand& part : sending.message.parts)
    frames.push_back(link_hex(link_frame(part)));
  const LinkDelivery delivery = sending.delivery.value_or(LinkDelivery{});
  return {{"to", to_string(sending.to)},
          {"transport", transport_of(command.firmware)},
          {"firmware", to_string(command.firmware)},
          {"command", command.name},
          {"frames", frames},
          {"status", sending.delivery ? to_string(delivery.status) : "dry-run"},
          {"sent", delivery.sent},
          {"acknowledged", delivery.acknowledged},
          {"answer", link_hex(delivery.reply)}};
}

std::string to_text(const LinkSending& sending) {
  const LinkCommand& command = sending.message.command;
  std::string frames;
  for (const LinkCommand& part : sending.message.parts)
    frames += (frames.empty() ? "" : "\n") + link_hex(link_frame(part));
  std::string text =
      section("to", fmt::format("{}, {}", to_string(sending.to), transport_of(command.firmware))) +
      section("command", command_line_of(command)) + section("frames", frames) +
      section("sent", sent_text(sending));
  if (sending.delivery && !sending.delivery->reply.empty())
    text += section("answer", link_hex(sending.delivery->reply));
  return text;
}

}  // namespace quadtune::report
