// SPDX-License-Identifier: Apache-2.0
/// Riccati problems: random ones, the hover of a 60 g quadrotor; and residuals computed from the
/// definition.
#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <random>
#include <string>
#include <vector>

namespace quadtune::testing {

struct RiccatiCase {
  Eigen::MatrixXd A;
  Eigen::MatrixXd B;
  Eigen::MatrixXd Q;
  Eigen::MatrixXd R;
  Eigen::MatrixXd N = {};
};

inline Eigen::MatrixXd random_matrix(Eigen::Index rows, Eigen::Index cols,
                                     std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  return Eigen::MatrixXd::NullaryExpr(rows, cols, [&] { return normal(random); });
}

/// Unstable plants with a full Q ≥ 0 and R > 0, and with a cross term that keeps [Q N; Nᵀ R] ≥ 0.
inline RiccatiCase random_case(Eigen::Index nx, Eigen::Index nu, bool discrete, bool cross,
                               std::mt19937_64& random) {
  RiccatiCase c;
  c.A = random_matrix(nx, nx, random);
  if (discrete) c.A /= 0.9 * std::sqrt(static_cast<double>(nx));
  c.B = random_matrix(nx, nu, random);
  const Eigen::MatrixXd C = random_matrix(nx, nx, random);
  const Eigen::MatrixXd D = random_matrix(nx, nu, random);
  c.Q = C.transpose() * C;
  c.R = D.transpose() * D + Eigen::MatrixXd::Identity(nu, nu);
  if (cross) c.N = 0.3 * C.transpose() * D;
  return c;
}

/// ‖residual‖ over the sum of the norms of the terms, by the definition.
inline double riccati_residual(const RiccatiCase& c, const Eigen::MatrixXd& X, bool discrete) {
  const Eigen::MatrixXd N =
      c.N.size() > 0 ? c.N : Eigen::MatrixXd::Zero(c.B.rows(), c.B.cols()).eval();
  const Eigen::MatrixXd XA = X * c.A;
  if (!discrete) {
    const Eigen::MatrixXd F = X * c.B + N;
    const Eigen::MatrixXd quadratic = F * c.R.llt().solve(F.transpose());
    return (XA + XA.transpose() - quadratic + c.Q).norm() /
           (2 * XA.norm() + quadratic.norm() + c.Q.norm());
  }
  const Eigen::MatrixXd F = c.A.transpose() * X * c.B + N;
  const Eigen::MatrixXd S = c.R + c.B.transpose() * X * c.B;
  const Eigen::MatrixXd quadratic = F * S.llt().solve(F.transpose());
  const Eigen::MatrixXd first = c.A.transpose() * XA;
  return (first - X - quadratic + c.Q).norm() /
         (first.norm() + X.norm() + quadratic.norm() + c.Q.norm());
}

/// Names of the states of small_hover().
inline std::vector<std::string> small_hover_names() {
  return {"x", "y", "z", "roll", "pitch", "yaw", "vx", "vy", "vz", "p", "q", "r"};
}

/// Hover of a quadrotor of 63 g in SI units, input wrench [N, N m]: 1/J ≈ 2e4 in addition to g ≈
/// 10.
inline RiccatiCase small_hover() {
  constexpr double mass = 0.063, Jxx = 5.83e-5, Jyy = 7.17e-5, Jzz = 1e-4, g = 9.81;
  RiccatiCase c;
  c.A = Eigen::MatrixXd::Zero(12, 12);
  c.A.block(0, 6, 3, 3).setIdentity();
  c.A.block(3, 9, 3, 3).setIdentity();
  c.A(6, 4) = -g;
  c.A(7, 3) = g;
  c.B = Eigen::MatrixXd::Zero(12, 4);
  c.B(8, 0) = 1 / mass;
  c.B(9, 1) = 1 / Jxx;
  c.B(10, 2) = 1 / Jyy;
  c.B(11, 3) = 1 / Jzz;
  c.Q = Eigen::MatrixXd::Identity(12, 12);
  c.R = Eigen::MatrixXd::Identity(4, 4);
  return c;
}

/// The same, held between samples of dt seconds; the plant is nilpotent, so the series is exact.
inline RiccatiCase small_hover_sampled(double dt) {
  RiccatiCase c = small_hover();
  const Eigen::MatrixXd step = c.A * dt;
  Eigen::MatrixXd term = Eigen::MatrixXd::Identity(12, 12);
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(12, 12);
  Eigen::MatrixXd held = Eigen::MatrixXd::Zero(12, 12);
  for (int k = 1; k <= 4; ++k) {
    A += term;
    held += term * (dt / k);
    term = (term * step / k).eval();
  }
  c.B = (held * c.B).eval();
  c.A = A;
  return c;
}

/// The numbers of a file of Fortran numbers ("1.2D-3", "0.12317-02"), words and lines with letters
/// other than an exponent left out.
inline std::vector<double> fortran_numbers(const std::filesystem::path& path) {
  std::vector<double> numbers;
  std::ifstream file(path);
  for (std::string word; file >> word;) {
    for (char& c : word)
      if (c == 'D' || c == 'd') c = 'E';
    const std::size_t sign = word.find_first_of("+-", 1);
    if (sign != std::string::npos && word[sign - 1] != 'E') word.insert(sign, "E");
    try {
      std::size_t end = 0;
      const double value = std::stod(word, &end);
      if (end == word.size()) numbers.push_back(value);
    } catch (const std::exception&) {
      continue;  // a word of the title
    }
  }
  return numbers;
}

/// Removes a matrix, row by row, from the front of `numbers`.
inline Eigen::MatrixXd take_matrix(std::vector<double>& numbers, Eigen::Index rows,
                                   Eigen::Index cols) {
  Eigen::MatrixXd M(rows, cols);
  for (Eigen::Index i = 0; i < rows; ++i)
    for (Eigen::Index j = 0; j < cols; ++j)
      M(i, j) = numbers.at(static_cast<std::size_t>(i * cols + j));
  numbers.erase(numbers.begin(), numbers.begin() + rows * cols);
  return M;
}

}  // namespace quadtune::testing
