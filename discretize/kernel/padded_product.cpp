// SPDX-License-Identifier: Apache-2.0
#include "kernel/padded_product.hpp"

#ifdef __FMA__
#include <immintrin.h>
#endif

#include <cmath>
#include <cstdint>
#include <limits>

namespace quadtune::internal {
namespace {

// Four doubles whatever the machine: the compiler splits them where its vectors are shorter. Wider
// ones gain nothing at a dozen states.
using Vector [[gnu::vector_size(kVectorLength * sizeof(double)), gnu::may_alias]] = double;

[[gnu::always_inline]] inline const Vector* vectors(const double* M) {
  return reinterpret_cast<const Vector*>(M);
}
[[gnu::always_inline]] inline Vector* vectors(double* M) { return reinterpret_cast<Vector*>(M); }

// The same for memory of the caller, which may lie anywhere.
using Unaligned [[gnu::vector_size(kVectorLength * sizeof(double)), gnu::may_alias,
                  gnu::aligned(alignof(double))]] = double;

[[gnu::always_inline]] inline void add_absolute(const Vector& v, Vector& sum) {
  using Bits [[gnu::vector_size(sizeof(Vector))]] = std::int64_t;
  sum += (Vector)((Bits)v & std::numeric_limits<std::int64_t>::max());  // all but the sign
}

// sum += a · b. Spelled out because -ffp-contract=off keeps the compiler from fusing it.
[[gnu::always_inline]] inline void multiply_add(const Vector& a, double b, Vector& sum) {
#ifdef __FMA__
  sum = (Vector)_mm256_fmadd_pd((__m256d)a, _mm256_set1_pd(b), (__m256d)sum);
#else
  sum += a * b;
#endif
}

// Keeps a vector that is used four times in a register: the compiler would load it four times, and
// loads are what such a product waits for.
[[gnu::always_inline]] inline void keep_in_register([[maybe_unused]] Vector& a) {
#ifdef __AVX__
  asm("" : "+x"(a));
#endif
}

// What the accumulators of the vector at an offset into C start from.
struct FromZero {
  [[gnu::always_inline]] void operator()(std::ptrdiff_t /*offset*/, Vector& sum) const {
    sum = Vector{};
  }
};
struct FromResult {
  const double* C;
  [[gnu::always_inline]] void operator()(std::ptrdiff_t offset, Vector& sum) const {
    sum = vectors(C + offset)[0];
  }
};
struct FromCombination {
  Combination from;
  [[gnu::always_inline]] void operator()(std::ptrdiff_t offset, Vector& sum) const {
    sum = from.c * vectors(from.C + offset)[0];
    multiply_add(vectors(from.B + offset)[0], from.b, sum);
    multiply_add(vectors(from.A + offset)[0], from.a, sum);
  }
};

// V vectors of rows by four columns of C at `offset`, kept in registers over the whole depth.
template <int V, class Start>
[[gnu::always_inline]] inline void tile(const double* A, const double* B, double* C,
                                        std::ptrdiff_t offset, std::ptrdiff_t rows,
                                        std::ptrdiff_t depth, const Start& start) {
  Vector sum[V][kVectorLength];
#pragma GCC unroll 4
  for (int j = 0; j < kVectorLength; ++j)
#pragma GCC unroll 4
    for (int v = 0; v < V; ++v) start(offset + j * rows + v * kVectorLength, sum[v][j]);
  for (std::ptrdiff_t k = 0; k < depth; ++k) {
    Vector a[V];
#pragma GCC unroll 4
    for (int v = 0; v < V; ++v) {
      a[v] = vectors(A + k * rows)[v];
      keep_in_register(a[v]);
    }
#pragma GCC unroll 4
    for (int j = 0; j < kVectorLength; ++j) {
      const double b = B[k + j * rows];
#pragma GCC unroll 4
      for (int v = 0; v < V; ++v) multiply_add(a[v], b, sum[v][j]);
    }
  }
#pragma GCC unroll 4
  for (int j = 0; j < kVectorLength; ++j)
#pragma GCC unroll 4
    for (int v = 0; v < V; ++v) vectors(C + offset + j * rows)[v] = sum[v][j];
}

// Three vectors by four columns fill twelve of sixteen registers; 4 = 2 + 2 beats 3 + 1.
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
  // Constants where a vehicle's models are: the compiler unrolls and folds every address.
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
  for (std::ptrdiff_t i = 0; i < size; i += kVectorLength) {
    Vector sum;
    form(i, sum);
    vectors(S + i)[0] = sum;
  }
}

void scale(double a, const double* A, double* S, std::ptrdiff_t size) {
  for (std::ptrdiff_t i = 0; i < size / kVectorLength; ++i) vectors(S)[i] = a * vectors(A)[i];
}

void copy_scaled(double a, const double* from, std::ptrdiff_t from_stride, double* to,
                 std::ptrdiff_t to_stride, std::ptrdiff_t rows, std::ptrdiff_t cols) {
  for (std::ptrdiff_t j = 0; j < cols; ++j, from += from_stride, to += to_stride) {
    std::ptrdiff_t i = 0;
    for (; i + kVectorLength <= rows; i += kVectorLength)
      *reinterpret_cast<Unaligned*>(to + i) = a * *reinterpret_cast<const Unaligned*>(from + i);
    for (; i < rows; ++i) to[i] = a * from[i];
  }
}

double norm(const double* M, std::ptrdiff_t rows, std::ptrdiff_t cols) {
  Vector largest = {};
  Vector total = {};
  for (std::ptrdiff_t i = 0; i < rows; i += kVectorLength) {
    Vector sum = {};
    for (std::ptrdiff_t j = 0; j < cols; ++j) {
      add_absolute(vectors(M + i + j * rows)[0], sum);
    }
    largest = sum > largest ? sum : largest;
    total += sum;  // a comparison lets NaN pass, a sum does not
  }
  double result = 0;
  double check = 0;
  for (int l = 0; l < kVectorLength; ++l) {
    result = largest[l] > result ? largest[l] : result;
    check += total[l];
  }
  return std::isfinite(check) ? result : std::numeric_limits<double>::infinity();
}

}  // namespace quadtune::internal
