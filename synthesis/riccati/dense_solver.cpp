// SPDX-License-Identifier: Apache-2.0
// Chooses the kernels for the size of an equation.
#include "riccati/kernel_ops.hpp"
#include "riccati/riccati_doubling.hpp"
#include "riccati/riccati_mixed.hpp"

namespace quadtune::internal {
namespace {

/// Up to this size the corrections cost more time than single precision saves.
constexpr Eigen::Index kMixedAbove = 32;

}  // namespace

std::unique_ptr<DoublingSolver> make_dense_solver(Eigen::Index nx, Eigen::Index nu) {
  const Eigen::Index size = std::max(nx, nu);
  if (size <= 4) return std::make_unique<Doubling<KernelOps<4>>>(nx, nu);
  if (size <= 8) return std::make_unique<Doubling<KernelOps<8>>>(nx, nu);
  if (size <= 12) return std::make_unique<Doubling<KernelOps<12>>>(nx, nu);
  if (size <= 16) return std::make_unique<Doubling<KernelOps<16>>>(nx, nu);
  if (size <= kMixedAbove) return std::make_unique<Doubling<KernelOps<0>>>(nx, nu);
  return std::make_unique<MixedDoubling>(nx, nu);
}

}  // namespace quadtune::internal
