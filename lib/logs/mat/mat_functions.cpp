// SPDX-License-Identifier: Apache-2.0
// What libquadtune_mat.so gives.
#include "logs/mat/mat_library.hpp"
#include "logs/mat/mat_table.hpp"
#include "logs/mat/system_call_filter.hpp"

extern "C" const quadtune::internal::MatFunctions* quadtune_mat_functions() {
  using namespace quadtune::internal;
  static const MatFunctions functions = {decode_mat, forbid_system_calls, bytes_by_matio,
                                         table_by_matio};
  return &functions;
}
