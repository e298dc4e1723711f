// SPDX-License-Identifier: Apache-2.0
#include "riccati/riccati_mixed.hpp"

namespace quadtune::internal {

// --- single precision ---

SingleDoubling::SingleDoubling(Eigen::Index nx, Eigen::Index nu) : DoublingSteps(nx, nu) {
  powers_.reserve(kRoom);
  for (std::size_t i = 0; i < kRoom; ++i) powers_.push_back(ops_.square());
}

bool SingleDoubling::approximate(bool continuous, const DoubleOps& ops,
                                 const DoubleOps::Square& A_tilde, const DoubleOps::Square& G,
                                 const DoubleOps::Square& Q_tilde, int max_iterations,
                                 double& gamma, DoubleOps::Square& X, int& iterations) {
  ops_.convert(ops, A_tilde, 1, A_tilde_);
  ops_.convert(ops, G, 1, G_);
  ops_.convert(ops, Q_tilde, 1, Q_tilde_);
  if (continuous && !start_continuous(gamma)) return false;
  if (!continuous) start_discrete();
  if (!iterate(max_iterations, kTolerance, iterations)) return false;
  gamma = gamma_;
  ops.convert(ops_, H_, 1, X);
  return true;
}

void SingleDoubling::start_powers(bool continuous, const DoubleOps& ops, double gamma,
                                  const DoubleOps::Square& F) {
  continuous_ = continuous;
  sum_gamma_ = gamma;
  kept_ = 0;
  if (continuous) ops_.convert(ops, F, 1, F_);
}

bool SingleDoubling::keep_power(const DoubleOps& ops, const DoubleOps::Square& power) {
  if (kept_ == powers_.size()) return false;
  ops_.convert(ops, power, 1, powers_[kept_++]);
  return true;
}

void SingleDoubling::solve_lyapunov(const DoubleOps& ops, DoubleOps::Square& M) {
  const double size = ops.norm_frobenius(M);
  if (size == 0) return;
  ops_.convert(ops, M, 1 / size, V_);
  if (continuous_) {
    ops_.multiply(V_, F_, T_);
    ops_.multiply_tn_symmetric(F_, T_, V_);
    V_ *= static_cast<float>(2 * sum_gamma_);
  }
  for (std::size_t i = 0; i < kept_; ++i) {
    ops_.multiply(V_, powers_[i], T_);
    ops_.add_product_tn(powers_[i], T_, V_);
  }
  ops.convert(ops_, V_, size, M);
}

// --- single and double precision ---

namespace {

/// Maximum residual of an approximation from which Newton's method converges reliably.
constexpr double kWorthMending = 1e-2;
/// Maximum ratio of successive residuals: a step in single precision gains about three digits until
/// the residual reaches rounding level.
constexpr double kStillGaining = 0.25;
constexpr int kMaxCorrections = 8;
/// Limits relative to the residual due to rounding: below the first another step is not useful;
/// above the second double precision would be better.
constexpr double kGoodEnough = 5;
constexpr double kTooMuch = 10;
/// Maximum norm of a power; sums of larger ones would exceed the accuracy of single precision.
constexpr double kLargestPower = 1e4;
constexpr double kLargestSpread = 64;
/// Maximum relative truncation error of the sums: a power of norm e contributes e², all later ones
/// e⁴.
constexpr double kLeftOut = 1e-3;

}  // namespace

MixedDoubling::MixedDoubling(Eigen::Index nx, Eigen::Index nu)
    : Doubling(nx, nu), single_(nx, nu) {}

bool MixedDoubling::solve(const RiccatiEquation& problem, const Eigen::MatrixXd& factor_R,
                          const RiccatiOptions& options, Candidate& found, SquaredNorms& norms) {
  load(problem, factor_R);
  const bool continuous = problem.time == Time::continuous;
  return solve_from_single(continuous, options, found, norms) ||
         solve_loaded(continuous, options, found, norms);
}

bool MixedDoubling::solve_from_single(bool continuous, const RiccatiOptions& options,
                                      Candidate& found, SquaredNorms& norms) {
  if (!(ops_.scale_spread() <= kLargestSpread)) return false;
  gamma_ = continuous ? ops_.speed(A_tilde_, G_, Q_tilde_) : 1;
  if (!single_.approximate(continuous, ops_, A_tilde_, G_, Q_tilde_, options.max_iterations, gamma_,
                           H_, found.iterations))
    return false;
  Residual now = residual(continuous);
  if (!(now.worst() < kWorthMending) || !keep_powers(continuous)) return false;
  single_.solve_lyapunov(ops_, h0_);
  single_.solve_lyapunov(ops_, h2_);
  if (!correct(continuous, now) || !proof_covers_correction(continuous)) return false;
  publish(continuous, now, found, norms);
  return true;
}

/// Proves in double precision that H_ is stabilizing: the powers of its closed loop converge to 0.
bool MixedDoubling::keep_powers(bool continuous) {
  if (!close_loop(continuous)) return false;
  load_norm_sums(continuous);
  single_.start_powers(continuous, ops_, gamma_, F_);
  for (;;) {
    const double size = ops_.norm_frobenius(E_);
    if (size * size <= kLeftOut) return true;
    if (!(size <= kLargestPower) || !single_.keep_power(ops_, E_)) return false;
    if (std::pow(size, 4) <= kLeftOut) return true;
    ops_.multiply(E_, E_, T_);
    swap(E_, T_);
  }
}

/// Refines X by Newton steps that use the closed loop of the first X, until they no longer reduce
/// the residual sufficiently. False if double precision would attain a smaller residual.
bool MixedDoubling::correct(bool continuous, Residual& now) {
  Square& X_before = G0_;
  for (int step = 0; now.worst() > kGoodEnough * worth_refining_ && step < kMaxCorrections;
       ++step) {
    X_before = H_;
    correction_ = residual_;
    single_.solve_lyapunov(ops_, correction_);
    ops_.add_symmetric(correction_, H_);
    const Residual then = residual(continuous);
    if (!(then.worst() < now.worst())) {
      H_ = X_before;
      now = residual(continuous);
      break;
    }
    const bool gaining = then.worst() < kStillGaining * now.worst();
    now = then;
    if (!gaining) break;
  }
  return now.worst() <= kTooMuch * worth_refining_;
}

}  // namespace quadtune::internal
