// SPDX-License-Identifier: Apache-2.0
#include "quadtune/workbench/systems/matrix_loop.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <type_traits>
#include <utility>

#include "quadtune/discretize/delay.hpp"
#include "quadtune/discretize/zoh.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/frequency_response.hpp"
#include "quadtune/internal/counted.hpp"
#include "quadtune/internal/joined.hpp"
#include "quadtune/internal/suggest.hpp"
#include "quadtune/internal/text_file.hpp"
#include "quadtune/internal/words.hpp"
#include "quadtune/synthesis/series.hpp"

namespace quadtune {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

/// The transfer function of a continuous PID controller. Terms whose gain is 0 add no poles.
ContinuousTransferFunction pid_fraction(const PidGains& gains) {
  if (gains.Kd != 0 && gains.Tf == 0)
    throw InvalidInput(
        "controller",
        "pid has no filter of the derivative, expected a fourth number, Tf, because the "
        "controller has more zeros than poles otherwise");
  return loop_of({Eigen::VectorXd::Ones(1), Eigen::VectorXd::Ones(1), 0}, gains);
}

/// A system, or a gain if it has no states.
template <class Lti>
struct Element {
  std::optional<Lti> system;
  MatrixXd gain;

  /// Requires the numbers of inputs and outputs with which the loop can be closed.
  void require_match(const Lti& plant) const {
    const Eigen::Index inputs = system ? system->B.cols() : gain.cols();
    const Eigen::Index own = system ? system->C.rows() : gain.rows();
    const Eigen::Index outputs = plant.C.size() == 0 ? plant.A.rows() : plant.C.rows();
    if (inputs != outputs || own != plant.B.cols())
      throw InvalidInput(
          "controller",
          fmt::format("the controller has {} and {}, expected {} and {}, because the "
                      "plant has {} and {}",
                      internal::counted(inputs, "input"), internal::counted(own, "output"), outputs,
                      plant.B.cols(), internal::counted(outputs, "output"),
                      internal::counted(plant.B.cols(), "input")));
  }
  [[nodiscard]] Lti after(const Lti& plant) const {
    require_match(plant);
    return system ? series(plant, *system) : series(plant, gain);
  }
  [[nodiscard]] Lti before(const Lti& plant) const {
    require_match(plant);
    return system ? series(*system, plant) : series(gain, plant);
  }
};

template <class Fraction>
auto element_of(const Fraction& fraction) {
  using Lti = std::conditional_t<std::is_same_v<Fraction, ContinuousTransferFunction>,
                                 ContinuousLti, DiscreteLti>;
  validate(fraction, "controller");
  if (fraction.den.size() > 1) return Element<Lti>{realize(fraction), {}};
  const double gain = fraction.num[fraction.num.size() - 1] / fraction.den[0];
  return Element<Lti>{{}, MatrixXd::Constant(1, 1, gain)};
}

template <class Lti>
Element<Lti> matrix_element(const LoopController& controller, double dt) {
  if (controller.A.size() == 0) return {{}, controller.D};
  Lti system;
  system.A = controller.A;
  system.B = controller.B;
  system.C = controller.C;
  system.D = controller.D;
  if constexpr (std::is_same_v<Lti, DiscreteLti>) system.dt = dt;
  validate(system, "controller");
  return {system, {}};
}

template <class Lti>
Element<Lti> element_of(const LoopController& controller, double dt) {
  constexpr bool is_discrete = std::is_same_v<Lti, DiscreteLti>;
  if (controller.pid) {
    if constexpr (is_discrete)
      return element_of(pid_transfer_function(pid_settings(*controller.pid, dt, controller.method),
                                              PidChannel::error));
    else
      return element_of(pid_fraction(*controller.pid));
  }
  if (controller.den.size() > 0) {
    if constexpr (is_discrete)
      return element_of(DiscreteTransferFunction{controller.num, controller.den, dt, 0});
    else
      return element_of(ContinuousTransferFunction{controller.num, controller.den, 0});
  }
  return matrix_element<Lti>(controller, dt);
}

template <class Lti>
Lti joined_loop(const Lti& plant, const std::optional<LoopController>& controller,
                const MatrixLoopOptions& options) {
  if (!controller) return plant;
  const Element<Lti> element = element_of<Lti>(*controller, options.dt);
  return options.at_outputs ? element.before(plant) : element.after(plant);
}

/// Response of a controller at w [rad/s], which must have one input and one output.
std::complex<double> controller_response(const LoopController& controller, double dt, double w) {
  const auto at = [w](const auto& element) -> std::complex<double> {
    const MatrixXd& gain = element.gain;
    if (!element.system) {
      if (gain.size() != 1)
        throw InvalidInput(
            "controller",
            fmt::format("the controller has {} and {}, expected one of each, as the data have",
                        internal::counted(gain.cols(), "input"),
                        internal::counted(gain.rows(), "output")));
      return gain(0, 0);
    }
    const Eigen::MatrixXcd G = FrequencyResponse(*element.system).at(w);
    if (G.size() != 1)
      throw InvalidInput(
          "controller",
          fmt::format("the controller has {} and {}, expected one of each, as the data have",
                      internal::counted(G.cols(), "input"), internal::counted(G.rows(), "output")));
    return G(0, 0);
  };
  return dt > 0 ? at(element_of<DiscreteLti>(controller, dt))
                : at(element_of<ContinuousLti>(controller, 0));
}

std::vector<std::string> frequency_notes(const FrequencyDataReport& report) {
  std::vector<std::string> notes = {
      "the closed loop is assumed to be stable; this is known only if it was closed when the data "
      "were "
      "measured"};
  const auto range = fmt::format("{:.4g} to {:.4g} rad/s", report.w_min, report.w_max);
  if (!report.data.crosses_gain)
    notes.push_back(
        fmt::format("|L| does not pass 1 within the data, {}, so that phase and delay "
                    "margin are not known",
                    range));
  if (!report.data.crosses_phase)
    notes.push_back(
        fmt::format("the phase of L does not pass -180 degrees within the data, {}, so "
                    "that the gain margins are not known",
                    range));
  if (report.data.largest_phase_step > std::numbers::pi / 2)
    notes.push_back(fmt::format(
        "the phase changes by {:.0f} degrees from {:.4g} rad/s to the next frequency; "
        "more than 90 is too coarse to interpolate",
        report.data.largest_phase_step * 180 / std::numbers::pi, report.data.w_largest_phase_step));
  return notes;
}

// Reading of frequency response data.

std::vector<std::string> words_of_line(const std::string& line) {
  std::vector<std::string> words;
  std::string word;
  for (const char c : line + " ") {
    const bool separates = c == ',' || c == ';' || c == ' ' || c == '\t' || c == '\r';
    if (!separates) {
      word += c;
    } else if (!word.empty()) {
      words.push_back(std::exchange(word, {}));
    }
  }
  return words;
}

/// Positions of the columns by name; -1: not there.
struct DataColumns {
  int w = -1, f = -1, re = -1, im = -1, mag = -1, mag_db = -1, phase_deg = -1, phase_rad = -1;
  std::size_t count = 0;
};

/// A name with its unit, as headers of logs have it, is the name alone.
std::string without_unit(const std::string& word) {
  static const std::map<std::string, std::string> names = {{"f[Hz]", "f"},
                                                           {"w[rad/s]", "w"},
                                                           {"mag[dB]", "mag_db"},
                                                           {"phase[deg]", "phase_deg"},
                                                           {"phase[rad]", "phase_rad"}};
  const auto found = names.find(word);
  return found == names.end() ? word : found->second;
}

DataColumns columns_of(std::vector<std::string> words, const std::string& where) {
  std::transform(words.begin(), words.end(), words.begin(), without_unit);
  DataColumns columns;
  columns.count = words.size();
  const std::pair<const char*, int*> known[] = {{"w", &columns.w},
                                                {"f", &columns.f},
                                                {"re", &columns.re},
                                                {"im", &columns.im},
                                                {"mag", &columns.mag},
                                                {"mag_db", &columns.mag_db},
                                                {"phase_deg", &columns.phase_deg},
                                                {"phase_rad", &columns.phase_rad}};
  for (std::size_t i = 0; i < words.size(); ++i)
    for (const auto& [name, column] : known)
      if (words[i] == name) {
        if (*column >= 0)
          throw InvalidInput(where, fmt::format("column '{}' occurs twice, expected once", name));
        *column = static_cast<int>(i);
      }
  const auto given = [](int column) { return int{column >= 0}; };
  const int frequencies = given(columns.w) + given(columns.f);
  if (frequencies != 1)
    throw InvalidInput(
        where, fmt::format("the columns are {}, expected {} named w (in rad/s) or f (in Hz)",
                           internal::printable(internal::joined(words, ", ")),
                           frequencies == 0 ? "one" : "only one"));
  const bool cartesian = columns.re >= 0 && columns.im >= 0;
  const bool polar = given(columns.mag) + given(columns.mag_db) == 1 &&
                     given(columns.phase_deg) + given(columns.phase_rad) == 1;
  if (cartesian && polar)
    throw InvalidInput(where,
                       "the response is given twice, by re and im and by magnitude and phase; "
                       "expected only one of the two");
  if (!cartesian && !polar)
    throw InvalidInput(where, fmt::format("the columns are {}, expected re and im, or one of mag "
                                          "and mag_db with one of phase_deg and phase_rad, in the "
                                          "first line",
                                          internal::printable(internal::joined(words, ", "))));
  return columns;
}

std::complex<double> value_of(const DataColumns& columns, const std::vector<double>& row,
                              const std::string& where) {
  const auto at = [&](int column) { return row[static_cast<std::size_t>(column)]; };
  if (columns.re >= 0) return {at(columns.re), at(columns.im)};
  if (columns.mag >= 0 && at(columns.mag) < 0)
    throw InvalidInput(where, fmt::format("mag is {}, expected 0 or more; a column in decibels is "
                                          "named mag_db",
                                          at(columns.mag)));
  const double size = columns.mag >= 0 ? at(columns.mag) : std::pow(10.0, at(columns.mag_db) / 20);
  const double phase = columns.phase_rad >= 0 ? at(columns.phase_rad)
                                              : at(columns.phase_deg) * std::numbers::pi / 180;
  return size * std::complex<double>(std::cos(phase), std::sin(phase));
}

}  // namespace

NamedLoop matrix_loop(const ContinuousLti& plant, const std::optional<LoopController>& controller,
                      const MatrixLoopOptions& options) {
  const auto names_of_cut = [&](Index count) {
    return numbered(controller && !options.at_outputs ? "u" : "y", count);
  };
  if (options.time == MatrixTime::continuous) {
    const ContinuousLti loop = joined_loop(plant, controller, options);
    return {OpenLoop(loop, options.delay), names_of_cut(loop.B.cols())};
  }
  DiscreteLti sampled;
  if (options.time == MatrixTime::sampled)
    sampled = discretize_zoh(plant, options.dt);
  else
    sampled = {plant.A, plant.B, plant.C, plant.D, options.dt, {}, {}, {}};
  DiscreteLti loop = joined_loop(sampled, controller, options);
  if (options.delay > 0) {
    const double exact = whole_samples(options.delay, options.dt) * options.dt;
    loop = with_delays(loop, {Eigen::VectorXd::Constant(loop.B.cols(), exact), {}});
  }
  return {OpenLoop(loop), names_of_cut(loop.B.cols())};
}

void set_skew(MarginsReport& report, const OpenLoop& loop, double skew) {
  for (Index i = 0; i < std::ssize(report.loops); ++i)
    report.loops[static_cast<std::size_t>(i)].disk = loop_margins(loop.channel(i), skew).disk;
  if (report.together) report.together = simultaneous_disk_margin(loop, skew);
}

FrequencyDataReport frequency_data_report(const FrequencyData& measured, MeasuredResponse what,
                                          const std::optional<LoopController>& controller,
                                          double dt, double delay, double skew) {
  FrequencyData L = open_loop_of(measured, what);
  for (Index i = 0; i < L.G.size(); ++i) {
    if (controller) L.G[i] *= controller_response(*controller, dt, L.w[i]);
    L.G[i] *= std::polar(1.0, -L.w[i] * delay);
  }
  FrequencyDataReport report;
  report.data = frequency_data_margins(L, true, skew);
  report.samples = L.w.size();
  report.w_min = L.w[0];
  report.w_max = L.w[L.w.size() - 1];
  report.margins.names = {"loop"};
  report.margins.loops = {report.data.margins};
  report.notes = frequency_notes(report);
  return report;
}

FrequencyData parse_frequency_data(const std::string& text, const std::string& origin) {
  DataColumns columns;
  std::vector<double> w;
  std::vector<std::complex<double>> G;
  std::size_t begin = 0;
  for (int number = 1; begin < text.size(); ++number) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    const std::vector<std::string> words = words_of_line(text.substr(begin, end - begin));
    begin = end + 1;
    if (words.empty() || words[0].starts_with('#')) continue;
    const std::string where = fmt::format("{}:{}", origin, number);
    if (columns.count == 0) {
      columns = columns_of(words, where);
      continue;
    }
    if (words.size() != columns.count)
      throw InvalidInput(
          where, fmt::format("{}, expected {}, as in the first line",
                             internal::counted(words.size(), "entry", "entries"), columns.count));
    std::vector<double> row;
    for (const std::string& word : words) {
      double value = 0;
      if (!internal::read_number(word, value))
        throw InvalidInput(
            where, fmt::format("'{}' is not a finite number, expected a number such as 0.01",
                               internal::printable(word)));
      row.push_back(value);
    }
    const double frequency = columns.w >= 0
                                 ? row[static_cast<std::size_t>(columns.w)]
                                 : row[static_cast<std::size_t>(columns.f)] * 2 * std::numbers::pi;
    if (!(frequency > (w.empty() ? 0.0 : w.back()))) {
      const double unit = columns.w >= 0 ? 1 : 2 * std::numbers::pi;
      throw InvalidInput(
          where, fmt::format("the frequency is {:.6g}{}, expected positive frequencies in "
                             "increasing order",
                             frequency / unit,
                             w.empty() ? "" : fmt::format(" after {:.6g}", w.back() / unit)));
    }
    w.push_back(frequency);
    G.push_back(value_of(columns, row, where));
  }
  FrequencyData data;
  const auto count = static_cast<Index>(w.size());
  data.w = Eigen::VectorXd::Map(w.data(), count);
  data.G = Eigen::VectorXcd::Map(G.data(), count);
  validate(data, origin);
  return data;
}

FrequencyData read_frequency_data(const std::string& path) {
  constexpr std::size_t kLimit = std::size_t{64} << 20;
  return parse_frequency_data(internal::read_text_file(path, kLimit), path);
}

MeasuredResponse measured_response(const std::string& word) {
  if (word == "loop") return MeasuredResponse::loop;
  if (word == "T") return MeasuredResponse::complementary_sensitivity;
  if (word == "S") return MeasuredResponse::sensitivity;
  throw OptionError("measured", fmt::format("measured is '{}', expected loop, T or S", word));
}

}  // namespace quadtune
