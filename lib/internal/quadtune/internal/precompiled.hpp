// SPDX-License-Identifier: Apache-2.0
/// The headers that most source files of the libraries include, parsed once for all of them. The
/// build includes this header before every source file. No file includes it by name, and each file
/// still includes what it uses, because the static analysis of `./dev check` compiles without it.
#pragma once

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <iterator>
#include <limits>
#include <map>
#include <memory>
#include <numbers>
#include <numeric>
#include <optional>
#include <ostream>
#include <set>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <tuple>
#include <utility>
#include <variant>
#include <vector>

#include "quadtune/internal/compiled_eigen.hpp"
