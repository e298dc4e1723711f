// SPDX-License-Identifier: Apache-2.0
/// The curves of a picture as numbers, for other programs.
#pragma once

#include <string>

#include "report/plots/figure.hpp"

namespace quadtune::report {

/// A table with the columns panel, curve, x and y, and a row for each point; the first line names
/// the columns. Texts are quoted. Numbers read back as the same double; points that are not finite
/// are omitted.
[[nodiscard]] std::string figure_csv(const Figure& figure);

/// {"title", "subtitle", "panels": [{"title", "x", "y", "curves": [{"name", "x", "y"}]}]}; x and y
/// of a panel are the labels of its axes. Numbers that are not finite are null.
[[nodiscard]] std::string figure_json(const Figure& figure);

}  // namespace quadtune::report
