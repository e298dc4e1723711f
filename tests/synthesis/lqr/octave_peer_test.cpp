// SPDX-License-Identifier: Apache-2.0
/// Gains against Octave's control package on a thousand random systems.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cstdlib>
#include <fstream>
#include <random>

#include "matrix_near.hpp"
#include "quadtune/synthesis/riccati.hpp"
#include "temporary_directory.hpp"

namespace quadtune {
namespace {

using testing::MatrixRelativelyNear;

struct System {
  bool discrete = false;
  Eigen::MatrixXd A, B, Q, R;
};

/// Well-conditioned: a tenth of the eigenvalues of A lie beyond the boundary, an input for every
/// two to four states, weights of order one.
System draw(std::mt19937_64& random, int number) {
  std::normal_distribution<double> normal;
  const auto matrix = [&](Eigen::Index rows, Eigen::Index cols) {
    return Eigen::MatrixXd::NullaryExpr(rows, cols, [&] { return normal(random); }).eval();
  };
  System system;
  system.discrete = number % 2 == 1;
  const Eigen::Index nx = 1 + number / 2 % 50;
  const Eigen::Index nu =
      std::uniform_int_distribution<Eigen::Index>((nx + 3) / 4, (nx + 1) / 2)(random);
  // Girko's disk: eigenvalues of matrix(nx, nx) / sqrt(nx) fill the unit disk.
  system.A = matrix(nx, nx) / std::sqrt(static_cast<double>(nx));
  if (system.discrete)
    system.A *= 1.05;
  else
    system.A.diagonal().array() -= 0.7;
  system.B = matrix(nx, nu);
  const Eigen::MatrixXd C = matrix(nx, nx) / std::sqrt(static_cast<double>(nx));
  system.Q = C.transpose() * C + Eigen::MatrixXd::Identity(nx, nx);
  const Eigen::MatrixXd D = matrix(nu, nu) / std::sqrt(static_cast<double>(nu));
  system.R = D.transpose() * D + Eigen::MatrixXd::Identity(nu, nu);
  return system;
}

void append(std::ofstream& file, const Eigen::MatrixXd& M) {
  file.write(reinterpret_cast<const char*>(M.data()),
             static_cast<std::streamsize>(sizeof(double)) * M.size());
}

constexpr const char* kScript = R"(
pkg load control
in = fopen('systems.bin'); out = fopen('gains.bin', 'w');
count = fread(in, 1, 'double');
for i = 1:count
  head = fread(in, 3, 'double'); n = head(1); m = head(2);
  A = fread(in, [n n], 'double'); B = fread(in, [n m], 'double');
  Q = fread(in, [n n], 'double'); R = fread(in, [m m], 'double');
  if head(3); K = dlqr(A, B, Q, R); else; K = lqr(A, B, Q, R); end
  fwrite(out, K, 'double');
end
)";

TEST(OctavePeer, GainsOfAThousandRandomSystemsAgree) {
  if (std::system("octave-cli --eval 'pkg load control' >/dev/null 2>&1") != 0)
    GTEST_SKIP() << "Octave with its control package is not installed (./dev peers installs it)";
  constexpr int kCount = 1000;
  std::mt19937_64 random(2026);
  std::vector<System> systems;
  systems.reserve(kCount);
  for (int i = 0; i < kCount; ++i) systems.push_back(draw(random, i));

  const testing::TemporaryDirectory folder;
  folder.write("compare.m", kScript);
  {
    std::ofstream file(folder.path() / "systems.bin", std::ios::binary);
    append(file, Eigen::MatrixXd::Constant(1, 1, kCount));
    for (const System& s : systems) {
      append(file, Eigen::Vector3d(static_cast<double>(s.A.rows()), static_cast<double>(s.B.cols()),
                                   s.discrete ? 1 : 0));
      for (const Eigen::MatrixXd* M : {&s.A, &s.B, &s.Q, &s.R}) append(file, *M);
    }
  }
  const std::string command =
      "cd '" + folder.path().string() + "' && octave-cli -q compare.m >octave.log 2>&1";
  ASSERT_EQ(std::system(command.c_str()), 0) << folder.read("octave.log");

  std::ifstream gains(folder.path() / "gains.bin", std::ios::binary);
  for (int i = 0; i < kCount; ++i) {
    const System& s = systems[static_cast<std::size_t>(i)];
    Eigen::MatrixXd theirs(s.B.cols(), s.A.rows());
    gains.read(reinterpret_cast<char*>(theirs.data()),
               static_cast<std::streamsize>(sizeof(double)) * theirs.size());
    ASSERT_TRUE(gains) << "system " << i;
    const RiccatiResult ours = s.discrete ? dare(s.A, s.B, s.Q, s.R) : care(s.A, s.B, s.Q, s.R);
    ASSERT_TRUE(ours.solved()) << "system " << i << ": " << ours;
    EXPECT_THAT(ours.K, MatrixRelativelyNear(theirs, 1e-9)) << "system " << i;
  }
}

}  // namespace
}  // namespace quadtune
