// SPDX-License-Identifier: Apache-2.0
#include "quadtune/exports/digital_filter.hpp"

#include <fmt/format.h>

#include <cmath>
#include <complex>
#include <numbers>
#include <vector>

#include "quadtune/errors.hpp"

namespace quadtune {
namespace {

using Complex = std::complex<double>;
using std::numbers::pi;

void require(const char* design, int order, double cutoff) {
  if (order < 1 || order > 12)
    throw InvalidInput(design, fmt::format("order is {}, expected 1 to 12", order));
  if (!(cutoff > 0 && cutoff < 1))
    throw InvalidInput(design, fmt::format("cutoff is {}, expected a fraction of half the sample "
                                           "rate between 0 and 1",
                                           cutoff));
}

// Coefficients of prod(1 - r z⁻¹); the roots are in conjugate pairs.
Eigen::VectorXd polynomial(const std::vector<Complex>& roots) {
  std::vector<Complex> c = {1};
  for (const Complex& root : roots) {
    c.push_back(0);
    for (std::size_t i = c.size() - 1; i > 0; --i) c[i] -= root * c[i - 1];
  }
  Eigen::VectorXd real(static_cast<Eigen::Index>(c.size()));
  for (std::size_t i = 0; i < c.size(); ++i) real(static_cast<Eigen::Index>(i)) = c[i].real();
  return real;
}

// Maps zeros and poles of the analogue low pass with edge 1 rad/s to those of the digital one by s
// = (z - 1) / (z + 1), with the edge at tan(pi cutoff / 2); zeros at infinity become z = -1.
DigitalFilter digital(const std::vector<Complex>& zeros, const std::vector<Complex>& poles,
                      double cutoff) {
  const double edge = std::tan(pi * cutoff / 2);
  std::vector<Complex> z;
  std::vector<Complex> p;
  Complex gain = 1;  // makes H(1) = 1; 1 - z = -2 s / (1 - s) loses no digits near z = 1
  for (const Complex& pole : poles) {
    const Complex s = edge * pole;
    p.push_back((1.0 + s) / (1.0 - s));
    gain *= -2.0 * s / (1.0 - s);
  }
  for (const Complex& zero : zeros) {
    const Complex s = edge * zero;
    z.push_back((1.0 + s) / (1.0 - s));
    gain /= -2.0 * s / (1.0 - s);
  }
  while (z.size() < p.size()) {
    z.emplace_back(-1);
    gain /= 2;
  }
  return {polynomial(z) * gain.real(), polynomial(p)};
}

}  // namespace

DigitalFilter butterworth(int order, double cutoff) {
  require("butterworth", order, cutoff);
  std::vector<Complex> poles;
  for (int m = 1 - order; m < order; m += 2)
    poles.push_back(-std::polar(1.0, pi * m / (2.0 * order)));
  return digital({}, poles, cutoff);
}

DigitalFilter chebyshev2(int order, double attenuation, double edge) {
  require("chebyshev2", order, edge);
  if (!(attenuation > 0 && attenuation < 300))
    throw InvalidInput("chebyshev2",
                       fmt::format("attenuation is {} dB, expected 0 to 300", attenuation));
  // The poles are the inverses of those of the first kind; the zeros are on the imaginary axis.
  const double mu = std::asinh(std::sqrt(std::pow(10, attenuation / 10) - 1)) / order;
  std::vector<Complex> zeros;
  std::vector<Complex> poles;
  for (int m = 1 - order; m < order; m += 2) {
    const double angle = pi * m / (2.0 * order);
    poles.push_back(1.0 /
                    Complex(-std::sinh(mu) * std::cos(angle), -std::cosh(mu) * std::sin(angle)));
    if (m != 0) zeros.emplace_back(0, 1 / std::sin(angle));
  }
  return digital(zeros, poles, edge);
}

DigitalFilter windowed_fir(int order, double cutoff) {
  require("windowed_fir", order, cutoff);
  Eigen::VectorXd h(order + 1);
  for (int i = 0; i <= order; ++i) {
    const double t = i - order / 2.0;
    const double sinc = t == 0 ? cutoff : std::sin(pi * cutoff * t) / (pi * t);
    h(i) = sinc * (0.54 - 0.46 * std::cos(2 * pi * i / order));
  }
  return {h / h.sum(), Eigen::VectorXd::Ones(1)};
}

}  // namespace quadtune
