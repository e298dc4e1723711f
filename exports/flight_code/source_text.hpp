// SPDX-License-Identifier: Apache-2.0
/// Specializes the C sources of source/ for one program: removes unused features, and inserts its
/// name and precision.
#pragma once

#include <map>
#include <set>
#include <string>

namespace quadtune::exports {

struct SourceChoices {
  std::string name;                          ///< prefix that replaces qt
  bool double_precision = false;             ///< double instead of float
  std::set<std::string> features;            ///< the X of all enabled QT_WITH_X
  std::map<std::string, std::string> words;  ///< replacements of @WORD@
  std::map<std::string, int> sizes;          ///< values of `#define QT_SIZE 4`
  std::string period;                        ///< value of `#define QT_DT 0.005f`
};

/// `text` with every `what` replaced.
[[nodiscard]] std::string replaced(std::string text, const std::string& what,
                                   const std::string& with);

/// Makes a name given by the user safe in a C comment and in a page.
[[nodiscard]] std::string in_comment(const std::string& name);

/// Resolves the conditions on features (`#if QT_WITH_X`, `#if !QT_WITH_X`, #else, #endif); other
/// conditions are kept.
[[nodiscard]] std::string with_features(const std::string& text,
                                        const std::set<std::string>& features);

/// The text of a source in source/ after all replacements for an exported program.
[[nodiscard]] std::string program_source(const std::string& text, const SourceChoices& choices);

/// The same for a source with the prefix qt that contains only numbers: only its names are
/// replaced.
[[nodiscard]] std::string with_own_names(std::string text, const std::string& name);

/// The text of a file in source/, e.g. "motors.c".
[[nodiscard]] const std::string& source_text(const std::string& name);

}  // namespace quadtune::exports
