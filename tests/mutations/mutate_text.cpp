// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cstdint>
#include <cstring>

#include "mutate.hpp"
#include "tree.hpp"

namespace quadtune::mutations {
namespace {

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::size_t at = 0;
  while (at < text.size()) {
    const std::size_t end = std::min(text.find('\n', at), text.size() - 1);
    lines.push_back(text.substr(at, end + 1 - at));
    at = end + 1;
  }
  return lines;
}

std::string joined(const std::vector<std::string>& lines) {
  std::string text;
  for (const std::string& line : lines) text += line;
  return text;
}

void change_lines(std::string& text, Random& random) {
  std::vector<std::string> lines = lines_of(text);
  if (lines.empty()) return;
  const std::size_t a = random.below(lines.size()), b = random.below(lines.size());
  const auto at = [&](std::size_t i) { return lines.begin() + static_cast<std::ptrdiff_t>(i); };
  switch (random.below(6)) {
    case 0:
      lines.erase(at(a));
      break;
    case 1:
      lines.insert(at(b), std::string(lines[a]));
      break;
    case 2:
      std::swap(lines[a], lines[b]);
      break;
    case 3:
      lines.erase(at(std::min(a, b)), at(std::max(a, b)));
      break;
    case 4:
      std::reverse(lines.begin(), lines.end());
      break;
    default:
      lines.insert(at(a), std::string(random.below(3) == 0 ? 9000 : 50, '=') + "\n");
  }
  text = joined(lines);
}

}  // namespace

const std::vector<std::string>& odd_numbers() {
  static const std::vector<std::string> all = {"0",
                                               "-0",
                                               "-0.0",
                                               "1",
                                               "-1",
                                               "2",
                                               "0.5",
                                               "1e308",
                                               "-1e308",
                                               "1e-308",
                                               "1e-320",
                                               "5e-324",
                                               "1e400",
                                               "-1e400",
                                               "1e154",
                                               "1e200",
                                               "1e-154",
                                               "1e15",
                                               "1e-15",
                                               "1e6",
                                               "1e-6",
                                               "nan",
                                               "-nan",
                                               "inf",
                                               "-inf",
                                               "100",
                                               "1000",
                                               "65536",
                                               "255",
                                               "4294967295",
                                               "4294967296",
                                               "2147483647",
                                               "-2147483648",
                                               "9223372036854775807",
                                               "-9223372036854775808",
                                               "18446744073709551616",
                                               "1e9",
                                               "1e18",
                                               "3.5",
                                               "0x10",
                                               "1_000",
                                               "1.",
                                               ".5",
                                               "+1",
                                               "0,5",
                                               "1e",
                                               "--1",
                                               "1.7976931348623157e308",
                                               "2.2250738585072014e-308"};
  return all;
}

const std::vector<std::string>& odd_texts() {
  static const std::vector<std::string> all = {"",
                                               " ",
                                               "a b",
                                               "nan",
                                               "1",
                                               "true",
                                               "../x",
                                               "/",
                                               ".",
                                               "no/such/file",
                                               "-",
                                               "--json",
                                               "\\n",
                                               "\\u0000",
                                               "\\u001b[31m",
                                               "\\u202e",
                                               "\\t",
                                               "{}",
                                               "%s%n",
                                               "caf\u00e9",
                                               "\u9ad8\u5ea6",
                                               "\xf0\x9f\x9a\x81",
                                               "\xff\xfe",
                                               "\xc3",
                                               "\xed\xa0\x80",
                                               "\x01",
                                               "#",
                                               "[",
                                               "]",
                                               "'",
                                               "x.y",
                                               std::string(64, 'n'),
                                               std::string(65, 'n'),
                                               std::string(5000, 'w')};
  return all;
}

void change_bytes(std::string& bytes, Random& random) {
  const std::size_t size = bytes.size();
  if (size == 0) {
    bytes.assign(random.below(20), static_cast<char>(random.below(256)));
    return;
  }
  const std::size_t at = random.below(size);
  const std::size_t length = std::min(size - at, 1 + random.below(random.percent(80) ? 16 : size));
  static const std::vector<std::uint64_t> odd = {0,
                                                 1,
                                                 2,
                                                 7,
                                                 8,
                                                 0x7f,
                                                 0x80,
                                                 0xff,
                                                 0x7fff,
                                                 0x8000,
                                                 0xffff,
                                                 0x7fffffff,
                                                 0x80000000,
                                                 0xffffffff,
                                                 0xfffffff8,
                                                 0x100000000,
                                                 0x7fffffffffffffff,
                                                 0xffffffffffffffff,
                                                 0x7ff0000000000000,
                                                 0x7ff8000000000000,
                                                 0x7fefffffffffffff};
  switch (random.below(9)) {
    case 0:
      bytes[at] = static_cast<char>(bytes[at] ^ (1 << random.below(8)));
      break;
    case 1:
      bytes[at] = static_cast<char>(random.below(256));
      break;
    case 2: {
      const std::uint64_t value = random.of(odd);
      const std::size_t width = std::size_t{1} << random.below(4);
      std::memcpy(bytes.data() + at, &value, std::min(width, size - at));
      break;
    }
    case 3:
      bytes.resize(at);
      break;
    case 4:
      bytes.insert(at, std::string(1 + random.below(40), static_cast<char>(random.below(256))));
      break;
    case 5:
      bytes.erase(at, length);
      break;
    case 6:
      bytes.insert(random.below(size), bytes.substr(at, length));
      break;
    case 7:
      std::fill_n(bytes.begin() + static_cast<std::ptrdiff_t>(at), length, '\0');
      break;
    default: {  // a double at a multiple of eight bytes
      const std::uint64_t value = random.of(odd);
      const std::size_t border = at / 8 * 8;
      std::memcpy(bytes.data() + border, &value, std::min<std::size_t>(8, size - border));
    }
  }
}

void change_text(std::string& text, Random& random) {
  switch (random.below(8)) {
    case 0:
      change_bytes(text, random);
      break;
    case 1:
      text.resize(random.below(text.size() + 1));
      break;
    case 2:
      text.insert(random.below(text.size() + 1), random.of(odd_texts()));
      break;
    case 3:
      text.insert(random.below(text.size() + 1), random.of(odd_numbers()));
      break;
    case 4:
      text = (random.percent(50) ? "\xef\xbb\xbf" : "\xff\xfe") + text;
      break;
    case 5: {  // line ends of another system
      std::string other;
      for (const char c : text)
        other += c == '\n' ? (random.percent(90) ? "\r\n" : "\r") : std::string(1, c);
      text = other;
      break;
    }
    default:
      change_lines(text, random);
  }
}

std::string mutated(const std::string& bytes, Format format, Random& random) {
  std::string result = bytes;
  const bool tree = format == Format::toml || format == Format::json;
  // The text of a tree is changed only sometimes, because the parser rejects most of these changes.
  if (tree && random.percent(85)) {
    Node root = format == Format::toml ? tree_of_toml(bytes) : tree_of_json(bytes);
    for (std::size_t i = 1 + random.below(random.percent(70) ? 1 : 4); i > 0; --i)
      change_tree(root, format == Format::json, random);
    return format == Format::toml ? toml_of(root) : json_of(root);
  }
  for (std::size_t i = 1 + random.below(random.percent(60) ? 1 : 4); i > 0; --i) {
    if (format == Format::numbers && random.percent(85))
      change_numbers(result, random);
    else if (format == Format::ulog && random.percent(80))
      change_ulog(result, random);
    else if (format == Format::mat && random.percent(80))
      change_mat(result, random);
    else if (format == Format::records && random.percent(80))
      change_records(result, random);
    else if (format == Format::ulog || format == Format::mat || format == Format::records)
      change_bytes(result, random);
    else
      change_text(result, random);
  }
  return result;
}

}  // namespace quadtune::mutations
