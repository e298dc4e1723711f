// SPDX-License-Identifier: Apache-2.0
/// quadtune diff: two gain sets entry by entry.
#include "quadtune/exports/diff.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <ostream>

#include "print.hpp"
#include "program.hpp"
#include "quadtune/exports/read_gains.hpp"
#include "quadtune/internal/json.hpp"

namespace quadtune::cli {
namespace {

constexpr std::size_t kShown = 20;

void print_json(const GainsDiff& difference, Context& context) {
  internal::Json entries = internal::Json::array();
  for (const DiffEntry& entry : difference.entries)
    entries.push_back({{"matrix", entry.matrix},
                       {"input", entry.input},
                       {"state", entry.state},
                       {"a", entry.a},
                       {"b", entry.b},
                       {"difference", entry.difference},
                       {"relative", entry.relative}});
  const internal::Json json = {{"max_relative", difference.max_relative}, {"entries", entries}};
  context.out << internal::readable(json) << "\n";
}

void print_text(const GainsDiff& difference, Context& context) {
  if (difference.entries.empty()) {
    context.out << "equal in every entry\n";
    return;
  }
  context.out << fmt::format(
      "{} entries differ, by {:.3g} at most (relative to their row's or "
      "column's largest)\n{:<8}{:<8}{:<10}{:>16}{:>16}{:>12}{:>10}\n",
      difference.entries.size(), difference.max_relative, "matrix", "input", "state", "A", "B",
      "B - A", "relative");
  for (std::size_t i = 0; i < std::min(kShown, difference.entries.size()); ++i) {
    const DiffEntry& entry = difference.entries[i];
    context.out << fmt::format("{:<8}{:<8}{:<10}{:>16.8g}{:>16.8g}{:>12.2g}{:>10.2g}\n",
                               entry.matrix, entry.input, entry.state, entry.a, entry.b,
                               entry.difference, entry.relative);
  }
  if (difference.entries.size() > kShown)
    context.out << fmt::format("... and {} smaller ones; --json lists them all\n",
                               difference.entries.size() - kShown);
}

}  // namespace

Verb diff_verb() {
  struct Options {
    std::string a, b;
  };
  return {"diff", "A B", "compare two gain sets entry by entry, across conventions",
          "quadtune diff out/uquad-hover out/uquad-hover", [](CLI::App& app) -> Action {
            auto options = std::make_shared<Options>();
            app.add_option("A", options->a, "an export's directory or a gain file");
            app.add_option("B", options->b, "another");
            return [options](Context& context) {
              if (options->b.empty())
                throw UsageError("quadtune diff: expected two gain sets, directories or files",
                                 options->a.empty() ? "A" : "B");
              const GainsDiff difference = diff(read_gains(options->a), read_gains(options->b));
              if (context.json)
                print_json(difference, context);
              else
                print_text(difference, context);
            };
          }};
}

}  // namespace quadtune::cli
