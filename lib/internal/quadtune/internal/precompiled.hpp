// SPDX-License-Identifier: Apache-2.0
/// What most source files of the libraries include, parsed once for all of them. The build adds
/// this header in front of every source file; no file includes it by name, and each still includes
/// what it uses: the static analysis of `./dev check` compiles without it.
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
