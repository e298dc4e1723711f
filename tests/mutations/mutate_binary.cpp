// SPDX-License-Identifier: Apache-2.0
#include <zlib.h>

#include <algorithm>
#include <cstdint>
#include <cstring>

#include "mutate.hpp"

namespace quadtune::mutations {
namespace {

template <typename Number>
Number number_at(const std::string& bytes, std::size_t at) {
  Number value{};
  if (at + sizeof value <= bytes.size()) std::memcpy(&value, bytes.data() + at, sizeof value);
  return value;
}
template <typename Number>
void put(std::string& bytes, std::size_t at, Number value) {
  if (at + sizeof value <= bytes.size()) std::memcpy(bytes.data() + at, &value, sizeof value);
}

/// A count, size or offset near the right one, at an end of its range, or any.
template <typename Number>
Number odd_count(Number right, Random& random) {
  switch (random.below(8)) {
    case 0:
      return 0;
    case 1:
      return static_cast<Number>(right + 1);
    case 2:
      return static_cast<Number>(right - 1);
    case 3:
      return static_cast<Number>(~Number{0});
    case 4:
      return static_cast<Number>(Number{1} << (8 * sizeof(Number) - 1));
    case 5:
      return static_cast<Number>(right * 2);
    case 6:
      return static_cast<Number>(right ^ (Number{1} << random.below(8 * sizeof(Number))));
    default:
      return static_cast<Number>(random.next());
  }
}

/// Replaces some of these bytes by a part of another length.
void replace(std::string& bytes, std::size_t at, std::size_t length, const std::string& by) {
  bytes.replace(std::min(at, bytes.size()), length, by);
}

// --- ULog ---

struct Message {
  std::size_t at;
  std::size_t size;  ///< of what follows the head of three bytes
  char type;
};

std::vector<Message> messages_of(const std::string& bytes) {
  std::vector<Message> all;
  for (std::size_t at = 16; at + 3 <= bytes.size();) {
    const Message message{at, number_at<std::uint16_t>(bytes, at), bytes[at + 2]};
    if (at + 3 + message.size > bytes.size()) break;
    all.push_back(message);
    at += 3 + message.size;
  }
  return all;
}

/// Changes the length of the text of a message, and its header accordingly.
void change_definition(std::string& bytes, const Message& message, Random& random) {
  static const std::vector<std::string> types = {"uint64_t",
                                                 "int8_t",
                                                 "double",
                                                 "float",
                                                 "char",
                                                 "bool",
                                                 "vector",
                                                 "sensor",
                                                 "nothing",
                                                 "float[0]",
                                                 "float[1]",
                                                 "float[65535]",
                                                 "float[4294967296]",
                                                 "float[-1]",
                                                 "char[",
                                                 "float[x]",
                                                 "sensor[3]",
                                                 "uint8_t[60000]",
                                                 "",
                                                 ";",
                                                 ";;",
                                                 "timestamp",
                                                 ":",
                                                 "=",
                                                 "\xff"};
  std::string body = bytes.substr(message.at + 3, message.size);
  const std::size_t at = random.below(body.size() + 1);
  const std::size_t end = std::min(body.find_first_of(" ;[:", at), body.size());
  switch (random.below(4)) {
    case 0:
      body.replace(at, end - at, random.of(types));
      break;
    case 1:
      body.insert(at, random.of(types) + " ");
      break;
    case 2:
      body += random.of(types) + " more;" + (random.percent(30) ? body : "");
      break;
    default:
      body = body.substr(0, at);
  }
  body.resize(std::min<std::size_t>(body.size(), 65535));
  std::string head(3, message.type);
  put(head, 0, static_cast<std::uint16_t>(body.size()));
  replace(bytes, message.at, 3 + message.size, head + body);
}

// --- MAT v5 ---

/// A tag: the type and the number of the bytes that follow.
struct Tag {
  std::size_t at;
  std::uint32_t type;
  std::uint32_t size;
  bool small;  ///< both in four bytes, and the data in the next four
};

constexpr std::uint32_t kMatrix = 14, kCompressed = 15;

void collect_tags(const std::string& bytes, std::size_t begin, std::size_t end,
                  std::vector<Tag>& tags) {
  for (std::size_t at = begin; at + 8 <= end;) {
    const auto first = number_at<std::uint32_t>(bytes, at);
    const bool small = first >> 16U != 0;
    const Tag tag{at, small ? first & 0xffffU : first,
                  small ? first >> 16U : number_at<std::uint32_t>(bytes, at + 4), small};
    tags.push_back(tag);
    if (small) {
      at += 8;
      continue;
    }
    if (tag.size > end - at - 8) return;
    if (tag.type == kMatrix) collect_tags(bytes, at + 8, at + 8 + tag.size, tags);
    at += 8 + (tag.type == kCompressed ? tag.size : (tag.size + 7U) / 8 * 8);
  }
}

std::string inflated(const std::string& packed) {
  std::string result(1 << 16, '\0');
  uLongf size = result.size();
  if (uncompress(reinterpret_cast<Bytef*>(result.data()), &size,
                 reinterpret_cast<const Bytef*>(packed.data()), packed.size()) != Z_OK)
    return {};
  result.resize(size);
  return result;
}

std::string deflated(const std::string& bytes) {
  uLongf size = compressBound(bytes.size());
  std::string packed(size, '\0');
  compress(reinterpret_cast<Bytef*>(packed.data()), &size,
           reinterpret_cast<const Bytef*>(bytes.data()), bytes.size());
  packed.resize(size);
  return packed;
}

void change_tag(std::string& bytes, const Tag& tag, Random& random) {
  const std::size_t data = tag.at + (tag.small ? 4 : 8);
  switch (random.below(5)) {
    case 0:
      if (tag.small)
        put(bytes, tag.at + 2, odd_count(static_cast<std::uint16_t>(tag.size), random));
      else
        put(bytes, tag.at + 4, odd_count(tag.size, random));
      break;
    case 1:
      if (tag.small)
        put(bytes, tag.at, static_cast<std::uint16_t>(random.below(22)));
      else
        put(bytes, tag.at, static_cast<std::uint32_t>(random.below(22)));
      break;
    case 2:  // a dimension, a flag, a letter, a number
      put(bytes, data + random.below(std::max<std::size_t>(1, tag.size)) / 4 * 4,
          odd_count<std::uint32_t>(number_at<std::uint32_t>(bytes, data), random));
      break;
    case 3:
      bytes.erase(std::min(tag.at, bytes.size()), 8 + (tag.small ? 0 : (tag.size + 7U) / 8 * 8));
      break;
    default:
      replace(bytes, tag.at, 0, bytes.substr(tag.at, 8 + (tag.small ? 0 : tag.size)));
  }
}

// --- records of a campaign ---

constexpr std::size_t kHeader = 64, kRecord = 224;

/// Recomputes the checksum of the bytes that follow it.
void seal(std::string& bytes, std::size_t at, std::size_t size) {
  if (at + size > bytes.size()) return;
  put(bytes, at,
      static_cast<std::uint32_t>(
          crc32(0, reinterpret_cast<const Bytef*>(bytes.data() + at + 4), uInt(size - 4))));
}

}  // namespace

void change_ulog(std::string& bytes, Random& random) {
  const std::vector<Message> all = messages_of(bytes);
  if (all.empty()) return change_bytes(bytes, random);
  std::vector<Message> definitions;
  for (const Message& message : all)
    if (std::string("FAIPML").find(message.type) != std::string::npos)
      definitions.push_back(message);
  const Message one = random.of(all), other = random.of(all);
  const std::string text = bytes.substr(one.at, 3 + one.size);
  switch (random.below(9)) {
    case 0:
      put(bytes, one.at, odd_count(static_cast<std::uint16_t>(one.size), random));
      break;
    case 1:
      bytes[one.at + 2] = random.of(std::string("BFIMPQADLCSRO?\0\xff", 16));
      break;
    case 2:
      bytes.erase(one.at, text.size());
      break;
    case 3:
      bytes.insert(other.at, text);
      break;
    case 4:
    case 5:
      if (!definitions.empty()) change_definition(bytes, random.of(definitions), random);
      break;
    case 6:  // which topic, which instance
      put(bytes, one.at + 3 + random.below(3), odd_count<std::uint8_t>(0, random));
      break;
    case 7:  // the clock of a record of data
      put(bytes, one.at + 5, odd_count<std::uint64_t>(500000, random));
      break;
    default: {  // a message of any type and size
      std::string any(3 + random.below(60), static_cast<char>(random.below(256)));
      put(any, 0, static_cast<std::uint16_t>(any.size() - 3));
      any[2] = random.of(std::string("BFIMPQADLCSRO"));
      bytes.insert(one.at, any);
    }
  }
}

void change_mat(std::string& bytes, Random& random) {
  std::vector<Tag> tags;
  collect_tags(bytes, 128, bytes.size(), tags);
  if (tags.empty() || random.percent(5)) return change_bytes(bytes, random);
  const Tag tag = random.of(tags);
  if (tag.type != kCompressed || random.percent(10)) return change_tag(bytes, tag, random);
  // The contents of a compressed variable.
  std::string inner = inflated(bytes.substr(tag.at + 8, tag.size));
  std::vector<Tag> inner_tags;
  collect_tags(inner, 0, inner.size(), inner_tags);
  if (inner_tags.empty()) return change_bytes(bytes, random);
  change_tag(inner, random.of(inner_tags), random);
  const std::string packed = deflated(inner);
  std::string head(8, '\0');
  put(head, 0, kCompressed);
  put(head, 4, static_cast<std::uint32_t>(packed.size()));
  replace(bytes, tag.at, 8 + tag.size, head + packed);
}

void change_records(std::string& bytes, Random& random) {
  const std::size_t records = bytes.size() <= kHeader ? 0 : (bytes.size() - kHeader) / kRecord;
  if (records == 0 || random.percent(30)) {
    static const std::vector<std::size_t> fields = {4, 8, 16, 20, 24, 32, 40};
    const std::size_t at = random.of(fields);
    put(bytes, at, odd_count(number_at<std::uint32_t>(bytes, at), random));
    if (random.percent(80)) seal(bytes, 0, kHeader);
    return;
  }
  const std::size_t at = kHeader + kRecord * random.below(records);
  switch (random.below(5)) {
    case 0:
      bytes.insert(at, bytes.substr(at, kRecord));
      break;
    case 1:
      bytes.erase(at, kRecord);
      break;
    case 2:
      put(bytes, at + 4 + 2 * random.below(6), odd_count<std::uint16_t>(1, random));
      break;
    case 3: {
      static const std::vector<std::uint64_t> doubles = {0,
                                                         0x8000000000000000,
                                                         0x7ff0000000000000,
                                                         0xfff0000000000000,
                                                         0x7ff8000000000000,
                                                         0x7fefffffffffffff,
                                                         1,
                                                         0xbff0000000000000};
      put(bytes, at + 16 + 8 * random.below(20), random.of(doubles));
      break;
    }
    default:
      bytes[std::min(at + 176 + random.below(48), bytes.size() - 1)] =
          static_cast<char>(random.below(256));
  }
  if (random.percent(85)) seal(bytes, at, kRecord);
}

}  // namespace quadtune::mutations
