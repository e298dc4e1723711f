// SPDX-License-Identifier: Apache-2.0
/// Uncertain parameters of a flight: their distributions and their values in one of many flights.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <string>
#include <vector>

#include "quadtune/simulation/flight.hpp"

namespace quadtune {

/// How a drawn number modifies the nominal value.
enum class QuantityKind {
  ratio,     ///< multiplies the value in the vehicle file; 1 changes nothing
  addition,  ///< added to that value; 0 changes nothing
  value,     ///< replaces that value
};

/// A parameter that may be uncertain.
struct UncertainQuantity {
  std::string name;                         ///< e.g. "mass", "wind_north", "gyroscope_noise"
  std::string unit;                         ///< of the drawn number; "1" for a ratio
  QuantityKind kind = QuantityKind::ratio;  ///< how the drawn number is applied
  double min = 0;                           ///< smallest accepted value
  double max = 0;                           ///< largest accepted value
  std::string meaning;                      ///< description in one line
};

/// All uncertain quantities, in the order of the documentation.
[[nodiscard]] const std::vector<UncertainQuantity>& uncertain_quantities();

/// The quantity with that name.
/// @throws InvalidInput  "where: no quantity 'mas', expected …; did you mean 'mass'?"
[[nodiscard]] const UncertainQuantity& uncertain_quantity(const std::string& name,
                                                          const std::string& where);

/// Kinds of distributions.
enum class DistributionKind { normal, uniform, log_normal };
/// "normal", "uniform", "log_normal".
[[nodiscard]] std::string to_string(DistributionKind kind);

/// Distribution of a number.
struct Distribution {
  DistributionKind kind = DistributionKind::normal;  ///< which distribution
  double first = 0;                                  ///< mean; minimum; median (> 0)
  double second = 0;  ///< standard deviation; maximum; standard deviation of the logarithm
  /// Bounds. The distribution is truncated and renormalized, not clipped.
  double min = -std::numeric_limits<double>::infinity();
  double max = std::numeric_limits<double>::infinity();  ///< upper bound

  friend bool operator==(const Distribution&, const Distribution&) = default;
};

/// The value that corresponds to the standard normal number z: nondecreasing in z, and distributed
/// as specified if z is standard normal.
/// @param distribution  accepted by validate()
/// @param z             any finite number
[[nodiscard]] double value_at(const Distribution& distribution, double z);

/// A quantity and its distribution.
struct UncertainNumber {
  std::string quantity;       ///< name of an UncertainQuantity
  Distribution distribution;  ///< of the drawn number

  friend bool operator==(const UncertainNumber&, const UncertainNumber&) = default;
};

/// All uncertain parameters of a flight.
struct Uncertainty {
  std::vector<UncertainNumber> numbers;  ///< n, each quantity once
  /// (n × n) correlation matrix of the underlying standard normal numbers (Gaussian copula):
  /// symmetric, ones on the diagonal, positive definite. Empty: independent.
  Eigen::MatrixXd correlation;
};

/// Checks that quantities are known and appear once, that the parameters of each distribution are
/// valid, that its range is within what the quantity accepts, and that the correlation matrix is
/// positive definite.
/// @throws InvalidInput  naming the number, its value and the expected one
void validate(const Uncertainty& uncertainty, const std::string& where);

/// Draws the parameters of one flight. Each depends on seed, flight and quantity only: adding or
/// removing quantities does not change the values of others that are not correlated with them.
/// @return  (n) in the order of `numbers`
[[nodiscard]] Eigen::VectorXd draw(const Uncertainty& uncertainty, std::uint64_t seed,
                                   std::uint32_t flight);

/// Applies drawn parameters to a flight. The models that law and estimator use do not change.
/// @param uncertainty  names the parameters
/// @param drawn        (n) in the order of `numbers`
/// @param setup        its true vehicle, sensors and wind are changed
/// @throws InvalidInput  for a parameter of a sensor, battery or rotor that the vehicle does not
///                       have, of the wind if the vehicle has no drag, or of a sensor in a flight
///                       with ideal sensors
void apply(const Uncertainty& uncertainty, const Eigen::Ref<const Eigen::VectorXd>& drawn,
           FlightSetup& setup);

}  // namespace quadtune
