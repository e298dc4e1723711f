// SPDX-License-Identifier: Apache-2.0
/// Sends commands to one Parrot Mambo, and waits for its answer.
///
/// What is sent can start motors. Nothing here chooses a vehicle: the address is the caller's, an
/// address that more than one device would hear is refused, and every wait has an end.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "quadtune/exports/link.hpp"

namespace quadtune {

/// Where one vehicle listens.
struct LinkTarget {
  std::string host;        ///< an IPv4 address, e.g. "192.168.3.1"
  std::uint16_t port = 0;  ///< 1 to 65535
};

/// "192.168.3.1:12391"
[[nodiscard]] std::string to_string(const LinkTarget& target);

/// Reads "HOST:PORT". HOST is an IPv4 address in four decimal numbers: a name could lead to any
/// vehicle, and looking it up has no time limit.
/// @throws OptionError  "to", for other text, for an address that is not that of one device (any,
///                      broadcast, multicast, reserved; the last number 0 or 255, which mean the
///                      network and all of it), for a port that is no number from 1 to 65535, and
///                      for the port of the other firmware
[[nodiscard]] LinkTarget link_target(const std::string& word, LinkFirmware firmware);

/// A command with the frames that express it.
struct LinkMessage {
  LinkCommand command;
  std::vector<LinkCommand> parts;  ///< one for each frame, in the order in which they are sent
};

/// The frames of a command. There is one, except that a command which stops the vehicle needs no
/// number: the native firmware orders frames by it, so without one there are four frames with
/// numbers a quarter of the circle apart, one of which is newer than whatever was sent before.
/// @param sequence  native firmware: the number of the frame, 0 to 255
/// @throws OptionError  "sequence", if it is missing for a command of the native firmware that does
///                      not stop the vehicle, is beyond 255, or comes with the firmware simulink,
///                      whose frames have none
/// @throws InvalidInput  as link_frame()
[[nodiscard]] LinkMessage link_message(LinkCommand command, std::optional<std::uint64_t> sequence);

/// How long and how often is tried.
struct LinkOptions {
  double timeout_s = 1;          ///< for a connection, and for each answer [s], 0.01 to 60
  std::uint64_t tries = 3;       ///< of each frame over UDP, 1 to 100
  std::uint64_t local_port = 0;  ///< to send from and to be answered at; 0: any
  /// Asked at least every 50 ms while something is waited for.
  std::function<bool()> interrupted = {};
};

/// @throws OptionError  "timeout", "tries" or "local-port", for a number beyond its limits
void require_valid(const LinkOptions& options);

enum class LinkStatus {
  answered,     ///< every frame was acknowledged (native), or something came back (simulink)
  sent,         ///< everything was sent; no answer is expected
  unanswered,   ///< everything was sent; whether it arrived is unknown
  interrupted,  ///< stopped by the caller after something was sent
};

/// "answered", "sent", "unanswered" or "interrupted".
[[nodiscard]] std::string to_string(LinkStatus status);

/// What was sent and what came back.
struct LinkDelivery {
  LinkStatus status = LinkStatus::unanswered;
  std::size_t sent = 0;          ///< frames, repetitions included
  std::size_t acknowledged = 0;  ///< frames of the message; native firmware
  LinkFrame reply;               ///< of the firmware simulink, whose answers are not documented
};

/// Sends a message and waits for the answer.
///
/// Firmware simulink: one TCP connection, the frame, then the first bytes of the answer. Nothing is
/// repeated, because TCP does. Native firmware: UDP datagrams; frames that are not acknowledged
/// within the timeout are sent again with the same bytes, so that the vehicle can see that it has
/// them already. Acknowledgements are accepted from any port of the target's address.
///
/// The call ends after 2 timeout_s over TCP, and after timeout_s for each try over UDP.
/// @throws OptionError  as require_valid()
/// @throws FileError    naming the target, if nothing listens there, if the connection breaks
/// within
///                      the frame, and for other errors of the system
/// @throws Interrupted  if the caller stops it before anything was sent
[[nodiscard]] LinkDelivery send_link(const LinkMessage& message, const LinkTarget& target,
                                     const LinkOptions& options);

}  // namespace quadtune
