// SPDX-License-Identifier: Apache-2.0
#include "peers/ordered_schur.hpp"

#include <cmath>

extern "C" {
void dgees_(const char* jobvs, const char* sort, int (*select)(const double*, const double*),
            const int* n, double* a, const int* lda, int* sdim, double* wr, double* wi, double* vs,
            const int* ldvs, double* work, const int* lwork, int* bwork, int* info, std::size_t,
            std::size_t);
void dgesv_(const int* n, const int* nrhs, double* a, const int* lda, int* ipiv, double* b,
            const int* ldb, int* info);
}

namespace quadtune::bench {
namespace {

int in_left_half_plane(const double* real, const double* /*imaginary*/) { return *real < 0; }

int in_unit_circle(const double* real, const double* imaginary) {
  return std::hypot(*real, *imaginary) < 1;
}

}  // namespace

OrderedSchur::OrderedSchur(Eigen::Index nx)
    : nx_(nx),
      H_(2 * nx, 2 * nx),
      U_(2 * nx, 2 * nx),
      U11_(nx, nx),
      X_(nx, nx),
      Ait_(nx, nx),
      real_(2 * nx),
      imaginary_(2 * nx),
      flags_(static_cast<std::size_t>(2 * nx)),
      pivots_(static_cast<std::size_t>(nx)) {
  // Query the optimal workspace of LAPACK.
  const int n = static_cast<int>(2 * nx);
  const int query = -1;
  int sdim = 0;
  int info = 0;
  double size = 0;
  dgees_("V", "S", in_left_half_plane, &n, H_.data(), &n, &sdim, real_.data(), imaginary_.data(),
         U_.data(), &n, &size, &query, flags_.data(), &info, 1, 1);
  work_.resize(static_cast<Eigen::Index>(size));
}

bool OrderedSchur::care(const Eigen::MatrixXd& A, const Eigen::MatrixXd& G,
                        const Eigen::MatrixXd& Q) {
  H_.topLeftCorner(nx_, nx_) = A;
  H_.topRightCorner(nx_, nx_) = -G;
  H_.bottomLeftCorner(nx_, nx_) = -Q;
  H_.bottomRightCorner(nx_, nx_) = -A.transpose();
  return invariant_subspace(in_left_half_plane);
}

bool OrderedSchur::dare(const Eigen::MatrixXd& A, const Eigen::MatrixXd& G,
                        const Eigen::MatrixXd& Q) {
  const int n = static_cast<int>(nx_);
  int info = 0;
  U11_ = A.transpose();
  Ait_.setIdentity();
  dgesv_(&n, &n, U11_.data(), &n, pivots_.data(), Ait_.data(), &n, &info);
  if (info != 0) return false;
  H_.topRightCorner(nx_, nx_).noalias() = -G * Ait_;
  H_.bottomRightCorner(nx_, nx_) = Ait_;
  H_.bottomLeftCorner(nx_, nx_).noalias() = -Ait_ * Q;
  H_.topLeftCorner(nx_, nx_) = A;
  H_.topLeftCorner(nx_, nx_).noalias() -= G * H_.bottomLeftCorner(nx_, nx_);
  return invariant_subspace(in_unit_circle);
}

bool OrderedSchur::invariant_subspace(Select select) {
  const int n = static_cast<int>(2 * nx_);
  const int half = static_cast<int>(nx_);
  const int lwork = static_cast<int>(work_.size());
  int sdim = 0;
  int info = 0;
  dgees_("V", "S", select, &n, H_.data(), &n, &sdim, real_.data(), imaginary_.data(), U_.data(), &n,
         work_.data(), &lwork, flags_.data(), &info, 1, 1);
  if (info != 0 || sdim != half) return false;
  // X U11 = U21, so U11ᵀ Xᵀ = U21ᵀ
  U11_ = U_.topLeftCorner(nx_, nx_).transpose();
  X_ = U_.bottomLeftCorner(nx_, nx_).transpose();
  dgesv_(&half, &half, U11_.data(), &half, pivots_.data(), X_.data(), &half, &info);
  if (info != 0) return false;
  X_ = (0.5 * (X_ + X_.transpose())).eval();
  return true;
}

}  // namespace quadtune::bench
