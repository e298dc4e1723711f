// SPDX-License-Identifier: Apache-2.0
#include "quadtune/discretize/zoh.hpp"

#include <fmt/format.h>

#include <limits>

#include "kernel/exponential_kernel.hpp"
#include "methods/period.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/matrix_checks.hpp"

namespace quadtune {
namespace {

// Building the message of require_shape() allocates memory, so it is called only on failure.
void expect_shape(const Eigen::Ref<const Eigen::MatrixXd>& M, Eigen::Index rows, Eigen::Index cols,
                  const char* name) {
  if (M.rows() != rows || M.cols() != cols)
    require_shape(M, rows, cols, "zoh", name, "the size of the workspace");
}

}  // namespace

struct ZohWorkspace::Workspace {
  Workspace(Eigen::Index nx, Eigen::Index nu)
      : storage(internal::ExponentialKernel::storage_size(nx, nu)),
        kernel(nx, nu, storage.data()) {}

  Eigen::VectorXd storage;
  internal::ExponentialKernel kernel;
};

ZohWorkspace::ZohWorkspace(Eigen::Index nx, Eigen::Index nu) {
  if (nx < 1 || nu < 1)
    throw InvalidInput(
        "zoh", fmt::format("{} states and {} inputs, expected at least one of each", nx, nu));
  workspace_ = std::make_unique<Workspace>(nx, nu);
}
ZohWorkspace::~ZohWorkspace() = default;
ZohWorkspace::ZohWorkspace(ZohWorkspace&&) noexcept = default;
ZohWorkspace& ZohWorkspace::operator=(ZohWorkspace&&) noexcept = default;

void ZohWorkspace::solve(const Eigen::Ref<const Eigen::MatrixXd>& A,
                         const Eigen::Ref<const Eigen::MatrixXd>& B, double dt,
                         Eigen::Ref<Eigen::MatrixXd> Ad, Eigen::Ref<Eigen::MatrixXd> Bd) {
  internal::ExponentialKernel& kernel = workspace_->kernel;
  expect_shape(A, kernel.n(), kernel.n(), "A");
  expect_shape(B, kernel.n(), kernel.nu(), "B");
  expect_shape(Ad, kernel.n(), kernel.n(), "Ad");
  expect_shape(Bd, kernel.n(), kernel.nu(), "Bd");
  if (!(dt > 0) || dt == std::numeric_limits<double>::infinity())
    internal::require_period(dt, "zoh");
  if (kernel.solve(A, B, dt, Ad, Bd) == ExponentialStatus::solved) return;
  // NaN and infinity always lead here, so A and B are checked only now.
  require_finite(A, "zoh", "A");
  require_finite(B, "zoh", "B");
  internal::refuse_long_period(dt, "zoh");
}

DiscreteLti discretize_zoh(const ContinuousLti& plant, double dt) {
  validate(plant, "zoh");
  internal::require_period(dt, "zoh");
  DiscreteLti result{.A = plant.A,
                     .B = plant.B,
                     .C = plant.C,
                     .D = plant.D,
                     .dt = dt,
                     .states = plant.states,
                     .inputs = plant.inputs,
                     .outputs = plant.outputs};
  if (internal::exponential_and_integral(plant.A, plant.B, dt, result.A, result.B) !=
      ExponentialStatus::solved)
    internal::refuse_long_period(dt, "zoh");
  return result;
}

}  // namespace quadtune
