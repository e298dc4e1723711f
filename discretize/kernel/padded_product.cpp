// SPDX-License-Identifier: Apache-2.0
#include "kernel/padded_product.hpp"

#include <cmath>
#include <cstring>
#include <limits>

#include "quadtune/internal/small_matrix.hpp"

namespace quadtune::internal {
namespace {

// Wider vectors are not faster for a dozen states.
using V = Vector<double, kVectorLength>;

// Keeps a vector that is used four times in a register. The compiler would load it four times, and
// loads are the bottleneck of these products.
[[gnu::always_inline]] inline V keep_in_register(V a) {
#ifdef __AVX__
  asm("" : "+x"(a));
#endif
  return a;
}

// The initial values of the accumulators for the vector at an offset into C.
struct FromZero {
  V operator()(std::ptrdiff_t /*offset*/) const { return V{}; }
};
struct FromResult {
  const double* C;
  V operator()(std::ptrdiff_t offset) const { return load<V>(C + offset); }
};
struct FromCombination {
  Combination from;
  [[gnu::always_inline]] V operator()(std::ptrdiff_t offset) const {
    const V c = from.c * load<V>(from.C + offset);
    const V bc = multiply_add(load<V>(from.B + offset), broadcast<V>(from.b), c);
    return multiply_add(load<V>(from.A + offset), broadcast<V>(from.a), bc);
  }
};

// Computes a tile of kVectors vectors of rows by four columns of C at `offset`; C is column-major.
template <int kVectors, class Start>
[[gnu::always_inline]] inline void tile(const double* A, const double* B, double* C,
                                        std::ptrdiff_t offset, std::ptrdiff_t rows,
                                        std::ptrdiff_t depth, const Start& start) {
  Tile<V, kVectorLength, kVectors> sum;
  sum.set([&](int j, int v) { return start(offset + j * rows + v * kVectorLength); });
  sum.add_product(0, depth, entries_of<V>(B, rows, 1), [&](int k, int v) {
    return keep_in_register(load<V>(A + k * rows + v * kVectorLength));
  });
  sum.each([&](int j, int v, V x) { store(C + offset + j * rows + v * kVectorLength, x); });
}

// Three vectors by four columns fill twelve of sixteen registers; 4 = 2 + 2 is faster than 3 + 1.
template <class Start>
[[gnu::always_inline]] inline void product(const double* A, const double* B, double* C,
                                           std::ptrdiff_t rows, std::ptrdiff_t depth,
                                           std::ptrdiff_t cols, const Start& start) {
  for (std::ptrdiff_t j = 0; j < cols; j += kVectorLength) {
    const double* Bj = B + j * rows;
    std::ptrdiff_t i = 0;
    std::ptrdiff_t left = rows / kVectorLength;
    for (; left == 3 || left > 4; left -= 3, i += 3 * kVectorLength)
      tile<3>(A + i, Bj, C, i + j * rows, rows, depth, start);
    for (; left >= 2; left -= 2, i += 2 * kVectorLength)
      tile<2>(A + i, Bj, C, i + j * rows, rows, depth, start);
    if (left == 1) tile<1>(A + i, Bj, C, i + j * rows, rows, depth, start);
  }
}

template <class Start>
void multiply_from(const double* A, const double* B, double* C, std::ptrdiff_t rows,
                   std::ptrdiff_t depth, std::ptrdiff_t cols, const Start& start) {
  // Constant sizes for the models of a vehicle let the compiler unroll and fold all addresses.
  if (rows == 12 && depth == 12)
    product(A, B, C, 12, 12, cols, start);
  else if (rows == 16 && depth == 16)
    product(A, B, C, 16, 16, cols, start);
  else
    product(A, B, C, rows, depth, cols, start);
}

}  // namespace

void multiply(const double* A, const double* B, double* C, std::ptrdiff_t rows,
              std::ptrdiff_t depth, std::ptrdiff_t cols, Start start) {
  if (start == Start::zero)
    multiply_from(A, B, C, rows, depth, cols, FromZero{});
  else
    multiply_from(A, B, C, rows, depth, cols, FromResult{C});
}

void multiply(const double* A, const double* B, double* C, std::ptrdiff_t rows,
              std::ptrdiff_t depth, std::ptrdiff_t cols, const Combination& start) {
  multiply_from(A, B, C, rows, depth, cols, FromCombination{start});
}

void combine(const Combination& combination, double* S, std::ptrdiff_t size) {
  const FromCombination form{combination};
  for (std::ptrdiff_t i = 0; i < size; i += kVectorLength) store(S + i, form(i));
}

void scale(double a, const double* A, double* S, std::ptrdiff_t size) {
  for (std::ptrdiff_t i = 0; i < size; i += kVectorLength) store(S + i, a * load<V>(A + i));
}

void copy_scaled(double a, const double* from, std::ptrdiff_t from_stride, double* to,
                 std::ptrdiff_t to_stride, std::ptrdiff_t rows, std::ptrdiff_t cols) {
  for (std::ptrdiff_t j = 0; j < cols; ++j, from += from_stride, to += to_stride) {
    std::ptrdiff_t i = 0;
    for (; i + kVectorLength <= rows; i += kVectorLength) {
      V x;  // the caller's memory may be unaligned
      std::memcpy(&x, from + i, sizeof x);
      x *= a;
      std::memcpy(to + i, &x, sizeof x);
    }
    for (; i < rows; ++i) to[i] = a * from[i];
  }
}

double norm(const double* M, std::ptrdiff_t rows, std::ptrdiff_t cols) {
  V largest = {};
  V sums = {};
  for (std::ptrdiff_t i = 0; i < rows; i += kVectorLength) {
    V sum = {};
    for (std::ptrdiff_t j = 0; j < cols; ++j) sum += abs_of(load<V>(M + i + j * rows));
    largest = sum > largest ? sum : largest;
    sums += sum;  // unlike a comparison, a sum propagates NaN
  }
  double result = 0;
  for (int i = 0; i < kVectorLength; ++i) result = largest[i] > result ? largest[i] : result;
  return std::isfinite(total(sums)) ? result : std::numeric_limits<double>::infinity();
}

}  // namespace quadtune::internal
