// SPDX-License-Identifier: Apache-2.0
#include "quadtune/simulation/campaign/campaign_table.hpp"

#include <fmt/format.h>
#include <sqlite3.h>
#include <unistd.h>

#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <memory>

#include "quadtune/errors.hpp"
#include "quadtune/internal/joined.hpp"

namespace quadtune {
namespace {

namespace fs = std::filesystem;

/// Number of rows between two checks for interruption.
constexpr std::size_t kRows = 4096;

/// A temporary file next to its target, which it replaces when it is complete.
class Beside {
 public:
  explicit Beside(fs::path target)
      : target_(std::move(target)),
        path_(target_.parent_path() /
              fmt::format(".{}.{}.quadtune-tmp", target_.filename().string(), ::getpid())) {
    std::error_code ignored;
    fs::remove(path_, ignored);
  }
  Beside(const Beside&) = delete;
  Beside& operator=(const Beside&) = delete;
  ~Beside() {
    std::error_code ignored;
    if (!done_) fs::remove(path_, ignored);
  }
  void take_place() {
    std::error_code error;
    fs::rename(path_, target_, error);
    if (error) throw FileError(target_.string(), error.message());
    done_ = true;
  }
  [[nodiscard]] const fs::path& path() const { return path_; }
  [[nodiscard]] const fs::path& target() const { return target_; }

 private:
  fs::path target_, path_;
  bool done_ = false;
};

std::string metric_column(Metric metric) {
  const std::string& unit = unit_of(metric);
  std::string name = name_of(metric);
  if (unit == "1") return name;
  for (const char c : "_" + unit) name += c == '/' ? std::string("_per_") : std::string(1, c);
  return name;
}

void ask(const std::function<bool()>& interrupted, std::size_t row) {
  if (row % kRows == 0 && interrupted && interrupted()) throw Interrupted();
}

// --- SQLite ---

struct CloseDatabase {
  void operator()(sqlite3* database) const { sqlite3_close(database); }
};
struct FinishStatement {
  void operator()(sqlite3_stmt* statement) const { sqlite3_finalize(statement); }
};
using Database = std::unique_ptr<sqlite3, CloseDatabase>;
using Statement = std::unique_ptr<sqlite3_stmt, FinishStatement>;

[[noreturn]] void throw_sqlite_error(const Beside& file, sqlite3* database) {
  throw FileError(file.target().string(), sqlite3_errmsg(database));
}

void run(const Beside& file, sqlite3* database, const std::string& sql) {
  if (sqlite3_exec(database, sql.c_str(), nullptr, nullptr, nullptr) != SQLITE_OK)
    throw_sqlite_error(file, database);
}

Statement prepare(const Beside& file, sqlite3* database, const std::string& sql) {
  sqlite3_stmt* statement = nullptr;
  if (sqlite3_prepare_v2(database, sql.c_str(), -1, &statement, nullptr) != SQLITE_OK)
    throw_sqlite_error(file, database);
  return Statement(statement);
}

/// Binds the values of one row, from left to right.
class Row {
 public:
  Row(const Beside& file, sqlite3* database, sqlite3_stmt* statement)
      : file_(file), database_(database), statement_(statement) {}

  void put(double x) {
    check(std::isnan(x) ? sqlite3_bind_null(statement_, ++column_)
                        : sqlite3_bind_double(statement_, ++column_, x));
  }
  void put(std::int64_t x) { check(sqlite3_bind_int64(statement_, ++column_, x)); }
  void put(const std::string& text) {
    check(sqlite3_bind_text(statement_, ++column_, text.data(), static_cast<int>(text.size()),
                            SQLITE_TRANSIENT));
  }
  void insert() {
    if (sqlite3_step(statement_) != SQLITE_DONE) throw_sqlite_error(file_, database_);
    sqlite3_reset(statement_);
    column_ = 0;
  }

 private:
  void check(int result) {
    if (result != SQLITE_OK) throw_sqlite_error(file_, database_);
  }
  const Beside& file_;
  sqlite3* database_;
  sqlite3_stmt* statement_;
  int column_ = 0;
};

std::string questions(std::size_t count) {
  std::string text = "?";
  for (std::size_t i = 1; i < count; ++i) text += ",?";
  return text;
}

void make_tables(const Beside& file, sqlite3* database, const Campaign& campaign) {
  const std::vector<std::string> columns = campaign_columns(campaign);
  std::string sql = "CREATE TABLE flights (";
  for (std::size_t i = 0; i < columns.size(); ++i) {
    const std::string& name = columns[i];
    const bool whole = name == "number" || name == "draw" || name == "passed";
    const bool text = name == "design" || name == "mission" || name == "end" || name == "reason";
    sql += fmt::format("{}\"{}\" {}", i == 0 ? "" : ", ", name,
                       name == "number" ? "INTEGER PRIMARY KEY"
                       : whole          ? "INTEGER"
                       : text           ? "TEXT"
                                        : "REAL");
  }
  run(file, database, sql + ")");
  run(file, database,
      "CREATE TABLE quantities (name TEXT, unit TEXT, distribution TEXT, first REAL, second REAL, "
      "least REAL, most REAL)");
  const Statement insert =
      prepare(file, database, "INSERT INTO quantities VALUES (" + questions(7) + ")");
  Row row(file, database, insert.get());
  for (const UncertainNumber& number : campaign.uncertainty.numbers) {
    const Distribution& d = number.distribution;
    row.put(number.quantity);
    row.put(uncertain_quantity(number.quantity, "table").unit);
    row.put(to_string(d.kind));
    for (const double x : {d.first, d.second, d.min, d.max}) row.put(x);
    row.insert();
  }
}

}  // namespace

std::vector<std::string> campaign_columns(const Campaign& campaign) {
  std::vector<std::string> columns = {"number", "draw", "design", "mission"};
  for (const UncertainNumber& number : campaign.uncertainty.numbers)
    columns.push_back(number.quantity);
  for (const char* name : {"passed", "end", "reason", "end_time_s"}) columns.emplace_back(name);
  for (std::size_t m = 0; m < kMetrics; ++m)
    columns.push_back(metric_column(static_cast<Metric>(m)));
  return columns;
}

void write_campaign_csv(const fs::path& target, const Campaign& campaign,
                        const Eigen::MatrixXd& drawn, std::span<const CampaignRecord> records,
                        const std::function<bool()>& interrupted) {
  Beside beside(target);
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(
      std::fopen(beside.path().c_str(), "wbe"), std::fclose);
  const auto failed = [&] { throw FileError(target.string(), std::strerror(errno)); };
  if (!file) failed();
  fmt::memory_buffer text;
  fmt::format_to(std::back_inserter(text), "{}\n",
                 internal::joined(campaign_columns(campaign), ","));
  const auto put = [&](double x) {
    text.push_back(',');
    if (!std::isnan(x)) fmt::format_to(std::back_inserter(text), "{}", x);
  };
  const auto flush = [&] {
    if (std::fwrite(text.data(), 1, text.size(), file.get()) != text.size()) failed();
    text.clear();
  };
  for (std::size_t i = 0; i < records.size(); ++i) {
    ask(interrupted, i);
    const CampaignRecord& record = records[i];
    const CampaignCase& of = campaign.cases[i % campaign.cases.size()];
    const auto flight = static_cast<Eigen::Index>(i / campaign.cases.size());
    fmt::format_to(std::back_inserter(text), "{},{},{},{}", record.number, flight, of.design,
                   of.mission);
    for (const double x : drawn.col(flight)) put(x);
    fmt::format_to(std::back_inserter(text), ",{},{},{}", record.passed ? 1 : 0,
                   to_string(record.end), record.reason);
    put(record.end_time);
    for (const double x : record.metrics.value) put(x);
    text.push_back('\n');
    if (text.size() > (std::size_t{1} << 20)) flush();
  }
  flush();
  if (std::fflush(file.get()) != 0 || ::fsync(fileno(file.get())) != 0) failed();
  beside.take_place();
}

void write_campaign_database(const fs::path& target, const Campaign& campaign,
                             const Eigen::MatrixXd& drawn, std::span<const CampaignRecord> records,
                             const std::function<bool()>& interrupted) {
  Beside beside(target);
  sqlite3* opened = nullptr;
  // No other process accesses the file, so no locking is needed.
  const int status =
      sqlite3_open_v2(beside.path().c_str(), &opened,
                      SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE | SQLITE_OPEN_NOMUTEX, nullptr);
  const Database database(opened);
  if (status != SQLITE_OK) throw_sqlite_error(beside, opened);
  // A file that is discarded after any failure needs no journal.
  run(beside, opened, "PRAGMA journal_mode = OFF");
  // Synced once, before the file replaces its target
  run(beside, opened, "PRAGMA synchronous = NORMAL");
  run(beside, opened, "BEGIN");
  make_tables(beside, opened, campaign);
  {
    const std::size_t columns = campaign_columns(campaign).size();
    const Statement insert =
        prepare(beside, opened, "INSERT INTO flights VALUES (" + questions(columns) + ")");
    Row row(beside, opened, insert.get());
    for (std::size_t i = 0; i < records.size(); ++i) {
      ask(interrupted, i);
      const CampaignRecord& record = records[i];
      const CampaignCase& of = campaign.cases[i % campaign.cases.size()];
      const auto flight = static_cast<Eigen::Index>(i / campaign.cases.size());
      row.put(static_cast<std::int64_t>(record.number));
      row.put(static_cast<std::int64_t>(flight));
      row.put(of.design);
      row.put(of.mission);
      for (const double x : drawn.col(flight)) row.put(x);
      row.put(std::int64_t{record.passed});
      row.put(to_string(record.end));
      row.put(record.reason);
      row.put(record.end_time);
      for (const double x : record.metrics.value) row.put(x);
      row.insert();
    }
  }
  run(beside, opened, "COMMIT");
  beside.take_place();
}

}  // namespace quadtune
