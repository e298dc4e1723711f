// SPDX-License-Identifier: Apache-2.0
/// Writes MAT v5 files byte by byte, as several programs do.
#pragma once

#include <zlib.h>

#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <vector>

namespace quadtune::testing {

class MatWriter {
 public:
  struct Signal {
    std::string label;
    std::vector<std::int32_t> dimensions;
    std::vector<double> values;
  };

  /// @param inner_names  Fields hold arrays that are named as the fields, as Simulink's code
  /// writes.
  explicit MatWriter(bool compressed, bool inner_names = false)
      : compressed_(compressed), inner_names_(inner_names) {
    bytes_ = "MATLAB 5.0 MAT-file";
    bytes_.resize(124, ' ');
    bytes_ += std::string("\0\1IM", 4);
  }

  MatWriter& matrix(const std::string& name, const std::vector<std::int32_t>& dimensions,
                    const std::vector<double>& values) {
    return add(numbers(name, dimensions, values));
  }

  /// A struct with time and signals, each with values and label.
  MatWriter& simulink(const std::string& name, const std::vector<double>& time,
                      const std::vector<Signal>& signals) {
    std::string fields;
    for (const Signal& signal : signals)
      fields += numbers(inner("values"), signal.dimensions, signal.values) +
                letters(inner("label"), signal.label);
    const std::string array =
        structs(inner("signals"), signals.size(), {"values", "label"}, fields);
    const std::string clock = numbers(inner("time"), {std::int32_t(time.size()), 1}, time);
    return add(structs(name, 1, {"time", "signals"}, clock + array));
  }

  [[nodiscard]] const std::string& bytes() const { return bytes_; }

  // The parts of a file, for arrays that no function above writes.
  template <typename Number>
  static std::string raw(const std::vector<Number>& numbers) {
    return {reinterpret_cast<const char*>(numbers.data()), numbers.size() * sizeof(Number)};
  }
  static std::string element(std::uint32_t type, const std::string& data) {
    std::string bytes = raw(std::vector<std::uint32_t>{type, std::uint32_t(data.size())}) + data;
    bytes.resize((bytes.size() + 7) / 8 * 8, '\0');
    return bytes;
  }
  static std::string head(std::uint32_t kind, const std::vector<std::int32_t>& dimensions,
                          const std::string& name) {
    return element(6, raw(std::vector<std::uint32_t>{kind, 0})) + element(5, raw(dimensions)) +
           element(1, name);
  }
  /// @param variable  An element, compressed here if this file is.
  MatWriter& add(const std::string& variable) {
    if (!compressed_) {
      bytes_ += variable;
      return *this;
    }
    uLongf size = compressBound(variable.size());
    std::string packed(size, '\0');
    if (compress(reinterpret_cast<Bytef*>(packed.data()), &size,
                 reinterpret_cast<const Bytef*>(variable.data()), variable.size()) != Z_OK)
      throw std::runtime_error("zlib");
    packed.resize(size);
    bytes_ += raw(std::vector<std::uint32_t>{15, std::uint32_t(size)}) + packed;
    return *this;
  }

 private:
  static constexpr std::size_t kFieldSize = 16;

  static std::string numbers(const std::string& name, const std::vector<std::int32_t>& dimensions,
                             const std::vector<double>& values) {
    return element(14, head(6, dimensions, name) + element(9, raw(values)));
  }
  static std::string letters(const std::string& name, const std::string& text) {
    const std::vector<std::uint16_t> units(text.begin(), text.end());
    return element(14, head(4, {text.empty() ? 0 : 1, std::int32_t(text.size())}, name) +
                           element(4, raw(units)));
  }
  // The length of the names is in its tag, as the format requires.
  // @param fields  fields of all structs, one struct after the other.
  static std::string structs(const std::string& name, std::size_t count,
                             const std::vector<std::string>& names, const std::string& fields) {
    std::string padded;
    for (const std::string& field : names) {
      padded += field;
      padded.resize((padded.size() / kFieldSize + 1) * kFieldSize, '\0');
    }
    return element(14, head(2, {1, std::int32_t(count)}, name) +
                           raw(std::vector<std::uint32_t>{0x40005, kFieldSize}) +
                           element(1, padded) + fields);
  }
  [[nodiscard]] std::string inner(const std::string& name) const {
    return inner_names_ ? name : "";
  }

  std::string bytes_;
  bool compressed_;
  bool inner_names_;
};

}  // namespace quadtune::testing
