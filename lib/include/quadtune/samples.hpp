// SPDX-License-Identifier: Apache-2.0
/// Storage of samples. Large arrays are stored in an unnamed memory-mapped file, whose pages the
/// operating system writes to disk and reads back as needed, so that a long log does not have to
/// fit in memory.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <limits>
#include <new>
#include <utility>
#include <vector>

namespace quadtune {

/// Blocks of fewer bytes are allocated on the heap.
inline constexpr std::size_t kMinSpooled = std::size_t{4} << 20;

namespace internal {
/// Creates the file in $TMPDIR, or in /var/tmp if that is not set. If the file system has no room,
/// the block is allocated in memory instead. A forked process shares the samples.
/// @throws std::bad_alloc
[[nodiscard]] void* allocate_samples(std::size_t bytes);
void free_samples(void* block, std::size_t bytes) noexcept;
}  // namespace internal

/// Allocator of samples: blocks of kMinSpooled bytes or more are memory-mapped.
template <class T>
struct SampleAllocator {
  using value_type = T;  ///< as allocators require

  SampleAllocator() = default;
  /// All allocators are alike.
  template <class Other>
  SampleAllocator(const SampleAllocator<Other>&) noexcept {}

  /// Storage for `count` values; throws std::bad_alloc.
  [[nodiscard]] T* allocate(std::size_t count) {
    if (count > std::numeric_limits<std::size_t>::max() / sizeof(T))
      throw std::bad_array_new_length();
    return static_cast<T*>(internal::allocate_samples(count * sizeof(T)));
  }
  /// Frees what allocate() returned.
  void deallocate(T* block, std::size_t count) noexcept {
    internal::free_samples(block, count * sizeof(T));
  }
  /// Any allocator can free the storage of another.
  template <class Other>
  bool operator==(const SampleAllocator<Other>&) const noexcept {
    return true;
  }
};

/// A vector of samples.
template <class T>
using SamplesOf = std::vector<T, SampleAllocator<T>>;
using Samples = SamplesOf<double>;  ///< a vector of numbers

/// A matrix of samples, one per column; usable as any Eigen matrix in expressions.
template <class Scalar>
class SampleArray : public Eigen::Map<Eigen::Matrix<Scalar, Eigen::Dynamic, Eigen::Dynamic>> {
 public:
  /// The matrix of Eigen that maps the storage.
  using Base = Eigen::Map<Eigen::Matrix<Scalar, Eigen::Dynamic, Eigen::Dynamic>>;

  SampleArray() : Base(nullptr, 0, 0) {}
  /// A matrix of zeros.
  SampleArray(Eigen::Index rows, Eigen::Index cols) : SampleArray() { resize(rows, cols); }
  /// A copy of any matrix or expression.
  template <class Derived>
  SampleArray(const Eigen::EigenBase<Derived>& other) : SampleArray() {
    *this = other;
  }
  /// @param columns  the entries in column-major order, rows × cols numbers
  /// @param rows     ≥ 0
  /// @param cols     ≥ 0
  SampleArray(SamplesOf<Scalar> columns, Eigen::Index rows, Eigen::Index cols)
      : Base(nullptr, 0, 0), storage_(std::move(columns)) {
    map(rows, cols);
  }
  /// A copy of the samples.
  SampleArray(const SampleArray& other) : Base(nullptr, 0, 0), storage_(other.storage_) {
    map(other.rows(), other.cols());
  }
  /// Takes over the samples.
  SampleArray(SampleArray&& other) noexcept : SampleArray() { swap(other); }
  ~SampleArray() = default;

  /// Receives the samples of `other`.
  SampleArray& operator=(SampleArray other) noexcept {
    swap(other);
    return *this;
  }
  /// Receives a copy of any matrix or expression.
  template <class Derived>
  SampleArray& operator=(const Eigen::EigenBase<Derived>& other) {
    SampleArray result;
    result.resize(other.rows(), other.cols());
    static_cast<Base&>(result) = other.derived();
    swap(result);
    return *this;
  }

  using Base::setConstant;

  /// Changes the size and sets all entries to zero.
  void resize(Eigen::Index rows, Eigen::Index cols) {
    storage_ = SamplesOf<Scalar>(static_cast<std::size_t>(rows * cols));
    map(rows, cols);
  }
  /// Changes the size and sets all entries to `value`.
  void setConstant(Eigen::Index rows, Eigen::Index cols, Scalar value) {
    storage_ = SamplesOf<Scalar>(static_cast<std::size_t>(rows * cols), value);
    map(rows, cols);
  }

  /// Exchanges sizes and samples.
  void swap(SampleArray& other) noexcept {
    const Eigen::Index rows = this->rows(), cols = this->cols();
    storage_.swap(other.storage_);
    map(other.rows(), other.cols());
    other.map(rows, cols);
  }

 private:
  void map(Eigen::Index rows, Eigen::Index cols) {
    new (static_cast<Base*>(this)) Base(storage_.data(), rows, cols);
  }

  SamplesOf<Scalar> storage_;
};

using SampleMatrix = SampleArray<double>;  ///< a matrix of numbers

}  // namespace quadtune
