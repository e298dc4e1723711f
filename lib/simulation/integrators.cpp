// SPDX-License-Identifier: Apache-2.0
#include "quadtune/simulation/integrators.hpp"

#include <fmt/format.h>

#include <vector>

#include "quadtune/errors.hpp"
#include "quadtune/internal/enum_names.hpp"
#include "quadtune/internal/joined.hpp"
#include "quadtune/internal/suggest.hpp"
#include "quadtune/internal/text_file.hpp"

namespace quadtune {

constexpr internal::EnumName<Integrator> kIntegrators[] = {
    {Integrator::euler, "euler"},
    {Integrator::bogacki_shampine_3, "bogacki-shampine-3"},
    {Integrator::runge_kutta_4, "runge-kutta-4"}};

std::string to_string(Integrator integrator) { return internal::name_in(kIntegrators, integrator); }

Integrator integrator(const std::string& name, const std::string& where) {
  return internal::require_in(kIntegrators, name, "solver", where);
}

}  // namespace quadtune
