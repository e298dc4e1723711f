// SPDX-License-Identifier: Apache-2.0
#include "quadtune/simulation/integrators.hpp"

#include <fmt/format.h>

#include <vector>

#include "quadtune/errors.hpp"
#include "quadtune/internal/joined.hpp"
#include "quadtune/internal/suggest.hpp"
#include "quadtune/internal/text_file.hpp"

namespace quadtune {

std::string to_string(Integrator integrator) {
  switch (integrator) {
    case Integrator::euler:
      return "euler";
    case Integrator::bogacki_shampine_3:
      return "bogacki-shampine-3";
    case Integrator::runge_kutta_4:
      break;
  }
  return "runge-kutta-4";
}

Integrator integrator(const std::string& name, const std::string& where) {
  std::vector<std::string> known;
  for (const Integrator one :
       {Integrator::euler, Integrator::bogacki_shampine_3, Integrator::runge_kutta_4}) {
    if (to_string(one) == name) return one;
    known.push_back(to_string(one));
  }
  throw InvalidInput(
      where, fmt::format("no integrator '{}', expected {}{}", internal::printable(name),
                         internal::joined(known, ", "), internal::did_you_mean(name, known)));
}

}  // namespace quadtune
