// SPDX-License-Identifier: Apache-2.0
#include "laws/given_gains.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "quadtune/errors.hpp"
#include "quadtune/exports/convert.hpp"
#include "quadtune/exports/export.hpp"
#include "quadtune/internal/joined.hpp"
#include "quadtune/internal/json.hpp"

namespace quadtune::cli {
namespace {

std::vector<std::string> names_of(const std::vector<Signal>& signals) {
  std::vector<std::string> result;
  result.reserve(signals.size());
  for (const Signal& signal : signals) result.push_back(signal.name);
  return result;
}

void require_same(const std::vector<std::string>& have, const std::vector<std::string>& want,
                  const std::string& what, const std::string& path) {
  if (std::is_permutation(have.begin(), have.end(), want.begin(), want.end())) return;
  throw InvalidInput(path,
                     fmt::format("the gains have the {} '{}', expected '{}' as the problem "
                                 "has, because a gain has no meaning without its others",
                                 what, internal::joined(have, " "), internal::joined(want, " ")));
}

/// Columns of M, named by `from`, in the order of `to`.
Eigen::MatrixXd ordered(const Eigen::MatrixXd& M, const std::vector<Signal>& from,
                        const std::vector<std::string>& to, const std::string& what,
                        const std::string& path) {
  const std::vector<std::string> have = names_of(from);
  require_same(have, to, what, path);
  Eigen::MatrixXd result(M.rows(), std::ssize(to));
  for (std::size_t j = 0; j < to.size(); ++j)
    result.col(static_cast<Eigen::Index>(j)) =
        M.col(std::find(have.begin(), have.end(), to[j]) - have.begin());
  return result;
}

}  // namespace

void add_laws(internal::Json& json, const ExportContent& content) {
  const internal::Json stored = internal::Json::parse(gains_json_text(content));
  for (const char* key : {"format", "format_version", "gains", "cascade", "estimator"})
    if (stored.contains(key)) json[key] = stored[key];
}

void require_states(const Gains& gains, const std::vector<Signal>& states, const Convention& words,
                    const std::string& path) {
  require_same(names_of(in_convention(gains, words).states), names_of(states), "states", path);
}

OrderedGains in_order_of(const Gains& gains, const Vehicle& vehicle, const LqrDesign& design,
                         const std::string& path) {
  if (!gains.vehicle.empty() && gains.vehicle != vehicle.name)
    throw InvalidInput(path, fmt::format("the gains are for the vehicle '{}', expected '{}'",
                                         gains.vehicle, vehicle.name));
  if (gains.input_kind != design.input_kind)
    throw InvalidInput(path,
                       fmt::format("the gains command {}, expected {} as --inputs says",
                                   to_string(gains.input_kind), to_string(design.input_kind)));
  const Gains turned = in_convention(gains, convention(design.convention, "--convention"));
  if (std::ssize(turned.inputs) != std::ssize(design.inputs))
    throw InvalidInput(
        path, fmt::format("the gains have {} inputs ({}), expected {} ({})", turned.inputs.size(),
                          names(turned.inputs), design.inputs.size(),
                          internal::joined(design.inputs, " ")));
  return {ordered(turned.K, turned.states, design.states, "states", path),
          ordered(turned.K_int, turned.integrals, design.integrals, "integrals", path)};
}

}  // namespace quadtune::cli
