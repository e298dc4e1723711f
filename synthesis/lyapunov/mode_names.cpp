// SPDX-License-Identifier: Apache-2.0
#include "lyapunov/mode_names.hpp"

#include <fmt/format.h>

#include <cmath>

namespace quadtune::internal {
namespace {

/// Formats a number; a negative zero has no sign.
std::string digits(double x) { return fmt::format("{:.4g}", x == 0 ? 0.0 : x); }

}  // namespace

std::string format_number(std::complex<double> value) {
  const double imaginary = value.imag();
  if (imaginary == 0) return digits(value.real());
  const std::string real = value.real() == 0 ? "" : digits(value.real());
  const std::string sign =
      imaginary < 0 ? (real.empty() ? "-" : " - ") : (real.empty() ? "" : " + ");
  return real + sign + digits(std::abs(imaginary)) + "i";
}

std::string format_mode(std::complex<double> value) {
  if (value.imag() == 0) return digits(value.real());
  const std::string real = value.real() == 0 ? "" : digits(value.real()) + " ";
  return fmt::format("{}±{}{}i", real, real.empty() ? "" : " ", digits(std::abs(value.imag())));
}

std::string join_names(const std::vector<std::string>& names) {
  std::string joined;
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (i > 0) joined += i + 1 == names.size() ? " and " : ", ";
    joined += names[i];
  }
  return joined;
}

}  // namespace quadtune::internal
