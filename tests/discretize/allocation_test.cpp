// SPDX-License-Identifier: Apache-2.0
// The workspace forms promise not to allocate. malloc is replaced by one that counts, which sees
// operator new and Eigen's aligned memory alike.
#include <atomic>
#include <cstdlib>
#include <random>

#include "matrix_near.hpp"
#include "quadtune/discretize/matrix_exponential.hpp"
#include "quadtune/discretize/zoh.hpp"

#if !defined(__SANITIZE_ADDRESS__) && defined(__GLIBC__)
#define QUADTUNE_COUNTS_ALLOCATIONS

namespace {
std::atomic<long> allocations = 0;
}

extern "C" {
void* __libc_malloc(std::size_t size);
void* __libc_memalign(std::size_t alignment, std::size_t size);
void* malloc(std::size_t size) {
  ++allocations;
  return __libc_malloc(size);
}
void* aligned_alloc(std::size_t alignment, std::size_t size) {
  ++allocations;
  return __libc_memalign(alignment, size);
}
}
#endif

namespace quadtune {
namespace {

using Eigen::MatrixXd;

#ifdef QUADTUNE_COUNTS_ALLOCATIONS
template <class F>
long allocations_of(const F& f) {
  const long before = allocations;
  f();
  return allocations - before;
}

TEST(Allocation, IsCounted) {
  EXPECT_GT(allocations_of([] { MatrixXd(3, 3).setZero(); }), 0);
}

TEST(Allocation, WorkspacesDoNotAllocate) {
  for (const Eigen::Index n : {1, 4, 12, 13, 16, 60}) {
    const MatrixXd A = -MatrixXd::Identity(n, n) + 0.1 * MatrixXd::Ones(n, n);
    const MatrixXd B = MatrixXd::Ones(n, 4);
    MatrixXd Ad(n, n);
    MatrixXd Bd(n, 4);
    ZohWorkspace zoh(n, 4);
    MatrixExponential exponential(n);
    for (const double dt : {0.001, 0.3, 100.0}) {
      EXPECT_EQ(allocations_of([&] { zoh.solve(A, B, dt, Ad, Bd); }), 0) << n << " at " << dt;
      EXPECT_EQ(allocations_of([&] { (void)exponential.solve(A, Ad); }), 0) << n;
    }
  }
}
#else
TEST(Allocation, IsCounted) { GTEST_SKIP() << "the sanitizer has its own malloc"; }
#endif

}  // namespace
}  // namespace quadtune
