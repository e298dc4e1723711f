// SPDX-License-Identifier: Apache-2.0
/// quadtune link: command frames of the Mambo's two firmwares, and sending them to one vehicle.
#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "program/command_line.hpp"
#include "program/program.hpp"
#include "program/refusal.hpp"
#include "quadtune/internal/counted.hpp"
#include "quadtune/internal/joined.hpp"
#include "quadtune/internal/json.hpp"
#include "quadtune/workbench/link/send_link.hpp"
#include "report/link/link_report.hpp"

namespace quadtune::cli {
namespace {

struct Options {
  std::string firmware, name;
  std::vector<std::string> words;
  std::uint64_t sequence = 0;
  bool no_ack = false;
  // options of `link send` alone
  std::string to;
  std::optional<double> timeout;
  LinkOptions link;
  bool dry_run = false;
};

/// The command that the words describe. Errors in them are errors of the command line.
LinkCommand command_of(const Options& options) {
  const LinkFirmware firmware = link_firmware(options.firmware);
  try {
    LinkCommand command = link_command(firmware, options.name, options.words);
    command.acknowledged = !options.no_ack;
    return command;
  } catch (const InvalidInput& error) {
    refuse(error.where(), "{}", error.what());
  }
}

std::optional<std::uint64_t> sequence_of(const CommandLine& line, const Options& options) {
  if (!line.was_given("--sequence")) return std::nullopt;
  return options.sequence;
}

// --- encode ---

void run_encode(CommandLine& line, const Options& options, Context& context) {
  const LinkCommand given = command_of(options);
  // A frame that is not sent may have any number.
  const std::optional<std::uint64_t> sequence = given.firmware == LinkFirmware::native
                                                    ? sequence_of(line, options).value_or(0)
                                                    : sequence_of(line, options);
  const LinkMessage message = link_message(given, sequence);
  context.print([&] { return to_json(message.command); }, [&] { return to_text(message.command); });
}

// --- decode ---

void run_decode(const Options& options, Context& context) {
  const LinkFirmware firmware = link_firmware(options.firmware);
  if (options.words.empty())
    refuse("HEX", "the bytes are missing, expected a frame, e.g. 02 00 00 00");
  const LinkCommand command = [&] {
    try {
      return decode_link_frame(firmware, link_bytes(internal::joined(options.words, " ")));
    } catch (const InvalidInput& error) {
      refuse("HEX", "{}", error.what());  // the frame is part of the command line
    }
  }();
  context.print([&] { return to_json(command); }, [&] { return to_text(command); });
}

// --- send ---

/// Throws the error for status 1, which states what a person must know before the next step.
[[noreturn]] void refuse_unanswered(const LinkSending& sending, const LinkOptions& options) {
  const bool stops =
      link_entry(sending.message.command.firmware, sending.message.command.name).stops;
  throw AnswerIsNo(
      fmt::format("{} did not answer {} within {} s{}; the vehicle may have received it{}",
                  to_string(sending.to), sending.message.command.name, options.timeout_s,
                  sending.message.command.firmware == LinkFirmware::native
                      ? fmt::format(" in {}", internal::counted(options.tries, "try", "tries"))
                      : "",
                  stops ? ", or may still be flying" : ""));
}

void run_send(CommandLine& line, Options& options, Context& context) {
  LinkSending sending;
  LinkOptions& link = options.link;
  link.interrupted = interrupted;
  if (options.timeout) link.timeout_s = *options.timeout;
  const LinkCommand command = command_of(options);
  sending.message = link_message(command, sequence_of(line, options));
  sending.to = link_target(options.to, command.firmware);
  require_valid(link);
  if (!options.dry_run) sending.delivery = send_link(sending.message, sending.to, link);
  context.print([&] { return to_json(sending); }, [&] { return to_text(sending); });
  // A frame may have reached the vehicle, so the result stays printed whatever follows.
  context.answered = true;
  if (!sending.delivery) return;
  if (sending.delivery->status == LinkStatus::interrupted) throw Interrupted();
  if (sending.delivery->status == LinkStatus::unanswered) refuse_unanswered(sending, link);
}

// --- their options ---

std::string names_of_commands() {
  std::vector<std::string> names;
  for (const LinkFirmware firmware : {LinkFirmware::simulink, LinkFirmware::native})
    for (const LinkEntry& entry : link_entries(firmware))
      if (std::find(names.begin(), names.end(), entry.name) == names.end())
        names.push_back(entry.name);
  return internal::joined(names, ", ");
}

void add_firmware(CommandLine& line, Options& options) {
  line.add_option("--firmware simulink|native", options.firmware,
                  "firmware of MathWorks' support package (TCP), or of the manufacturer (UDP)");
}

void add_command(CommandLine& line, Options& options) {
  line.add_option("NAME", options.name, names_of_commands());
  line.add_words("VALUE", options.words, 8, "its values, e.g. -0.3 for height");
  add_firmware(line, options);
}

void add_no_ack(CommandLine& line, Options& options) {
  line.add_flag("--no-ack", options.no_ack, "ask for no acknowledgement");
}

void add_encode_options(CommandLine& line, Options& options) {
  add_command(line, options);
  line.add_count("--sequence N", options.sequence, 0,
                 "number of a native frame, 0 to 255; default 0");
  add_no_ack(line, options);
}

void add_decode_options(CommandLine& line, Options& options) {
  line.add_words("HEX", options.words, 64, "the bytes of one frame");
  add_firmware(line, options);
}

void add_send_options(CommandLine& line, Options& options) {
  add_command(line, options);
  line.add_option("--to HOST:PORT", options.to, "IPv4 address and port of one vehicle; no default");
  line.add_flag("--dry-run", options.dry_run, "print what would be sent, and send nothing");
  line.add_count("--sequence N", options.sequence, 0,
                 "number of a native frame, 0 to 255, one more than that of the previous frame; "
                 "not needed to stop the vehicle");
  add_no_ack(line, options);
  line.add_positive("--timeout S", options.timeout,
                    "timeout of the connection and of each answer [s], at most 60; default 1");
  line.add_count("--tries N", options.link.tries, 1,
                 "number of attempts for a native frame, at most 100; default 3");
  line.add_count("--local-port N", options.link.local_port, 1,
                 "local port for sending and for the answer; default: any");
}

}  // namespace

std::vector<Verb> link_verbs() {
  return {{"link encode", "NAME [VALUE...] --firmware simulink|native",
           "show the bytes of a command for the Mambo; nothing is sent",
           "quadtune link encode height -0.3 --firmware simulink",
           with_options(add_encode_options, run_encode)},
          {"link decode", "HEX... --firmware simulink|native", "explain the bytes of a command",
           "quadtune link decode 0e 00 00 00 e2 ff ff ff --firmware simulink",
           with_options(add_decode_options, run_decode)},
          {"link send", "NAME [VALUE...] --firmware simulink|native --to HOST:PORT",
           "send a command to one Mambo, which may start its motors",
           "quadtune link send land --firmware native --to 192.168.99.3:6000 --dry-run",
           with_options(add_send_options, run_send)}};
}

}  // namespace quadtune::cli
