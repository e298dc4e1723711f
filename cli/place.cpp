// SPDX-License-Identifier: Apache-2.0
/// quadtune place: a state feedback with given closed-loop poles.
#include <fmt/format.h>

#include <complex>
#include <optional>

#include "arguments/matrix_arguments.hpp"
#include "program/command_line.hpp"
#include "program/program.hpp"
#include "program/refusal.hpp"
#include "quadtune/internal/json.hpp"
#include "quadtune/internal/text_file.hpp"
#include "quadtune/internal/words.hpp"
#include "report/loops/matrix_loops.hpp"

namespace quadtune::cli {
namespace {

struct Options {
  std::string A, B, poles;
  std::optional<double> dt;
};

/// "-2", "-1+2i" or "-1-2j"; a complex pole stands for itself only.
std::optional<std::complex<double>> pole_of(const std::string& word) {
  double real = 0;
  if (internal::read_number(word, real)) return std::complex<double>(real, 0);
  if (word.empty() || (word.back() != 'i' && word.back() != 'j')) return {};
  const std::string body = word.substr(0, word.size() - 1);
  // The sign between the parts is the last one that does not belong to an exponent.
  for (std::size_t i = body.size(); i-- > 0;) {
    if ((body[i] != '+' && body[i] != '-') || (i > 0 && (body[i - 1] == 'e' || body[i - 1] == 'E')))
      continue;
    double imaginary = 0;
    const std::string part = body.substr(i);
    if (!internal::read_number(part.size() > 1 ? part : part + "1", imaginary)) return {};
    if (i > 0 && !internal::read_number(body.substr(0, i), real)) return {};
    return std::complex<double>(real, imaginary);
  }
  double imaginary = 0;
  if (!internal::read_number(body, imaginary)) return {};
  return std::complex<double>(0, imaginary);
}

Eigen::VectorXcd poles_of(const std::string& list) {
  if (list.empty())
    refuse("--poles", "--poles is missing, expected one pole per state, e.g. -2,-1+2i,-1-2i");
  std::vector<std::complex<double>> poles;
  for (const std::string& word : word_list(list)) {
    const auto pole = pole_of(word);
    if (!pole)
      refuse("--poles",
             "--poles: '{}' is not a pole, expected numbers such as -2 or -1+2i, separated by "
             "commas",
             internal::printable(word));
    poles.push_back(*pole);
  }
  return Eigen::VectorXcd::Map(poles.data(), static_cast<Eigen::Index>(poles.size()));
}

/// The first requested pole that is unstable, as it was given; empty if there is none.
std::string unstable_pole(const Options& options, const Eigen::VectorXcd& poles) {
  const std::vector<std::string> words = word_list(options.poles);
  for (Eigen::Index i = 0; i < poles.size(); ++i)
    if (options.dt ? !(std::abs(poles[i]) < 1) : !(poles[i].real() < 0))
      return internal::printable(words[static_cast<std::size_t>(i)]);
  return "";
}

void run_place(const Options& options, Context& context) {
  const Eigen::VectorXcd poles = poles_of(options.poles);
  if (options.dt) require_positive(*options.dt, "--dt");
  const Eigen::MatrixXd A = require_matrix(options.A, context.in, "--A");
  const Eigen::MatrixXd B = require_matrix(options.B, context.in, "--B");
  const PolePlacement placement = place_poles(A, B, poles);
  if (!placement.solved())
    throw NoSolution(fmt::format("place: {}: {}{}", to_string(placement.status), placement.culprit,
                                 placement.status == PolePlacementStatus::not_controllable
                                     ? ", and is not one of --poles"
                                     : ""),
                     "--A");
  if (const std::string pole = unstable_pole(options, poles); !pole.empty())
    context.note(fmt::format("warning: the closed loop is unstable: the pole {} is not {}", pole,
                             options.dt ? "inside the unit circle; with --dt, poles are those in z"
                                        : "in the left half-plane; discrete A and B require --dt"));
  context.print([&] { return to_json(placement); },
                [&] { return to_text(placement, options.dt.value_or(0)); });
}

void add_options(CommandLine& line, Options& options) {
  line.add_option("--A FILE", options.A, "dynamics (nx x nx)");
  line.add_option("--B FILE", options.B, "inputs (nx x nu)");
  line.add_option("--poles LIST", options.poles,
                  "closed-loop poles, one per state, complex ones in pairs: -2,-1+2i,-1-2i");
  line.add_number("--dt T", options.dt, "sample period [s] if A and B are discrete");
}

}  // namespace

Verb place_verb() {
  return {"place", "--A FILE --B FILE --poles LIST [--dt T]",
          "state feedback with given closed-loop poles",
          "quadtune place --A docs/examples/A.txt --B docs/examples/B.txt --poles -4,-5",
          with_options(add_options, run_place)};
}

}  // namespace quadtune::cli
