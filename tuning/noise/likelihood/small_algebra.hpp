// SPDX-License-Identifier: Apache-2.0
/// Products of small square matrices whose size is known to the compiler. Stored column by column,
/// padded with zeros to N = 2 or a multiple of four.
#pragma once

#include <cstddef>
#include <utility>

namespace quadtune::internal {

/// A vector of `count` doubles without alignment requirements: the compiler splits it if the
/// vectors of the machine are shorter.
template <int count>
struct [[gnu::packed, gnu::may_alias]] Lanes {
  typedef double Vector __attribute__((vector_size(count * sizeof(double))));  // NOLINT
  Vector v;
};
template <int count>
using Vector = typename Lanes<count>::Vector;

/// Number of entries of a column of N that are computed together.
template <int N>
inline constexpr int kLanes = N < 4 ? 2 : 4;

/// The vectors of a column of N.
template <int N>
[[gnu::always_inline]] inline Lanes<kLanes<N>>* lanes(double* column) {
  return reinterpret_cast<Lanes<kLanes<N>>*>(column);
}
template <int N>
[[gnu::always_inline]] inline const Lanes<kLanes<N>>* lanes(const double* column) {
  return reinterpret_cast<const Lanes<kLanes<N>>*>(column);
}

template <int N>
struct Column {
  alignas(N < 8 ? 8 * N : 64) double at[N] = {};
};

template <int N>
struct Square {
  alignas(N < 8 ? 8 * N : 64) double at[N * N] = {};

  double& operator()(std::ptrdiff_t i, std::ptrdiff_t j) { return at[j * N + i]; }
  double operator()(std::ptrdiff_t i, std::ptrdiff_t j) const { return at[j * N + i]; }
  double* column(std::ptrdiff_t j) { return at + j * N; }
  [[nodiscard]] const double* column(std::ptrdiff_t j) const { return at + j * N; }
  /// Adds to an entry and to its mirror image.
  void add_symmetric(std::ptrdiff_t i, std::ptrdiff_t j, double value) {
    at[j * N + i] += value;
    if (i != j) at[i * N + j] += value;
  }
};

/// y += a x
template <int N>
[[gnu::always_inline]] inline void add_scaled(double a, const double* x, double* y) {
  for (int i = 0; i < N / kLanes<N>; ++i) lanes<N>(y)[i].v += a * lanes<N>(x)[i].v;
}

template <int N>
[[gnu::always_inline]] inline double dot(const double* a, const double* b) {
  auto sum = lanes<N>(a)[0].v * lanes<N>(b)[0].v;
  for (int i = 1; i < N / kLanes<N>; ++i) sum += lanes<N>(a)[i].v * lanes<N>(b)[i].v;
  if constexpr (N < 4)
    return sum[0] + sum[1];
  else
    return (sum[0] + sum[1]) + (sum[2] + sum[3]);
}

/// y = A x
template <int N>
[[gnu::always_inline]] inline void multiply(const Square<N>& A, const double* x, double* y) {
  Vector<kLanes<N>> even[N / kLanes<N>] = {}, odd[N / kLanes<N>] = {};
  for (std::ptrdiff_t q = 0; q < N; q += 2)
    for (int i = 0; i < N / kLanes<N>; ++i) {
      even[i] += lanes<N>(A.column(q))[i].v * x[q];
      odd[i] += lanes<N>(A.column(q + 1))[i].v * x[q + 1];
    }
  for (int i = 0; i < N / kLanes<N>; ++i) lanes<N>(y)[i].v = even[i] + odd[i];
}

/// Columns j … j + width - 1 of A B, in each starting with the vector `first`; b(q, j) is an entry
/// of B.
template <int N, int width, int first, class Entry>
[[gnu::always_inline]] inline void multiply_columns(const Square<N>& A, const Entry& b,
                                                    std::ptrdiff_t j, Square<N>& result) {
  constexpr int rows = N / kLanes<N> - first;
  Vector<kLanes<N>> sum[width][rows] = {};
  for (std::ptrdiff_t q = 0; q < N; ++q)
    for (std::ptrdiff_t w = 0; w < width; ++w)
      for (int i = 0; i < rows; ++i) sum[w][i] += lanes<N>(A.column(q))[first + i].v * b(q, j + w);
  for (std::ptrdiff_t w = 0; w < width; ++w)
    for (int i = 0; i < rows; ++i) lanes<N>(result.column(j + w))[first + i].v = sum[w][i];
}

template <int N>
void propagate_columns(const Square<N>& F, Square<N>& P, const Square<N>* Q) {
  // As many columns together as keep their sums in registers.
  constexpr int width = N <= 12 ? 4 : 2;
  Square<N> FP;
  for (std::ptrdiff_t j = 0; j < N; j += width)
    multiply_columns<N, width, 0>(
        F, [&](std::ptrdiff_t q, std::ptrdiff_t c) { return P(q, c); }, j, FP);
  const auto transposed = [&](std::ptrdiff_t q, std::ptrdiff_t c) { return F(c, q); };
  [&]<int... block>(std::integer_sequence<int, block...>) {
    (multiply_columns<N, width, block * width / kLanes<N>>(FP, transposed, block * width, P), ...);
  }
  (std::make_integer_sequence<int, N / width>());
  if (Q != nullptr) add_scaled<N * N>(1, Q->at, P.at);
  for (int j = 0; j < N; ++j)
    for (int i = 0; i < j; ++i) P(i, j) = P(j, i);
}

/// P ← F P Fᵀ + Q, exactly symmetric. Q may be null.
template <int N>
[[gnu::always_inline]] inline void propagate(const Square<N>& F, Square<N>& P, const Square<N>* Q) {
  if constexpr (N == 2) {  // in registers: P is on the critical path of each step
    const auto *f = lanes<2>(F.at), *q = Q == nullptr ? nullptr : lanes<2>(Q->at);
    const Vector<2> FP0 = f[0].v * P(0, 0) + f[1].v * P(1, 0);
    const Vector<2> FP1 = f[0].v * P(1, 0) + f[1].v * P(1, 1);
    Vector<2> P0 = FP0 * F(0, 0) + FP1 * F(0, 1), P1 = FP0 * F(1, 0) + FP1 * F(1, 1);
    if (q != nullptr) {
      P0 += q[0].v;
      P1 += q[1].v;
    }
    lanes<2>(P.at)[0].v = P0;
    lanes<2>(P.at)[1].v = Vector<2>{P0[1], P1[1]};
  } else {
    propagate_columns<N>(F, P, Q);
  }
}

template <int N>
void transpose(const Square<N>& A, Square<N>& result) {
  for (int j = 0; j < N; ++j)
    for (int i = 0; i < N; ++i) result(i, j) = A(j, i);
}

/// M += factor a bᵀ
template <int N>
[[gnu::always_inline]] inline void add_outer(double factor, const double* a, const double* b,
                                             Square<N>& M) {
  for (int j = 0; j < N; ++j) add_scaled<N>(factor * b[j], a, M.column(j));
}

/// A part of the vector by which a matrix is multiplied.
/// @tparam fixed  its length if the compiler knows it, so that it unrolls loops; otherwise -1
template <int fixed = -1>
struct Input {
  const double* at;
  std::ptrdiff_t count = fixed;
  [[nodiscard]] std::ptrdiff_t size() const { return fixed >= 0 ? fixed : count; }
};

/// even + odd += A x for 8 `width` rows of A; advances to the next column.
template <int width, int fixed>
[[gnu::always_inline]] inline void add_columns(const double*& A, std::ptrdiff_t rows,
                                               const Input<fixed>& x, Vector<8>* even,
                                               Vector<8>* odd) {
  const auto add = [](const double* column, double factor, Vector<8>* sum) {
    for (int i = 0; i < width; ++i)
      sum[i] += reinterpret_cast<const Lanes<8>*>(column)[i].v * factor;
  };
  std::ptrdiff_t q = 0;
  for (; q + 1 < x.size(); q += 2, A += 2 * rows) {
    add(A, x.at[q], even);
    add(A + rows, x.at[q + 1], odd);
  }
  if (q < x.size()) {
    add(A, x.at[q], even);
    A += rows;
  }
}

/// y = A [x₁; x₂; …] for 8 `width` rows of A.
template <int width, class... Inputs>
[[gnu::always_inline]] inline void multiply_rows(const double* A, std::ptrdiff_t rows, double* y,
                                                 const Inputs&... x) {
  Vector<8> even[width] = {}, odd[width] = {};
  (add_columns<width>(A, rows, x, even, odd), ...);
  for (int i = 0; i < width; ++i) reinterpret_cast<Lanes<8>*>(y)[i].v = even[i] + odd[i];
}

/// y = A [x₁; x₂; …], A of `rows` rows, a multiple of eight. As many rows together as keep their
/// sums in registers, because each entry of x is loaded once for them.
template <class... Inputs>
[[gnu::always_inline]] inline void multiply(const double* A, std::ptrdiff_t rows, double* y,
                                            const Inputs&... x) {
  std::ptrdiff_t i = 0;
  for (; i + 24 <= rows; i += 24) multiply_rows<3>(A + i, rows, y + i, x...);
  for (; i < rows; i += 8) multiply_rows<1>(A + i, rows, y + i, x...);
}

}  // namespace quadtune::internal
