// SPDX-License-Identifier: Apache-2.0
/// What is not known for certain of a flight: which numbers, how they are distributed, and what
/// they are in one flight of many.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <string>
#include <vector>

#include "quadtune/simulation/flight.hpp"

namespace quadtune {

/// How a drawn number enters a flight.
enum class QuantityKind {
  ratio,     ///< multiplies what the vehicle's file says; 1 changes nothing
  addition,  ///< is added to it; 0 changes nothing
  value,     ///< takes its place
};

/// A number that a flight may vary.
struct UncertainQuantity {
  std::string name;  ///< e.g. "mass", "wind_north", "gyroscope_noise"
  std::string unit;  ///< of what is drawn; "1" of a ratio
  QuantityKind kind = QuantityKind::ratio;
  double least = 0;     ///< that a flight accepts
  double greatest = 0;  ///< likewise
  std::string meaning;  ///< one line
};

/// All of them, in the order of the documentation.
[[nodiscard]] const std::vector<UncertainQuantity>& uncertain_quantities();

/// The quantity of that name.
/// @throws InvalidInput  "where: no quantity 'mas', expected …; did you mean 'mass'?"
[[nodiscard]] const UncertainQuantity& uncertain_quantity(const std::string& name,
                                                          const std::string& where);

enum class DistributionKind { normal, uniform, log_normal };
/// "normal", "uniform", "log_normal".
[[nodiscard]] std::string to_string(DistributionKind kind);

/// How a number is distributed.
struct Distribution {
  DistributionKind kind = DistributionKind::normal;
  double first = 0;   ///< mean; least; median (> 0)
  double second = 0;  ///< standard deviation; greatest; standard deviation of the logarithm
  /// Nothing is drawn beyond these: the rest of the distribution is scaled up, not heaped there.
  double least = -std::numeric_limits<double>::infinity();
  double most = std::numeric_limits<double>::infinity();

  friend bool operator==(const Distribution&, const Distribution&) = default;
};

/// The number at a standard normal one: not decreasing in z, and distributed as asked where z is
/// standard normal.
/// @param distribution  as validate() accepts it
[[nodiscard]] double value_at(const Distribution& distribution, double z);

/// One quantity and its distribution.
struct UncertainNumber {
  std::string quantity;  ///< name of an UncertainQuantity
  Distribution distribution;

  friend bool operator==(const UncertainNumber&, const UncertainNumber&) = default;
};

/// All that is uncertain of a flight.
struct Uncertainty {
  std::vector<UncertainNumber> numbers;  ///< n, each quantity once
  /// (n × n) of the standard normal numbers from which they are made (a Gaussian copula):
  /// symmetric, ones on the diagonal, > 0. Empty: independent.
  Eigen::MatrixXd correlation;
};

/// Checks that quantities are known and appear once, that each distribution is one and stays within
/// what its quantity accepts, and that the correlations are some.
/// @throws InvalidInput  naming the number, what came and what was expected.
void validate(const Uncertainty& uncertainty, const std::string& where);

/// The numbers of one flight. They depend on seed, flight and quantity alone: another list of
/// quantities leaves those that are not correlated as they were.
/// @return  (n) in the order of `numbers`
[[nodiscard]] Eigen::VectorXd draw(const Uncertainty& uncertainty, std::uint64_t seed,
                                   std::uint32_t flight);

/// Gives a flight its numbers. What law and estimator believe stays as it is.
/// @param drawn  (n) in the order of `numbers`
/// @throws InvalidInput  for a quantity of a sensor, a battery or a rotor that the vehicle lacks,
///                       of the wind where it has no drag, of a sensor in a flight with ideal ones.
void apply(const Uncertainty& uncertainty, const Eigen::Ref<const Eigen::VectorXd>& drawn,
           FlightSetup& setup);

}  // namespace quadtune
