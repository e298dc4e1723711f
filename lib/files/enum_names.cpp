// SPDX-License-Identifier: Apache-2.0
#include "quadtune/internal/enum_names.hpp"

#include <fmt/format.h>

#include "quadtune/errors.hpp"
#include "quadtune/internal/joined.hpp"
#include "quadtune/internal/suggest.hpp"
#include "quadtune/internal/text_file.hpp"

namespace quadtune::internal {

void refuse_name(const std::string& name, const std::string& what,
                 const std::vector<std::string>& known, const std::string& where) {
  throw InvalidInput(where, fmt::format("no {} '{}', expected {}{}", what, printable(name),
                                        joined(known, ", "), did_you_mean(name, known)));
}

}  // namespace quadtune::internal
