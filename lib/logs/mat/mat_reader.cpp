// SPDX-License-Identifier: Apache-2.0
#include "logs/mat/mat_reader.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <new>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "logs/formats/log_lines.hpp"
#include "logs/log_clock.hpp"
#include "logs/mat/guarded_process.hpp"
#include "logs/mat/mat_library.hpp"
#include "quadtune/errors.hpp"

namespace quadtune::internal {
namespace {

constexpr std::size_t kBlockValues = 4096;
// What the child may say in one piece; no honest one says more.
constexpr std::uint64_t kLongest = std::uint64_t{1} << 28U;

// Pieces: a letter, a length, so many bytes.
enum Piece : char {
  kGroup = 'G',  // timed, name, then name and unit of each channel
  kRows = 'R',   // group, rows, their times, their values
  kTorn = 'T',   // LogCondition
  kSkipped = 'S',
  kNote = 'N',
  kError = 'E',  // InvalidInput
  kFault = 'F',  // FileError: where, why
  kEnd = 'Z',
};

class Writer {
 public:
  explicit Writer(int pipe) : pipe_(pipe) {}

  void add(std::string_view text) {
    add_number(text.size());
    bytes_.append(text);
  }
  void add_number(std::uint64_t number) { add_bytes(&number, sizeof number); }
  void add_bytes(const void* bytes, std::size_t size) {
    bytes_.append(static_cast<const char*>(bytes), size);
  }
  void send(Piece piece) {
    const std::uint64_t size = bytes_.size();
    const auto letter = static_cast<char>(piece);
    // Without a reader there is nothing left to do.
    if (!write_fully(pipe_, &letter, 1) || !write_fully(pipe_, &size, sizeof size) ||
        !write_fully(pipe_, bytes_.data(), bytes_.size()))
      ::_Exit(1);
    bytes_.clear();
  }

 private:
  int pipe_;
  std::string bytes_;
};

void send_rows(const MatTable& table, std::size_t group, Writer& writer) {
  const std::size_t columns = table.columns.size();
  const std::size_t step =
      std::max<std::size_t>(1, kBlockValues / std::max<std::size_t>(1, columns));
  std::vector<double> numbers;
  for (std::size_t start = 0; start < table.rows(); start += step) {
    const std::size_t rows = std::min(step, table.rows() - start);
    numbers.clear();
    for (std::size_t i = start; i < start + rows; ++i)
      numbers.push_back(table.time.empty() ? std::numeric_limits<double>::quiet_NaN()
                                           : table.time[i]);
    for (std::size_t i = start; i < start + rows; ++i)
      for (const std::vector<double>& column : table.columns) numbers.push_back(column[i]);
    writer.add_number(group);
    writer.add_number(rows);
    writer.add_bytes(numbers.data(), numbers.size() * sizeof(double));
    writer.send(kRows);
  }
}

void send_content(const MatContent& content, Writer& writer) {
  for (const MatTable& table : content.tables) {
    writer.add_number(table.group.timed ? 1 : 0);
    writer.add(table.group.name);
    for (const LogChannel& channel : table.group.channels) {
      writer.add(channel.name);
      writer.add(channel.unit);
    }
    writer.send(kGroup);
  }
  const LogCondition& condition = content.condition;
  for (const std::string& note : condition.notes) {
    writer.add(note);
    writer.send(kNote);
  }
  if (!condition.torn.empty()) {
    writer.add(condition.torn);
    writer.send(kTorn);
  }
  if (condition.skipped > 0) {
    writer.add_number(condition.skipped);
    writer.add(condition.first_skipped);
    writer.send(kSkipped);
  }
  for (std::size_t i = 0; i < content.tables.size(); ++i) send_rows(content.tables[i], i, writer);
  writer.send(kEnd);
}

// In the child. The libraries are loaded before the filter forbids to open files.
MatContent decoded(ByteStream& stream, std::size_t memory) {
  const MatFunctions& mat = mat_functions();
  const bool confined = mat.forbid_system_calls();
  MatContent content = mat.decode(stream, memory);
  if (!confined)
    content.condition.notes.emplace_back(
        "the system lets no filter of system calls be set (seccomp), so the process that read this "
        "file was confined by its limits of memory and time alone");
  return content;
}

void decode_into(ByteStream& stream, std::size_t memory, int pipe) {
  Writer writer(pipe);
  const auto fail = [&](std::string_view why) {
    Writer error(pipe);
    error.add(why);
    error.send(kError);
  };
  try {
    send_content(decoded(stream, memory), writer);
  } catch (const std::bad_alloc&) {
    fail(fmt::format("{}: needs more than {} MiB of memory to be read", stream.name(),
                     memory >> 20U));
  } catch (const InvalidInput& error) {
    fail(error.what());
  } catch (const FileError& error) {
    Writer fault(pipe);
    fault.add(error.path());
    fault.add(error.message());
    fault.send(kFault);
  } catch (const std::exception& error) {
    fail(fmt::format("{}: {}", stream.name(), error.what()));
  }
}

// Takes a piece apart.
class Content {
 public:
  explicit Content(std::string_view bytes) : rest_(bytes) {}

  [[nodiscard]] bool empty() const { return rest_.empty(); }
  std::uint64_t number() {
    std::uint64_t value = 0;
    copy(&value, sizeof value);
    return value;
  }
  std::string text() {
    const std::uint64_t size = number();
    if (size > rest_.size()) throw InvalidInput("", kGarbled);
    std::string value(rest_.substr(0, size));
    rest_.remove_prefix(size);
    return value;
  }
  void copy(void* to, std::size_t size) {
    if (size > rest_.size()) throw InvalidInput("", kGarbled);
    rest_.copy(static_cast<char*>(to), size);
    rest_.remove_prefix(size);
  }

  static constexpr const char* kGarbled = "the process that reads MAT files told garbled numbers";

 private:
  std::string_view rest_;
};

class MatReader final : public LogReader {
 public:
  MatReader(ByteStream stream, const LogOptions& options)
      : LogReader("mat"),
        name_(stream.name()),
        clock_(options.epoch_s),
        process_({options.memory_limit, options.time_limit_s},
                 [&](int pipe) { decode_into(stream, options.memory_limit, pipe); }) {
    receive();
  }

  bool next(LogBlock& block) override {
    block.time.clear();
    block.values.clear();
    while (piece_ == kRows) {
      read_rows(block);
      receive();
      if (!block.time.empty()) return true;
    }
    return false;
  }

  [[nodiscard]] std::int64_t epoch_s() const override { return clock_.epoch_s(); }

 private:
  // Takes pieces up to the next rows or the end.
  void receive() {
    while (true) {
      piece_ = next_piece();
      Content content(bytes_);
      switch (piece_) {
        case kGroup:
          read_group(content);
          break;
        case kNote:
          condition_.notes.push_back(content.text());
          break;
        case kTorn:
          condition_.torn = content.text();
          break;
        case kSkipped:
          condition_.skipped += content.number();
          condition_.first_skipped = content.text();
          break;
        case kError:
          throw InvalidInput("", content.text());
        case kFault: {
          const std::string path = content.text();
          throw FileError(path, content.text());
        }
        default:
          return;
      }
    }
  }

  Piece next_piece() {
    char letter = 0;
    std::uint64_t size = 0;
    bool got = process_.read(&letter, 1) && process_.read(&size, sizeof size) && size <= kLongest;
    if (got) {
      bytes_.resize(size);
      got = process_.read(bytes_.data(), size);
    }
    constexpr std::string_view kPieces = "GRTSNEFZ";
    if (got && kPieces.find(letter) != std::string_view::npos) return static_cast<Piece>(letter);
    throw InvalidInput(name_, fmt::format("cannot be read: the process that reads MAT files {}",
                                          process_.why_ended()));
  }

  void read_group(Content& content) {
    LogGroup group;
    group.timed = content.number() != 0;
    group.name = content.text();
    while (!content.empty()) {
      std::string name = content.text();
      group.channels.push_back({std::move(name), content.text()});
    }
    add_group(std::move(group));
  }

  void read_rows(LogBlock& block) {
    Content content(bytes_);
    block.group = content.number();
    const std::uint64_t rows = content.number();
    if (block.group >= groups().size() || rows > kLongest / sizeof(double))
      throw InvalidInput(name_, Content::kGarbled);
    const LogGroup& group = groups()[block.group];
    const std::size_t columns = group.channels.size();
    block.time.resize(rows);
    content.copy(block.time.data(), rows * sizeof(double));
    block.values.resize(rows * columns);
    content.copy(block.values.data(), rows * columns * sizeof(double));
    if (!group.timed) return;
    std::size_t kept = 0;
    for (std::size_t i = 0; i < rows; ++i) {
      const double time = clock_.seconds(block.time[i]);
      if (std::isnan(time)) {
        skip_record(condition_, fmt::format("{}: a row of '{}' has no time, expected a number",
                                            name_, group.name));
        continue;
      }
      block.time[kept] = time;
      std::copy_n(block.values.begin() + static_cast<std::ptrdiff_t>(i * columns), columns,
                  block.values.begin() + static_cast<std::ptrdiff_t>(kept * columns));
      ++kept;
    }
    block.time.resize(kept);
    block.values.resize(kept * columns);
  }

  std::string name_;
  LogClock clock_;
  GuardedProcess process_;
  Piece piece_ = kEnd;
  std::string bytes_;  // of the piece that came last
};

}  // namespace

bool is_mat(std::string_view bytes) {
  constexpr std::size_t kOrder = 126;
  return bytes.starts_with("MATLAB ") || bytes.starts_with("\x89HDF") ||
         (bytes.size() >= kOrder + 2 &&
          (bytes.substr(kOrder, 2) == "IM" || bytes.substr(kOrder, 2) == "MI") &&
          (bytes[kOrder - 1] == 1 || bytes[kOrder - 2] == 1));
}

std::unique_ptr<LogReader> open_mat(ByteStream stream, const LogOptions& options) {
  return std::make_unique<MatReader>(std::move(stream), options);
}

}  // namespace quadtune::internal
