// SPDX-License-Identifier: Apache-2.0
/// Arguments that may be written in several ways, as types with a name in signatures.
#pragma once

#include <pybind11/eigen.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <Eigen/Core>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace quadtune::python {

/// A path, or a built-in name where the argument has some: str or os.PathLike.
struct Path {
  std::string text;
};

/// A vehicle by name, by its file, or one that was loaded from either.
struct VehicleWord {
  std::string text;
};

/// Weights or coefficients: one number, or a sequence of numbers.
struct Numbers {
  Eigen::VectorXd values;
};

/// Poles or a frequency response: one number, or a sequence of numbers, real or complex.
struct ComplexNumbers {
  Eigen::VectorXcd values;
};

/// The grid of a gain schedule: "speed=0:0.5:10, mass=1", or a mapping from quantities to numbers.
struct Grid {
  std::string text;  ///< empty if it was a mapping
  std::vector<std::pair<std::string, Eigen::VectorXd>> axes;
};

/// Names: "px,py", or a sequence of str.
struct Names {
  std::vector<std::string> list;
  [[nodiscard]] std::string joined() const;  ///< with commas
};

/// One number for all loops, or a mapping from loops to numbers: {"roll": 40, "x": 2}.
struct ByLoop {
  std::string text;  ///< as the command line has it: "roll=40,x=2"
};

// What type casters call; false where the object is of another kind.
bool read(pybind11::handle from, Path& to);
bool read(pybind11::handle from, VehicleWord& to);
bool read(pybind11::handle from, Numbers& to);
bool read(pybind11::handle from, ComplexNumbers& to);
bool read(pybind11::handle from, Grid& to);
bool read(pybind11::handle from, Names& to);
bool read(pybind11::handle from, ByLoop& to);

/// @throws OptionError  unless value is positive and finite
void require_positive(double value, const char* name, const char* unit);
/// @throws OptionError  unless value ≥ 0
void require_not_negative(double value, const char* name);
/// @throws OptionError  for another count than one or `count`, and for negative weights
[[nodiscard]] Eigen::VectorXd weights(const Numbers& numbers, std::size_t count, const char* name,
                                      const std::string& of);

}  // namespace quadtune::python

namespace pybind11::detail {

#define QUADTUNE_CASTER(Type, words)                                             \
  template <>                                                                    \
  struct type_caster<quadtune::python::Type> {                                   \
    PYBIND11_TYPE_CASTER(quadtune::python::Type, const_name(words));             \
    bool load(handle from, bool) { return quadtune::python::read(from, value); } \
  }
QUADTUNE_CASTER(Path, "Path");
QUADTUNE_CASTER(VehicleWord, "VehicleLike");
QUADTUNE_CASTER(Numbers, "Numbers");
QUADTUNE_CASTER(ComplexNumbers, "ComplexNumbers");
QUADTUNE_CASTER(Grid, "Grid");
QUADTUNE_CASTER(Names, "Names");
QUADTUNE_CASTER(ByLoop, "ByLoop");
#undef QUADTUNE_CASTER

}  // namespace pybind11::detail
