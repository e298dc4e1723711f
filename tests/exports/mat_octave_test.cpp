// SPDX-License-Identifier: Apache-2.0
// gains.mat as Octave loads it.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <cstdlib>
#include <sstream>

#include "matrix_near.hpp"
#include "plants/export_models.hpp"
#include "quadtune/exports/export.hpp"
#include "temporary_directory.hpp"

namespace quadtune {
namespace {

using testing::mambo_content;
using testing::MatrixNear;
using testing::TemporaryDirectory;

TEST(MatOctave, LoadsEveryNumberAsTheSameDouble) {
  if (std::system("octave-cli --version > /dev/null 2>&1") != 0)
    GTEST_SKIP() << "octave-cli is not installed here";
  const TemporaryDirectory folder;
  const ExportContent content = mambo_content();
  write_export(folder.path(), ExportKind("mat"), content);
  folder.write("show.m",
               "load gains.mat\nprintf('%.17g ', gains.K', gains.dt_s, vehicle.body.mass_kg, "
               "quadtune.filters(1).L, strcmp(gains.states(1).name, 'phi'));\n");
  ASSERT_EQ(std::system(fmt::format("cd '{}' && octave-cli --no-init-file show.m > out 2>&1",
                                    folder.path().string())
                            .c_str()),
            0)
      << folder.read("out");
  std::istringstream numbers(folder.read("out"));
  Eigen::MatrixXd K(content.gains->K.rows(), content.gains->K.cols());
  for (Eigen::Index i = 0; i < K.rows(); ++i)
    for (Eigen::Index j = 0; j < K.cols(); ++j) numbers >> K(i, j);
  EXPECT_THAT(K, MatrixNear(content.gains->K, 0));
  double dt = 0, mass = 0, L0 = 0, L1 = 0, is_phi = 0;
  numbers >> dt >> mass >> L0 >> L1 >> is_phi;
  EXPECT_EQ(dt, content.gains->dt);
  EXPECT_EQ(mass, content.vehicle.mass);
  EXPECT_EQ(L0, content.filters[0].L(0));
  EXPECT_EQ(is_phi, 1);
}

}  // namespace
}  // namespace quadtune
