// SPDX-License-Identifier: Apache-2.0
#include "riccati_doubling.hpp"

#include "eigen_ops.hpp"
#include "fixed_ops.hpp"

namespace quadtune::internal {

std::unique_ptr<DoublingSolver> make_dense_solver(Eigen::Index nx, Eigen::Index nu) {
  const Eigen::Index size = std::max(nx, nu);
  if (size <= 4) return std::make_unique<Doubling<FixedOps<4>>>(nx, nu);
  if (size <= 8) return std::make_unique<Doubling<FixedOps<8>>>(nx, nu);
  if (size <= 12) return std::make_unique<Doubling<FixedOps<12>>>(nx, nu);
  if (size <= 16) return std::make_unique<Doubling<FixedOps<16>>>(nx, nu);
  if (size <= 24) return std::make_unique<Doubling<FixedOps<24>>>(nx, nu);
  return std::make_unique<Doubling<EigenOps>>(nx, nu);
}

}  // namespace quadtune::internal
