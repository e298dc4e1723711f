// SPDX-License-Identifier: Apache-2.0
#include "quadtune/cascade.hpp"

#include <fmt/format.h>

#include "quadtune/errors.hpp"
#include "quadtune/internal/enum_names.hpp"
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
     {"altitude", "force along +z, added to -m g", "N/m"}}};

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

constexpr internal::EnumName<CascadeStructure> kStructures[] = {{CascadeStructure::pid, "pid"},
                                                                {CascadeStructure::p_pi, "p-pi"}};

std::string to_string(CascadeStructure structure) {
  return internal::name_in(kStructures, structure);
}

CascadeStructure cascade_structure(const std::string& name, const std::string& where) {
  return internal::require_in(kStructures, name, "structure", where);
}

constexpr internal::EnumName<PidMethod> kPidMethods[] = {
    {PidMethod::forward_euler, "euler"},
    {PidMethod::backward_euler, "backward-euler"},
    {PidMethod::tustin, "tustin"}};

std::string to_string(PidMethod method) { return internal::name_in(kPidMethods, method); }

PidMethod pid_method(const std::string& name, const std::string& where) {
  return internal::require_in(kPidMethods, name, "method", where);
}

}  // namespace quadtune
