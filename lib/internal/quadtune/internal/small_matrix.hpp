// SPDX-License-Identifier: Apache-2.0
/// Short vectors, register tiles and building blocks of kernels for small dense matrices. Include
/// it only in sources listed as KERNELS (docs/decisions/0011-variants.md), because the register
/// width is fixed when they are compiled. Rationale: docs/decisions/0017-one-small-matrix-layer.md.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <memory>
#include <new>
#include <type_traits>
#include <utility>
#if defined(__FMA__) || defined(__AVX512F__)
#include <immintrin.h>
#endif

namespace quadtune::internal {

#if defined(__AVX512F__)
inline constexpr int kRegisters = 32;
inline constexpr int kRegisterBytes = 64;
#else
inline constexpr int kRegisters = 16;
inline constexpr int kRegisterBytes = 32;
#endif

template <class Real, int kWidth>
struct VectorOf {
  typedef Real type __attribute__((vector_size(kWidth * sizeof(Real))));
};
/// A vector of kWidth numbers; the compiler splits vectors longer than the processor's registers.
template <class Real, int kWidth>
using Vector = typename VectorOf<Real, kWidth>::type;

/// The number of elements of a vector, and their type.
template <class V>
using ElementOf = std::remove_reference_t<decltype(std::declval<V&>()[0])>;
template <class V>
inline constexpr int kWidthOf = sizeof(V) / sizeof(ElementOf<V>);

template <class V>
[[gnu::always_inline]] inline V broadcast(ElementOf<V> x) {
  return x - V{};
}
/// Load from and store to memory that is aligned to a vector.
template <class V>
[[gnu::always_inline]] inline V load(const ElementOf<V>* p) {
  return *reinterpret_cast<const V*>(p);
}
template <class V>
[[gnu::always_inline]] inline void store(ElementOf<V>* p, V v) {
  *reinterpret_cast<V*>(p) = v;
}

/// a b + c, fused if the processor supports it: -ffp-contract=off keeps the compiler from fusing.
template <class V>
[[gnu::always_inline]] inline V multiply_add(V a, V b, V c) {
  [[maybe_unused]] constexpr bool kDouble = std::is_same_v<ElementOf<V>, double>;
#if defined(__AVX512F__)
  if constexpr (sizeof(V) == 64) {
    if constexpr (kDouble)
      return (V)_mm512_fmadd_pd((__m512d)a, (__m512d)b, (__m512d)c);
    else
      return (V)_mm512_fmadd_ps((__m512)a, (__m512)b, (__m512)c);
  }
#endif
#if defined(__FMA__)
  if constexpr (sizeof(V) == 32) {
    if constexpr (kDouble)
      return (V)_mm256_fmadd_pd((__m256d)a, (__m256d)b, (__m256d)c);
    else
      return (V)_mm256_fmadd_ps((__m256)a, (__m256)b, (__m256)c);
  }
#endif
  return a * b + c;
}
/// c - a b, fused if the processor supports it.
template <class V>
[[gnu::always_inline]] inline V subtract_product(V a, V b, V c) {
  return multiply_add(-a, b, c);
}

/// The absolute value: clears the sign bits.
template <class V>
[[gnu::always_inline]] inline V abs_of(V v) {
  using Bits = decltype(v < v);
  return (V)((Bits)v & ~(Bits)(-V{}));
}
/// The sum of the elements, in ascending order of their index.
template <class V>
[[gnu::always_inline]] inline ElementOf<V> total(V v) {
  ElementOf<V> sum = 0;
  for (int i = 0; i < kWidthOf<V>; ++i) sum += v[i];
  return sum;
}
inline double square_root(double x) { return std::sqrt(x); }
template <class V>
[[gnu::always_inline]] inline V square_root(V v) {
#if defined(__AVX512F__)
  if constexpr (sizeof(V) == 64) return (V)_mm512_sqrt_pd((__m512d)v);
#endif
#if defined(__FMA__)
  if constexpr (sizeof(V) == 32) return (V)_mm256_sqrt_pd((__m256d)v);
#endif
  for (int i = 0; i < kWidthOf<V>; ++i) v[i] = std::sqrt(v[i]);
  return v;
}

/// (r, k) → entry (r, k) of a matrix with strides `row` and `column`, in numbers.
template <class V>
[[gnu::always_inline]] inline auto entries_of(const ElementOf<V>* M, std::ptrdiff_t row,
                                              std::ptrdiff_t column) {
  return [=](int r, int k) { return broadcast<V>(M[r * row + k * column]); };
}
/// (k, v) → vector v of row k of a matrix with row stride `row`, in numbers.
template <class V>
[[gnu::always_inline]] inline auto vectors_of(const ElementOf<V>* M, std::ptrdiff_t row) {
  return [=](int k, int v) { return load<V>(M + k * row + v * kWidthOf<V>); };
}

/// kRows rows of kVectors vectors each, all in registers: all loops over them are unrolled.
template <class V, int kRows, int kVectors>
struct Tile {
  V at[kRows][kVectors] = {};

  /// Calls work(row, vector index, vector&).
  template <class Work>
  [[gnu::always_inline]] inline void each(const Work& work) {
#pragma GCC unroll 8
    for (int r = 0; r < kRows; ++r)
#pragma GCC unroll 4
      for (int v = 0; v < kVectors; ++v) work(r, v, at[r][v]);
  }

  /// Sets the vectors to source(row, vector index).
  template <class Source>
  [[gnu::always_inline]] inline void set(const Source& source) {
    each([&](int r, int v, V& x) { x = source(r, v); });
  }
  /// Adds A B over the inner indices [from, to). left(r, k) is an entry of A, broadcast to all
  /// elements of a vector; right(k, v) is vector v of row k of B.
  template <class To, class Left, class Right>
  [[gnu::always_inline]] inline void add_product(int from, To to, const Left& left,
                                                 const Right& right) {
    accumulate<multiply_add<V>>(from, to, left, right);
  }
  /// Subtracts A B.
  template <class To, class Left, class Right>
  [[gnu::always_inline]] inline void subtract_product_of(int from, To to, const Left& left,
                                                         const Right& right) {
    accumulate<subtract_product<V>>(from, to, left, right);
  }

  /// Subtracts `factor` times row q from row r.
  [[gnu::always_inline]] inline void subtract_row(int r, int q, V factor) {
#pragma GCC unroll 4
    for (int v = 0; v < kVectors; ++v) at[r][v] = subtract_product(factor, at[q][v], at[r][v]);
  }
  [[gnu::always_inline]] inline void multiply_row(int r, V factor) {
#pragma GCC unroll 4
    for (int v = 0; v < kVectors; ++v) at[r][v] *= factor;
  }
  /// Multiplies the tile by L⁻¹ from the left. L has a unit diagonal and the entries l(r, q) below
  /// it.
  template <class Entry>
  [[gnu::always_inline]] inline void solve_unit_lower(const Entry& l) {
#pragma GCC unroll 8
    for (int r = 1; r < kRows; ++r)
#pragma GCC unroll 8
      for (int q = 0; q < r; ++q) subtract_row(r, q, l(r, q));
  }

 private:
  template <V (*term)(V, V, V), class To, class Left, class Right>
  [[gnu::always_inline]] inline void accumulate(int from, To to, const Left& left,
                                                const Right& right) {
    for (int k = from; k < to; ++k) {
      V row[kVectors];
#pragma GCC unroll 4
      for (int v = 0; v < kVectors; ++v) row[v] = right(k, v);
#pragma GCC unroll 8
      for (int r = 0; r < kRows; ++r) {
        const V a = left(r, k);
#pragma GCC unroll 4
        for (int v = 0; v < kVectors; ++v) at[r][v] = term(a, row[v], at[r][v]);
      }
    }
  }
};

/// Inverts a lower triangular L of n rows. Both arguments return a reference for (row, column), to
/// a double or to a vector with one entry of each of several matrices.
template <class Lower, class Inverse>
void invert_lower(int n, const Lower& L, Inverse&& X) {
  using Number = std::decay_t<decltype(X(0, 0))>;
  for (int j = 0; j < n; ++j) {
    for (int i = 0; i < j; ++i) X(i, j) = Number{};
    X(j, j) = 1 / L(j, j);
    for (int i = j + 1; i < n; ++i) {
      Number sum{};
      for (int k = j; k < i; ++k) sum -= L(i, k) * X(k, j);
      X(i, j) = sum / L(i, i);
    }
  }
}

/// Computes the Cholesky factor of S in place in its lower triangle. Returns false as soon as a
/// pivot and the original diagonal entry do not satisfy is_positive(pivot, entry).
template <class Matrix, class Positive>
bool factor_cholesky(int n, Matrix&& S, const Positive& is_positive) {
  for (int j = 0; j < n; ++j) {
    const auto before = S(j, j);
    for (int k = 0; k < j; ++k) S(j, j) -= S(j, k) * S(j, k);
    if (!is_positive(S(j, j), before)) return false;
    S(j, j) = square_root(S(j, j));
    for (int i = j + 1; i < n; ++i) {
      for (int k = 0; k < j; ++k) S(i, j) -= S(i, k) * S(j, k);
      S(i, j) /= S(j, j);
    }
  }
  return true;
}

/// Zero-initialized storage for a matrix of vectors, aligned to 64 bytes: in place if the number of
/// vectors, kCount, is known at compile time, else (0) on the heap. Assignment copies the numbers
/// of a matrix of the same size and does not allocate.
template <class V, int kCount = 0>
class VectorStorage {
 public:
  using Real = ElementOf<V>;

  explicit VectorStorage(int count) : count_(count) {
    if constexpr (kCount == 0) vectors_.reset(new (std::align_val_t{64}) V[size()]());
  }
  VectorStorage(const VectorStorage&) = delete;
  VectorStorage(VectorStorage&&) noexcept = default;
  ~VectorStorage() = default;

  // Copies with the kernels' vector width: wider loads would stall on narrower stores.
  VectorStorage& operator=(const VectorStorage& other) {
    return assign([&](int i) { return other.begin()[i]; });
  }
  VectorStorage& operator=(Real x) {
    return assign([&](int) { return broadcast<V>(x); });
  }
  VectorStorage& operator+=(const VectorStorage& other) {
    return assign([&](int i) { return begin()[i] + other.begin()[i]; });
  }
  VectorStorage& operator*=(Real x) {
    return assign([&](int i) { return begin()[i] * broadcast<V>(x); });
  }
  /// this = A - B
  void set_difference(const VectorStorage& A, const VectorStorage& B) {
    assign([&](int i) { return A.begin()[i] - B.begin()[i]; });
  }
  friend void swap(VectorStorage& a, VectorStorage& b) noexcept {
    if constexpr (kCount == 0)
      std::swap(a.vectors_, b.vectors_);
    else
      std::swap_ranges(a.begin(), a.begin() + kCount, b.begin());
  }

  /// Calls value(i) for each vector i and stores the result.
  template <class Value>
  [[gnu::always_inline]] inline VectorStorage& assign(const Value& value) {
    for (int i = 0; i < size(); ++i) begin()[i] = value(i);
    return *this;
  }

  [[nodiscard]] int size() const {
    if constexpr (kCount > 0)
      return kCount;
    else
      return count_;
  }
  [[nodiscard]] V* begin() { return &vectors_[0]; }
  [[nodiscard]] const V* begin() const { return &vectors_[0]; }
  [[nodiscard]] Real* data() { return reinterpret_cast<Real*>(begin()); }
  [[nodiscard]] const Real* data() const { return reinterpret_cast<const Real*>(begin()); }
  [[nodiscard]] Real operator[](int i) const { return data()[i]; }

 private:
  struct Free {
    void operator()(V* p) const { ::operator delete[](p, std::align_val_t{64}); }
  };
  using InPlace = std::array<V, static_cast<std::size_t>(kCount)>;
  struct NoCount {  // saves 64 bytes in a matrix in place
    explicit NoCount(int /*count*/) {}
  };

  [[no_unique_address]] std::conditional_t<(kCount > 0), NoCount, int> count_;
  alignas(kCount > 0 ? 64 : alignof(void*))
      std::conditional_t<(kCount > 0), InPlace, std::unique_ptr<V[], Free>> vectors_{};
};

}  // namespace quadtune::internal
