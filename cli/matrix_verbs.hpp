// SPDX-License-Identifier: Apache-2.0
/// Commands for linear systems that are given as matrices.
#pragma once

#include "program/program.hpp"

namespace quadtune::cli {

Verb analyze_verb();
Verb place_verb();

}  // namespace quadtune::cli
