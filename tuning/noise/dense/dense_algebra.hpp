// SPDX-License-Identifier: Apache-2.0
/// Products of small square matrices whose size the compiler knows, held in registers. Stored
/// column by column, padded with zeros to a multiple of four.
#pragma once

#include <cstddef>
#include <utility>

namespace quadtune::internal {

// Four and eight doubles whatever the machine: the compiler splits them where its vectors are
// shorter.
using Eight [[gnu::vector_size(8 * sizeof(double)), gnu::may_alias]] = double;
using Four [[gnu::vector_size(4 * sizeof(double)), gnu::may_alias]] = double;

[[gnu::always_inline]] inline const Four* fours(const double* p) {
  return reinterpret_cast<const Four*>(p);
}
[[gnu::always_inline]] inline Four* fours(double* p) { return reinterpret_cast<Four*>(p); }
[[gnu::always_inline]] inline Four all_four(double x) { return Four{x, x, x, x}; }

template <int N>
struct Column {
  alignas(64) double at[N] = {};
};

template <int N>
struct Square {
  alignas(64) double at[N * N] = {};

  double& operator()(std::ptrdiff_t i, std::ptrdiff_t j) { return at[j * N + i]; }
  double operator()(std::ptrdiff_t i, std::ptrdiff_t j) const { return at[j * N + i]; }
  double* column(std::ptrdiff_t j) { return at + j * N; }
  [[nodiscard]] const double* column(std::ptrdiff_t j) const { return at + j * N; }
  /// To the entry, and to its mirror image where that is another.
  void add_symmetric(std::ptrdiff_t i, std::ptrdiff_t j, double value) {
    at[j * N + i] += value;
    if (i != j) at[i * N + j] += value;
  }
};

/// y += a x
template <int N>
[[gnu::always_inline]] inline void add_scaled(double a, const double* x, double* y) {
  for (int i = 0; i < N / 4; ++i) fours(y)[i] += all_four(a) * fours(x)[i];
}

template <int N>
[[gnu::always_inline]] inline double dot(const double* a, const double* b) {
  Four sum = fours(a)[0] * fours(b)[0];
  for (int i = 1; i < N / 4; ++i) sum += fours(a)[i] * fours(b)[i];
  return (sum[0] + sum[1]) + (sum[2] + sum[3]);
}

/// y = A x; A has `columns` columns of N numbers.
template <int N>
[[gnu::always_inline]] inline void multiply(const double* A, const double* x, int columns,
                                            double* y) {
  Four even[N / 4], odd[N / 4];
  for (int i = 0; i < N / 4; ++i) {
    even[i] = Four{};
    odd[i] = Four{};
  }
  std::ptrdiff_t q = 0;
  for (; q + 1 < columns; q += 2) {
    const Four a = all_four(x[q]), b = all_four(x[q + 1]);
    for (int i = 0; i < N / 4; ++i) {
      even[i] += fours(A + q * N)[i] * a;
      odd[i] += fours(A + q * N + N)[i] * b;
    }
  }
  if (q < columns)
    for (int i = 0; i < N / 4; ++i) even[i] += fours(A + q * N)[i] * all_four(x[q]);
  for (int i = 0; i < N / 4; ++i) fours(y)[i] = even[i] + odd[i];
}

/// y = A x + b, A of N columns: in four sums, since y may be waited for.
template <int N>
[[gnu::always_inline]] inline void multiply_onto(const double* A, const double* x, const double* b,
                                                 double* y) {
  Four sum[4][N / 4];
  for (int i = 0; i < N / 4; ++i) {
    sum[0][i] = fours(b)[i] + fours(A)[i] * all_four(x[0]);
    for (std::ptrdiff_t s = 1; s < 4; ++s) sum[s][i] = fours(A + s * N)[i] * all_four(x[s]);
  }
  for (std::ptrdiff_t q = 4; q < N; q += 4)
    for (std::ptrdiff_t s = 0; s < 4; ++s)
      for (int i = 0; i < N / 4; ++i) sum[s][i] += fours(A + (q + s) * N)[i] * all_four(x[q + s]);
  for (int i = 0; i < N / 4; ++i) fours(y)[i] = (sum[0][i] + sum[1][i]) + (sum[2][i] + sum[3][i]);
}

/// y = A x, A of `rows` rows, a multiple of four.
inline void multiply(const double* A, int rows, const double* x, int columns, double* y) {
  for (std::ptrdiff_t i = 0; i < rows; i += 4) {
    Four even{}, odd{};
    std::ptrdiff_t q = 0;
    for (; q + 1 < columns; q += 2) {
      even += *fours(A + q * rows + i) * all_four(x[q]);
      odd += *fours(A + (q + 1) * rows + i) * all_four(x[q + 1]);
    }
    if (q < columns) even += *fours(A + q * rows + i) * all_four(x[q]);
    *fours(y + i) = even + odd;
  }
}

/// y = A x for `count` vectors, each `from` numbers after the one before, to results `to` numbers
/// apart; A has `columns` columns of N numbers, `stride` apart.
template <int N, int count>
[[gnu::always_inline]] inline void multiply_each(const double* A, int stride, const double* x,
                                                 int from, int columns, double* y, int to) {
  Four sum[count][N / 4] = {};
  for (std::ptrdiff_t q = 0; q < columns; ++q)
    for (std::ptrdiff_t c = 0; c < count; ++c)
      for (int i = 0; i < N / 4; ++i)
        sum[c][i] += fours(A + q * stride)[i] * all_four(x[c * from + q]);
  for (std::ptrdiff_t c = 0; c < count; ++c)
    for (int i = 0; i < N / 4; ++i) fours(y + c * to)[i] = sum[c][i];
}

/// The same with rows of eight.
template <int count>
[[gnu::always_inline]] inline void multiply_each_of_eight(const double* A, int stride,
                                                          const double* x, int from, int columns,
                                                          double* y, int to) {
  Eight sum[count] = {};
  for (std::ptrdiff_t q = 0; q < columns; ++q) {
    const Eight a = *reinterpret_cast<const Eight*>(A + q * stride);
    for (std::ptrdiff_t c = 0; c < count; ++c) {
      const double b = x[c * from + q];
      sum[c] += a * Eight{b, b, b, b, b, b, b, b};
    }
  }
  for (std::ptrdiff_t c = 0; c < count; ++c) *reinterpret_cast<Eight*>(y + c * to) = sum[c];
}

/// Columns j … j + width - 1 of A B, from row 4 first on; b(q, j) is an entry of B.
template <int N, int width, int first, class Entry>
[[gnu::always_inline]] inline void multiply_columns(const double* A, const Entry& b,
                                                    std::ptrdiff_t j, double* result) {
  constexpr int rows = N / 4 - first;
  Four sum[width][rows] = {};
  for (std::ptrdiff_t q = 0; q < N; ++q) {
    Four a[rows];
    for (int i = 0; i < rows; ++i) a[i] = fours(A + q * N)[first + i];
    for (std::ptrdiff_t w = 0; w < width; ++w) {
      const Four factor = all_four(b(q, j + w));
      for (int i = 0; i < rows; ++i) sum[w][i] += a[i] * factor;
    }
  }
  for (std::ptrdiff_t w = 0; w < width; ++w)
    for (int i = 0; i < rows; ++i) fours(result + (j + w) * N)[first + i] = sum[w][i];
}

/// P ← F P Fᵀ + Q, symmetric to the bit. Q may be null.
template <int N>
void propagate(const Square<N>& F, Square<N>& P, const Square<N>* Q) {
  // As many columns at once as leave their sums in registers.
  constexpr int width = N <= 12 ? 4 : 2;
  Square<N> FP;
  for (std::ptrdiff_t j = 0; j < N; j += width)
    multiply_columns<N, width, 0>(
        F.at, [&](std::ptrdiff_t q, std::ptrdiff_t c) { return P(q, c); }, j, FP.at);
  const auto transposed = [&](std::ptrdiff_t q, std::ptrdiff_t c) { return F(c, q); };
  [&]<int... block>(std::integer_sequence<int, block...>) {
    (multiply_columns<N, width, block * width / 4>(FP.at, transposed, block * width, P.at), ...);
  }
  (std::make_integer_sequence<int, N / width>());
  if (Q != nullptr)
    for (int i = 0; i < N * N / 4; ++i) fours(P.at)[i] += fours(Q->at)[i];
  for (int j = 0; j < N; ++j)
    for (int i = 0; i < j; ++i) P(i, j) = P(j, i);
}

template <int N>
void transpose(const Square<N>& A, Square<N>& result) {
  for (int j = 0; j < N; ++j)
    for (int i = 0; i < N; ++i) result(i, j) = A(j, i);
}

/// M += a bᵀ times `factor`
template <int N>
[[gnu::always_inline]] inline void add_outer(double factor, const double* a, const double* b,
                                             Square<N>& M) {
  for (int j = 0; j < N; ++j) add_scaled<N>(factor * b[j], a, M.column(j));
}

}  // namespace quadtune::internal
