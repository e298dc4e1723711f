// SPDX-License-Identifier: Apache-2.0
#include "noise/autocovariance/sparse_ldl.hpp"

#include <cholmod.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace quadtune::internal {

using Eigen::Index;
using Eigen::SparseMatrix;
using Eigen::VectorXd;

struct SparseLdl::Parts {
  cholmod_common common{};
  cholmod_factor* factor = nullptr;
  SparseMatrix<double> L;  ///< unit lower triangular, without its diagonal
  VectorXd D;
  bool factored = false;
  Index bad_row = 0;

  Parts() {
    cholmod_start(&common);
    common.supernodal = CHOLMOD_SIMPLICIAL;
    common.final_ll = 0;
    common.nmethods = 1;
    common.method[0].ordering = CHOLMOD_NATURAL;
    common.postorder = 0;
    common.print = 0;
  }
  ~Parts() {
    cholmod_free_factor(&factor, &common);
    cholmod_finish(&common);
  }
  Parts(const Parts&) = delete;
  Parts& operator=(const Parts&) = delete;

  /// Copies the factor; CHOLMOD stores D on the diagonal of L.
  void take_factor() {
    const auto n = static_cast<Index>(factor->n);
    const auto* start = static_cast<const int*>(factor->p);
    const auto* count = static_cast<const int*>(factor->nz);
    const auto* row = static_cast<const int*>(factor->i);
    const auto* value = static_cast<const double*>(factor->x);
    D.resize(n);
    std::vector<Eigen::Triplet<double>> entries;
    for (Index j = 0; j < n; ++j)
      for (int k = start[j]; k < start[j] + count[j]; ++k) {
        if (row[k] == j)
          D(j) = value[k];
        else
          entries.emplace_back(row[k], static_cast<int>(j), value[k]);
      }
    L.resize(n, n);
    L.setFromTriplets(entries.begin(), entries.end());
    factored = true;
    for (Index j = 0; j < n && factored; ++j)
      if (!std::isfinite(D(j)) || D(j) == 0) {
        factored = false;
        bad_row = j;
      }
  }
};

SparseLdl::SparseLdl(const SparseMatrix<double>& lower) : parts_(std::make_unique<Parts>()) {
  SparseMatrix<double> copy = lower;
  copy.makeCompressed();
  cholmod_sparse A{};
  A.nrow = static_cast<std::size_t>(copy.rows());
  A.ncol = static_cast<std::size_t>(copy.cols());
  A.nzmax = static_cast<std::size_t>(copy.nonZeros());
  A.p = copy.outerIndexPtr();
  A.i = copy.innerIndexPtr();
  A.x = copy.valuePtr();
  A.stype = -1;
  A.itype = CHOLMOD_INT;
  A.xtype = CHOLMOD_REAL;
  A.dtype = CHOLMOD_DOUBLE;
  A.sorted = 1;
  A.packed = 1;
  parts_->factor = cholmod_analyze(&A, &parts_->common);
  cholmod_factorize(&A, parts_->factor, &parts_->common);
  if (parts_->factor->minor < parts_->factor->n) {
    parts_->bad_row = static_cast<Index>(parts_->factor->minor);
    return;
  }
  parts_->take_factor();
}

SparseLdl::~SparseLdl() = default;
bool SparseLdl::factored() const { return parts_->factored; }
Index SparseLdl::bad_row() const { return parts_->bad_row; }

VectorXd SparseLdl::solve(const VectorXd& b) const {
  VectorXd x = b;
  parts_->L.triangularView<Eigen::UnitLower>().solveInPlace(x);
  x = x.cwiseQuotient(parts_->D).eval();
  parts_->L.transpose().triangularView<Eigen::UnitUpper>().solveInPlace(x);
  return x;
}

double SparseLdl::log_determinant() const { return parts_->D.cwiseAbs().array().log().sum(); }

SparseMatrix<double> SparseLdl::inverse_on_pattern() const {
  // Z = D⁻¹ L⁻¹ + (I - Lᵀ) Z: from the last column backwards, each entry follows from those below
  // and to the right.
  const SparseMatrix<double>& L = parts_->L;
  const Index n = L.rows();
  SparseMatrix<double> Z(n, n);
  Eigen::VectorXi sizes(n);
  for (Index j = 0; j < n; ++j) sizes(j) = L.outerIndexPtr()[j + 1] - L.outerIndexPtr()[j] + 1;
  Z.reserve(sizes);
  for (Index j = 0; j < n; ++j) {
    Z.insert(j, j) = 0;
    for (SparseMatrix<double>::InnerIterator it(L, j); it; ++it) Z.insert(it.row(), j) = 0;
  }
  Z.makeCompressed();
  const int* start = Z.outerIndexPtr();
  const int* row = Z.innerIndexPtr();
  double* value = Z.valuePtr();
  const auto entry = [&](int i, int j) -> double {
    if (i < j) std::swap(i, j);
    const int* found = std::lower_bound(row + start[j], row + start[j + 1], i);
    return value[found - row];
  };
  for (Index j = n - 1; j >= 0; --j) {
    const int first = start[j], last = start[j + 1];
    for (int a = last - 1; a > first; --a) {
      double sum = 0;
      for (SparseMatrix<double>::InnerIterator it(L, j); it; ++it)
        sum -= it.value() * entry(static_cast<int>(it.row()), row[a]);
      value[a] = sum;
    }
    double sum = 1 / parts_->D(j);
    int a = first + 1;
    for (SparseMatrix<double>::InnerIterator it(L, j); it; ++it) sum -= it.value() * value[a++];
    value[first] = sum;
  }
  return Z;
}

}  // namespace quadtune::internal
