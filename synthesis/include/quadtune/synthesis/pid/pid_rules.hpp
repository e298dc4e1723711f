// SPDX-License-Identifier: Apache-2.0
/// PID gains by published tuning rules, and the fit of the models that these rules use to a plant.
#pragma once

#include <limits>
#include <string>

#include "quadtune/synthesis/pid/pid_gains.hpp"
#include "quadtune/transfer_function.hpp"

namespace quadtune {

/// First order plus dead time: gain e^(-delay s) / (time_constant s + 1).
struct FopdtModel {
  double gain = std::numeric_limits<double>::quiet_NaN();           ///< [output / input]
  double time_constant = std::numeric_limits<double>::quiet_NaN();  ///< [s]
  double delay = std::numeric_limits<double>::quiet_NaN();          ///< [s]
};

/// Second order plus dead time: gain e^(-delay s) / ((time_constant s + 1)(second s + 1)).
struct SopdtModel {
  double gain = std::numeric_limits<double>::quiet_NaN();           ///< [output / input]
  double time_constant = std::numeric_limits<double>::quiet_NaN();  ///< the larger [s]
  double second = std::numeric_limits<double>::quiet_NaN();         ///< the smaller [s]
  double delay = std::numeric_limits<double>::quiet_NaN();          ///< [s]
};

/// A fitted model, or the reason why it cannot be fitted.
template <class Model>
struct LagFit {
  Model model;          ///< all NaN unless fitted
  std::string culprit;  ///< e.g. "the pole at 0 does not settle"; empty when fitted

  [[nodiscard]] bool fitted() const { return culprit.empty(); }  ///< whether there is a model
};

/// Computes the first-order model whose step response equals that of the plant at 28.3 % and 63.2 %
/// of the final value (1 - e^(-1/3) and 1 - e^(-1)): time_constant = 1.5 (t63 - t28), and
/// delay = t63 - time_constant, but not less than the plant's own delay. Exact for a plant of this
/// form. If the plant overshoots or has an inverse response, t28 and t63 are the first times at
/// which the response reaches these values.
/// @throws InvalidInput  for the reasons of validate()
/// Source: Smith 1972; Seborg, Edgar, Mellichamp, Doyle 2016, section 7.2.
[[nodiscard]] LagFit<FopdtModel> fit_fopdt(const ContinuousTransferFunction& plant);

/// Computes a model by Skogestad's half rule: half of the largest neglected lag is added to the
/// smallest retained one; the other half, all smaller lags and all right-half-plane zeros (as
/// 1/zero) are added to the delay. The poles must be real and stable, without zeros in the left
/// half-plane.
/// @throws InvalidInput  for the reasons of validate()
/// Source: Skogestad 2003, section 3.
[[nodiscard]] LagFit<FopdtModel> half_rule_fopdt(const ContinuousTransferFunction& plant);

/// The same with two lags.
[[nodiscard]] LagFit<SopdtModel> half_rule_sopdt(const ContinuousTransferFunction& plant);

/// N of the derivative filter Tf = Td / N that all rules below add; the sources do not prescribe
/// one. An infinite N means no filter.
inline constexpr double kPidFilterRatio = 10;

/// Ziegler and Nichols, from the step response: K = T/(gain L) · {1; 0.9; 1.2} for {P; PI; PID},
/// Ti = L/0.3 (PI) or 2 L (PID), Td = L/2. Here and below, T is the time_constant of the model [s]
/// and L its delay [s].
/// @param type   P, PI or PID
/// @param model  fitted to the step response
/// @param N      Tf = Td / N, > 0
/// @throws InvalidInput  unless the gain is finite and not 0 and T, L, N > 0; for type PD.
/// Source: Ziegler and Nichols 1942.
[[nodiscard]] PidGains ziegler_nichols_step(PidType type, const FopdtModel& model,
                                            double N = kPidFilterRatio);

/// Ziegler and Nichols, from the limit of stability: K = Ku · {0.5; 0.45; 0.6}, Ti = Tu/1.2 (PI),
/// Tu/2 (PID), Td = Tu/8.
/// @param type             P, PI or PID
/// @param ultimate_gain    Ku, the gain at which a proportional loop oscillates; not 0
/// @param ultimate_period  Tu, of that oscillation [s], > 0
/// @param N                Tf = Td / N, > 0
/// @throws InvalidInput  if a number is out of range; for type PD.
/// Source: Ziegler and Nichols 1942.
[[nodiscard]] PidGains ziegler_nichols_ultimate(PidType type, double ultimate_gain,
                                                double ultimate_period, double N = kPidFilterRatio);

/// Cohen and Coon: dominant closed-loop poles with quarter amplitude decay. With r = L/T,
///
///     P    K = (1/(gain r)) (1 + r/3)
///     PI   K = (1/(gain r)) (9/10 + r/12),  Ti = L (30 + 3 r)/(9 + 20 r)
///     PD   K = (1/(gain r)) (5/4 + r/6),    Td = L (6 - 2 r)/(22 + 3 r), for r < 3
///     PID  K = (1/(gain r)) (4/3 + r/4),    Ti = L (32 + 6 r)/(13 + 8 r),  Td = 4 L/(11 + 2 r)
///
/// @throws InvalidInput  unless the gain is finite and not 0 and T, L, N > 0; for PD with L ≥ 3 T.
/// Source: Cohen and Coon 1953.
[[nodiscard]] PidGains cohen_coon(PidType type, const FopdtModel& model,
                                  double N = kPidFilterRatio);

/// AMIGO, a fit to the gains with the maximum Ki at Ms = Mt = 1.4:
///
///     PI   K = 0.15/gain + (0.35 - L T/(L + T)²) T/(gain L),
///          Ti = 0.35 L + 13 L T²/(T² + 12 L T + 7 L²)
///     PID  K = (0.2 + 0.45 T/L)/gain,  Ti = L (0.4 L + 0.8 T)/(L + 0.1 T),
///          Td = 0.5 L T/(0.3 L + T)
///
/// @param type   PI or PID
/// @param model  fitted to the plant
/// @param N      Tf = Td / N, > 0
/// @throws InvalidInput  unless the gain is finite and not 0 and T, L, N > 0; for other types.
/// Source: Åström and Hägglund 2006, chapter 7.
[[nodiscard]] PidGains amigo(PidType type, const FopdtModel& model, double N = kPidFilterRatio);

/// SIMC, PI: K = T/(gain (tau_c + L)), Ti = min(T, 4 (tau_c + L)).
/// @param model  fitted to the plant
/// @param tau_c  desired time constant of the closed loop [s], > -L; the source recommends L for
///               tight control
/// @throws InvalidInput  unless the gain is finite and not 0, T > 0, L ≥ 0 and tau_c + L > 0.
/// Source: Skogestad 2003.
[[nodiscard]] PidGains simc(const FopdtModel& model, double tau_c);

/// SIMC, PID: the same rule in series form, K' (1 + 1/(Ti' s)) (1 + Td' s), with Td' the second
/// time constant, written as K = K' f, Ti = Ti' f, Td = Td'/f, f = 1 + Td'/Ti'.
/// @throws InvalidInput  for the same reasons, if the second time constant is negative, or N ≤ 0.
[[nodiscard]] PidGains simc(const SopdtModel& model, double tau_c, double N = kPidFilterRatio);

/// Lambda tuning (IMC): inverts the model, with e^(-L s) approximated by 1 - L s (PI) or by the
/// first-order Padé approximation (PID). The closed loop is approximately e^(-L s)/(lambda s + 1).
///
///     PI   K = T/(gain (lambda + L)),  Ti = T
///     PID  K = (T + L/2)/(gain (lambda + L/2)),  Ti = T + L/2,  Td = T L/(2 T + L)
///
/// @param type    PI or PID
/// @param model   fitted to the plant
/// @param lambda  desired time constant of the closed loop [s], > 0
/// @param N       Tf = Td / N, > 0
/// @throws InvalidInput  unless the gain is finite and not 0, L ≥ 0 and T, lambda, N > 0; for other
///                       types.
/// Source: Rivera, Morari, Skogestad 1986.
[[nodiscard]] PidGains lambda_tuning(PidType type, const FopdtModel& model, double lambda,
                                     double N = kPidFilterRatio);

/// Pole placement: the PI controller for gain/(T s + 1) whose closed-loop poles are the roots of
/// s² + 2 zeta w0 s + w0² = 0:
/// Kp = (2 zeta w0 T - 1)/gain, Ki = w0² T/gain.
/// @param gain           of the plant [output / input], not 0
/// @param time_constant  T [s], > 0
/// @param w0             [rad/s], > 0
/// @param zeta           damping ratio, > 0
/// @throws InvalidInput  if a number is out of range, or the gain is 0
[[nodiscard]] PidGains pi_by_poles(double gain, double time_constant, double w0, double zeta);

}  // namespace quadtune
