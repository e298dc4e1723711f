// SPDX-License-Identifier: Apache-2.0
/// From the C sources of source/ to those of one program: what it does not have is taken out, its
/// name is put in, and its precision.
#pragma once

#include <map>
#include <set>
#include <string>

namespace quadtune::exports {

struct SourceChoices {
  std::string name;                          ///< prefix in place of qt
  bool double_precision = false;             ///< double in place of float
  std::set<std::string> features;            ///< X of QT_WITH_X that are there
  std::map<std::string, std::string> words;  ///< for @WORD@
  std::map<std::string, int> sizes;          ///< of `#define QT_SIZE 4`
  std::string period;                        ///< of `#define QT_DT 0.005f`
};

/// `text` with every `what` replaced.
[[nodiscard]] std::string replaced(std::string text, const std::string& what,
                                   const std::string& with);

/// A name of the user's as it can stand in a comment of C and in a page.
[[nodiscard]] std::string in_comment(const std::string& name);

/// The lines that the features leave: `#if QT_WITH_X`, `#if !QT_WITH_X`, #else and #endif are
/// resolved, other conditions stay.
[[nodiscard]] std::string with_features(const std::string& text,
                                        const std::set<std::string>& features);

/// A source of source/ as it stands in an exported program.
[[nodiscard]] std::string program_source(const std::string& text, const SourceChoices& choices);

/// A source with the prefix qt that is all numbers: its names alone become those of the program.
[[nodiscard]] std::string with_own_names(std::string text, const std::string& name);

/// The text of a source of source/, e.g. "motors.c".
[[nodiscard]] const std::string& source_text(const std::string& name);

}  // namespace quadtune::exports
