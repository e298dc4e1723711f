// SPDX-License-Identifier: Apache-2.0
#include "quadtune/discretize/discretize.hpp"

#include <fmt/format.h>

#include <vector>

#include "options.hpp"
#include "quadtune/discretize/backward_euler.hpp"
#include "quadtune/discretize/euler.hpp"
#include "quadtune/discretize/foh.hpp"
#include "quadtune/discretize/impulse.hpp"
#include "quadtune/discretize/matched.hpp"
#include "quadtune/discretize/tustin.hpp"
#include "quadtune/discretize/zoh.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/internal/suggest.hpp"

namespace quadtune {
namespace {

using Options = DiscretizationOptions;

struct Method {
  DiscretizationMethod method;
  const char* name;
  DiscreteLti (*run)(const ContinuousLti&, double, const Options&);
};

// Adapts a method without options; options that do not apply have been rejected before.
template <DiscreteLti (*discretize_by)(const ContinuousLti&, double)>
DiscreteLti plain(const ContinuousLti& plant, double dt, const Options&) {
  return discretize_by(plant, dt);
}

DiscreteLti tustin(const ContinuousLti& plant, double dt, const Options& options) {
  return discretize_tustin(plant, dt, options.prewarp);
}

constexpr Method kMethods[] = {
    {DiscretizationMethod::zoh, "zoh", plain<discretize_zoh>},
    {DiscretizationMethod::foh, "foh", plain<discretize_foh>},
    {DiscretizationMethod::impulse, "impulse", plain<discretize_impulse>},
    {DiscretizationMethod::euler, "euler", plain<discretize_euler>},
    {DiscretizationMethod::backward_euler, "backward-euler", plain<discretize_backward_euler>},
    {DiscretizationMethod::tustin, "tustin", tustin},
    {DiscretizationMethod::matched, "matched", plain<discretize_matched>},
};

const Method& entry(DiscretizationMethod method) {
  for (const Method& known : kMethods)
    if (known.method == method) return known;
  throw InvalidInput("discretize", fmt::format("no method number {}, expected an enumerator",
                                               static_cast<int>(method)));
}

}  // namespace

namespace internal {

void refuse_prewarp(DiscretizationMethod method, const std::optional<double>& prewarp) {
  if (prewarp && method != DiscretizationMethod::tustin)
    throw InvalidInput(to_string(method),
                       fmt::format("prewarp is {:.6g} rad/s, expected no prewarping because "
                                   "only tustin supports it",
                                   *prewarp));
}

}  // namespace internal

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

DiscreteLti discretize(const ContinuousLti& plant, double dt, DiscretizationMethod method,
                       const DiscretizationOptions& options) {
  internal::refuse_prewarp(method, options.prewarp);
  if (!options.delays.any()) return entry(method).run(plant, dt, options);
  if (method == DiscretizationMethod::zoh) return discretize_zoh(plant, dt, options.delays);
  return with_delays(entry(method).run(plant, dt, options), options.delays);
}

}  // namespace quadtune
