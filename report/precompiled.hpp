// SPDX-License-Identifier: Apache-2.0
/// What most source files of report/ and of the program include, parsed once for all of them, as
/// quadtune/internal/precompiled.hpp is for the libraries. Whoever changes one of these headers
/// compiles both again.
#pragma once

#include "quadtune/internal/joined.hpp"
#include "quadtune/internal/json.hpp"
#include "quadtune/internal/precompiled.hpp"
#include "quadtune/workbench/design/design.hpp"
#include "quadtune/workbench/design/given_gains.hpp"
#include "quadtune/workbench/flight/flight_plan.hpp"
#include "quadtune/workbench/flown/flown_loop.hpp"
#include "report/text/print.hpp"
