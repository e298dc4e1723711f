// SPDX-License-Identifier: Apache-2.0
/// Aligned memory for one matrix: in place where the size is known to the compiler.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <new>
#include <utility>

namespace quadtune::internal {

/// kRows rows of kColumns numbers, all 0 at first.
template <int kRows, int kColumns, class Real = double>
class KernelStorage {
 public:
  KernelStorage(int /*rows*/, int /*stride*/) {}
  [[nodiscard]] Real* data() { return values_.data(); }
  [[nodiscard]] const Real* data() const { return values_.data(); }
  [[nodiscard]] Real operator[](int i) const { return data()[i]; }
  void fill(Real value) { values_.fill(value); }

 private:
  alignas(64) std::array<Real, static_cast<std::size_t>(kRows) * kColumns> values_{};
};

/// The same with sizes known at run time only.
template <int kRows, class Real>
class KernelStorage<kRows, 0, Real> {
 public:
  KernelStorage(int rows, int stride)
      : size_(static_cast<std::size_t>(rows) * static_cast<std::size_t>(stride)),
        values_(new (kAlignment) Real[size_]()) {}
  ~KernelStorage() { ::operator delete[](values_, kAlignment); }
  KernelStorage(const KernelStorage&) = delete;
  KernelStorage(KernelStorage&& other) noexcept
      : size_(other.size_), values_(std::exchange(other.values_, nullptr)) {}
  /// Both have the same size.
  KernelStorage& operator=(const KernelStorage& other) {
    if (this != &other) std::copy_n(other.values_, size_, values_);
    return *this;
  }
  KernelStorage& operator=(KernelStorage&& other) noexcept {
    std::swap(values_, other.values_);
    return *this;
  }

  [[nodiscard]] Real* data() { return values_; }
  [[nodiscard]] const Real* data() const { return values_; }
  [[nodiscard]] Real operator[](int i) const { return values_[i]; }
  void fill(Real value) { std::fill_n(values_, size_, value); }

 private:
  static constexpr std::align_val_t kAlignment{64};

  std::size_t size_;
  Real* values_;
};

}  // namespace quadtune::internal
