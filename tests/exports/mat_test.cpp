// SPDX-License-Identifier: Apache-2.0
// gains.mat, read by the MAT reader for logs.
#include <gmock/gmock.h>

#include "logs/mat/mat_elements.hpp"
#include "plants/export_models.hpp"
#include "quadtune/exports/export.hpp"
#include "quadtune/exports/read_gains.hpp"
#include "quadtune/internal/mat_values.hpp"
#include "temporary_directory.hpp"

namespace quadtune {
namespace {

using internal::MatArray;
using testing::mambo_content;
using testing::TemporaryDirectory;

const MatArray& named(const std::vector<MatArray>& variables, const std::string& name) {
  for (const MatArray& variable : variables)
    if (variable.name == name) return variable;
  throw std::out_of_range(name);
}

Eigen::MatrixXd matrix(const MatArray& array) {
  Eigen::MatrixXd M(static_cast<Eigen::Index>(array.rows()),
                    static_cast<Eigen::Index>(array.columns()));
  for (Eigen::Index i = 0; i < M.size(); ++i)
    M.reshaped()(i) = array.number(static_cast<std::size_t>(i));
  return M;
}

TEST(MatExport, HoldsTheNumbersOfGainsJson) {
  const TemporaryDirectory folder;
  ExportContent content = mambo_content();
  content.Q = Eigen::MatrixXd::Identity(14, 14);
  content.R = Eigen::MatrixXd::Identity(4, 4) * 2;
  write_export(folder.path(), ExportKind("mat"), content);
  const std::string bytes = folder.read("gains.mat");
  internal::MemoryBudget budget(std::size_t{1} << 20);
  const std::vector<MatArray> all = internal::parse_mat(bytes, "gains.mat", budget);
  const MatArray& gains = named(all, "gains");
  EXPECT_EQ(matrix(*gains.field("K")), content.gains->K);
  EXPECT_EQ(matrix(*gains.field("x0")), content.gains->x0);
  EXPECT_EQ(matrix(*gains.field("dt_s"))(0, 0), content.gains->dt);
  const MatArray& states = *gains.field("states");
  EXPECT_EQ(states.entries(), 12U);
  EXPECT_EQ(states.field("name", 3)->utf16_text(), content.gains->states[3].name);
  EXPECT_EQ(matrix(*named(all, "vehicle").field("body")->field("mass_kg"))(0, 0),
            content.vehicle.mass);
  EXPECT_EQ(matrix(*named(all, "weights").field("Q")), content.Q);
  EXPECT_EQ(named(all, "quadtune").field("filters")->entries(), content.filters.size());
  EXPECT_EQ(read_gains(folder.path()).K, content.gains->K);
}

TEST(MatExport, EveryKindOfValueHasItsClass) {
  const std::string text = R"({"empty": [], "null": null, "yes": true, "text": "grüße",
    "column": [1, 2.5, -3], "rows": [[1, 2], [3, 4], [5, 6]], "ragged": [[1], [2, 3]],
    "structs": [{"a": 1, "b": "x"}, {"a": 2, "b": "y"}], "mixed": [{"a": 1}, {"b": 2}, "z"],
    "wide": [[], []]})";
  const std::string bytes =
      internal::mat_header("test") + internal::mat_of_json(internal::Json::parse(text), "v");
  internal::MemoryBudget budget(std::size_t{1} << 20);
  const std::vector<MatArray> all = internal::parse_mat(bytes, "test", budget);
  ASSERT_EQ(all.size(), 1U);
  const auto field = [&](const char* name) -> const MatArray& { return *all[0].field(name); };
  EXPECT_EQ(field("empty").entries(), 0U);
  EXPECT_EQ(field("null").entries(), 0U);
  EXPECT_EQ(field("yes").number(0), 1);
  EXPECT_EQ(field("text").utf16_text(), "grüße");
  EXPECT_EQ(matrix(field("column")), Eigen::Vector3d(1, 2.5, -3));
  EXPECT_EQ(matrix(field("rows")), (Eigen::MatrixXd(3, 2) << 1, 2, 3, 4, 5, 6).finished());
  EXPECT_EQ(field("ragged").kind, internal::MatClass::cell);
  EXPECT_EQ(field("structs").field("b", 1)->utf16_text(), "y");
  EXPECT_EQ(field("mixed").kind, internal::MatClass::cell);
  EXPECT_EQ(field("wide").rows(), 2U);
  EXPECT_EQ(field("wide").columns(), 0U);
}

}  // namespace
}  // namespace quadtune
