// SPDX-License-Identifier: Apache-2.0
// Source: PX4 User Guide, "ULog File Format".
#include "logs/formats/ulog_reader.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <limits>
#include <optional>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include "logs/formats/log_lines.hpp"
#include "logs/formats/ulog_formats.hpp"
#include "logs/log_clock.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/internal/text_file.hpp"

namespace quadtune::internal {
namespace {

using std::string_view_literals::operator""sv;

constexpr std::string_view kMagic = "ULog\x01\x12\x35"sv;
constexpr std::size_t kHeaderSize = 16;  // magic, version, time
constexpr std::size_t kMessageHeader = 3;
constexpr std::string_view kKnownTypes = "ABCDFILMOPQRS";
constexpr std::string_view kSync = "\x2f\x73\x13\x20\x25\x0c\xbb\x12"sv;
constexpr std::size_t kMaxChannels = 200000;
constexpr std::size_t kMaxUlogGroups = 10000;
constexpr std::size_t kUlogBlockValues = 4096;
constexpr double kUlogTicks = 1e6;       // microseconds
constexpr std::size_t kTopicNumber = 2;  // [bytes] before the record's data
constexpr std::uint64_t kLastTime = std::numeric_limits<std::int64_t>::max();  // [us]
constexpr std::uint64_t kFarFromStart = 1'000'000;        // [us]: no logger starts that quickly
constexpr std::uint64_t kOtherClock = 1'000'000'000'000;  // [us] = 1e6 s
constexpr std::uint64_t kNowhere = std::numeric_limits<std::uint64_t>::max();

template <typename Number>
Number read_number(std::string_view bytes, std::size_t at) {
  Number value;
  std::memcpy(&value, bytes.data() + at, sizeof value);
  return value;
}

class UlogReader final : public LogReader {
 public:
  UlogReader(ByteStream stream, const LogOptions& options)
      : LogReader("ulog"), stream_(std::move(stream)), clock_(options.epoch_s) {
    if (!is_ulog(stream_.peek(kMagic.size())))
      throw InvalidInput(stream_.name(), "does not begin like a ULog file");
    const std::string_view header = stream_.peek(kHeaderSize);
    if (header.size() < kHeaderSize)
      throw InvalidInput(stream_.name(), "has no complete ULog header; is it cut short?");
    latest_ = read_number<std::uint64_t>(header, kMagic.size() + 1);
    stream_.skip(kHeaderSize);
  }

  // A block ends at the first record of another topic, to keep the order of the file.
  bool next(LogBlock& block) override {
    block.time.clear();
    block.values.clear();
    std::optional<std::size_t> group;
    while (block.values.size() < kUlogBlockValues && block.rows() < kUlogBlockValues) {
      const std::optional<Message> message = next_message();
      if (!message) break;
      if (message->type == 'D') {
        const Topic* const topic = topic_of(message->body);
        // Remains for the next block
        if (topic != nullptr && group && topic->group != *group) break;
        if (topic != nullptr && !is_stray(*topic, message->body)) {
          // Peek again, since looking ahead may have moved the buffer.
          const std::string_view whole = stream_.peek(kMessageHeader + message->body.size());
          add_row(topic->layout, whole.substr(kMessageHeader + kTopicNumber), block);
          group = topic->group;
        }
      } else {
        take(*message);
      }
      stream_.skip(kMessageHeader + message->body.size());
    }
    block.group = group.value_or(0);
    if (block.time.empty()) report_strays();
    return !block.time.empty();
  }

  [[nodiscard]] std::int64_t epoch_s() const override { return clock_.epoch_s(); }

 private:
  struct Message {
    char type;
    std::string_view body;
  };
  struct Topic {
    std::size_t group;
    UlogLayout layout;
  };

  void tear(const std::string& why) {
    condition_.torn = fmt::format("{}: {} at offset {}", stream_.name(), why, stream_.offset());
  }
  void skip(const std::string& why) {
    skip_record(condition_,
                fmt::format("{}: {} at offset {}", stream_.name(), why, stream_.offset()));
  }

  // Reads the message at the current position without consuming it.
  std::optional<Message> next_message() {
    while (condition_.torn.empty()) {
      if (stream_.offset() == border()) ++borders_passed_;
      const std::string_view head = stream_.peek(kMessageHeader);
      if (head.empty()) {
        if (border() != kNowhere)
          tear(fmt::format("the file ends before the appended data at {}", border()));
        return std::nullopt;
      }
      if (head.size() < kMessageHeader) {
        tear("the file ends within a message");
        return std::nullopt;
      }
      const std::size_t size = read_number<std::uint16_t>(head, 0);
      const char type = head[2];
      if (stream_.offset() + kMessageHeader + size > border()) {
        // The log was interrupted, e.g. by a crash, and the data were appended later.
        skip("a message is cut by appended data");
        stream_.skip(border() - stream_.offset());
        continue;
      }
      if (kKnownTypes.find(type) == std::string_view::npos) {
        pass_unknown(size, type);
        continue;
      }
      const std::string_view message = stream_.peek(kMessageHeader + size);
      if (message.size() < kMessageHeader + size) {
        tear("the file ends within a message");
        return std::nullopt;
      }
      return Message{type, message.substr(kMessageHeader)};
    }
    return std::nullopt;
  }

  // A message of unknown type, or no message: continue at the next synchronization mark, which the
  // logger writes from time to time.
  void pass_unknown(std::size_t size, char type) {
    const std::size_t length = kMessageHeader + size;
    const std::string_view with_next = stream_.peek(length + kMessageHeader);
    const bool at_end = with_next.size() == length;
    skip(fmt::format("a message of unknown type {:#04x}", static_cast<unsigned char>(type)));
    if (at_end || (with_next.size() == length + kMessageHeader &&
                   kKnownTypes.find(with_next[length + 2]) != std::string_view::npos)) {
      stream_.skip(length);
      return;
    }
    while (true) {
      const std::string_view window =
          stream_.peek(std::min<std::uint64_t>(ByteStream::kWindow, border() - stream_.offset()));
      const std::size_t mark = window.find(kSync);
      if (mark != std::string_view::npos) {
        stream_.skip(mark + kSync.size());
        return;
      }
      if (window.size() < kSync.size() || stream_.offset() + window.size() == border() ||
          window.size() < ByteStream::kWindow) {
        tear("no readable data follow");
        return;
      }
      stream_.skip(window.size() - kSync.size() + 1);
    }
  }

  [[nodiscard]] std::uint64_t border() const {
    return borders_passed_ < borders_.size() ? borders_[borders_passed_] : kNowhere;
  }

  void take(const Message& message) {
    switch (message.type) {
      case 'B':
        take_flags(message.body);
        return;
      case 'F':
        if (const std::string problem = formats_.add(message.body); !problem.empty()) skip(problem);
        return;
      case 'A':
        subscribe(message.body);
        return;
      case 'R':
        if (message.body.size() >= 2) topics_.erase(read_number<std::uint16_t>(message.body, 0));
        return;
      case 'O':
        ++condition_.dropouts;
        if (message.body.size() >= 2)
          condition_.dropout_s += 1e-3 * read_number<std::uint16_t>(message.body, 0);
        return;
      default:
        return;  // information, parameters, texts, synchronization marks
    }
  }

  void take_flags(std::string_view body) {
    constexpr std::size_t kFlags = 8;  // compatible flags, then incompatible flags
    constexpr std::size_t kSize = 2 * kFlags + 3 * sizeof(std::uint64_t);
    if (body.size() < kSize) {
      skip("flags without their offsets");
      return;
    }
    for (std::size_t i = 0; i < kFlags; ++i)
      if ((static_cast<unsigned char>(body[kFlags + i]) & (i == 0 ? 0xfeU : 0xffU)) != 0)
        throw InvalidInput(stream_.name(),
                           "has incompatible flags that this reader does not know, expected at "
                           "most the flag for appended data: it is a newer version of ULog");
    for (std::size_t i = 0; i < 3; ++i) {
      const auto offset = read_number<std::uint64_t>(body, 2 * kFlags + 8 * i);
      if (offset == 0) break;
      const std::uint64_t before =
          borders_.empty() ? stream_.offset() + kMessageHeader + body.size() : borders_.back() + 1;
      if (offset < before) {
        skip(fmt::format("appended data at {}, which is not after the preceding data", offset));
        break;
      }
      borders_.push_back(offset);
    }
  }

  void subscribe(std::string_view body) {
    if (body.size() < 4) {
      skip("a subscription without a topic");
      return;
    }
    const auto instance = static_cast<unsigned char>(body[0]);
    const auto id = read_number<std::uint16_t>(body, 1);
    const std::string topic(body.substr(3));
    Topic entry{groups().size(), {}};
    if (const std::string problem = formats_.layout(topic, entry.layout); !problem.empty()) {
      skip(fmt::format("topic '{}': {}", printable(topic), problem));
      return;
    }
    const std::string name = instance == 0 ? topic : fmt::format("{}.{}", topic, instance);
    const auto same = std::find_if(groups().begin(), groups().end(),
                                   [&](const LogGroup& group) { return group.name == name; });
    const auto place = static_cast<std::size_t>(same - groups().begin());
    if (same != groups().end() &&
        (same->channels != entry.layout.channels || same->timed != entry.layout.timed)) {
      skip(fmt::format("topic '{}' is subscribed again with different fields", printable(name)));
      return;
    }
    entry.group = place;
    if (same == groups().end()) {
      channels_ += entry.layout.channels.size() + 1;
      if (channels_ > kMaxChannels || groups().size() == kMaxUlogGroups)
        throw InvalidInput(stream_.name(),
                           fmt::format("has more than {} channels or {} topics, expected fewer",
                                       kMaxChannels, kMaxUlogGroups));
      add_group({name, entry.layout.channels, entry.layout.timed});
    }
    topics_.insert_or_assign(id, std::move(entry));
  }

  // The topic of a record, if the record can be read.
  const Topic* topic_of(std::string_view body) {
    if (body.size() < kTopicNumber) {
      skip("a record without a topic");
      return nullptr;
    }
    const auto number = read_number<std::uint16_t>(body, 0);
    const auto found = topics_.find(number);
    if (found == topics_.end()) {
      skip(fmt::format("a record of topic {}, which is not subscribed", number));
      return nullptr;
    }
    const UlogLayout& layout = found->second.layout;
    const std::string_view record = body.substr(kTopicNumber);
    if (record.size() < layout.min || record.size() > layout.max) {
      skip(fmt::format("a record of {} bytes, expected {}", record.size(), layout.max));
      return nullptr;
    }
    if (layout.timed && ulog_whole(layout.timestamp, record) > kLastTime) {
      skip("a record with an invalid time");
      return nullptr;
    }
    return &found->second;
  }

  // PX4 writes 0 for a time that was never set; 0 is valid only if logging began at 0.
  bool is_stray(const Topic& topic, std::string_view body) {
    if (!topic.layout.timed) return false;
    const std::uint64_t ticks = ulog_whole(topic.layout.timestamp, body.substr(kTopicNumber));
    if (ticks != 0) {
      latest_ = ticks;
      return false;
    }
    if (latest_ < kFarFromStart) {
      if (!ahead_) ahead_ = next_time();
      if (*ahead_ < kOtherClock) return false;
    }
    if (strays_++ == 0) first_stray_ = groups()[topic.group].name;
    return true;
  }

  // Time of the next record with a time other than 0, within the look-ahead [us]; otherwise 0.
  std::uint64_t next_time() {
    const std::string_view ahead = stream_.peek(ByteStream::kWindow);
    for (std::size_t at = 0; at + kMessageHeader <= ahead.size();) {
      const std::size_t size = read_number<std::uint16_t>(ahead, at);
      const std::string_view body = ahead.substr(at + kMessageHeader, size);
      if (ahead[at + 2] == 'D' && body.size() == size && size > kTopicNumber) {
        const auto topic = topics_.find(read_number<std::uint16_t>(body, 0));
        if (topic != topics_.end() && topic->second.layout.timed &&
            size - kTopicNumber >= topic->second.layout.min)
          if (const std::uint64_t time =
                  ulog_whole(topic->second.layout.timestamp, body.substr(kTopicNumber));
              time != 0)
            return time;
      }
      at += kMessageHeader + size;
    }
    return 0;
  }

  void report_strays() {
    if (strays_ == 0) return;
    condition_.notes.push_back(
        fmt::format("{} {} at time 0 (clock not set) and left out, the first of '{}'", strays_,
                    strays_ == 1 ? "record is" : "records are", printable(first_stray_)));
    strays_ = 0;
  }

  void add_row(const UlogLayout& layout, std::string_view record, LogBlock& block) {
    const auto time = [&] {
      const std::uint64_t ticks = ulog_whole(layout.timestamp, record);
      return clock_.seconds({static_cast<std::int64_t>(ticks), 0}, kUlogTicks);
    };
    block.time.push_back(layout.timed ? time() : std::numeric_limits<double>::quiet_NaN());
    for (const UlogLeaf& leaf : layout.leaves) block.values.push_back(ulog_value(leaf, record));
  }

  ByteStream stream_;
  LogClock clock_;
  UlogFormats formats_;
  // By the number with which records refer to them
  std::unordered_map<std::uint16_t, Topic> topics_;
  std::vector<std::uint64_t> borders_;  // offsets at which appended data begin
  std::size_t borders_passed_ = 0;
  std::size_t channels_ = 0;  // in all groups
  // Last time that was read and is not 0, initially that of the header [us]
  std::uint64_t latest_ = 0;
  std::optional<std::uint64_t> ahead_;  // next_time() at the first record with time 0
  std::uint64_t strays_ = 0;            // number of records whose time was not set
  std::string first_stray_;             // group of the first of them
};

}  // namespace

bool is_ulog(std::string_view bytes) { return bytes.starts_with(kMagic); }

std::unique_ptr<LogReader> open_ulog(ByteStream stream, const LogOptions& options) {
  return std::make_unique<UlogReader>(std::move(stream), options);
}

}  // namespace quadtune::internal
