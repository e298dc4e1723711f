// SPDX-License-Identifier: Apache-2.0
#include "quadtune/discretize/discretize.hpp"

#include <fmt/format.h>

#include <vector>

#include "quadtune/discretize/euler.hpp"
#include "quadtune/discretize/tustin.hpp"
#include "quadtune/discretize/zoh.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/internal/suggest.hpp"

namespace quadtune {
namespace {

struct Method {
  DiscretizationMethod method;
  const char* name;
  DiscreteLti (*run)(const ContinuousLti&, double);
};

constexpr Method kMethods[] = {
    {DiscretizationMethod::zoh, "zoh", discretize_zoh},
    {DiscretizationMethod::euler, "euler", discretize_euler},
    {DiscretizationMethod::tustin, "tustin", discretize_tustin},
};

const Method& entry(DiscretizationMethod method) {
  for (const Method& known : kMethods)
    if (known.method == method) return known;
  throw InvalidInput("discretize", fmt::format("no method number {}, expected a named one",
                                               static_cast<int>(method)));
}

}  // namespace

std::string to_string(DiscretizationMethod method) { return entry(method).name; }

DiscretizationMethod discretization_method(const std::string& name, const std::string& where) {
  std::vector<std::string> known;
  std::string listed;
  for (const Method& method : kMethods) {
    if (name == method.name) return method.method;
    known.emplace_back(method.name);
    listed += (listed.empty() ? "" : ", ") + known.back();
  }
  throw InvalidInput(where, fmt::format("no discretization method '{}', expected {}{}", name,
                                        listed, internal::did_you_mean(name, known)));
}

DiscreteLti discretize(const ContinuousLti& plant, double dt, DiscretizationMethod method) {
  return entry(method).run(plant, dt);
}

}  // namespace quadtune
