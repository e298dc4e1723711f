// SPDX-License-Identifier: Apache-2.0
#include "quadtune/synthesis/pole_placement.hpp"

#include <fmt/format.h>

#include <Eigen/LU>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <vector>

#include "lyapunov/eigenvalues.hpp"
#include "lyapunov/lapack.hpp"
#include "lyapunov/mode_names.hpp"
#include "quadtune/errors.hpp"
#include "quadtune/internal/counted.hpp"
#include "quadtune/matrix_checks.hpp"

namespace quadtune {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXcd;
using Complex = std::complex<double>;

namespace {

/// A gain below this share of the norm of B is rounding.
constexpr double kUncontrollable = 1e-12;

/// The poles that are still to be placed: real ones, and one of each complex pair.
struct WantedPoles {
  std::vector<double> real;
  std::vector<Complex> complex;  // imag > 0
};

WantedPoles split(const VectorXcd& poles) {
  WantedPoles wanted;
  std::vector<Complex> below;
  for (const Complex& pole : poles) {
    if (pole.imag() == 0)
      wanted.real.push_back(pole.real());
    else
      (pole.imag() > 0 ? wanted.complex : below).push_back(pole);
  }
  for (const Complex& pole : wanted.complex) {
    const auto conjugate = std::find_if(below.begin(), below.end(), [&](const Complex& other) {
      return std::abs(other - std::conj(pole)) <= 1e-9 * std::abs(pole);
    });
    if (conjugate == below.end())
      throw InvalidInput(
          "place_poles",
          fmt::format("pole {} has no conjugate, expected complex poles in conjugate "
                      "pairs because the gain is real",
                      internal::format_number(pole)));
    below.erase(conjugate);
  }
  if (!below.empty())
    throw InvalidInput("place_poles",
                       fmt::format("pole {} has no conjugate, expected complex poles in conjugate "
                                   "pairs because the gain is real",
                                   internal::format_number(below.front())));
  return wanted;
}

/// Removes and returns the entry that is nearest to a value.
template <class Number>
Number take_nearest(std::vector<Number>& from, Complex value) {
  const auto nearest =
      std::min_element(from.begin(), from.end(), [&](const Number& a, const Number& b) {
        return std::abs(Complex(a) - value) < std::abs(Complex(b) - value);
      });
  const Number taken = *nearest;
  from.erase(nearest);
  return taken;
}

/// A - B K in the real Schur form U T Uᵀ. Its first `placed` eigenvalues are final.
class Placement {
 public:
  Placement(const MatrixXd& A, const MatrixXd& B)
      : n_(A.rows()),
        A_(A),
        B_(B),
        T_(A),
        U_(A.rows(), A.rows()),
        K_(MatrixXd::Zero(B.cols(), A.rows())) {
    Eigen::VectorXd real(n_), imaginary(n_);
    lapack_int count = 0;
    const auto n = static_cast<lapack_int>(n_);
    valid_ = LAPACKE_dgees(LAPACK_COL_MAJOR, 'V', 'N', nullptr, n, T_.data(), n, &count,
                           real.data(), imaginary.data(), U_.data(), n) == 0;
  }

  [[nodiscard]] bool valid() const { return valid_; }
  [[nodiscard]] const MatrixXd& K() const { return K_; }
  [[nodiscard]] const std::string& culprit() const { return culprit_; }
  [[nodiscard]] bool controllable() const { return controllable_; }

  /// Places all poles.
  /// @return  false if a mode cannot be moved, or LAPACK could not exchange two eigenvalues
  bool place(WantedPoles wanted) {
    while (placed_ < n_) {
      const bool is_pair = n_ - placed_ >= 2 && T_(n_ - 1, n_ - 2) != 0;
      if (!is_pair && !wanted.real.empty()) {
        if (!place_one(take_nearest(wanted.real, T_(n_ - 1, n_ - 1)))) return false;
        continue;
      }
      // All that remain are pairs: a second real eigenvalue is moved next to the last one.
      if (!is_pair && !pair_last()) return false;
      const Eigen::Matrix2d last = T_.bottomRightCorner<2, 2>();
      const VectorXcd now = internal::eigenvalues(last);
      Complex p, q;
      if (!wanted.complex.empty()) {
        p = take_nearest(wanted.complex, now[0].imag() >= 0 ? now[0] : now[1]);
        q = std::conj(p);
      } else {
        p = take_nearest(wanted.real, now[0]);
        q = take_nearest(wanted.real, now[1]);
      }
      if (!place_two(p, q)) return false;
    }
    return true;
  }

 private:
  /// The last rows of Uᵀ B, through which the last eigenvalues are moved.
  [[nodiscard]] MatrixXd last_inputs(Index rows) const {
    return U_.rightCols(rows).transpose() * B_;
  }

  /// u = -[0 F] Uᵀ x changes the last columns of T only.
  void feed_back(const MatrixXd& F) {
    const Index s = F.cols();
    K_ += F * U_.rightCols(s).transpose();
    T_.rightCols(s) -= U_.transpose() * B_ * F;
  }

  bool place_one(double wanted) {
    const MatrixXd g = last_inputs(1);  // (1 × nu)
    const double change = T_(n_ - 1, n_ - 1) - wanted;
    const double scale = std::max({std::abs(wanted), std::abs(T_(n_ - 1, n_ - 1)), 1e-300});
    if (std::abs(change) > kUncontrollable * scale) {
      if (g.norm() <= kUncontrollable * B_.norm())
        return cannot_move(VectorXcd::Constant(1, T_(n_ - 1, n_ - 1)));
      feed_back(g.transpose() * (change / g.squaredNorm()));  // g f = change
    }
    return move_up(1);
  }

  /// Gives the last two eigenvalues the sum p + q and the product p q.
  bool place_two(Complex p, Complex q) {
    const Eigen::Matrix2d T2 = T_.bottomRightCorner<2, 2>();
    const MatrixXd G = last_inputs(2);  // (2 × nu)
    const Eigen::JacobiSVD<MatrixXd> svd(G, Eigen::ComputeThinU | Eigen::ComputeThinV);
    const Eigen::VectorXd& sigma = svd.singularValues();
    if (sigma[0] <= kUncontrollable * B_.norm()) {
      const VectorXcd now = internal::eigenvalues(T2);
      const double scale = std::max(std::abs(now[0]), 1e-300);
      if (std::abs(p + q - T2.trace()) > 1e-9 * scale ||
          std::abs(p * q - T2.determinant()) > 1e-9 * scale * scale)
        return cannot_move(now);
    } else if (sigma.size() > 1 && sigma[1] > 1e-3 * sigma[0]) {
      // Two independent inputs: T2 - G F may be any matrix, here one that is near T2.
      feed_back(svd.solve(T2 - near_matrix(T2, p, q)));
    } else {
      // The direction of the inputs that has the most effect, b, and Ackermann's formula for it:
      // f = [0 1] [b T2 b]⁻¹ (T2² - (p + q) T2 + p q I).
      const Eigen::Vector2d b = svd.matrixU().col(0) * sigma[0];
      Eigen::Matrix2d reach;
      reach << b, T2 * b;
      const double size = b.norm() * (T2 * b).norm();
      if (!(std::abs(reach.determinant()) > kUncontrollable * std::max(size, 1e-300)))
        return cannot_move(internal::eigenvalues(T2));
      const Eigen::Matrix2d polynomial =
          T2 * T2 - (p + q).real() * T2 + (p * q).real() * Eigen::Matrix2d::Identity();
      const Eigen::RowVector2d f = Eigen::RowVector2d(0, 1) * reach.inverse() * polynomial;
      feed_back(svd.matrixV().col(0) * f);
    }
    return standardize_last() && move_up(2);
  }

  /// A real matrix with the eigenvalues p and q that resembles T2.
  static Eigen::Matrix2d near_matrix(const Eigen::Matrix2d& T2, Complex p, Complex q) {
    Eigen::Matrix2d M;
    if (p.imag() != 0) {
      const double ratio = T2(0, 1) != 0 && T2(1, 0) != 0 ? std::abs(T2(0, 1) / T2(1, 0)) : 1;
      const double s = std::sqrt(std::clamp(ratio, 1e-6, 1e6));
      const double sign = T2(0, 1) < 0 ? -1 : 1;
      M << p.real(), sign * p.imag() * s, -sign * p.imag() / s, p.real();
    } else {
      M << p.real(), T2(0, 1), 0, q.real();
    }
    return M;
  }

  /// Brings the last block, which feedback has filled, to Schur form.
  bool standardize_last() {
    Eigen::Matrix2d block = T_.bottomRightCorner<2, 2>();
    Eigen::Matrix2d Z;
    Eigen::Vector2d real, imaginary;
    lapack_int count = 0;
    if (LAPACKE_dgees(LAPACK_COL_MAJOR, 'V', 'N', nullptr, 2, block.data(), 2, &count, real.data(),
                      imaginary.data(), Z.data(), 2) != 0)
      return false;
    T_.rightCols(2) = (T_.rightCols(2) * Z).eval();
    U_.rightCols(2) = (U_.rightCols(2) * Z).eval();
    T_.bottomRightCorner<2, 2>() = block;
    return true;
  }

  /// Moves the eigenvalue at row `from` (1-based) to row `to`.
  bool exchange(Index from, Index to) {
    auto first = static_cast<lapack_int>(from);
    auto last = static_cast<lapack_int>(to);
    const auto n = static_cast<lapack_int>(n_);
    return from == to ||
           LAPACKE_dtrexc(LAPACK_COL_MAJOR, 'V', n, T_.data(), n, U_.data(), n, &first, &last) == 0;
  }

  /// Moves the last `size` eigenvalues above all that are not placed.
  bool move_up(Index size) {
    const bool is_pair = size == 2 && T_(n_ - 1, n_ - 2) != 0;
    if (is_pair || size == 1) {
      if (!exchange(n_ - size + 1, placed_ + 1)) return false;
    } else if (!exchange(n_ - 1, placed_ + 1) || !exchange(n_, placed_ + 2)) {
      return false;
    }
    placed_ += size;
    return true;
  }

  /// Moves the nearest real eigenvalue above the last one next to it.
  bool pair_last() {
    for (Index i = n_ - 2; i >= placed_; --i) {
      if (i > placed_ && T_(i, i - 1) != 0) {
        --i;
        continue;
      }
      return exchange(i + 1, n_ - 1);
    }
    return false;
  }

  /// The large gains of poles far away hide the effect of the inputs on the other modes in rounding
  /// errors. The test of Popov, Belevitch and Hautus with the given plant distinguishes this from
  /// a mode that no input moves.
  ///
  /// @param modes  one or two, of which the less controllable one is named
  bool cannot_move(const VectorXcd& modes) {
    const VectorXcd of_plant = internal::eigenvalues(A_);
    std::vector<Complex> given(of_plant.begin(), of_plant.end());
    Complex culprit;
    double smallest = std::numeric_limits<double>::infinity();
    for (Complex mode : modes) {
      if (!given.empty()) mode = take_nearest(given, mode);
      const double margin = controllability(mode);
      if (!(margin < smallest)) continue;
      smallest = margin;
      culprit = mode;
    }
    controllable_ = smallest > 1e-9;
    culprit_ = controllable_
                   ? fmt::format(
                         "the requested poles are so far from those of the plant that "
                         "rounding hides how the inputs move the mode at {}; expected poles "
                         "nearer to those of the plant",
                         internal::format_mode(culprit))
                   : fmt::format("mode at {} cannot be controlled", internal::format_mode(culprit));
    return false;
  }

  /// Relative distance of [A - λ I, B] from a matrix of lower rank.
  [[nodiscard]] double controllability(Complex mode) const {
    Eigen::MatrixXcd pencil(n_, n_ + B_.cols());
    pencil << A_.cast<Complex>() - mode * Eigen::MatrixXcd::Identity(n_, n_),
        (B_ * (std::max(A_.norm(), 1e-300) / std::max(B_.norm(), 1e-300))).cast<Complex>();
    const Eigen::VectorXd sigma = Eigen::JacobiSVD<Eigen::MatrixXcd>(pencil).singularValues();
    return sigma[n_ - 1] / std::max(sigma[0], 1e-300);
  }

  Index n_;
  MatrixXd A_, B_, T_, U_, K_;
  Index placed_ = 0;
  bool valid_ = false;
  bool controllable_ = true;  // whether the mode of the culprit is controllable in the given plant
  std::string culprit_;
};

/// Distances between the requested poles and the computed ones.
struct PoleErrors {
  double largest = 0;
  double largest_relative = 0;  ///< to the larger of the pole itself and the poles of the plant
};

/// Pairs each requested pole with the nearest computed one that is left.
/// @param plant  magnitude of the largest pole of the plant
PoleErrors errors_of(const VectorXcd& wanted, const VectorXcd& computed, double plant) {
  std::vector<Complex> left(computed.begin(), computed.end());
  PoleErrors errors;
  for (const Complex& pole : wanted) {
    const double distance = std::abs(take_nearest(left, pole) - pole);
    errors.largest = std::max(errors.largest, distance);
    const double size = std::max(std::abs(pole), plant);
    if (size > 0) errors.largest_relative = std::max(errors.largest_relative, distance / size);
  }
  return errors;
}

/// The largest number of requested poles that are equal.
double multiplicity(const VectorXcd& poles) {
  Index most = 1;
  for (const Complex& pole : poles)
    most = std::max(most, Index{((poles.array() - pole).abs() <= 1e-6 * std::abs(pole)).count()});
  return static_cast<double>(most);
}

}  // namespace

std::string to_string(PolePlacementStatus status) {
  switch (status) {
    case PolePlacementStatus::solved:
      return "solved";
    case PolePlacementStatus::not_controllable:
      return "not controllable";
    case PolePlacementStatus::inaccurate:
      return "inaccurate";
    case PolePlacementStatus::not_run:
      break;
  }
  return "not run";
}

PolePlacement place_poles(const Eigen::Ref<const MatrixXd>& A, const Eigen::Ref<const MatrixXd>& B,
                          const Eigen::Ref<const VectorXcd>& poles, double tolerance) {
  const char* where = "place_poles";
  const Index n = A.rows();
  if (n == 0 || B.cols() == 0)
    throw InvalidInput(where, "A or B is empty, expected at least one state and one input");
  require_shape(A, n, n, where, "A", "A must be square");
  if (B.rows() != n)
    throw InvalidInput(where, fmt::format("B is {}, expected {} (A is {})", shape(B),
                                          internal::counted(n, "row"), shape(A)));
  require_finite(A, where, "A");
  require_finite(B, where, "B");
  if (poles.size() != n || !poles.allFinite())
    throw InvalidInput(where, fmt::format("poles has {}, expected {}, one per state",
                                          internal::counted(poles.size(), "entry", "entries"),
                                          internal::counted(n, "finite number")));
  PolePlacement result;
  result.K = MatrixXd::Constant(B.cols(), n, std::numeric_limits<double>::quiet_NaN());
  Placement placement(A, B);
  WantedPoles wanted = split(poles);
  if (!placement.valid() || !placement.place(std::move(wanted))) {
    result.status = placement.culprit().empty() || placement.controllable()
                        ? PolePlacementStatus::inaccurate
                        : PolePlacementStatus::not_controllable;
    result.culprit = placement.culprit().empty()
                         ? "the eigenvalues of A could not be computed or ordered"
                         : placement.culprit();
    return result;
  }
  const VectorXcd computed = internal::eigenvalues(A - B * placement.K());
  const double plant = internal::eigenvalues(A).cwiseAbs().maxCoeff();
  constexpr double kNone = std::numeric_limits<double>::infinity();
  const PoleErrors errors =
      computed.size() == n ? errors_of(poles, computed, plant) : PoleErrors{kNone, kNone};
  const double scale = std::max({poles.cwiseAbs().maxCoeff(), plant, 1e-300});
  // A pole of multiplicity m moves by the m-th root of a change of the matrix.
  const double allowed = std::max(
      tolerance, 100 * std::pow(std::numeric_limits<double>::epsilon(), 1 / multiplicity(poles)));
  // A pole that is far smaller than another one is accurate only if its own error is small.
  const double allowed_of_each = std::max(allowed, 1e-3);
  result.error = errors.largest;
  if (!placement.K().allFinite() || !(errors.largest <= allowed * scale) ||
      !(errors.largest_relative <= allowed_of_each)) {
    result.status = PolePlacementStatus::inaccurate;
    result.culprit = fmt::format(
        "a computed pole differs from the requested one by {:.2g}: the plant is nearly "
        "uncontrollable, or the poles are too far from those of the plant or from one another",
        errors.largest);
    return result;
  }
  result.status = PolePlacementStatus::solved;
  result.K = placement.K();
  result.poles = computed;
  return result;
}

}  // namespace quadtune
