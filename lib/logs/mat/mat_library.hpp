// SPDX-License-Identifier: Apache-2.0
/// What needs libmatio, in a library of its own that is loaded when a MAT file is read or written:
/// libmatio brings some thirty others (HDF5, and what that asks for), which no other work needs.
#pragma once

#include <cstddef>
#include <string>

#include "logs/formats/byte_stream.hpp"
#include "logs/mat/mat_content.hpp"
#include "quadtune/logs/log_table.hpp"

namespace quadtune::internal {

/// Functions of libquadtune_mat.so.
struct MatFunctions {
  /// As decode_mat().
  MatContent (*decode)(ByteStream& stream, std::size_t most);
  /// As forbid_system_calls().
  bool (*forbid_system_calls)();
  /// As bytes_of_mat() and table_of_mat().
  std::string (*bytes)(const LogTable& table);
  LogTable (*table)(const std::string& bytes, const std::string& origin);
};

/// Loads the library with the first call: it lies beside the one that this function is in.
/// @throws FileError  with the loader's reason
[[nodiscard]] const MatFunctions& mat_functions();

}  // namespace quadtune::internal

/// The one name that is looked up in libquadtune_mat.so.
extern "C" const quadtune::internal::MatFunctions* quadtune_mat_functions();
