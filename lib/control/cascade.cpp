// SPDX-License-Identifier: Apache-2.0
#include "quadtune/cascade.hpp"

#include <fmt/format.h>

#include "quadtune/errors.hpp"
#include "quadtune/internal/joined.hpp"
#include "quadtune/internal/suggest.hpp"
#include "quadtune/internal/text_file.hpp"

namespace quadtune {
namespace {

struct LoopWords {
  const char* name;
  const char* output;
  const char* unit;
};
constexpr std::array<LoopWords, kCascadeAxes> kWords = {
    {{"x", "pitch reference", "rad/m"},
     {"y", "roll reference", "rad/m"},
     {"pitch", "tau_y", "N m/rad"},
     {"roll", "tau_x", "N m/rad"},
     {"yaw", "tau_z", "N m/rad"},
     {"altitude", "force along +z beside -m g", "N/m"}}};

constexpr std::array<PidMethod, 3> kMethods = {PidMethod::forward_euler, PidMethod::backward_euler,
                                               PidMethod::tustin};

}  // namespace

std::string to_string(CascadeAxis axis) { return kWords[index_of(axis)].name; }

std::vector<std::string> cascade_axis_names() {
  std::vector<std::string> names;
  names.reserve(kCascadeAxes);
  for (const LoopWords& words : kWords) names.emplace_back(words.name);
  return names;
}

CascadeAxis cascade_axis(const std::string& name, const std::string& where) {
  for (const CascadeAxis axis : kAllCascadeAxes)
    if (name == to_string(axis)) return axis;
  const std::vector<std::string> known = cascade_axis_names();
  throw InvalidInput(
      where, fmt::format("no loop '{}', expected {}{}", internal::printable(name),
                         internal::joined(known, ", "), internal::did_you_mean(name, known)));
}

PidLoop cascade_loop(CascadeAxis axis) {
  const LoopWords& words = kWords[index_of(axis)];
  return {words.name, words.output, words.unit, 0, 0, 0};
}

std::string to_string(PidMethod method) {
  switch (method) {
    case PidMethod::forward_euler:
      return "euler";
    case PidMethod::backward_euler:
      return "backward-euler";
    case PidMethod::tustin:
      return "tustin";
  }
  return "";
}

PidMethod pid_method(const std::string& name, const std::string& where) {
  std::vector<std::string> known;
  for (const PidMethod method : kMethods) {
    known.push_back(to_string(method));
    if (known.back() == name) return method;
  }
  throw InvalidInput(
      where, fmt::format("no method '{}', expected {}{}", internal::printable(name),
                         internal::joined(known, ", "), internal::did_you_mean(name, known)));
}

}  // namespace quadtune
