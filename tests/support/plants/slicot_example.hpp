// SPDX-License-Identifier: Apache-2.0
/// Reads matrices from the text of SLICOT's example data and results.
#pragma once

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <filesystem>
#include <fstream>
#include <string>

namespace quadtune::testing {

/// The (rows × cols) numbers, row by row, that follow the first line containing `title`.
inline Eigen::MatrixXd matrix_after(const std::filesystem::path& file, const std::string& title,
                                    Eigen::Index rows, Eigen::Index cols) {
  std::ifstream in(file);
  std::string line;
  while (std::getline(in, line) && line.find(title) == std::string::npos) {
  }
  Eigen::MatrixXd M(rows, cols);
  for (Eigen::Index i = 0; i < rows; ++i)
    for (Eigen::Index j = 0; j < cols; ++j) in >> M(i, j);
  EXPECT_TRUE(in) << file << " has no " << rows << "x" << cols << " numbers after '" << title
                  << "'";
  return M;
}

}  // namespace quadtune::testing
