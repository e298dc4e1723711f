// SPDX-License-Identifier: Apache-2.0
/// Dense kernels whose size is known to the compiler, for the Riccati doubling of small systems:
/// rows of N doubles (N a multiple of 4) held in vector registers, stored row by row.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstring>
#include <utility>
#if defined(__FMA__) || defined(__AVX512F__)
#include <immintrin.h>
#endif

namespace quadtune::internal {

template <int Width>
struct VectorOf;
template <>
struct VectorOf<4> {
  typedef double type __attribute__((vector_size(32)));
};
#if defined(__AVX512F__)
template <>
struct VectorOf<8> {
  typedef double type __attribute__((vector_size(64)));
};
#endif

/// a b + c. Fused by hand, since the build keeps the compiler from fusing on its own.
inline VectorOf<4>::type multiply_add(VectorOf<4>::type a, VectorOf<4>::type b,
                                      VectorOf<4>::type c) {
#if defined(__FMA__)
  return _mm256_fmadd_pd(a, b, c);
#else
  return a * b + c;
#endif
}
#if defined(__AVX512F__)
inline VectorOf<8>::type multiply_add(VectorOf<8>::type a, VectorOf<8>::type b,
                                      VectorOf<8>::type c) {
  return _mm512_fmadd_pd(a, b, c);
}
#endif

#if defined(__AVX512F__)
inline constexpr int kRegisters = 32;
template <int N>
inline constexpr int kWidth = N % 8 == 0 ? 8 : 4;
#else
inline constexpr int kRegisters = 16;
template <int N>
inline constexpr int kWidth = 4;
#endif

/// The kernels for N × N matrices. All pointers are aligned to 64 bytes; outputs do not overlap
/// inputs.
template <int N>
struct Kernels {
  static constexpr int W = kWidth<N>;
  static constexpr int kVectors = N / W;  ///< vectors in a row
  using V = typename VectorOf<W>::type;

  static V load(const double* p) { return *reinterpret_cast<const V*>(p); }
  static void store(double* p, V v) { *reinterpret_cast<V*>(p) = v; }
  static V broadcast(double x) { return x - V{}; }

  /// Rows that share one pass over the right factor: as many as the registers hold.
  static constexpr int kRows = 4 * kVectors + kVectors + 1 <= kRegisters   ? 4
                               : 2 * kVectors + kVectors + 1 <= kRegisters ? 2
                                                                           : 1;

  /// C = A B, or C = Aᵀ B, over `inner` terms: columns of A (rows of Aᵀ) used.
  template <bool kTransposeA>
  static void multiply(const double* __restrict A, const double* __restrict B, double* __restrict C,
                       int inner = N) {
    for (int i = 0; i < N; i += kRows) {
      V sum[kRows][kVectors] = {};
      for (int k = 0; k < inner; ++k) {
        V row[kVectors];
#pragma GCC unroll 8
        for (int j = 0; j < kVectors; ++j) row[j] = load(B + k * N + j * W);
#pragma GCC unroll 4
        for (int r = 0; r < kRows; ++r) {
          const V a = broadcast(kTransposeA ? A[k * N + i + r] : A[(i + r) * N + k]);
#pragma GCC unroll 8
          for (int j = 0; j < kVectors; ++j) sum[r][j] = multiply_add(a, row[j], sum[r][j]);
        }
      }
#pragma GCC unroll 4
      for (int r = 0; r < kRows; ++r)
#pragma GCC unroll 8
        for (int j = 0; j < kVectors; ++j) store(C + (i + r) * N + j * W, sum[r][j]);
    }
  }

  /// T = Aᵀ.
  static void transpose(const double* __restrict A, double* __restrict T) {
    for (int i = 0; i < N; i += 4)
      for (int j = 0; j < N; j += 4)
#pragma GCC unroll 4
        for (int r = 0; r < 4; ++r)
#pragma GCC unroll 4
          for (int c = 0; c < 4; ++c) T[(j + c) * N + i + r] = A[(i + r) * N + j + c];
  }

  /// Factors P W = L U in place, by partial pivoting; `W_` holds the matrix by columns, so that a
  /// column is a vector. The diagonal of U is left inverted. False when a pivot is 0 or not finite.
  static bool factor(double* __restrict W_, int* __restrict pivots) {
    for (int k = 0; k < N; ++k) {
      double* column = W_ + k * N;
      int pivot = k;
      double largest = std::abs(column[k]);
      for (int i = k + 1; i < N; ++i) {
        const double size = std::abs(column[i]);
        if (size > largest) {
          largest = size;
          pivot = i;
        }
      }
      pivots[k] = pivot;
      if (!(largest > 0) || !(largest <= 1e300)) return false;
      if (pivot != k)
        for (int j = 0; j < N; ++j) std::swap(W_[j * N + k], W_[j * N + pivot]);
      const double inverse = 1 / column[k];
      // Only rows below k are eliminated: the multipliers of the others are set to 0.
      alignas(64) double multipliers[N];
      const int first = (k + 1) / W * W;
      for (int i = first; i < N; ++i) multipliers[i] = column[i] * inverse;
      for (int i = first; i <= k; ++i) multipliers[i] = 0;
      for (int i = k + 1; i < N; ++i) column[i] = multipliers[i];
      column[k] = inverse;
      for (int j = k + 1; j < N; ++j) {
        double* target = W_ + j * N;
        const V factor_kj = broadcast(-target[k]);
        for (int i = first; i < N; i += W)
          store(target + i, multiply_add(factor_kj, load(multipliers + i), load(target + i)));
      }
    }
    return true;
  }

  /// X = W⁻¹ X from factor(), for one or two right-hand sides of N columns at once.
  template <int kSides>
  static void solve(const double* __restrict LU, const int* pivots, double* const (&X)[kSides]) {
    constexpr int n_vectors = kSides * kVectors;
    const auto row = [&X](int i, int v) { return X[v / kVectors] + i * N + v % kVectors * W; };
    for (int k = 0; k < N; ++k) {
      if (pivots[k] == k) continue;
#pragma GCC unroll 16
      for (int v = 0; v < n_vectors; ++v) {
        const V upper = load(row(k, v));
        store(row(k, v), load(row(pivots[k], v)));
        store(row(pivots[k], v), upper);
      }
    }
    for (int i = 1; i < N; ++i) {
      V sum[n_vectors];
#pragma GCC unroll 16
      for (int v = 0; v < n_vectors; ++v) sum[v] = load(row(i, v));
      for (int k = 0; k < i; ++k) {
        const V l = broadcast(-LU[k * N + i]);
#pragma GCC unroll 16
        for (int v = 0; v < n_vectors; ++v) sum[v] = multiply_add(l, load(row(k, v)), sum[v]);
      }
#pragma GCC unroll 16
      for (int v = 0; v < n_vectors; ++v) store(row(i, v), sum[v]);
    }
    for (int i = N - 1; i >= 0; --i) {
      V sum[n_vectors];
#pragma GCC unroll 16
      for (int v = 0; v < n_vectors; ++v) sum[v] = load(row(i, v));
      for (int k = N - 1; k > i; --k) {
        const V u = broadcast(-LU[k * N + i]);
#pragma GCC unroll 16
        for (int v = 0; v < n_vectors; ++v) sum[v] = multiply_add(u, load(row(k, v)), sum[v]);
      }
      const V inverse = broadcast(LU[i * N + i]);
#pragma GCC unroll 16
      for (int v = 0; v < n_vectors; ++v) store(row(i, v), sum[v] * inverse);
    }
  }
};

}  // namespace quadtune::internal
