// SPDX-License-Identifier: Apache-2.0
/// Declares Eigen's decompositions of dynamic matrices as instantiated elsewhere. Each takes
/// between 3 and 30 seconds to compile, and without these declarations every source file that uses
/// one would compile it again.
///
/// The definitions are in lib/compiled_eigen/. Every library links its own copy, because a program
/// that uses the libraries may contain slower ones, compiled for a generic machine.
///
/// Only precompiled.hpp includes this header. A build without precompiled headers takes longer and
/// gives the same results.
#pragma once

#include <Eigen/Dense>

// Each list is a macro whose argument precedes each declaration: `extern template` here, `template`
// in lib/compiled_eigen/. Member templates are listed by name, because instantiating a class does
// not instantiate them.

#define QUADTUNE_EIGEN_PRODUCT(declaration, Lhs, Rhs)                                             \
  declaration struct general_matrix_matrix_product<Index, double, Lhs, false, double, Rhs, false, \
                                                   ColMajor, 1>;

#define QUADTUNE_EIGEN_VECTOR_PRODUCT(declaration, Lhs, Rhs)                         \
  declaration struct general_matrix_vector_product<                                  \
      Index, double, const_blas_data_mapper<double, Index, Lhs>, Lhs, false, double, \
      const_blas_data_mapper<double, Index, Rhs>, false, Specialized>;               \
  declaration struct general_matrix_vector_product<                                  \
      Index, double, const_blas_data_mapper<double, Index, Lhs>, Lhs, false, double, \
      const_blas_data_mapper<double, Index, Rhs>, false, BuiltIn>;

// The complex ones that frequency responses need.
#define QUADTUNE_EIGEN_COMPLEX_PRODUCTS(declaration)                                              \
  declaration struct gebp_kernel<std::complex<double>, std::complex<double>, Index,               \
                                 blas_data_mapper<std::complex<double>, Index, ColMajor>,         \
                                 gebp_traits<std::complex<double>, std::complex<double>>::mr,     \
                                 gebp_traits<std::complex<double>, std::complex<double>>::nr,     \
                                 false, false>;                                                   \
  declaration struct general_matrix_vector_product<                                               \
      Index, std::complex<double>, const_blas_data_mapper<std::complex<double>, Index, RowMajor>, \
      RowMajor, false, std::complex<double>,                                                      \
      const_blas_data_mapper<std::complex<double>, Index, ColMajor>, false>;                      \
  declaration struct general_matrix_vector_product<                                               \
      Index, std::complex<double>, const_blas_data_mapper<std::complex<double>, Index, RowMajor>, \
      RowMajor, false, double, const_blas_data_mapper<double, Index, ColMajor>, false>;           \
  declaration struct general_matrix_vector_product<                                               \
      Index, std::complex<double>, const_blas_data_mapper<std::complex<double>, Index, ColMajor>, \
      ColMajor, false, std::complex<double>,                                                      \
      const_blas_data_mapper<std::complex<double>, Index, RowMajor>, false>;

#define QUADTUNE_EIGEN_TRIANGULAR_PRODUCT(declaration, Mode, Lhs)                            \
  declaration struct product_triangular_matrix_matrix<double, Index, Mode, true, Lhs, false, \
                                                      ColMajor, false, ColMajor, 1>;

#define QUADTUNE_EIGEN_PRODUCTS(declaration)                                                       \
  namespace Eigen::internal {                                                                      \
  declaration struct gebp_kernel<double, double, Index, blas_data_mapper<double, Index, ColMajor>, \
                                 gebp_traits<double, double>::mr, gebp_traits<double, double>::nr, \
                                 false, false>;                                                    \
  declaration void evaluateProductBlockingSizesHeuristic<double, double, 1, Index>(Index&, Index&, \
                                                                                   Index&, Index); \
  declaration void evaluateProductBlockingSizesHeuristic<double, double, 4, Index>(Index&, Index&, \
                                                                                   Index&, Index); \
  QUADTUNE_EIGEN_COMPLEX_PRODUCTS(declaration)                                                     \
  QUADTUNE_EIGEN_PRODUCT(declaration, ColMajor, ColMajor)                                          \
  QUADTUNE_EIGEN_PRODUCT(declaration, ColMajor, RowMajor)                                          \
  QUADTUNE_EIGEN_PRODUCT(declaration, RowMajor, ColMajor)                                          \
  QUADTUNE_EIGEN_PRODUCT(declaration, RowMajor, RowMajor)                                          \
  QUADTUNE_EIGEN_VECTOR_PRODUCT(declaration, ColMajor, ColMajor)                                   \
  QUADTUNE_EIGEN_VECTOR_PRODUCT(declaration, ColMajor, RowMajor)                                   \
  QUADTUNE_EIGEN_VECTOR_PRODUCT(declaration, RowMajor, ColMajor)                                   \
  QUADTUNE_EIGEN_VECTOR_PRODUCT(declaration, RowMajor, RowMajor)                                   \
  QUADTUNE_EIGEN_TRIANGULAR_PRODUCT(declaration, Lower, ColMajor)                                  \
  QUADTUNE_EIGEN_TRIANGULAR_PRODUCT(declaration, UnitLower, ColMajor)                              \
  QUADTUNE_EIGEN_TRIANGULAR_PRODUCT(declaration, Upper, RowMajor)                                  \
  QUADTUNE_EIGEN_TRIANGULAR_PRODUCT(declaration, UnitUpper, RowMajor)                              \
  }

#define QUADTUNE_EIGEN_TRIANGULAR_SOLVE(declaration, Mode, Order)                          \
  declaration struct triangular_solve_matrix<double, Index, OnTheLeft, Mode, false, Order, \
                                             ColMajor, 1>;                                 \
  declaration struct triangular_solve_vector<double, double, Index, OnTheLeft, Mode, false, Order>;

// Reflections of a Householder sequence, applied in blocks.
#define QUADTUNE_EIGEN_REFLECTIONS(declaration)                                                   \
  declaration void make_block_householder_triangular_factor(                                      \
      Matrix<double, Dynamic, Dynamic, RowMajor>&, const Block<MatrixXd>&,                        \
      const Block<const VectorXd, Dynamic, 1>&);                                                  \
  declaration void make_block_householder_triangular_factor(                                      \
      Matrix<double, Dynamic, Dynamic, RowMajor>&, const Block<MatrixXd>&,                        \
      const VectorBlock<const VectorXd>&);                                                        \
  declaration void apply_block_householder_on_the_left(Block<MatrixXd>&, const Block<MatrixXd>&,  \
                                                       const VectorBlock<const VectorXd>&, bool); \
  declaration double rcond_invmatrix_L1_norm_estimate(const PartialPivLU<MatrixXd>&);

#define QUADTUNE_EIGEN_FACTORIZATIONS(declaration)                                               \
  namespace Eigen::internal {                                                                    \
  QUADTUNE_EIGEN_REFLECTIONS(declaration)                                                        \
  QUADTUNE_EIGEN_TRIANGULAR_SOLVE(declaration, UnitLower, ColMajor)                              \
  QUADTUNE_EIGEN_TRIANGULAR_SOLVE(declaration, Lower, ColMajor)                                  \
  QUADTUNE_EIGEN_TRIANGULAR_SOLVE(declaration, Upper, ColMajor)                                  \
  QUADTUNE_EIGEN_TRIANGULAR_SOLVE(declaration, Upper, RowMajor)                                  \
  QUADTUNE_EIGEN_TRIANGULAR_SOLVE(declaration, UnitUpper, RowMajor)                              \
  }                                                                                              \
  namespace Eigen {                                                                              \
  declaration class PartialPivLU<MatrixXd>;                                                      \
  declaration class PartialPivLU<MatrixXcd>;                                                     \
  declaration class HouseholderQR<MatrixXd>;                                                     \
  declaration class ColPivHouseholderQR<MatrixXd>;                                               \
  declaration void ColPivHouseholderQR<MatrixXd>::_solve_impl(const MatrixXd&, MatrixXd&) const; \
  declaration void ColPivHouseholderQR<MatrixXd>::_solve_impl(const VectorXd&, VectorXd&) const; \
  declaration class ColPivHouseholderQR<MatrixXcd>;                                              \
  declaration class CompleteOrthogonalDecomposition<MatrixXd>;                                   \
  declaration void CompleteOrthogonalDecomposition<MatrixXd>::_solve_impl(const MatrixXd&,       \
                                                                          MatrixXd&) const;      \
  declaration void CompleteOrthogonalDecomposition<MatrixXd>::_solve_impl(const VectorXd&,       \
                                                                          VectorXd&) const;      \
  declaration class LLT<MatrixXd, Lower>;                                                        \
  declaration LLT<MatrixXd, Lower>& LLT<MatrixXd, Lower>::compute(const EigenBase<MatrixXd>&);   \
  declaration class LDLT<MatrixXd, Lower>;                                                       \
  declaration LDLT<MatrixXd, Lower>& LDLT<MatrixXd, Lower>::compute(const EigenBase<MatrixXd>&); \
  }

#define QUADTUNE_EIGEN_EIGENVALUES(declaration)                                                    \
  namespace Eigen {                                                                                \
  declaration class HessenbergDecomposition<MatrixXd>;                                             \
  declaration class RealSchur<MatrixXd>;                                                           \
  declaration RealSchur<MatrixXd>& RealSchur<MatrixXd>::compute(const EigenBase<MatrixXd>&, bool); \
  declaration class EigenSolver<MatrixXd>;                                                         \
  declaration EigenSolver<MatrixXd>& EigenSolver<MatrixXd>::compute(const EigenBase<MatrixXd>&,    \
                                                                    bool);                         \
  declaration class ComplexSchur<MatrixXcd>;                                                       \
  declaration ComplexSchur<MatrixXcd>& ComplexSchur<MatrixXcd>::compute(                           \
      const EigenBase<MatrixXcd>&, bool);                                                          \
  declaration class ComplexEigenSolver<MatrixXcd>;                                                 \
  declaration ComplexEigenSolver<MatrixXcd>& ComplexEigenSolver<MatrixXcd>::compute(               \
      const EigenBase<MatrixXcd>&, bool);                                                          \
  declaration class SelfAdjointEigenSolver<MatrixXd>;                                              \
  declaration SelfAdjointEigenSolver<MatrixXd>& SelfAdjointEigenSolver<MatrixXd>::compute(         \
      const EigenBase<MatrixXd>&, int);                                                            \
  }

#define QUADTUNE_EIGEN_SINGULAR_VALUES(declaration) \
  namespace Eigen {                                 \
  declaration class JacobiSVD<MatrixXd>;            \
  declaration class JacobiSVD<MatrixXcd>;           \
  }

QUADTUNE_EIGEN_PRODUCTS(extern template)
QUADTUNE_EIGEN_FACTORIZATIONS(extern template)
QUADTUNE_EIGEN_EIGENVALUES(extern template)
QUADTUNE_EIGEN_SINGULAR_VALUES(extern template)
