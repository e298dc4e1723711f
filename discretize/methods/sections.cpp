// SPDX-License-Identifier: Apache-2.0
#include "methods/sections.hpp"

#include <algorithm>
#include <complex>
#include <optional>
#include <utility>
#include <vector>

namespace quadtune::internal {
namespace {

using Complex = std::complex<double>;
using Eigen::Index;
using Eigen::MatrixXd;
using Pair = std::pair<Complex, Complex>;

/// Roots in pairs: conjugate pairs, then real roots in their order; a remaining root is real.
struct Grouped {
  std::vector<Pair> pairs;
  std::optional<double> single;
};

Grouped grouped(const Eigen::VectorXcd& roots) {
  Grouped groups;
  std::vector<double> real;
  for (const Complex& root : roots) {
    if (root.imag() > 0) groups.pairs.emplace_back(root, std::conj(root));
    if (root.imag() == 0) real.push_back(root.real());
  }
  std::sort(real.begin(), real.end());
  if (real.size() % 2 == 1) {
    groups.single = real.back();
    real.pop_back();
  }
  for (std::size_t i = 0; i < real.size(); i += 2) groups.pairs.emplace_back(real[i], real[i + 1]);
  return groups;
}

struct Section {
  MatrixXd A, B, C;
  double D = 0;
};

/// A first-order section with one zero or none.
Section first_order(double pole, const std::optional<double>& zero) {
  Section section;
  section.A = MatrixXd::Constant(1, 1, pole);
  section.B = MatrixXd::Ones(1, 1);
  section.C = MatrixXd::Constant(1, 1, zero ? pole - *zero : 1);
  section.D = zero ? 1 : 0;
  return section;
}

/// A contains the poles directly. With y = z - a, where a is the first diagonal entry of A, the
/// zeros contribute, in addition to D, (n1 y + n0) divided by the denominator.
Section second_order(const Pair& poles, double n1, double n0, double D) {
  Section section;
  section.A = MatrixXd(2, 2);
  section.B = Eigen::Vector2d(0, 1);
  section.D = D;
  const double imaginary = poles.first.imag();
  if (imaginary != 0) {
    // x2 = y/(y² + w²), x1 = w/(y² + w²)
    section.A << poles.first.real(), imaginary, -imaginary, poles.first.real();
    section.C = Eigen::RowVector2d(n0 / imaginary, n1);
  } else {
    // x2 = 1/(z - p2), x1 = 1/((z - p1)(z - p2))
    section.A << poles.first.real(), 1, 0, poles.second.real();
    section.C = Eigen::RowVector2d(n0, n1);
  }
  return section;
}

Section two_zeros(const Pair& poles, const Pair& zeros) {
  const double a = poles.first.real();
  const double w = poles.first.imag();
  // (z - q1)(z - q2) - (z - p1)(z - p2) = n1 y + n0
  const double n1 = (poles.first + poles.second - zeros.first - zeros.second).real();
  const double n0 = ((zeros.first - a) * (zeros.second - a)).real() - w * w;
  return second_order(poles, n1, n0, 1);
}

Section one_zero(const Pair& poles, double zero) {
  return second_order(poles, 1, poles.first.real() - zero, 0);
}

double value_at(const Section& section, double z) {
  const Index n = section.A.rows();
  if (n == 1) return section.C(0, 0) / (z - section.A(0, 0)) + section.D;
  const Eigen::Matrix2d M = z * Eigen::Matrix2d::Identity() - section.A;
  const double determinant = M(0, 0) * M(1, 1) - M(0, 1) * M(1, 0);
  // M⁻¹ (0, 1)ᵀ
  const Eigen::Vector2d x(-M(0, 1) / determinant, M(0, 0) / determinant);
  return section.C.row(0).dot(x) + section.D;
}

std::vector<Section> sections_of(const Grouped& poles, const Grouped& zeros) {
  std::vector<Section> sections;
  std::size_t next = 0;
  std::optional<double> single = zeros.single;
  if (poles.single) {
    sections.push_back(first_order(*poles.single, single));
    single.reset();
  }
  for (const Pair& pair : poles.pairs) {
    if (next < zeros.pairs.size()) {
      sections.push_back(two_zeros(pair, zeros.pairs[next++]));
    } else if (single) {
      sections.push_back(one_zero(pair, *single));
      single.reset();
    } else {
      sections.push_back(second_order(pair, 0, 1, 0));
    }
  }
  return sections;
}

}  // namespace

DiscreteLti series_of_sections(const Eigen::VectorXcd& poles, const Eigen::VectorXcd& zeros,
                               double z, double value, double dt) {
  const std::vector<Section> sections = sections_of(grouped(poles), grouped(zeros));
  DiscreteLti plant;
  plant.dt = dt;
  plant.A = MatrixXd::Zero(poles.size(), poles.size());
  plant.B = MatrixXd::Zero(poles.size(), 1);
  plant.C = MatrixXd::Zero(1, poles.size());
  plant.D = MatrixXd::Ones(1, 1);
  Index at = 0;
  for (Section section : sections) {
    // Each section has gain 1 at z, so that the signals between sections are well scaled.
    const double here = value_at(section, z);
    section.C /= here;
    section.D /= here;
    const Index n = section.A.rows();
    plant.A.block(at, at, n, n) = section.A;
    plant.A.block(at, 0, n, at) = section.B * plant.C.leftCols(at);
    plant.B.middleRows(at, n) = section.B * plant.D;
    plant.C *= section.D;
    plant.C.middleCols(at, n) = section.C;
    plant.D *= section.D;
    at += n;
  }
  plant.C *= value;
  plant.D *= value;
  return plant;
}

}  // namespace quadtune::internal
