// SPDX-License-Identifier: Apache-2.0
/// quadtune diff: two gain sets entry by entry.
#include "quadtune/exports/diff.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <ostream>

#include "quadtune/workbench/design/given_gains.hpp"
#include "program/command_line.hpp"
#include "program/program.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/internal/json.hpp"
#include "report/text/print.hpp"

namespace quadtune::cli {
namespace {

constexpr std::size_t kShown = 20;

void print_json(const GainsDiff& difference, Context& context) {
  internal::Json entries = internal::Json::array();
  for (const DiffEntry& entry : difference.entries)
    entries.push_back({{"matrix", entry.matrix},
                       {"input", entry.input},
                       {"state", entry.state},
                       {"a", internal::finite_or_null(entry.a)},
                       {"b", internal::finite_or_null(entry.b)},
                       {"difference", internal::finite_or_null(entry.difference)},
                       {"relative", entry.relative}});
  const internal::Json json = {{"max_relative", difference.max_relative}, {"entries", entries}};
  context.out << internal::readable(json) << "\n";
}

void print_text(const GainsDiff& difference, Context& context) {
  if (difference.entries.empty()) {
    context.out << "equal in every entry\n";
    return;
  }
  std::size_t width = 7;  // of the first two columns; the names of a cascade's numbers are longer
  for (const DiffEntry& entry : difference.entries)
    width = std::max({width, entry.matrix.size(), entry.input.size()});
  ++width;
  context.out << fmt::format(
      "{} entries differ, by {:.3g} at most (relative to their row's or "
      "column's largest)\n{:<{}}{:<{}}{:<10}{:>16}{:>16}{:>12}{:>10}\n",
      difference.entries.size(), difference.max_relative, "matrix", width, "input", width, "state",
      "A", "B", "B - A", "relative");
  for (std::size_t i = 0; i < std::min(kShown, difference.entries.size()); ++i) {
    const DiffEntry& entry = difference.entries[i];
    context.out << fmt::format("{:<{}}{:<{}}{:<10}{:>16.8g}{:>16.8g}{:>12.2g}{:>10.2g}\n",
                               entry.matrix, width, entry.input, width, entry.state, entry.a,
                               entry.b, entry.difference, entry.relative);
  }
  if (difference.entries.size() > kShown)
    context.out << fmt::format("... and {} smaller ones; --json lists them all\n",
                               difference.entries.size() - kShown);
}

/// What both hold is compared; state feedback and cascade are two laws.
GainsDiff difference_of(const std::string& first, const std::string& second, Context& context) {
  const StoredLaws a = read_given_laws(first).laws;
  const StoredLaws b = read_given_laws(second).laws;
  const bool gains = a.gains && b.gains;
  const bool cascade = a.cascade && b.cascade;
  if (!gains && !cascade)
    throw InvalidInput(second, fmt::format("holds a {} and {} a {}, expected laws of one kind",
                                           b.gains ? "state feedback" : "PID cascade", first,
                                           a.gains ? "state feedback" : "PID cascade"));
  GainsDiff difference = gains ? diff(*a.gains, *b.gains) : GainsDiff{};
  if (a.gains.has_value() != b.gains.has_value() || a.cascade.has_value() != b.cascade.has_value())
    context.note(fmt::format("diff: note: one of the two holds a {} as well, which is not compared",
                             gains ? "PID cascade" : "state feedback"));
  if (!cascade) return difference;
  const GainsDiff more = diff(*a.cascade, *b.cascade);
  difference.max_relative = std::max(difference.max_relative, more.max_relative);
  difference.entries.insert(difference.entries.end(), more.entries.begin(), more.entries.end());
  return difference;
}

}  // namespace

Verb diff_verb() {
  struct Options {
    std::string a, b;
  };
  return {"diff", "A B", "compare two gain sets entry by entry, across conventions",
          "quadtune diff out/uquad-hover out/uquad-hover", [](CommandLine& line) -> Action {
            auto options = std::make_shared<Options>();
            line.add_option("A", options->a,
                            "an export's directory, a file of gains or a design file");
            line.add_option("B", options->b, "another such directory or file");
            return [options](Context& context) {
              if (options->b.empty())
                throw UsageError("quadtune diff: expected two gain sets, directories or files",
                                 options->a.empty() ? "A" : "B");
              const GainsDiff difference = difference_of(options->a, options->b, context);
              if (context.json)
                print_json(difference, context);
              else
                print_text(difference, context);
            };
          }};
}

}  // namespace quadtune::cli
