// SPDX-License-Identifier: Apache-2.0
#include "quadtune/workbench/link/send_link.hpp"

#include <fmt/format.h>
#include <sys/socket.h>

#include <chrono>
#include <cmath>

#include "link/link_socket.hpp"
#include "quadtune/errors.hpp"

namespace quadtune {
namespace {

using workbench::LinkClock;
using workbench::LinkSocket;
using workbench::Waited;

LinkClock::time_point deadline_of(const LinkOptions& options) {
  return LinkClock::now() +
         std::chrono::ceil<LinkClock::duration>(std::chrono::duration<double>(options.timeout_s));
}

/// Reports a timeout while connecting or sending.
[[noreturn]] void refuse_late(const LinkTarget& target, const LinkOptions& options,
                              const std::string& what) {
  throw FileError(to_string(target), fmt::format("{} within {} s, expected a Mambo that listens "
                                                 "there",
                                                 what, options.timeout_s));
}

bool expects_answer(const LinkCommand& command) {
  return command.acknowledged && link_entry(command.firmware, command.name).answered;
}

/// Table 5.1: one connection; any reply is accepted.
LinkDelivery send_stream(const LinkMessage& message, const LinkTarget& target,
                         const LinkOptions& options) {
  LinkDelivery delivery;
  LinkSocket socket(SOCK_STREAM, target, static_cast<std::uint16_t>(options.local_port),
                    options.interrupted);
  const LinkClock::time_point deadline = deadline_of(options);
  const Waited connected = socket.connect(deadline);
  if (connected == Waited::interrupted) throw Interrupted();
  if (connected == Waited::timed_out) refuse_late(target, options, "no connection");
  const Waited sent = socket.send(link_frame(message.parts.front()), deadline);
  if (sent == Waited::interrupted) throw Interrupted();
  if (sent == Waited::timed_out) refuse_late(target, options, "the frame could not be sent");
  delivery.sent = 1;
  delivery.status = LinkStatus::sent;
  if (!expects_answer(message.command)) return delivery;
  const Waited received = socket.receive(delivery.reply, deadline_of(options));
  delivery.status = received == Waited::interrupted ? LinkStatus::interrupted
                    : delivery.reply.empty()        ? LinkStatus::unanswered
                                                    : LinkStatus::answered;
  return delivery;
}

/// Frames of the native firmware, and which of them are acknowledged.
class Datagrams {
 public:
  Datagrams(const LinkMessage& message, const LinkTarget& target, const LinkOptions& options)
      : target_(target),
        options_(options),
        socket_(SOCK_DGRAM, target, static_cast<std::uint16_t>(options.local_port),
                options.interrupted) {
    for (const LinkCommand& part : message.parts) waiting_.push_back(link_frame(part));
  }

  /// Sends the frames that are not acknowledged yet.
  void send(LinkDelivery& delivery, LinkClock::time_point deadline) {
    for (const LinkFrame& frame : waiting_) {
      const Waited sent = socket_.send(frame, deadline);
      if (sent == Waited::ready) {
        ++delivery.sent;
        continue;
      }
      if (sent == Waited::interrupted && delivery.sent == 0) throw Interrupted();
      if (sent == Waited::interrupted) delivery.status = LinkStatus::interrupted;
      if (sent == Waited::timed_out && delivery.sent == 0)
        refuse_late(target_, options_, "the frame could not be sent");
      return;
    }
  }

  /// Waits until all are acknowledged. Other datagrams of the vehicle are ignored.
  void receive(LinkDelivery& delivery, LinkClock::time_point deadline) {
    std::vector<std::uint8_t> reply;
    while (!waiting_.empty()) {
      const Waited received = socket_.receive(reply, deadline);
      if (received == Waited::interrupted) delivery.status = LinkStatus::interrupted;
      if (received != Waited::ready) return;
      delivery.acknowledged += std::erase_if(
          waiting_, [&](const LinkFrame& frame) { return acknowledges(reply, frame); });
    }
    delivery.status = LinkStatus::answered;
  }

 private:
  const LinkTarget& target_;
  const LinkOptions& options_;
  LinkSocket socket_;
  std::vector<LinkFrame> waiting_;
};

LinkDelivery send_datagrams(const LinkMessage& message, const LinkTarget& target,
                            const LinkOptions& options) {
  LinkDelivery delivery;
  Datagrams datagrams(message, target, options);
  const bool answered = expects_answer(message.command);
  for (std::uint64_t i = 0; i < options.tries; ++i) {
    const LinkClock::time_point deadline = deadline_of(options);
    datagrams.send(delivery, deadline);
    if (delivery.status == LinkStatus::interrupted) return delivery;
    if (!answered) {
      delivery.status = LinkStatus::sent;
      return delivery;
    }
    datagrams.receive(delivery, deadline);
    if (delivery.status != LinkStatus::unanswered) return delivery;
  }
  return delivery;
}

}  // namespace

std::string to_string(LinkStatus status) {
  switch (status) {
    case LinkStatus::answered:
      return "answered";
    case LinkStatus::sent:
      return "sent";
    case LinkStatus::interrupted:
      return "interrupted";
    case LinkStatus::unanswered:
      break;
  }
  return "unanswered";
}

void require_valid(const LinkOptions& options) {
  if (!std::isfinite(options.timeout_s) || options.timeout_s < 0.01 || options.timeout_s > 60)
    throw OptionError("timeout",
                      fmt::format("timeout is {}, expected 0.01 to 60 s, because every wait "
                                  "has a time limit",
                                  options.timeout_s));
  if (options.tries < 1 || options.tries > 100)
    throw OptionError("tries", fmt::format("tries is {}, expected 1 to 100, because the vehicle "
                                           "may be unreachable",
                                           options.tries));
  if (options.local_port > 65535)
    throw OptionError("local-port",
                      fmt::format("local-port is {}, expected 1 to 65535", options.local_port));
}

LinkDelivery send_link(const LinkMessage& message, const LinkTarget& target,
                       const LinkOptions& options) {
  require_valid(options);
  return message.command.firmware == LinkFirmware::simulink
             ? send_stream(message, target, options)
             : send_datagrams(message, target, options);
}

}  // namespace quadtune
