// SPDX-License-Identifier: Apache-2.0
/// What most source files of the program include, parsed once for all of them, as
/// quadtune/internal/precompiled.hpp is for the libraries.
#pragma once

#include <nlohmann/json.hpp>

#include "quadtune/internal/precompiled.hpp"
