// SPDX-License-Identifier: Apache-2.0
#include "peers/slicot.hpp"

#include <algorithm>
#include <limits>

extern "C" {
void sb02md_(const char* dico, const char* hinv, const char* uplo, const char* scal,
             const char* sort, const int* n, double* a, const int* lda, double* g, const int* ldg,
             double* q, const int* ldq, double* rcond, double* wr, double* wi, double* s,
             const int* lds, double* u, const int* ldu, int* iwork, double* dwork,
             const int* ldwork, int* bwork, int* info, std::size_t, std::size_t, std::size_t,
             std::size_t, std::size_t);
void sb02od_(const char* dico, const char* jobb, const char* fact, const char* uplo,
             const char* jobl, const char* sort, const int* n, const int* m, const int* p,
             const double* a, const int* lda, const double* b, const int* ldb, const double* q,
             const int* ldq, const double* r, const int* ldr, const double* l, const int* ldl,
             double* rcond, double* x, const int* ldx, double* alfar, double* alfai, double* beta,
             double* s, const int* lds, double* t, const int* ldt, double* u, const int* ldu,
             const double* tol, int* iwork, double* dwork, const int* ldwork, int* bwork, int* info,
             std::size_t, std::size_t, std::size_t, std::size_t, std::size_t, std::size_t);
void mb05nd_(const int* n, const double* delta, const double* a, const int* lda, double* ex,
             const int* ldex, double* exint, const int* ldexin, const double* tol, int* iwork,
             double* dwork, const int* ldwork, int* info);
}

namespace quadtune::bench {
namespace {

using Eigen::Index;

int size(Index n) { return static_cast<int>(n); }
std::size_t count(Index n) { return static_cast<std::size_t>(n); }

}  // namespace

// 12 (2n)² is far above the workspace that the blocked LAPACK routines inside SLICOT request.
Sb02md::Sb02md(Index nx, bool discrete, bool scaled)
    : discrete_(discrete),
      scaled_(scaled),
      A_(nx, nx),
      G_(nx, nx),
      Q_(nx, nx),
      S_(2 * nx, 2 * nx),
      U_(2 * nx, 2 * nx),
      real_(2 * nx),
      imaginary_(2 * nx),
      work_(48 * nx * nx + 100),
      integers_(count(2 * nx)),
      flags_(count(2 * nx)) {}

bool Sb02md::solve(const Eigen::MatrixXd& A, const Eigen::MatrixXd& G, const Eigen::MatrixXd& Q) {
  A_ = A;  // overwritten when discrete
  G_ = G;  // scaled in place when SCAL = 'G'
  Q_ = Q;  // becomes X
  const int n = size(A.rows());
  const int n2 = 2 * n;
  const int ldwork = size(work_.size());
  double rcond = 0;
  int info = 0;
  sb02md_(discrete_ ? "D" : "C", "D", "U", scaled_ ? "G" : "N", "S", &n, A_.data(), &n, G_.data(),
          &n, Q_.data(), &n, &rcond, real_.data(), imaginary_.data(), S_.data(), &n2, U_.data(),
          &n2, integers_.data(), work_.data(), &ldwork, flags_.data(), &info, 1, 1, 1, 1, 1);
  return info == 0;
}

Sb02od::Sb02od(Index nx, Index nu, bool discrete)
    : discrete_(discrete),
      X_(nx, nx),
      S_(2 * nx + nu, 2 * nx + nu),
      T_(2 * nx + nu, 2 * nx),
      U_(2 * nx, 2 * nx),
      alpha_real_(2 * nx),
      alpha_imaginary_(2 * nx),
      beta_(2 * nx),
      work_(48 * (nx + nu) * (nx + nu) + 200),
      integers_(count(std::max(nu, 2 * nx))),
      flags_(count(2 * nx)) {}

bool Sb02od::solve(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B, const Eigen::MatrixXd& Q,
                   const Eigen::MatrixXd& R) {
  const int n = size(A.rows());
  const int m = size(B.cols());
  const int n2 = 2 * n;
  const int extended = n2 + m;
  const int ldwork = size(work_.size());
  const double tol = 0;  // SLICOT's default
  double rcond = 0;
  int info = 0;
  // L is not referenced with JOBL = 'Z', nor P with FACT = 'N'.
  sb02od_(discrete_ ? "D" : "C", "B", "N", "U", "Z", "S", &n, &m, &n, A.data(), &n, B.data(), &n,
          Q.data(), &n, R.data(), &m, B.data(), &n, &rcond, X_.data(), &n, alpha_real_.data(),
          alpha_imaginary_.data(), beta_.data(), S_.data(), &extended, T_.data(), &extended,
          U_.data(), &n2, &tol, integers_.data(), work_.data(), &ldwork, flags_.data(), &info, 1, 1,
          1, 1, 1, 1);
  return info == 0;
}

Mb05nd::Mb05nd(Index nx)
    : E_(nx, nx), integral_(nx, nx), work_(2 * nx * nx), integers_(count(nx)) {}

bool Mb05nd::solve(const Eigen::MatrixXd& A, double dt) {
  const int n = size(A.rows());
  const int ldwork = size(work_.size());
  const double tol = std::numeric_limits<double>::epsilon();
  int info = 0;
  mb05nd_(&n, &dt, A.data(), &n, E_.data(), &n, integral_.data(), &n, &tol, integers_.data(),
          work_.data(), &ldwork, &info);
  return info == 0;
}

}  // namespace quadtune::bench
