// SPDX-License-Identifier: Apache-2.0
#include "design/table_entries.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "quadtune/errors.hpp"
#include "quadtune/internal/counted.hpp"
#include "quadtune/internal/joined.hpp"
#include "quadtune/internal/suggest.hpp"
#include "quadtune/matrix_checks.hpp"

namespace quadtune::internal {

std::string spaced(const std::vector<std::string>& words) {
  return fmt::format("{}", joined(words, " "));
}

std::string dotted(const TomlTable& table, const std::string& key) {
  const std::string& title = table.title();
  if (title.empty()) return key;
  if (title.rfind("[[", 0) == 0) return key + " in " + title;
  return title.substr(1, title.size() - 2) + "." + key;
}

Eigen::VectorXd read_weights_of_each(const TomlTable& table, const std::string& key,
                                     Eigen::Index size, const std::string& names,
                                     const Range& range) {
  const std::string name = dotted(table, key);
  if (table.is_list_of_lists(key))
    throw InvalidInput(table.where(key),
                       fmt::format("{} is a matrix, expected {} numbers ({}), because the weights "
                                   "on the flown plant are diagonal",
                                   name, size, names));
  Eigen::VectorXd weights = table.vector(key, range);
  if (weights.size() != size)
    throw InvalidInput(table.where(key),
                       fmt::format("{} has {}, expected {} ({})", name,
                                   counted(weights.size(), "entry", "entries"), size, names));
  return weights;
}

Eigen::MatrixXd read_weight(const TomlTable& table, const std::string& key, Eigen::Index size,
                            const std::string& names, const Range& range) {
  const std::string name = dotted(table, key);
  if (table.is_list_of_lists(key)) {
    Eigen::MatrixXd M = table.matrix(key);
    if (M.rows() != size || M.cols() != size)
      throw InvalidInput(table.where(key), fmt::format("{} is {}x{}, expected {}x{} ({})", name,
                                                       M.rows(), M.cols(), size, size, names));
    require_symmetric(M, table.where(key), name);
    return M;
  }
  return read_weights_of_each(table, key, size, names, range).asDiagonal();
}

Eigen::MatrixXd read_shaped(const TomlTable& table, const std::string& key, Eigen::Index rows,
                            Eigen::Index cols, const std::string& why) {
  Eigen::MatrixXd M = table.matrix(key);
  require_shape(M, rows, cols, table.where(key), dotted(table, key), why);
  return M;
}

std::vector<std::string> read_names(const TomlTable& table, const std::string& key,
                                    const std::vector<std::string>& known) {
  std::vector<std::string> words = table.texts(key);
  for (std::size_t i = 0; i < words.size(); ++i) {
    if (std::find(known.begin(), known.end(), words[i]) == known.end())
      throw InvalidInput(
          table.where(key),
          fmt::format("{} has '{}', expected names from {}{}", dotted(table, key),
                      printable(words[i]), spaced(known), did_you_mean(words[i], known)));
    if (std::find(words.begin(), words.begin() + static_cast<std::ptrdiff_t>(i), words[i]) !=
        words.begin() + static_cast<std::ptrdiff_t>(i))
      throw InvalidInput(table.where(key), fmt::format("{} lists '{}' twice, expected it once",
                                                       dotted(table, key), words[i]));
  }
  return words;
}

}  // namespace quadtune::internal
