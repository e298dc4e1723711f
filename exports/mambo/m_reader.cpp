// SPDX-License-Identifier: Apache-2.0
// Reads the parameter files that mambo.cpp writes.
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>
#include <set>

#include "mambo/m_file.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/exports/mambo.hpp"

namespace quadtune {
namespace {

struct Line {
  int number = 0;
  std::string text;  // without comment and trailing blanks
};

std::vector<Line> lines_of(const std::string& text) {
  std::vector<Line> lines;
  int number = 0;
  for (std::size_t start = 0; start < text.size();) {
    const std::size_t end = std::min(text.find('\n', start), text.size());
    std::string line = text.substr(start, end - start);
    start = end + 1;
    ++number;
    // Octave, unlike MATLAB, also accepts '#'. A quoted '%' is not a comment, but is never written.
    line.erase(std::min(line.find_first_of("%#"), line.size()));
    line.erase(line.find_last_not_of(" \t\r") + 1);
    line.erase(0, line.find_first_not_of(" \t"));
    if (!line.empty()) lines.push_back({number, line});
  }
  return lines;
}

std::optional<double> number_in(std::string word) {
  word.erase(0, word.find_first_not_of(" \t"));
  word.erase(word.find_last_not_of(" \t") + 1);
  double number = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), number);
  if (word.empty() || error != std::errc() || end != word.data() + word.size()) return {};
  return number;
}

// Parses a row of numbers separated by commas; empty if it is not one, that is an expression.
std::vector<double> row_in(const std::string& text) {
  std::vector<double> row;
  for (std::size_t start = 0; start <= text.size();) {
    const std::size_t end = std::min(text.find(',', start), text.size());
    const std::optional<double> number = number_in(text.substr(start, end - start));
    if (!number) return {};
    row.push_back(*number);
    start = end + 1;
  }
  return row;
}

// Parses the rows of a matrix that starts on lines[at]; `at` then refers to the closing line.
Eigen::MatrixXd rows_in(const std::vector<Line>& lines, std::size_t& at,
                        const std::string& origin) {
  std::vector<std::vector<double>> rows;
  while (++at < lines.size() && lines[at].text != "];") {
    const std::string where = fmt::format("{}:{}", origin, lines[at].number);
    rows.push_back(row_in(lines[at].text));
    if (rows.back().empty())
      throw InvalidInput(where,
                         fmt::format("'{}' is not a row of numbers; expected numbers separated "
                                     "by commas",
                                     lines[at].text));
    if (rows.back().size() != rows.front().size())
      throw InvalidInput(where, fmt::format("has {} numbers, expected {} as in the rows before it",
                                            rows.back().size(), rows.front().size()));
  }
  if (at == lines.size()) throw InvalidInput(origin, "ends within a matrix, expected '];'");
  if (rows.empty()) return {};
  Eigen::MatrixXd M(static_cast<Eigen::Index>(rows.size()),
                    static_cast<Eigen::Index>(rows.front().size()));
  for (Eigen::Index i = 0; i < M.rows(); ++i)
    M.row(i) =
        Eigen::Map<const Eigen::RowVectorXd>(rows[static_cast<std::size_t>(i)].data(), M.cols());
  return M;
}

Eigen::MatrixXd scalar_or_row(const std::string& value) {
  if (const std::optional<double> number = number_in(value))
    return Eigen::MatrixXd::Constant(1, 1, *number);
  if (value.size() < 2 || value.front() != '[' || value.back() != ']') return {};
  const std::vector<double> row = row_in(value.substr(1, value.size() - 2));
  return Eigen::Map<const Eigen::RowVectorXd>(row.data(), static_cast<Eigen::Index>(row.size()));
}

const Eigen::MatrixXd* find(const std::vector<NamedMatrix>& numbers, const std::string& name) {
  for (const NamedMatrix& number : numbers)
    if (number.name == name) return &number.value;
  return nullptr;
}

bool has_any(const std::vector<NamedMatrix>& all, const std::string& prefix) {
  return std::any_of(all.begin(), all.end(),
                     [&](const NamedMatrix& one) { return one.name.starts_with(prefix); });
}

// "Controller.Cascade.Ts"
bool is_dotted_name(std::string_view name) {
  while (true) {
    const std::size_t point = name.find('.');
    if (!exports::is_m_name(name.substr(0, point))) return false;
    if (point == std::string_view::npos) return true;
    name.remove_prefix(point + 1);
  }
}

// Parses the words of "name = {'a', 'b'};" or "name = 'a';".
std::vector<std::string> words_of(const std::string& text, const std::string& name,
                                  const std::string& origin) {
  for (const Line& line : lines_of(text)) {
    if (line.text.rfind(name + " = ", 0) != 0) continue;
    std::vector<std::string> words;
    for (std::size_t open = line.text.find('\''), close; open != std::string::npos;
         open = line.text.find('\'', close + 1)) {
      close = line.text.find('\'', open + 1);
      if (close == std::string::npos) break;
      words.push_back(line.text.substr(open + 1, close - open - 1));
    }
    return words;
  }
  throw InvalidInput(origin, "has no " + name);
}

std::vector<Signal> signals_of(const std::vector<std::string>& words,
                               const std::vector<Signal>& known, const std::string& unit_suffix,
                               const std::string& where) {
  std::vector<Signal> signals;
  for (const std::string& word : words) {
    const auto found = std::find_if(known.begin(), known.end(),
                                    [&](const Signal& signal) { return signal.name == word; });
    if (found == known.end())
      throw InvalidInput(where,
                         fmt::format("has '{}'; expected names from {}", word, names(known)));
    signals.push_back({word, found->unit + unit_suffix});
  }
  return signals;
}

}  // namespace

std::vector<NamedMatrix> parse_m_numbers(const std::string& text, const std::string& origin) {
  std::vector<NamedMatrix> all = parse_m_file(text, origin);
  std::erase_if(all, [](const NamedMatrix& one) { return one.value.size() == 0; });
  return all;
}

std::vector<NamedMatrix> parse_m_file(const std::string& text, const std::string& origin) {
  const std::vector<Line> lines = lines_of(text);
  std::vector<NamedMatrix> numbers;
  std::set<std::string> seen;
  for (std::size_t at = 0; at < lines.size(); ++at) {
    const std::string where = fmt::format("{}:{}", origin, lines[at].number);
    const std::size_t equals = lines[at].text.find(" = ");
    const std::string name = lines[at].text.substr(0, std::min(equals, lines[at].text.size()));
    if (equals == std::string::npos || !is_dotted_name(name))
      throw InvalidInput(where, fmt::format("has '{}'; expected 'Name = value;', because only "
                                            "that can be checked",
                                            lines[at].text));
    std::string value = lines[at].text.substr(equals + 3);
    if (!seen.insert(name).second) throw InvalidInput(where, name + " is defined twice");
    Eigen::MatrixXd M;
    if (value == "[") {
      M = rows_in(lines, at, origin);
    } else if (value.empty() || value.back() != ';' ||
               std::count(value.begin(), value.end(), ';') != 1) {
      throw InvalidInput(where, fmt::format("has '{}'; expected one value and a semicolon", value));
    } else {
      value.pop_back();
      M = scalar_or_row(value);
    }
    if (!M.allFinite())
      throw InvalidInput(where, name + " has an entry that is not finite, expected numbers");
    numbers.push_back({origin, name, M, M.size() > 0 ? "" : value});
  }
  return numbers;
}

bool has_state_feedback(const std::string& text, const std::string& origin) {
  return has_any(parse_m_file(text, origin), "Controller.StateFeedback.");
}

std::optional<CascadeDesign> parse_cascade_vars(const std::string& text,
                                                const std::string& origin) {
  const std::vector<NamedMatrix> all = parse_m_file(text, origin);
  const std::string prefix = "Controller.Cascade.";
  const auto scalar = [&](const std::string& name) -> std::optional<double> {
    const Eigen::MatrixXd* found = find(all, prefix + name);
    if (found == nullptr || found->size() == 0) return std::nullopt;
    if (found->size() != 1)
      throw InvalidInput(origin, fmt::format("{}{} is {}x{}, expected one number", prefix, name,
                                             found->rows(), found->cols()));
    return (*found)(0, 0);
  };
  const auto required = [&](const std::string& name) {
    const std::optional<double> value = scalar(name);
    if (!value)
      throw InvalidInput(origin,
                         fmt::format("lacks the number {}{}; it is required because the other "
                                     "loops are defined",
                                     prefix, name));
    return *value;
  };
  const std::optional<double> dt = scalar("Ts");
  if (!dt) return std::nullopt;
  if (!(*dt > 0))
    throw InvalidInput(origin, fmt::format("{}Ts is {}, expected more than 0", prefix, *dt));
  CascadeDesign cascade;
  cascade.gains.dt = *dt;
  for (const CascadeAxis axis : kAllCascadeAxes) {
    PidLoop loop = cascade_loop(axis);
    loop.Kp = required(loop.name + ".Kp");
    loop.Ki = required(loop.name + ".Ki");
    loop.Kd = required(loop.name + ".Kd");
    cascade.gains.loops.push_back(std::move(loop));
  }
  // A missing limit is written as [], which is not a number.
  cascade.attitude_limit = scalar("attitudeLimit").value_or(cascade.attitude_limit);
  cascade.integrator_limit = scalar("integratorLimit").value_or(cascade.integrator_limit);
  cascade.back_calculation = scalar("backCalculation").value_or(0);
  cascade.takeoff_time = scalar("takeoffTime").value_or(0);
  const auto truth = [&](const char* name) {
    const double value = scalar(name).value_or(0);
    if (value != 0 && value != 1)
      throw InvalidInput(origin, fmt::format("{}{} is {}, expected 0 or 1", prefix, name, value));
    return value == 1;
  };
  cascade.velocity_feed_forward = truth("velocityFeedForward");
  cascade.conditional_integration = truth("conditionalIntegration");
  if (find(all, prefix + "integrator") != nullptr) {
    const std::vector<std::string> word = words_of(text, prefix + "integrator", origin);
    cascade.method = pid_method(word.empty() ? "" : word.front(), origin);
  }
  return cascade;
}

Gains parse_controller_vars(const std::string& text, const std::string& origin) {
  const std::vector<NamedMatrix> numbers = parse_m_numbers(text, origin);
  const std::string prefix = "Controller.StateFeedback.";
  const auto get = [&](const char* name) {
    const Eigen::MatrixXd* found = find(numbers, prefix + name);
    if (found == nullptr)
      throw InvalidInput(origin, fmt::format("has no numbers for {}{}; expected a matrix of plain "
                                             "numbers",
                                             prefix, name));
    return *found;
  };
  const auto words = [&](const char* name) { return words_of(text, prefix + name, origin); };
  const Convention& mambo = convention("mambo", origin);
  Gains gains;
  gains.convention = mambo.name;
  gains.input_kind = InputKind::wrench;
  gains.K = get("K");
  gains.states = signals_of(words("states"), mambo.states, "", origin);
  gains.inputs = signals_of(words("inputs"), mambo.wrench, "", origin);
  gains.integrals = signals_of(words("integrals"), mambo.states, " s", origin);
  gains.K_int = gains.integrals.empty() ? Eigen::MatrixXd(gains.K.rows(), 0) : get("K_int");
  gains.x0 = get("x0").reshaped();
  gains.u0 = get("u0").reshaped();
  gains.dt = get("Ts")(0, 0);
  const std::vector<std::string> law = words("signLaw");
  gains.sign_law = sign_law(law.empty() ? "" : law.front(), origin);
  validate(gains, origin);
  return gains;
}

}  // namespace quadtune
