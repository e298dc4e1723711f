// SPDX-License-Identifier: Apache-2.0
/// Writes PX4 ULogs, valid or unusual, for tests.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>
#include <vector>

namespace quadtune::testing {

/// The bytes of numbers, one after the other.
template <typename... Numbers>
std::string packed(const Numbers&... numbers) {
  std::string bytes;
  const auto add = [&](const auto& number) {
    bytes.append(reinterpret_cast<const char*>(&number), sizeof number);
  };
  (add(numbers), ...);
  return bytes;
}

/// A ULog message by message.
class UlogWriter {
 public:
  UlogWriter() {
    using std::string_view_literals::operator""sv;
    bytes_ = "ULog\x01\x12\x35\x01"sv;
    bytes_ += packed(std::uint64_t{1000});
    borders_.push_back(bytes_.size());
  }

  UlogWriter& message(char type, std::string_view body) {
    bytes_ += packed(static_cast<std::uint16_t>(body.size()), type);
    bytes_ += body;
    borders_.push_back(bytes_.size());
    return *this;
  }
  /// Flags with space for the offset of appended data; see append_here().
  UlogWriter& flags() {
    flags_at_ = bytes_.size() + 3;
    return message('B', std::string(40, '\0'));
  }
  UlogWriter& format(std::string_view definition) { return message('F', definition); }
  UlogWriter& subscribe(std::uint8_t instance, std::uint16_t id, std::string_view topic) {
    return message('A', packed(instance, id) + std::string(topic));
  }
  UlogWriter& data(std::uint16_t id, std::string_view record) {
    return message('D', packed(id) + std::string(record));
  }
  UlogWriter& sync() { return message('S', "\x2f\x73\x13\x20\x25\x0c\xbb\x12"); }
  UlogWriter& dropout(std::uint16_t ms) { return message('O', packed(ms)); }
  UlogWriter& raw(std::string_view bytes) {
    bytes_ += bytes;
    return *this;
  }
  /// Sets in the flags that appended data begin here.
  UlogWriter& append_here() {
    const std::uint64_t offset = bytes_.size();
    bytes_[flags_at_ + 8] = 1;
    std::memcpy(bytes_.data() + flags_at_ + 16, &offset, sizeof offset);
    return *this;
  }

  [[nodiscard]] const std::string& bytes() const { return bytes_; }
  /// The offsets at which messages end, beginning with the header.
  [[nodiscard]] const std::vector<std::size_t>& borders() const { return borders_; }

 private:
  std::string bytes_;
  std::vector<std::size_t> borders_;
  std::size_t flags_at_ = 0;
};

/// A log with the features of real ones: nested types, arrays, padding, texts, two instances, a
/// drop-out, marks, parameters. `sensor` is at 100 Hz, `status` at 50 Hz.
inline UlogWriter sample_ulog() {
  UlogWriter log;
  log.flags();
  log.message('I', packed(std::uint8_t{14}) + "char[3] sys_namePX4");
  log.format("vector:float x;float y;");
  log.format("sensor:uint64_t timestamp;vector[2] gyro;int16_t[3] counts;uint8_t[2] _padding0;");
  log.format("status:uint64_t timestamp;char[4] name;bool armed;uint8_t[3] _padding0;");
  log.message('P', packed(std::uint8_t{8}) + "float P1" + packed(1.5F));
  log.subscribe(0, 0, "sensor").subscribe(1, 1, "sensor").subscribe(0, 2, "status");
  for (std::uint64_t k = 0; k < 10; ++k) {
    const std::uint64_t t = 500000 + 10000 * k;
    const auto x = static_cast<float>(k);
    const auto n = static_cast<std::int16_t>(k);
    const std::string counts = packed(n, static_cast<std::int16_t>(-n), std::int16_t{7});
    log.data(0, packed(t, x, -x, 2 * x, 0.5F) + counts);
    log.data(1, packed(t + 1000, x + 100, -x, x, x) + counts);
    if (k % 2 == 0) log.data(2, packed(t) + "name" + packed(static_cast<std::uint8_t>(k > 4)));
    if (k == 3) log.dropout(25);
    if (k == 5) log.sync();
  }
  return log;
}

}  // namespace quadtune::testing
