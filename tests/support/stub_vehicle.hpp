// SPDX-License-Identifier: Apache-2.0
/// A stub of a Mambo on the loopback interface: it records every received byte and answers as a
/// test defines.
#pragma once

#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <mutex>
#include <optional>
#include <stdexcept>
#include <string>
#include <thread>
#include <utility>
#include <vector>

namespace quadtune::testing {

class StubVehicle {
 public:
  using Bytes = std::vector<std::uint8_t>;
  /// The pieces that it sends back after it received these frames, the last of which is new; if
  /// there are none, it closes the connection. Called in the thread of the stub.
  using Answer = std::function<std::optional<std::vector<Bytes>>(const std::vector<Bytes>& frames)>;

  struct Settings {
    int type = SOCK_STREAM;          ///< or SOCK_DGRAM
    std::size_t length = 8;          ///< of the frames of a stream [bytes]
    Answer answer = {};              ///< if empty, it never answers
    std::string from = "127.0.0.1";  ///< the address from which it sends datagrams
  };

  explicit StubVehicle(Settings settings)
      : settings_(std::move(settings)), socket_(bound(settings_.type, "127.0.0.1")) {
    if (stream() && ::listen(socket_, 1) != 0) throw std::runtime_error("listen() failed");
    // Like the vehicle in figure 5.3 of Oliveira 2020, it answers from another port than 6000.
    if (!stream()) answers_ = bound(SOCK_DGRAM, settings_.from);
    thread_ = std::thread([this] { run(); });
  }
  ~StubVehicle() {
    stopping_ = true;
    thread_.join();
    for (const int descriptor : {socket_, answers_})
      if (descriptor >= 0) ::close(descriptor);
  }
  StubVehicle(const StubVehicle&) = delete;
  StubVehicle& operator=(const StubVehicle&) = delete;

  [[nodiscard]] std::uint16_t port() const { return port_of(socket_); }
  [[nodiscard]] std::string address() const { return "127.0.0.1:" + std::to_string(port()); }

  /// The received frames.
  [[nodiscard]] std::vector<Bytes> frames() const {
    const std::lock_guard lock(mutex_);
    return frames_;
  }
  /// Waits until it has received this number of frames.
  [[nodiscard]] std::vector<Bytes> frames(std::size_t count) const {
    while (frames().size() < count) pause();
    return frames();
  }
  /// For a delayed Answer.
  static void wait_for(const std::atomic<bool>& flag) {
    while (!flag) pause();
  }

  /// A socket of the loopback at a port that the system chooses.
  [[nodiscard]] static int bound(int type, const std::string& host) {
    const int descriptor = ::socket(AF_INET, type | SOCK_CLOEXEC, 0);
    sockaddr_in address = {};
    address.sin_family = AF_INET;
    inet_pton(AF_INET, host.c_str(), &address.sin_addr);
    if (descriptor < 0 ||
        ::bind(descriptor, reinterpret_cast<sockaddr*>(&address), sizeof address) != 0)
      throw std::runtime_error("no socket on " + host);
    return descriptor;
  }
  [[nodiscard]] static std::uint16_t port_of(int descriptor) {
    sockaddr_in address = {};
    socklen_t size = sizeof address;
    ::getsockname(descriptor, reinterpret_cast<sockaddr*>(&address), &size);
    return ntohs(address.sin_port);
  }

 private:
  static void pause() { std::this_thread::sleep_for(std::chrono::milliseconds(1)); }
  [[nodiscard]] bool stream() const { return settings_.type == SOCK_STREAM; }

  /// @return  false once the stub ends
  [[nodiscard]] bool wait_readable(int descriptor) const {
    while (!stopping_) {
      pollfd polled = {descriptor, POLLIN, 0};
      if (::poll(&polled, 1, 10) > 0) return true;
    }
    return false;
  }

  void run() {
    if (!stream()) {
      while (wait_readable(socket_)) take_datagram();
      return;
    }
    while (wait_readable(socket_)) {
      const int connection = ::accept(socket_, nullptr, nullptr);
      serve(connection);
      ::close(connection);
    }
  }

  void take_datagram() {
    std::array<std::uint8_t, 2048> bytes{};
    sockaddr_in from = {};
    socklen_t size = sizeof from;
    const ssize_t count = ::recvfrom(socket_, bytes.data(), bytes.size(), 0,
                                     reinterpret_cast<sockaddr*>(&from), &size);
    if (count < 0) return;
    for (const Bytes& piece :
         answers({bytes.begin(), bytes.begin() + count}).value_or(std::vector<Bytes>{}))
      ::sendto(answers_, piece.data(), piece.size(), 0, reinterpret_cast<sockaddr*>(&from), size);
  }

  void serve(int connection) {
    Bytes frame;
    while (wait_readable(connection)) {
      std::uint8_t byte = 0;
      if (::recv(connection, &byte, 1, 0) != 1) break;
      frame.push_back(byte);
      if (frame.size() < settings_.length) continue;
      const auto pieces = answers(std::exchange(frame, {}));
      if (!pieces) return;
      for (const Bytes& piece : *pieces)
        if (::send(connection, piece.data(), piece.size(), MSG_NOSIGNAL) < 0) return;
    }
    // Bytes after the last frame, or those of an incomplete one.
    if (!frame.empty()) (void)answers(frame);
  }

  [[nodiscard]] std::optional<std::vector<Bytes>> answers(const Bytes& frame) {
    {
      const std::lock_guard lock(mutex_);
      frames_.push_back(frame);
    }
    if (!settings_.answer) return std::vector<Bytes>{};
    return settings_.answer(frames());
  }

  Settings settings_;
  int socket_ = -1, answers_ = -1;
  std::atomic<bool> stopping_{false};
  mutable std::mutex mutex_;
  std::vector<Bytes> frames_;
  std::thread thread_;
};

}  // namespace quadtune::testing
