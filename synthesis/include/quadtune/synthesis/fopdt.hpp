// SPDX-License-Identifier: Apache-2.0
/// The small models that PID rules are written for, and how to get them from a transfer function.
#pragma once

#include <limits>
#include <string>

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

/// A model, or why there is none.
template <class Model>
struct LagFit {
  Model model;          ///< all NaN unless fitted
  std::string culprit;  ///< e.g. "the pole at 0 does not settle"; empty when fitted

  [[nodiscard]] bool fitted() const { return culprit.empty(); }
};

/// The first-order model whose step response meets the plant's at 28.3 % and 63.2 % of the way
/// (1 - e^(-1/3) and 1 - e^(-1)): time_constant = 1.5 (t63 - t28), delay = t63 - time_constant, at
/// least the plant's own delay. Exact for a plant of this form. Where the plant overshoots or
/// starts the wrong way, the first passages count.
/// @throws InvalidInput  as validate()
/// Source: Smith 1972; Seborg, Edgar, Mellichamp, Doyle 2016, section 7.2.
[[nodiscard]] LagFit<FopdtModel> fit_fopdt(const ContinuousTransferFunction& plant);

/// Skogestad's half rule: half of the largest lag that is left out lengthens the smallest one that
/// is kept, the other half, all smaller lags and all right-half-plane zeros (as 1/zero) become
/// delay. For real stable poles and no zero in the left half-plane.
/// @throws InvalidInput  as validate()
/// Source: Skogestad 2003, section 3.
[[nodiscard]] LagFit<FopdtModel> half_rule_fopdt(const ContinuousTransferFunction& plant);
[[nodiscard]] LagFit<SopdtModel> half_rule_sopdt(const ContinuousTransferFunction& plant);

}  // namespace quadtune
