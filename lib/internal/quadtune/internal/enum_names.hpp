// SPDX-License-Identifier: Apache-2.0
/// Names of enumerators: one table per enumeration, used in both directions.
///
///     constexpr EnumName<FlowModel> kFlowModels[] = {{FlowModel::full, "full"}, …};
///     std::string to_string(FlowModel model) { return name_in(kFlowModels, model); }
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace quadtune::internal {

template <class Enum>
struct EnumName {
  Enum value;
  const char* name;
};

/// The name of a value; "unknown" if the value is not in the table.
template <class Enum, std::size_t count>
[[nodiscard]] std::string name_in(const EnumName<Enum> (&table)[count], Enum value) {
  for (const EnumName<Enum>& entry : table)
    if (entry.value == value) return entry.name;
  return "unknown";
}

/// The value of a name, or nothing if the name is not in the table.
template <class Enum, std::size_t count>
[[nodiscard]] std::optional<Enum> value_in(const EnumName<Enum> (&table)[count],
                                           std::string_view name) {
  for (const EnumName<Enum>& entry : table)
    if (entry.name == name) return entry.value;
  return {};
}

/// All names, in the order of the table.
template <class Enum, std::size_t count>
[[nodiscard]] std::vector<std::string> names_in(const EnumName<Enum> (&table)[count]) {
  std::vector<std::string> names;
  for (const EnumName<Enum>& entry : table) names.emplace_back(entry.name);
  return names;
}

/// @throws InvalidInput  "where: no WHAT 'NAME', expected a, b, c; did you mean 'a'?"
[[noreturn]] void refuse_name(const std::string& name, const std::string& what,
                              const std::vector<std::string>& known, const std::string& where);

/// The value of a name.
/// @param what  the kind of name for the message, e.g. "flow model"
/// @throws InvalidInput  as refuse_name()
template <class Enum, std::size_t count>
[[nodiscard]] Enum require_in(const EnumName<Enum> (&table)[count], const std::string& name,
                              const std::string& what, const std::string& where) {
  if (const std::optional<Enum> value = value_in(table, name)) return *value;
  refuse_name(name, what, names_in(table), where);
}

}  // namespace quadtune::internal
