// SPDX-License-Identifier: Apache-2.0
#include "quadtune/exports/digital_filter.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <complex>
#include <numbers>

#include "matrix_near.hpp"
#include "quadtune/errors.hpp"

namespace quadtune {
namespace {

using ::testing::HasSubstr;
using testing::MatrixNear;
using ::testing::ThrowsMessage;

double gain_at(const DigitalFilter& filter, double frequency) {
  const std::complex<double> z1 = std::polar(1.0, -std::numbers::pi * frequency);
  const auto value = [&](const Eigen::VectorXd& c) {
    std::complex<double> sum = 0;
    for (Eigen::Index i = c.size() - 1; i >= 0; --i) sum = sum * z1 + c(i);
    return sum;
  };
  return std::abs(value(filter.num) / value(filter.den));
}

// Coefficients in the published code of the Mambo's flight program, single precision there.
TEST(DigitalFilter, ReproducesThePublishedCoefficients) {
  const DigitalFilter height = butterworth(3, 0.01);
  Eigen::VectorXd num(4);
  num << 3.75683802e-6, 1.12705141e-5, 1.12705141e-5, 3.75683802e-6;
  Eigen::VectorXd den(4);
  den << 1, -2.93717073, 2.87629972, -0.93909894;
  EXPECT_THAT(height.num, MatrixNear(num, 1e-13));
  EXPECT_THAT(height.den, MatrixNear(den, 1e-8));

  const DigitalFilter gyro = chebyshev2(5, 40, 0.8);
  Eigen::VectorXd b(6);
  b << 0.282124132, 1.27253926, 2.42084408, 2.42084408, 1.27253926, 0.282124132;
  Eigen::VectorXd a(6);
  a << 1, 2.22871494, 2.52446198, 1.57725322, 0.54102242, 0.0795623958;
  EXPECT_THAT(gyro.num, MatrixNear(b, 1.5e-7));
  EXPECT_THAT(gyro.den, MatrixNear(a, 1.5e-7));

  const DigitalFilter accel = windowed_fir(5, 0.1);
  Eigen::VectorXd h(6);
  h << 0.0264077249, 0.140531361, 0.33306092, 0.33306092, 0.140531361, 0.0264077249;
  EXPECT_THAT(accel.num, MatrixNear(h, 1e-8));
}

TEST(DigitalFilter, PassesRestAndStopsAsItsDesignSays) {
  for (int order = 1; order <= 6; ++order) {
    const DigitalFilter b = butterworth(order, 0.3);
    EXPECT_NEAR(gain_at(b, 0), 1, 1e-12);
    EXPECT_NEAR(gain_at(b, 0.3), std::sqrt(0.5), 1e-12);
    const DigitalFilter c = chebyshev2(order, 40, 0.6);
    EXPECT_NEAR(gain_at(c, 0), 1, 1e-12);
    EXPECT_NEAR(gain_at(c, 0.6), 0.01, 1e-12);
    for (int percent = 61; percent <= 100; ++percent)
      EXPECT_LE(gain_at(c, 0.01 * percent), 0.01 + 1e-12);
    EXPECT_NEAR(gain_at(windowed_fir(order, 0.3), 0), 1, 1e-12);
  }
}

TEST(DigitalFilter, RefusesWhatIsNoLowPass) {
  EXPECT_THAT([] { (void)butterworth(0, 0.1); },
              ThrowsMessage<InvalidInput>(HasSubstr("order is 0, expected 1 to 12")));
  EXPECT_THAT([] { (void)windowed_fir(5, 1); },
              ThrowsMessage<InvalidInput>(HasSubstr("cutoff is 1, expected a fraction")));
  EXPECT_THAT([] { (void)chebyshev2(5, NAN, 0.5); },
              ThrowsMessage<InvalidInput>(HasSubstr("attenuation is nan dB")));
}

}  // namespace
}  // namespace quadtune
