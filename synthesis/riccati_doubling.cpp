// SPDX-License-Identifier: Apache-2.0
#include "riccati_doubling.hpp"

#include "kernel_ops.hpp"

namespace quadtune::internal {

std::unique_ptr<DoublingSolver> make_dense_solver(Eigen::Index nx, Eigen::Index nu) {
  const Eigen::Index size = std::max(nx, nu);
  if (size <= 4) return std::make_unique<Doubling<KernelOps<4>>>(nx, nu);
  if (size <= 8) return std::make_unique<Doubling<KernelOps<8>>>(nx, nu);
  if (size <= 12) return std::make_unique<Doubling<KernelOps<12>>>(nx, nu);
  if (size <= 16) return std::make_unique<Doubling<KernelOps<16>>>(nx, nu);
  return std::make_unique<Doubling<KernelOps<0>>>(nx, nu);
}

}  // namespace quadtune::internal
