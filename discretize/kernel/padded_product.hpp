// SPDX-License-Identifier: Apache-2.0
/// Arithmetic on small matrices that are padded to whole vectors: no remainder loops, no packing,
/// no allocation. All matrices are column-major with leading dimension `rows` and aligned to a
/// vector; the padding rows and columns are zero.
#pragma once

#include <cstddef>

namespace quadtune::internal {

/// Doubles per vector: the rows and columns of a padded matrix are multiples of it.
inline constexpr std::ptrdiff_t kVectorLength = 4;

/// The next multiple of kVectorLength.
constexpr std::ptrdiff_t padded(std::ptrdiff_t n) {
  return (n + kVectorLength - 1) / kVectorLength * kVectorLength;
}

/// Whether the accumulators start at zero or at the present result.
enum class Start { zero, result };

/// C = A B, or C += A B. C must be neither A nor B.
///
/// @param rows   rows of A and C, a multiple of kVectorLength
/// @param depth  columns of A and rows of B that may be nonzero, ≤ rows
/// @param cols   columns of B and C, a multiple of kVectorLength
void multiply(const double* A, const double* B, double* C, std::ptrdiff_t rows,
              std::ptrdiff_t depth, std::ptrdiff_t cols, Start start);

/// The linear combination a A + b B + c C, evaluated where it is used.
struct Combination {
  double a;
  const double* A;
  double b;
  const double* B;
  double c;
  const double* C;
};

/// C = A B + start, otherwise like multiply() above.
void multiply(const double* A, const double* B, double* C, std::ptrdiff_t rows,
              std::ptrdiff_t depth, std::ptrdiff_t cols, const Combination& start);

/// S = the combination, over `size` doubles, a multiple of kVectorLength.
void combine(const Combination& combination, double* S, std::ptrdiff_t size);

/// S = a A over `size` doubles, a multiple of kVectorLength; S may be A.
void scale(double a, const double* A, double* S, std::ptrdiff_t size);

/// to = a · from for rows × cols of any two column-major matrices, aligned or not.
void copy_scaled(double a, const double* from, std::ptrdiff_t from_stride, double* to,
                 std::ptrdiff_t to_stride, std::ptrdiff_t rows, std::ptrdiff_t cols);

/// ‖M‖∞, the largest row sum of absolute values; infinity if any entry is not finite or the sums
/// overflow.
[[nodiscard]] double norm(const double* M, std::ptrdiff_t rows, std::ptrdiff_t cols);

}  // namespace quadtune::internal
