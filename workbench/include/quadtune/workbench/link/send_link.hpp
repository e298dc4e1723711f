// SPDX-License-Identifier: Apache-2.0
/// Sends commands to one Parrot Mambo and waits for its reply.
///
/// Commands can start motors. Nothing here selects a vehicle: the caller gives the address,
/// addresses that reach more than one device are rejected, and every wait has a time limit.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "quadtune/exports/link.hpp"

namespace quadtune {

/// The address of one vehicle.
struct LinkTarget {
  std::string host;        ///< an IPv4 address, e.g. "192.168.3.1"
  std::uint16_t port = 0;  ///< 1 to 65535
};

/// For example "192.168.3.1:12391".
[[nodiscard]] std::string to_string(const LinkTarget& target);

/// Parses "HOST:PORT". HOST is an IPv4 address in four decimal numbers: a host name could resolve
/// to any vehicle, and resolving it has no time limit.
/// @throws OptionError  "to", for malformed text, for an address that is not that of a single
///                      device (any, broadcast, multicast, reserved; the last number 0 or 255,
///                      which denote the network and its broadcast address), for a port that is not
///                      a number from 1 to 65535, and for the port of the other firmware
[[nodiscard]] LinkTarget link_target(const std::string& word, LinkFirmware firmware);

/// A command with the frames that represent it.
struct LinkMessage {
  LinkCommand command;             ///< as it was given
  std::vector<LinkCommand> parts;  ///< one for each frame, in the order in which they are sent
};

/// The frames of a command. There is one frame, except for a command without a sequence number that
/// stops the vehicle: the native firmware orders frames by number, so four frames are sent whose
/// numbers are a quarter of the range apart, one of which is newer than any earlier frame.
/// @param command   of any firmware
/// @param sequence  native firmware: the number of the frame, 0 to 255
/// @throws OptionError  "sequence", if it is missing for a command of the native firmware that does
///                      not stop the vehicle, exceeds 255, or is given for the firmware simulink,
///                      whose frames have none
/// @throws InvalidInput  as link_frame()
[[nodiscard]] LinkMessage link_message(LinkCommand command, std::optional<std::uint64_t> sequence);

/// Time limits and number of attempts.
struct LinkOptions {
  double timeout_s = 1;          ///< for a connection, and for each reply [s], 0.01 to 60
  std::uint64_t tries = 3;       ///< of each frame over UDP, 1 to 100
  std::uint64_t local_port = 0;  ///< port from which to send, and at which replies are expected; 0:
                                 ///< any
  /// Called at least every 50 ms while waiting.
  std::function<bool()> interrupted = {};
};

/// @throws OptionError  "timeout", "tries" or "local-port", if the number is out of range
void require_valid(const LinkOptions& options);

/// What became of the frames.
enum class LinkStatus {
  answered,     ///< every frame was acknowledged (native), or a reply was received (simulink)
  sent,         ///< everything was sent; no reply is expected
  unanswered,   ///< everything was sent; whether it arrived is unknown
  interrupted,  ///< stopped by the caller after something was sent
};

/// "answered", "sent", "unanswered" or "interrupted".
[[nodiscard]] std::string to_string(LinkStatus status);

/// Frames sent and replies received.
struct LinkDelivery {
  LinkStatus status = LinkStatus::unanswered;  ///< what became of the frames
  std::size_t sent = 0;                        ///< frames, repetitions included
  std::size_t acknowledged = 0;                ///< frames of the message; native firmware
  LinkFrame reply;  ///< firmware simulink, whose replies are not documented
};

/// Sends a message and waits for the reply.
///
/// Firmware simulink: one TCP connection, the frame, then the first bytes of the reply. Nothing is
/// repeated, because TCP retransmits. Native firmware: UDP datagrams; frames that are not
/// acknowledged within the timeout are sent again with the same bytes, so that the vehicle
/// recognizes duplicates. Acknowledgements are accepted from any port of the target's address.
///
/// The call returns after at most 2 timeout_s over TCP, and timeout_s per try over UDP.
/// @throws OptionError  as require_valid()
/// @throws FileError    naming the target, if nothing listens there, if the connection is closed
///                      within the frame, and for other errors of the system
/// @throws Interrupted  if the caller stops it before anything was sent
[[nodiscard]] LinkDelivery send_link(const LinkMessage& message, const LinkTarget& target,
                                     const LinkOptions& options);

}  // namespace quadtune
