// SPDX-License-Identifier: Apache-2.0
#include "quadtune/internal/small_matrix.hpp"

#include <gmock/gmock.h>

#include <Eigen/Dense>
#include <cmath>
#include <cstdint>
#include <limits>

#include "matrix_near.hpp"

namespace quadtune::internal {
namespace {

using Eigen::MatrixXd;
using V = Vector<double, 4>;
using Rows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// Small integers, whose sums and products are exact; stored row by row.
VectorStorage<V> numbers(int rows, int columns, int seed) {
  VectorStorage<V> M(rows * columns / 4);
  for (int i = 0; i < rows * columns; ++i) M.data()[i] = (i * i + seed * i + seed) % 11 - 5;
  return M;
}
Rows as_matrix(const VectorStorage<V>& M, int rows, int columns) {
  return Eigen::Map<const Rows>(M.data(), rows, columns);
}
template <int kRows, int kVectors>
Rows as_matrix(const Tile<V, kRows, kVectors>& tile) {
  return Eigen::Map<const Rows>(reinterpret_cast<const double*>(tile.at), kRows,
                                Eigen::Index{4} * kVectors);
}

TEST(SmallMatrix, VectorsHaveTheArithmeticOfTheirElements) {
  const V x = {-3, 0, 2, -0.0};
  EXPECT_EQ(total(x), -1);
  EXPECT_EQ(total(abs_of(x)), 5);
  EXPECT_FALSE(std::signbit(abs_of(x)[3]));
  EXPECT_EQ(total(multiply_add(x, x, broadcast<V>(1))), 17);      // Σ (x² + 1)
  EXPECT_EQ(total(subtract_product(x, x, broadcast<V>(1))), -9);  // Σ (1 - x²)
  EXPECT_EQ(total(square_root(broadcast<V>(9))), 12);
  EXPECT_EQ(square_root(16.0), 4);
}

TEST(SmallMatrix, TileSumsAProductOverTheInnerIndicesThatAreGiven) {
  const VectorStorage<V> A = numbers(4, 8, 3);
  const VectorStorage<V> B = numbers(8, 8, 7);
  const Rows a = as_matrix(A, 4, 8);
  const Rows b = as_matrix(B, 8, 8);
  Tile<V, 4, 2> tile;
  tile.add_product(0, 8, entries_of<V>(A.data(), 8, 1), vectors_of<V>(B.data(), 8));
  EXPECT_EQ(as_matrix(tile), a * b);
  tile.subtract_product_of(2, 5, entries_of<V>(A.data(), 8, 1), vectors_of<V>(B.data(), 8));
  EXPECT_EQ(as_matrix(tile), a * b - a.middleCols(2, 3) * b.middleRows(2, 3));
}

TEST(SmallMatrix, TileIsSolvedWithAUnitTriangle) {
  const VectorStorage<V> L = numbers(4, 4, 2);
  const VectorStorage<V> X = numbers(4, 8, 5);
  Tile<V, 4, 2> tile;
  tile.set(vectors_of<V>(X.data(), 8));
  tile.solve_unit_lower(entries_of<V>(L.data(), 4, 1));
  const MatrixXd l = as_matrix(L, 4, 4).triangularView<Eigen::UnitLower>();
  EXPECT_EQ(l * as_matrix(tile), as_matrix(X, 4, 8));
}

TEST(SmallMatrix, InverseOfACholeskyFactor) {
  const MatrixXd L{{2, 0, 0}, {1, 4, 0}, {-3, 5, 1}};
  const auto positive = [](double pivot, double /*entry*/) { return pivot > 0; };
  MatrixXd S = L * L.transpose();
  ASSERT_TRUE(factor_cholesky(3, S, positive));
  EXPECT_EQ(MatrixXd(S.triangularView<Eigen::Lower>()), L);
  MatrixXd inverse = MatrixXd::Constant(3, 3, std::numeric_limits<double>::quiet_NaN());
  invert_lower(3, S, inverse);
  EXPECT_THAT(inverse, testing::MatrixNear(L.inverse(), 1e-15));
  MatrixXd indefinite{{1, 2}, {2, 1}};
  EXPECT_FALSE(factor_cholesky(2, indefinite, positive));
}

template <class Storage>
void check_storage() {
  Storage a(2);
  Storage b(2);
  EXPECT_EQ(total(a.begin()[0] + a.begin()[1]), 0);
  EXPECT_EQ(reinterpret_cast<std::uintptr_t>(a.data()) % 64, 0U);
  a = 3;
  b = a;
  b *= 2;
  b += a;
  EXPECT_EQ(total(b.begin()[1]), 36);
  a.set_difference(b, a);
  EXPECT_EQ(total(a.begin()[1]), 24);
  swap(a, b);
  EXPECT_EQ(a[7], 9);
  EXPECT_EQ(b[7], 6);
}

TEST(SmallMatrix, StorageIsZeroAndAlignedAndIsCopiedByValue) {
  check_storage<VectorStorage<V>>();     // on the heap
  check_storage<VectorStorage<V, 2>>();  // in place
}

}  // namespace
}  // namespace quadtune::internal
