// SPDX-License-Identifier: Apache-2.0
// Source: PX4 User Guide, "ULog File Format".
#include "logs/formats/ulog_formats.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cstdint>
#include <cstring>
#include <optional>

#include "logs/log_titles.hpp"
#include "quadtune/internal/text_file.hpp"

namespace quadtune::internal {
namespace {

static_assert(std::endian::native == std::endian::little,
              "records are copied without byte swapping");

constexpr std::size_t kMaxFormats = 4096;
constexpr std::size_t kMaxBytes = 65535;  // per record, whose size field has 16 bits
// Of unfolding: types without bytes could nest indefinitely
constexpr std::size_t kMaxSteps = 65536;
constexpr int kDeepest = 16;

struct BasicType {
  std::string_view name;
  UlogType type;
  std::size_t bytes;
};
constexpr std::array<BasicType, 11> kBasicTypes = {{{"int8_t", UlogType::kInt8, 1},
                                                    {"uint8_t", UlogType::kUint8, 1},
                                                    {"int16_t", UlogType::kInt16, 2},
                                                    {"uint16_t", UlogType::kUint16, 2},
                                                    {"int32_t", UlogType::kInt32, 4},
                                                    {"uint32_t", UlogType::kUint32, 4},
                                                    {"int64_t", UlogType::kInt64, 8},
                                                    {"uint64_t", UlogType::kUint64, 8},
                                                    {"float", UlogType::kFloat, 4},
                                                    {"double", UlogType::kDouble, 8},
                                                    {"bool", UlogType::kBool, 1}}};
constexpr std::string_view kLetter = "char";
constexpr std::string_view kPadding = "_padding";
constexpr std::string_view kClock = "timestamp";

const BasicType* basic_type(std::string_view name) {
  const auto* const found = std::find_if(kBasicTypes.begin(), kBasicTypes.end(),
                                         [&](const BasicType& type) { return type.name == name; });
  return found == kBasicTypes.end() ? nullptr : found;
}

template <typename Number>
Number number_at(std::string_view record, std::size_t offset) {
  Number value;
  std::memcpy(&value, record.data() + offset, sizeof value);
  return value;
}

template <typename Result>
Result value_of(const UlogLeaf& leaf, std::string_view record) {
  const auto as = [&]<typename Number>(Number) {
    return static_cast<Result>(number_at<Number>(record, leaf.offset));
  };
  switch (leaf.type) {
    case UlogType::kInt8:
      return as(std::int8_t{});
    case UlogType::kUint8:
    case UlogType::kBool:
      return as(std::uint8_t{});
    case UlogType::kInt16:
      return as(std::int16_t{});
    case UlogType::kUint16:
      return as(std::uint16_t{});
    case UlogType::kInt32:
      return as(std::int32_t{});
    case UlogType::kUint32:
      return as(std::uint32_t{});
    case UlogType::kInt64:
      return as(std::int64_t{});
    case UlogType::kUint64:
      return as(std::uint64_t{});
    case UlogType::kFloat:
      return as(float{});
    case UlogType::kDouble:
      return as(double{});
  }
  return Result{};
}

bool is_whole(UlogType type) { return type != UlogType::kFloat && type != UlogType::kDouble; }

}  // namespace

double ulog_value(const UlogLeaf& leaf, std::string_view record) {
  return value_of<double>(leaf, record);
}

std::uint64_t ulog_whole(const UlogLeaf& leaf, std::string_view record) {
  return value_of<std::uint64_t>(leaf, record);
}

std::string UlogFormats::add(std::string_view definition) {
  const std::size_t colon = definition.find(':');
  if (colon == std::string_view::npos || colon == 0) return "a format without a name";
  const std::string name(definition.substr(0, colon));
  if (formats_.size() == kMaxFormats) return fmt::format("more than {} formats", kMaxFormats);
  std::vector<Field> fields;
  for (std::string_view rest = definition.substr(colon + 1); !trimmed(rest).empty();) {
    const std::size_t end = std::min(rest.find(';'), rest.size());
    const std::string_view field = trimmed(rest.substr(0, end));
    rest.remove_prefix(std::min(end + 1, rest.size()));
    const std::size_t blank = field.find(' ');
    if (blank == std::string_view::npos)
      return fmt::format("field '{}' of format '{}' has no type and name", printable(field),
                         printable(name));
    std::string_view type = field.substr(0, blank);
    std::size_t count = 0;
    if (const std::size_t bracket = type.find('['); bracket != std::string_view::npos) {
      const char* const last = type.data() + type.size();
      const auto [stop, error] = std::from_chars(type.data() + bracket + 1, last, count);
      if (error != std::errc() || count == 0 || count > kMaxBytes ||
          std::string_view(stop, last) != "]")
        return fmt::format("field '{}' of format '{}' is an array of unknown length",
                           printable(field), printable(name));
      type = type.substr(0, bracket);
    }
    fields.push_back({std::string(type), std::string(trimmed(field.substr(blank + 1))), count});
  }
  formats_[name] = std::move(fields);
  return "";
}

// Expands a topic field by field.
class UlogFormats::Unfolder {
 public:
  Unfolder(const UlogFormats& formats, UlogLayout& layout) : formats_(formats), layout_(layout) {}

  std::string unfold(const std::string& topic, const std::string& prefix, int depth) {
    const auto found = formats_.formats_.find(topic);
    if (found == formats_.formats_.end())
      return fmt::format("no format '{}' is defined", printable(topic));
    if (depth > kDeepest) return fmt::format("formats are nested more than {} deep", kDeepest);
    for (const Field& field : found->second) {
      if (std::string problem = unfold(field, prefix, depth); !problem.empty()) return problem;
    }
    return "";
  }

 private:
  std::string unfold(const Field& field, const std::string& prefix, int depth) {
    const BasicType* const basic = basic_type(field.type);
    const std::size_t count = std::max<std::size_t>(field.count, 1);
    const std::string name = prefix + field.name;
    if (field.type == kLetter || field.name.starts_with(kPadding)) {
      const std::size_t bytes = count * (basic == nullptr ? 1 : basic->bytes);
      return advance(bytes, field.type == kLetter && !field.name.starts_with(kPadding));
    }
    for (std::size_t i = 0; i < count; ++i) {
      if (++steps_ > kMaxSteps) return fmt::format("a topic of more than {} fields", kMaxSteps);
      const std::string entry = field.count == 0 ? name : fmt::format("{}[{}]", name, i);
      std::string problem;
      if (basic == nullptr) {
        problem = unfold(field.type, entry + ".", depth + 1);
      } else {
        add({basic->type, layout_.max}, entry, depth == 0 && field.count == 0);
        problem = advance(basic->bytes, true);
      }
      if (!problem.empty()) return problem;
    }
    return "";
  }

  void add(const UlogLeaf& leaf, const std::string& name, bool outermost) {
    if (outermost && name == kClock && is_whole(leaf.type)) {
      layout_.timed = true;
      layout_.timestamp = leaf;
      return;
    }
    layout_.leaves.push_back(leaf);
    // Suffixes of PX4's names are not units: gyro_rad is in rad/s.
    layout_.channels.push_back({name, ""});
  }

  std::string advance(std::size_t bytes, bool needed) {
    layout_.max += bytes;
    if (needed) layout_.min = layout_.max;
    return layout_.max > kMaxBytes ? fmt::format("a record of more than {} bytes", kMaxBytes) : "";
  }

  const UlogFormats& formats_;
  UlogLayout& layout_;
  std::size_t steps_ = 0;
};

std::string UlogFormats::layout(const std::string& topic, UlogLayout& layout) const {
  layout = {};
  return Unfolder(*this, layout).unfold(topic, "", 0);
}

}  // namespace quadtune::internal
