// SPDX-License-Identifier: Apache-2.0
/// Headers that most tests include, parsed once for all of them, as
/// quadtune/internal/precompiled.hpp is for the libraries.
#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "quadtune/internal/precompiled.hpp"
