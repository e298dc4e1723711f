// SPDX-License-Identifier: Apache-2.0
/// Headers that most source files of report/ and of the program include, parsed once for all of
/// them, as quadtune/internal/precompiled.hpp is for the libraries. A change of one of these
/// headers recompiles both.
#pragma once

#include "quadtune/internal/joined.hpp"
#include "quadtune/internal/json.hpp"
#include "quadtune/internal/precompiled.hpp"
#include "quadtune/workbench/design/design.hpp"
#include "quadtune/workbench/design/given_gains.hpp"
#include "quadtune/workbench/flight/flight_plan.hpp"
#include "quadtune/workbench/flown/flown_loop.hpp"
#include "report/text/print.hpp"
