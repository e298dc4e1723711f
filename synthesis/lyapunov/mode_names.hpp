// SPDX-License-Identifier: Apache-2.0
/// Formats eigenvalues and lists of states for messages.
#pragma once

#include <complex>
#include <string>
#include <vector>

namespace quadtune::internal {

/// "0", "-2.5", "0.1 + 2i"
[[nodiscard]] std::string format_number(std::complex<double> value);

/// "0", "-2.5", "0.1 ± 2i": an eigenvalue of a real matrix together with its conjugate.
[[nodiscard]] std::string format_mode(std::complex<double> value);

/// "x", "x and y", "x, y and z".
[[nodiscard]] std::string join_names(const std::vector<std::string>& names);

}  // namespace quadtune::internal
