// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <sstream>

#include "flight_code/compiled/process.hpp"
#include "flight_code/flight_recording.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/internal/text_file.hpp"

namespace quadtune::exports {
namespace {

/// `replay -` of an exported program.
class ProcessProgram final : public RunningProgram {
 public:
  ProcessProgram(const ProgramSettings& settings, const std::vector<std::string>& command,
                 bool double_precision)
      : name_(command.front()),
        rotors_(settings.allocation.rotors),
        lines_(settings.has_estimator(), double_precision),
        double_(double_precision),
        process_(command) {}

  void start(const ProgramStart& start) override { send(lines_.start(start)); }

  Estimate<double> estimate(const EstimatorInput& input) override {
    constexpr int kAnswers = 13;  // the states, and a flag whether they are finite
    send(lines_.input(input));
    const std::vector<double> answer = receive(kAnswers);
    Estimate<double> result;
    for (int i = 0; i < 12; ++i) result.x(i) = answer[static_cast<std::size_t>(i)];
    result.finite = answer.back() != 0;
    return result;
  }

  ProgramOutput control(const Reference<double>& reference, const Eigen::VectorXd& idle) override {
    send(lines_.reference(reference, idle));
    const std::vector<double> answer = receive(rotors_ + 14);
    ProgramOutput output;
    output.commands = Eigen::Map<const Eigen::VectorXd>(answer.data(), rotors_);
    output.estimate = Eigen::Map<const Eigen::VectorXd>(answer.data() + rotors_, 12);
    output.limited = answer[answer.size() - 2] != 0;
    output.finite = answer.back() != 0;
    return output;
  }

 private:
  void send(const std::string& line) {
    if (!process_.write(line + "\n"))
      throw InvalidInput(name_,
                         "the program stopped reading its input; expected it to run until the "
                         "end of the flight");
  }

  [[nodiscard]] std::vector<double> receive(int count) {
    const std::optional<std::string> line = process_.read_line();
    if (!line)
      throw InvalidInput(name_,
                         "the program ended early; expected it to run until the end of the flight");
    std::vector<double> numbers;
    std::istringstream words(*line);
    for (std::string word; words >> word;) {
      std::size_t used = 0;
      try {
        // Reading as float restores the value that was written as float.
        numbers.push_back(double_ ? std::stod(word, &used)
                                  : static_cast<double>(std::stof(word, &used)));
      } catch (const std::exception&) {
        used = 0;
      }
      if (used != word.size())
        throw InvalidInput(name_, fmt::format("the program answers '{}', expected {} numbers",
                                              internal::printable(*line), count));
    }
    if (std::ssize(numbers) != count)
      throw InvalidInput(name_, fmt::format("the program answers {} numbers, expected {}: it is "
                                            "made for another vehicle or another estimator",
                                            numbers.size(), count));
    return numbers;
  }

  std::string name_;
  int rotors_;
  FlightLines lines_;
  bool double_;
  Process process_;
};

}  // namespace

std::shared_ptr<RunningProgram> process_program(const ProgramSettings& settings,
                                                const std::vector<std::string>& command,
                                                bool double_precision) {
  return std::make_shared<ProcessProgram>(settings, command, double_precision);
}

}  // namespace quadtune::exports
