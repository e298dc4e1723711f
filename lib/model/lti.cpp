// SPDX-License-Identifier: Apache-2.0
#include "quadtune/lti.hpp"

#include <fmt/format.h>

#include <cmath>

#include "quadtune/errors.hpp"
#include "quadtune/matrix_checks.hpp"

namespace quadtune {
namespace {

void require_count(const std::vector<Signal>& signals, Eigen::Index expected,
                   const std::string& where, const char* what) {
  if (!signals.empty() && static_cast<Eigen::Index>(signals.size()) != expected)
    throw InvalidInput(where, fmt::format("{} {} names, expected {} ({})", signals.size(), what,
                                          expected, names(signals)));
}

template <class Lti>
void validate_lti(const Lti& plant, const std::string& where) {
  const Eigen::Index nx = plant.A.rows();
  const Eigen::Index nu = plant.B.cols();
  if (nx == 0) throw InvalidInput(where, "A is empty, expected at least one state");
  if (plant.A.cols() != nx)
    throw InvalidInput(where, fmt::format("A is {}, expected a square matrix", shape(plant.A)));
  if (plant.B.rows() != nx)
    throw InvalidInput(where, fmt::format("B is {}, expected {} row{} (A is {})", shape(plant.B),
                                          nx, nx == 1 ? "" : "s", shape(plant.A)));
  if (nu == 0)
    throw InvalidInput(where, fmt::format("B is {}, expected at least one column", shape(plant.B)));
  const Eigen::Index ny = plant.C.size() ? plant.C.rows() : nx;
  if (plant.C.size() && plant.C.cols() != nx)
    throw InvalidInput(where, fmt::format("C is {}, expected {} column{} (A is {})", shape(plant.C),
                                          nx, nx == 1 ? "" : "s", shape(plant.A)));
  if (plant.D.size())
    require_shape(plant.D, ny, nu, where, "D", "one row per output, one column per input");
  require_finite(plant.A, where, "A");
  require_finite(plant.B, where, "B");
  require_finite(plant.C, where, "C");
  require_finite(plant.D, where, "D");
  require_count(plant.states, nx, where, "state");
  require_count(plant.inputs, nu, where, "input");
  require_count(plant.outputs, ny, where, "output");
}

}  // namespace

void validate(const ContinuousLti& plant, const std::string& where) { validate_lti(plant, where); }

void validate(const DiscreteLti& plant, const std::string& where) {
  validate_lti(plant, where);
  if (!(plant.dt > 0) || !std::isfinite(plant.dt))
    throw InvalidInput(where, fmt::format("dt is {} s, expected a positive number", plant.dt));
}

std::string names(const std::vector<Signal>& signals) {
  std::string joined;
  for (const Signal& signal : signals) joined += (joined.empty() ? "" : " ") + signal.name;
  return joined;
}

std::vector<std::string> names_or_numbers(const std::vector<Signal>& signals, Eigen::Index count) {
  std::vector<std::string> result;
  for (Eigen::Index i = 0; i < count; ++i)
    result.push_back(signals.empty() ? std::to_string(i + 1)
                                     : signals[static_cast<std::size_t>(i)].name);
  return result;
}

}  // namespace quadtune
