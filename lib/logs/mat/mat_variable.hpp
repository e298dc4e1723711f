// SPDX-License-Identifier: Apache-2.0
/// matio's variables with an owner, and the names that a log has in a MAT file.
#pragma once

#include <matio.h>

#include <memory>

namespace quadtune::internal {

struct MatDelete {
  void operator()(matvar_t* variable) const { Mat_VarFree(variable); }
  void operator()(mat_t* file) const { Mat_Close(file); }
};
using MatVariable = std::unique_ptr<matvar_t, MatDelete>;
using MatFile = std::unique_ptr<mat_t, MatDelete>;

// Not `log`: loading a file would hide the logarithm.
inline constexpr const char* kMatVariable = "flight";
inline constexpr const char* kMatFormat = "quadtune-log";
inline constexpr double kMatVersion = 1;

}  // namespace quadtune::internal
