// SPDX-License-Identifier: Apache-2.0
/// A socket that never blocks: every wait has a deadline and can be interrupted.
#pragma once

#include <netinet/in.h>

#include <chrono>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "quadtune/workbench/link/send_link.hpp"

namespace quadtune::workbench {

/// Result of a wait.
enum class Waited { ready, timed_out, interrupted };

using LinkClock = std::chrono::steady_clock;

class LinkSocket {
 public:
  /// @param type        SOCK_STREAM or SOCK_DGRAM
  /// @param local_port  to bind to on all interfaces; 0: any
  /// @throws FileError  naming the target, with the system's reason
  LinkSocket(int type, const LinkTarget& target, std::uint16_t local_port,
             std::function<bool()> interrupted);
  ~LinkSocket();
  LinkSocket(const LinkSocket&) = delete;
  LinkSocket& operator=(const LinkSocket&) = delete;

  /// Connects a stream.
  /// @throws FileError  if the connection is refused or another error occurs
  [[nodiscard]] Waited connect(LinkClock::time_point deadline);
  /// Sends bytes over the connection, or as one datagram to the target.
  /// @throws FileError
  [[nodiscard]] Waited send(std::span<const std::uint8_t> bytes, LinkClock::time_point deadline);
  /// Receives the next bytes of the connection (empty at its end), or the next datagram from the
  /// target's address.
  /// @throws FileError
  [[nodiscard]] Waited receive(std::vector<std::uint8_t>& bytes, LinkClock::time_point deadline);

 private:
  [[nodiscard]] Waited wait(short events, LinkClock::time_point deadline) const;
  [[noreturn]] void fail(int error) const;

  int descriptor_ = -1;
  bool stream_ = false;
  LinkTarget target_;
  sockaddr_in address_ = {};
  std::function<bool()> interrupted_;
};

}  // namespace quadtune::workbench
