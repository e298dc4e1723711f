// SPDX-License-Identifier: Apache-2.0
#include "quadtune/convention.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <mutex>

#include "quadtune/convention_file.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/internal/enum_names.hpp"
#include "quadtune/internal/joined.hpp"
#include "quadtune/internal/suggest.hpp"

namespace quadtune {
namespace {

// Indices of the states in ned_convention().
enum NedState { px, py, pz, roll, pitch, yaw, u, v, w, p, q, r };

struct Slot {
  Signal signal;
  NedState source;
  double sign;
};

Eigen::Matrix<double, 12, 12> permutation(const std::vector<Slot>& slots) {
  Eigen::Matrix<double, 12, 12> M = Eigen::Matrix<double, 12, 12>::Zero();
  for (std::size_t i = 0; i < slots.size(); ++i)
    M(static_cast<Eigen::Index>(i), slots[i].source) = slots[i].sign;
  return M;
}

Convention make(const std::string& name, const std::string& description,
                const std::vector<Slot>& slots, const std::vector<Signal>& wrench,
                const Eigen::Vector4d& wrench_signs) {
  Convention convention;
  convention.name = name;
  convention.description = description;
  for (const Slot& slot : slots) convention.states.push_back(slot.signal);
  convention.from_ned = permutation(slots);
  convention.wrench = wrench;
  convention.wrench_from_ned = wrench_signs.asDiagonal();
  return convention;
}

Convention make_ned() {
  return make("ned",
              "world north-east-down, body forward-right-down; Euler angles yaw, pitch, roll; "
              "velocities and rates in body axes; thrust along body -z",
              {{{"px", "m"}, px, 1},
               {{"py", "m"}, py, 1},
               {{"pz", "m"}, pz, 1},
               {{"roll", "rad"}, roll, 1},
               {{"pitch", "rad"}, pitch, 1},
               {{"yaw", "rad"}, yaw, 1},
               {{"u", "m/s"}, u, 1},
               {{"v", "m/s"}, v, 1},
               {{"w", "m/s"}, w, 1},
               {{"p", "rad/s"}, p, 1},
               {{"q", "rad/s"}, q, 1},
               {{"r", "rad/s"}, r, 1}},
              {{"T", "N"}, {"tau_x", "N m"}, {"tau_y", "N m"}, {"tau_z", "N m"}}, {1, 1, 1, 1});
}

// A rotation of both frames by half a turn about x negates y and z of every vector and, with the
// same Euler sequence, pitch and yaw: diag(1,-1,-1) Rz(a) Ry(b) Rx(c) diag(1,-1,-1)
// = Rz(-a) Ry(-b) Rx(c).
Convention make_uquad() {
  return make("uquad",
              "world and body x forward, y left, z up; psi is roll, phi is pitch (positive nose "
              "down), theta is yaw (positive to the left); velocities and rates in body axes",
              {{{"x", "m"}, px, 1},
               {{"y", "m"}, py, -1},
               {{"z", "m"}, pz, -1},
               {{"psi", "rad"}, roll, 1},
               {{"phi", "rad"}, pitch, -1},
               {{"theta", "rad"}, yaw, -1},
               {{"vqx", "m/s"}, u, 1},
               {{"vqy", "m/s"}, v, -1},
               {{"vqz", "m/s"}, w, -1},
               {{"wqx", "rad/s"}, p, 1},
               {{"wqy", "rad/s"}, q, -1},
               {{"wqz", "rad/s"}, r, -1}},
              {{"T", "N"}, {"tau_x", "N m"}, {"tau_y", "N m"}, {"tau_z", "N m"}}, {1, 1, -1, -1});
}

Convention make_mambo() {
  return make("mambo",
              "world north-east-down, body forward-right-down; attitude first; phi is roll, theta "
              "is pitch, psi is yaw; phidot… are body rates and pxdot… body velocities; thrust "
              "along body -z",
              {{{"phi", "rad"}, roll, 1},
               {{"theta", "rad"}, pitch, 1},
               {{"psi", "rad"}, yaw, 1},
               {{"phidot", "rad/s"}, p, 1},
               {{"thetadot", "rad/s"}, q, 1},
               {{"psidot", "rad/s"}, r, 1},
               {{"px", "m"}, px, 1},
               {{"py", "m"}, py, 1},
               {{"pz", "m"}, pz, 1},
               {{"pxdot", "m/s"}, u, 1},
               {{"pydot", "m/s"}, v, 1},
               {{"pzdot", "m/s"}, w, 1}},
              {{"T", "N"}, {"tau_x", "N m"}, {"tau_y", "N m"}, {"tau_z", "N m"}}, {1, 1, 1, 1});
}

bool same(const Convention& a, const Convention& b) {
  return a.description == b.description && a.states == b.states && a.from_ned == b.from_ned &&
         a.wrench == b.wrench && a.wrench_from_ned == b.wrench_from_ned && a.sign_law == b.sign_law;
}

/// The conventions of add_convention(). References stay valid: entries are never removed or moved.
struct Added {
  std::mutex mutex;
  std::map<std::string, Convention> by_name;
};

Added& added() {
  static Added all;
  return all;
}

}  // namespace

const std::vector<Convention>& conventions() {
  static const std::vector<Convention> all = {make_ned(), make_uquad(), make_mambo()};
  return all;
}

const Convention& ned_convention() { return conventions().front(); }

const Convention& convention(const std::string& name, const std::string& where) {
  std::vector<std::string> known;
  for (const Convention& candidate : conventions()) {
    if (candidate.name == name) return candidate;
    known.push_back(candidate.name);
  }
  const std::lock_guard lock(added().mutex);
  for (const auto& [added_name, candidate] : added().by_name) {
    if (added_name == name) return candidate;
    known.push_back(added_name);
  }
  throw InvalidInput(
      where, fmt::format("no convention '{}', expected {} or a convention file{}", name,
                         internal::joined(known, ", "), internal::did_you_mean(name, known)));
}

bool is_built_in(const Convention& convention) {
  return std::any_of(conventions().begin(), conventions().end(),
                     [&](const Convention& known) { return known.name == convention.name; });
}

const Convention& add_convention(const Convention& convention, const std::string& where) {
  const Convention* known = nullptr;
  for (const Convention& built_in : conventions())
    if (built_in.name == convention.name) known = &built_in;
  if (known == nullptr) {
    const std::lock_guard lock(added().mutex);
    known = &added().by_name.try_emplace(convention.name, convention).first->second;
  }
  if (!same(*known, convention))
    throw InvalidInput(where, fmt::format("another convention with the name '{}' is already "
                                          "registered, expected a different name",
                                          convention.name));
  return *known;
}

std::vector<Signal> input_signals(const Convention& convention, InputKind kind, int rotors,
                                  const std::string& command_unit) {
  if (kind == InputKind::wrench) return convention.wrench;
  std::string prefix;
  std::string unit;
  switch (kind) {
    case InputKind::rotor_speed:
      prefix = "w";
      unit = "rad/s";
      break;
    case InputKind::rotor_thrust:
      prefix = "T";
      unit = "N";
      break;
    default:
      prefix = "c";
      unit = command_unit;
      break;
  }
  std::vector<Signal> signals;
  for (int i = 1; i <= rotors; ++i) signals.push_back({prefix + std::to_string(i), unit});
  return signals;
}

Eigen::MatrixXd input_from_ned(const Convention& convention, InputKind kind, int rotors) {
  if (kind == InputKind::wrench) return convention.wrench_from_ned;
  return Eigen::MatrixXd::Identity(rotors, rotors);
}

constexpr internal::EnumName<InputKind> kInputKinds[] = {{InputKind::rotor_speed, "rotor-speed"},
                                                         {InputKind::rotor_thrust, "rotor-thrust"},
                                                         {InputKind::wrench, "wrench"},
                                                         {InputKind::command, "command"}};

std::string to_string(InputKind kind) { return internal::name_in(kInputKinds, kind); }

InputKind input_kind(const std::string& name, const std::string& where) {
  return internal::require_in(kInputKinds, name, "inputs", where);
}

constexpr internal::EnumName<SignLaw> kSignLaws[] = {
    {SignLaw::set_point_minus_state, "set-point-minus-state"},
    {SignLaw::state_minus_set_point, "state-minus-set-point"}};

std::string to_string(SignLaw law) { return internal::name_in(kSignLaws, law); }

SignLaw sign_law(const std::string& name, const std::string& where) {
  if (const auto law = internal::value_in(kSignLaws, name)) return *law;
  const std::vector<std::string> known = internal::names_in(kSignLaws);
  throw InvalidInput(
      where, fmt::format("no sign law '{}', expected {}{}", name, internal::joined(known, " or "),
                         internal::did_you_mean(name, known)));
}

}  // namespace quadtune
