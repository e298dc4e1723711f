// SPDX-License-Identifier: Apache-2.0
#include "link/link_socket.hpp"

#include <arpa/inet.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <utility>

#include "quadtune/errors.hpp"

namespace quadtune::workbench {
namespace {

sockaddr_in address_of(in_addr host, std::uint16_t port) {
  sockaddr_in address = {};
  address.sin_family = AF_INET;
  address.sin_addr = host;
  address.sin_port = htons(port);
  return address;
}

/// POSIX uses this type for addresses of all families.
const sockaddr* any_family(const sockaddr_in& address) {
  return reinterpret_cast<const sockaddr*>(&address);
}

bool has_to_wait(int error) { return error == EAGAIN || error == EWOULDBLOCK || error == EINTR; }

}  // namespace

LinkSocket::LinkSocket(int type, const LinkTarget& target, std::uint16_t local_port,
                       std::function<bool()> interrupted)
    : stream_(type == SOCK_STREAM), target_(target), interrupted_(std::move(interrupted)) {
  in_addr host = {};
  if (inet_pton(AF_INET, target.host.c_str(), &host) != 1) fail(EINVAL);
  address_ = address_of(host, target.port);
  // Without SO_BROADCAST, the system rejects the broadcast addresses of its networks.
  descriptor_ = ::socket(AF_INET, type | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
  if (descriptor_ < 0) fail(errno);
  const int on = 1;
  if (stream_) ::setsockopt(descriptor_, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
  if (local_port == 0) return;
  // Allows to reuse the port of a connection that has just ended.
  if (stream_) ::setsockopt(descriptor_, SOL_SOCKET, SO_REUSEADDR, &on, sizeof on);
  const sockaddr_in local = address_of({htonl(INADDR_ANY)}, local_port);
  if (::bind(descriptor_, any_family(local), sizeof local) == 0) return;
  const int error = errno;
  ::close(descriptor_);
  throw FileError("local port " + std::to_string(local_port), std::strerror(error));
}

LinkSocket::~LinkSocket() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

void LinkSocket::fail(int error) const {
  throw FileError(to_string(target_), std::strerror(error));
}

Waited LinkSocket::wait(short events, LinkClock::time_point deadline) const {
  using std::chrono::milliseconds;
  constexpr milliseconds kSlice(50);
  for (;;) {
    if (interrupted_ && interrupted_()) return Waited::interrupted;
    const auto left = deadline - LinkClock::now();
    if (left <= left.zero()) return Waited::timed_out;
    // Rounded up, so that the last slice is not a busy loop.
    const milliseconds slice = std::min(kSlice, std::chrono::ceil<milliseconds>(left));
    pollfd polled = {descriptor_, events, 0};
    const int ready = ::poll(&polled, 1, static_cast<int>(slice.count()));
    if (ready > 0) return Waited::ready;
    if (ready < 0 && errno != EINTR) fail(errno);
  }
}

Waited LinkSocket::connect(LinkClock::time_point deadline) {
  if (::connect(descriptor_, any_family(address_), sizeof address_) == 0) return Waited::ready;
  if (errno != EINPROGRESS && errno != EINTR) fail(errno);
  if (const Waited waited = wait(POLLOUT, deadline); waited != Waited::ready) return waited;
  int error = 0;
  socklen_t size = sizeof error;
  if (::getsockopt(descriptor_, SOL_SOCKET, SO_ERROR, &error, &size) != 0) error = errno;
  if (error != 0) fail(error);
  return Waited::ready;
}

Waited LinkSocket::send(std::span<const std::uint8_t> bytes, LinkClock::time_point deadline) {
  const auto* const to = stream_ ? nullptr : any_family(address_);
  const socklen_t size = stream_ ? 0 : sizeof address_;
  while (!bytes.empty()) {
    if (const Waited waited = wait(POLLOUT, deadline); waited != Waited::ready) return waited;
    const ssize_t count = ::sendto(descriptor_, bytes.data(), bytes.size(), MSG_NOSIGNAL, to, size);
    if (count < 0 && !has_to_wait(errno)) fail(errno);
    if (count > 0) bytes = bytes.subspan(static_cast<std::size_t>(count));
  }
  return Waited::ready;
}

Waited LinkSocket::receive(std::vector<std::uint8_t>& bytes, LinkClock::time_point deadline) {
  for (;;) {
    if (const Waited waited = wait(POLLIN, deadline); waited != Waited::ready) return waited;
    std::array<std::uint8_t, 2048> part{};
    sockaddr_in from = {};
    socklen_t size = sizeof from;
    const ssize_t count = ::recvfrom(descriptor_, part.data(), part.size(), 0,
                                     reinterpret_cast<sockaddr*>(&from), &size);
    if (count < 0 && has_to_wait(errno)) continue;
    // A reset by the peer counts as the end of the connection.
    if (count < 0 && stream_ && errno == ECONNRESET) {
      bytes.clear();
      return Waited::ready;
    }
    if (count < 0) fail(errno);
    if (!stream_ && from.sin_addr.s_addr != address_.sin_addr.s_addr) continue;
    bytes.assign(part.begin(), part.begin() + count);
    return Waited::ready;
  }
}

}  // namespace quadtune::workbench
