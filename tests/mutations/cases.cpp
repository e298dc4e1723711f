// SPDX-License-Identifier: Apache-2.0
#include "cases.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

#include "quadtune/errors.hpp"
#include "quadtune/exports/imu_calibration_file.hpp"
#include "quadtune/exports/schedule_table.hpp"
#include "quadtune/logs/flight_log.hpp"

namespace quadtune::mutations {
namespace {

using SortedJson = nlohmann::json;

bool has(const Command& command, const std::string& word) {
  return std::find(command.begin(), command.end(), word) != command.end();
}

/// The first words of a command line, i.e. the name of the command.
std::string name_of(const Command& command) {
  if (command.size() > 1 &&
      (command[0] == "tune" || command[0] == "campaign" || command[0] == "link"))
    return command[0] + " " + command[1];
  return command[0];
}

/// Whether an array contains null, which stands for NaN.
bool lacks_number(const SortedJson& json) {
  if (json.is_null()) return true;
  return json.is_structured() && std::any_of(json.begin(), json.end(), lacks_number);
}

std::string matrix_without_number(const SortedJson& json) {
  static const std::set<std::string> matrices = {"A", "B", "C", "D",  "K",  "K_int", "S",   "P",
                                                 "L", "M", "Z", "x0", "u0", "poles", "num", "den"};
  if (!json.is_structured()) return "";
  for (const auto& [key, value] : json.items()) {
    if (matrices.contains(key) && value.is_array() && lacks_number(value)) return key;
    if (std::string inner = matrix_without_number(value); !inner.empty()) return inner;
  }
  return "";
}

std::string json_complaint(const Command& command, const testing::ProgramResult& result) {
  // If the output goes to a file, only an error is printed.
  if (result.out.empty() && has(command, "-o") && result.status <= 1) return "";
  const SortedJson json = SortedJson::parse(result.out, nullptr, false);
  if (json.is_discarded()) return "prints what is no JSON";
  if (!json.is_object()) return "prints another JSON than an object";
  const bool error = json.contains("error") && json["error"].is_object();
  // A negative answer before there is a result is reported like an error.
  if (result.status == 0 || (result.status == 1 && !error)) {
    if (error) return "prints an error and ends as if there were none";
    if (const std::string key = matrix_without_number(json); !key.empty())
      return fmt::format("ends with {} and has null in {}", result.status, key);
    return "";
  }
  if (!error) {
    // A search that has a result prints it.
    const bool answered = result.status == 5 || result.status == 130;
    return answered ? "" : "prints JSON without its error";
  }
  if (json["error"].value("code", -1) != result.status)
    return "prints another code than it ends with";
  return "";
}

std::string text_complaint(const testing::ProgramResult& result) {
  std::istringstream words(result.out);
  for (std::string word; words >> word;)
    if (word == "nan" || word == "-nan") return "prints nan and ends with 0";
  return "";
}

}  // namespace

Cases::Cases(std::vector<Kind> kinds, std::map<std::string, std::vector<std::string>> options,
             std::uint64_t seed)
    : kinds_(std::move(kinds)), options_(std::move(options)), seed_(seed) {}

const Kind& Cases::kind_of(std::uint64_t number) const {
  // Shifted in each round, so that each part of the numbers is used with all kinds.
  return kinds_[(number + number / kinds_.size()) % kinds_.size()];
}

Case Cases::make(std::uint64_t number) const {
  Random random(seed_, number);
  const Kind& kind = kind_of(number);
  const Sample& sample = random.of(kind.samples);
  Case result{seed_, number, kind.name, sample.files, {}};
  // Two commands that read it, where there are two.
  result.commands.push_back(random.of(sample.commands));
  if (const Command& other = random.of(sample.commands);
      !sample.target.empty() && other != result.commands[0])
    result.commands.push_back(other);
  if (sample.target.empty()) {
    Command& command = result.commands[0];
    const auto options = options_.find(name_of(command));
    command =
        mutated_words(command, options == options_.end() ? Command{} : options->second, random);
  } else {
    std::string& target = result.files.at(sample.target);
    target = mutated(target, sample.format, random);
    if (sample.mend && random.percent(85)) sample.mend(result.files);
  }
  for (Command& command : result.commands) {
    if (!command.empty() && command[0] == "(library)") continue;
    if (random.percent(60)) command.emplace_back("--json");
    if (random.percent(80)) command.emplace_back("--quiet");
  }
  return result;
}

std::vector<Case> Cases::unchanged() const {
  std::vector<Case> all;
  for (const Kind& kind : kinds_)
    for (const Sample& sample : kind.samples) {
      Case one{seed_, all.size(), kind.name, sample.files, sample.commands};
      all.push_back(std::move(one));
    }
  return all;
}

std::string complaint(const Command& command, const testing::ProgramResult& result,
                      bool asked_to_stop, const Files& files) {
  const int status = result.status;
  if (status != 130 && (status < 0 || status > 5))
    return fmt::format("ends with {}, expected 0 to 5", status);
  if (status == 130 && !asked_to_stop) return "ends as if interrupted";
  const bool quiet = has(command, "--quiet");
  const auto lines = std::count(result.err.begin(), result.err.end(), '\n');
  if (status == 0 && quiet && !result.err.empty()) return "is not quiet: " + result.err;
  if (status != 0 && (result.err.empty() || result.err.back() != '\n'))
    return fmt::format("ends with {} and does not say why", status);
  if (status != 0 && quiet && lines != 1)
    return fmt::format("says in {} lines why it ended with {}", lines, status);
  // Requested help is text.
  if (has(command, "--json") && !has(command, "--man") && !has(command, "--completion") &&
      !has(command, "--version"))
    return json_complaint(command, result);
  const auto says_nan = [](const std::string& text) {
    return text.find("nan") != std::string::npos;
  };
  const bool given = std::any_of(command.begin(), command.end(), says_nan) ||
                     std::any_of(files.begin(), files.end(),
                                 [&](const auto& file) { return says_nan(file.second); });
  return status == 0 && !given ? text_complaint(result) : "";
}

std::string typed(const Command& command, const std::string& folder) {
  std::string line = "quadtune";
  for (std::string word : command) {
    if (word.starts_with("@")) word.replace(0, 1, folder);
    std::string safe;
    bool plain = !word.empty();
    for (const char c : word) {
      const auto byte = static_cast<unsigned char>(c);
      plain =
          plain && (std::isalnum(byte) || std::string("/._-+:,@%=").find(c) != std::string::npos);
      if (byte < 0x20 || byte >= 0x7f || c == '\'' || c == '\\')
        safe += fmt::format("\\x{:02x}", byte);
      else
        safe += c;
    }
    line += plain ? fmt::format(" {}", word) : fmt::format(" $'{}'", safe);
  }
  return line;
}

testing::ProgramResult run_command(const Command& command, const std::string& folder) {
  Command words = command;
  for (std::string& word : words)
    if (word.starts_with("@")) word.replace(0, 1, folder);
  if (words.empty() || words[0] != "(library)") return testing::run_program(words);
  testing::ProgramResult result;
  try {
    if (words.at(1) == "schedule") {
      const GainSchedule schedule = read_schedule(words.at(2));
      // At a corner of the grid, and outside.
      Eigen::VectorXd at(std::ssize(schedule.axes));
      for (Eigen::Index i = 0; i < at.size(); ++i)
        at(i) = schedule.axes[static_cast<std::size_t>(i)].values.front();
      (void)schedule.at(at);
      (void)schedule.at(1.5 * at);
    } else if (words.at(1) == "flight log") {
      (void)read_log(words.at(2));
    } else {
      (void)read_imu_calibration(words.at(2));
    }
  } catch (const InvalidInput& error) {
    result.status = 3;
    result.err = std::string(error.what()) + "\n";
  } catch (const FileError& error) {
    result.status = 5;
    result.err = std::string(error.what()) + "\n";
  }
  return result;
}

}  // namespace quadtune::mutations
