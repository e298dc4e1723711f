// SPDX-License-Identifier: Apache-2.0
/// Discretizations against Octave's control package and SciPy on five hundred random systems.
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <complex>
#include <cstdlib>
#include <fstream>
#include <random>
#include <string>
#include <vector>

#include "matrix_near.hpp"
#include "plants/random_plant.hpp"
#include "quadtune/discretize/discretize.hpp"
#include "temporary_directory.hpp"

namespace quadtune {
namespace {

using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using testing::MatrixNear;
using testing::MatrixRelativelyNear;
using Complex = std::complex<double>;
using Method = DiscretizationMethod;

constexpr int kCount = 500;
constexpr double kPrewarp = 2;  // [rad/s]

struct System {
  ContinuousLti plant;
  double dt = 0;
};

/// One to ten states, up to three inputs and outputs; sample periods from 5 ms to 0.5 s for poles
/// of about 1 rad/s. Every second one has feed-through, which not all methods take.
std::vector<System> draw() {
  std::mt19937_64 random(2026);
  std::uniform_int_distribution<Index> channels(1, 3);
  std::uniform_real_distribution<double> decades(std::log(0.005), std::log(0.5));
  std::vector<System> systems;
  for (int i = 0; i < kCount; ++i) {
    const Index nu = channels(random);
    const Index ny = channels(random);
    systems.push_back(
        {testing::random_plant(1 + i % 10, nu, ny, i % 2 == 1, random), std::exp(decades(random))});
  }
  return systems;
}

void append(std::ofstream& file, const MatrixXd& M) {
  file.write(reinterpret_cast<const char*>(M.data()),
             static_cast<std::streamsize>(sizeof(double)) * M.size());
}

void write_systems(const std::filesystem::path& path, const std::vector<System>& systems) {
  std::ofstream file(path, std::ios::binary);
  append(file, MatrixXd::Constant(1, 1, static_cast<double>(systems.size())));
  for (const System& s : systems) {
    append(file, Eigen::Vector4d(static_cast<double>(s.plant.A.rows()),
                                 static_cast<double>(s.plant.B.cols()),
                                 static_cast<double>(s.plant.C.rows()), s.dt));
    for (const MatrixXd* M : {&s.plant.A, &s.plant.B, &s.plant.C, &s.plant.D}) append(file, *M);
  }
}

MatrixXd take(std::ifstream& file, Index rows, Index cols) {
  MatrixXd M(rows, cols);
  file.read(reinterpret_cast<char*>(M.data()),
            static_cast<std::streamsize>(sizeof(double)) * M.size());
  EXPECT_TRUE(file) << "the peer's answers end early";
  return M;
}

DiscreteLti take_like(std::ifstream& file, const ContinuousLti& plant) {
  DiscreteLti theirs;
  theirs.A = take(file, plant.A.rows(), plant.A.cols());
  theirs.B = take(file, plant.B.rows(), plant.B.cols());
  theirs.C = take(file, plant.C.rows(), plant.C.cols());
  theirs.D = take(file, plant.D.rows(), plant.D.cols());
  return theirs;
}

/// Impulse responses, which do not depend on how a state is scaled: D, C B, C A B, … side by side.
MatrixXd markov(const DiscreteLti& plant) {
  constexpr Index kTerms = 30;
  const Index nu = plant.B.cols();
  MatrixXd all(plant.D.rows(), nu * (kTerms + 1));
  all.leftCols(nu) = plant.D;
  MatrixXd state = plant.B;
  for (Index k = 1; k <= kTerms; ++k) {
    all.middleCols(k * nu, nu) = plant.C * state;
    state = (plant.A * state).eval();
  }
  return all;
}

void expect_agreement(const DiscreteLti& ours, const DiscreteLti& theirs, const std::string& what) {
  EXPECT_THAT(ours.A, MatrixRelativelyNear(theirs.A, 1e-9)) << what;
  EXPECT_THAT(markov(ours), MatrixRelativelyNear(markov(theirs), 1e-9)) << what;
}

void run_peer(const testing::TemporaryDirectory& folder, const std::string& command) {
  write_systems(folder.path() / "systems.bin", draw());
  const std::string line = "cd '" + folder.path().string() + "' && " + command + " >peer.log 2>&1";
  ASSERT_EQ(std::system(line.c_str()), 0) << folder.read("peer.log");
}

constexpr const char* kOctave = R"(
pkg load control
in = fopen('systems.bin'); out = fopen('answers.bin', 'w');
count = fread(in, 1, 'double');
for i = 1:count
  head = fread(in, 4, 'double'); n = head(1); m = head(2); p = head(3); dt = head(4);
  A = fread(in, [n n], 'double'); B = fread(in, [n m], 'double');
  C = fread(in, [p n], 'double'); D = fread(in, [p m], 'double');
  plant = ss(A, B, C, D);
  sampled = {c2d(plant, dt, 'zoh'), c2d(plant, dt, 'foh'), c2d(plant, dt, 'tustin'), ...
             c2d(plant, dt, 'prewarp', 2)};
  for j = 1:numel(sampled)
    [a, b, c, d] = ssdata(sampled{j});
    fwrite(out, a, 'double'); fwrite(out, b, 'double');
    fwrite(out, c, 'double'); fwrite(out, d, 'double');
  end
end
)";

TEST(OctavePeer, FiveHundredRandomSystemsAgree) {
  if (std::system("octave-cli --eval 'pkg load control' >/dev/null 2>&1") != 0)
    GTEST_SKIP() << "Octave with its control package is not installed (./dev peers installs it)";
  const testing::TemporaryDirectory folder;
  folder.write("compare.m", kOctave);
  ASSERT_NO_FATAL_FAILURE(run_peer(folder, "octave-cli -q compare.m"));
  std::ifstream answers(folder.path() / "answers.bin", std::ios::binary);
  for (const System& s : draw()) {
    for (const Method method : {Method::zoh, Method::foh, Method::tustin})
      expect_agreement(discretize(s.plant, s.dt, method), take_like(answers, s.plant),
                       to_string(method));
    expect_agreement(discretize(s.plant, s.dt, Method::tustin, {.prewarp = kPrewarp, .delays = {}}),
                     take_like(answers, s.plant), "prewarp");
    if (HasFailure()) return;
  }
}

/// A random stable transfer function of one to five poles.
ContinuousTransferFunction draw_fraction(std::mt19937_64& random) {
  std::uniform_int_distribution<Index> count(1, 5);
  std::uniform_real_distribution<double> size(0.2, 5);
  // Half a rad/s apart at least: Octave's impulse takes poles that are near for one.
  const auto roots = [&](Index n) {
    Eigen::VectorXcd all(n);
    double real = 0;
    for (Index i = 0; i < n; ++i) {
      real -= 0.5 + size(random) / 2;
      all[i] = real;
      if (i + 1 < n && size(random) > 2.5) {
        all[i] += Complex(0, size(random));
        all[i + 1] = std::conj(all[i]);
        ++i;
      }
    }
    return all;
  };
  const Index poles = count(random);
  ContinuousTransferFunction plant;
  plant.den = polynomial_of_roots(roots(poles));
  plant.num = VectorXd::Zero(poles + 1);
  const Index zeros = std::uniform_int_distribution<Index>(0, poles - 1)(random);
  plant.num.tail(zeros + 1) = polynomial_of_roots(roots(zeros), size(random));
  return plant;
}

constexpr const char* kOctaveFractions = R"(
pkg load control
in = fopen('fractions.bin'); out = fopen('answers.bin', 'w');
count = fread(in, 1, 'double');
for i = 1:count
  head = fread(in, 2, 'double'); n = head(1); dt = head(2);
  num = fread(in, n + 1, 'double')'; den = fread(in, n + 1, 'double')';
  plant = tf(num, den);
  for j = 1:3
    if j == 1
      [b, a] = tfdata(c2d(plant, dt, 'matched'), 'vector');
    elseif j == 2
      % What c2d calls, but without taking a zero near a pole for the same. It leaves the samples
      % of the impulse response as they are.
      [b, a] = imp_invar(num, den, 1 / dt, 1e-13);
      b = b * dt;
    else
      [b, a] = tfdata(c2d(plant, dt, 'zoh'), 'vector');
    end
    b = [zeros(1, n + 1 - numel(b)) b] / a(1); a = a / a(1);
    fwrite(out, b, 'double'); fwrite(out, a, 'double');
  end
end
)";

TEST(OctavePeer, FiveHundredRandomTransferFunctionsAgree) {
  if (std::system("octave-cli --eval 'pkg load control' >/dev/null 2>&1") != 0)
    GTEST_SKIP() << "Octave with its control package is not installed (./dev peers installs it)";
  const testing::TemporaryDirectory folder;
  folder.write("compare.m", kOctaveFractions);
  std::mt19937_64 random(7);
  std::vector<ContinuousTransferFunction> plants;
  std::vector<double> periods;
  {
    std::ofstream file(folder.path() / "fractions.bin", std::ios::binary);
    append(file, MatrixXd::Constant(1, 1, kCount));
    for (int i = 0; i < kCount; ++i) {
      plants.push_back(draw_fraction(random));
      periods.push_back(std::uniform_real_distribution<double>(0.05, 0.3)(random));
      append(file,
             Eigen::Vector2d(static_cast<double>(plants.back().den.size() - 1), periods.back()));
      append(file, plants.back().num);
      append(file, plants.back().den);
    }
  }
  const std::string line =
      "cd '" + folder.path().string() + "' && octave-cli -q compare.m >peer.log 2>&1";
  ASSERT_EQ(std::system(line.c_str()), 0) << folder.read("peer.log");
  std::ifstream answers(folder.path() / "answers.bin", std::ios::binary);
  for (std::size_t i = 0; i < plants.size(); ++i)
    for (const Method method : {Method::matched, Method::impulse, Method::zoh}) {
      const DiscreteTransferFunction ours = discretize(plants[i], periods[i], method);
      const VectorXd num = take(answers, plants[i].den.size(), 1);
      const VectorXd den = take(answers, plants[i].den.size(), 1);
      VectorXd padded = VectorXd::Zero(den.size());
      padded.tail(ours.num.size()) = ours.num;
      EXPECT_THAT(padded, MatrixNear(num, 1e-9 * num.cwiseAbs().maxCoeff()))
          << to_string(method) << " of system " << i;
      EXPECT_THAT(ours.den, MatrixNear(den, 1e-9 * den.cwiseAbs().maxCoeff()))
          << to_string(method) << " of system " << i;
    }
}

constexpr const char* kScipy = R"(
import numpy as np
from scipy.signal import cont2discrete
numbers = np.fromfile('systems.bin')
at = 1
def take(rows, cols):
    global at
    at += rows * cols
    return numbers[at - rows * cols:at].reshape((rows, cols), order='F')
with open('answers.bin', 'wb') as out:
    for _ in range(int(numbers[0])):
        n, m, p, dt = numbers[at:at + 4]
        n, m, p, at = int(n), int(m), int(p), at + 4
        system = (take(n, n), take(n, m), take(p, n), take(p, m))
        methods = ['zoh', 'foh', 'euler', 'backward_diff', 'bilinear']
        if not system[3].any():
            methods.append('impulse')
        for method in methods:
            for M in cont2discrete(system, dt, method)[:4]:
                out.write(np.asarray(M, dtype=float).tobytes(order='F'))
)";

TEST(ScipyPeer, FiveHundredRandomSystemsAgree) {
  if (std::system("/usr/bin/python3 -c 'import scipy.signal' >/dev/null 2>&1") != 0)
    GTEST_SKIP() << "SciPy is not installed (./dev peers installs it)";
  const testing::TemporaryDirectory folder;
  folder.write("compare.py", kScipy);
  ASSERT_NO_FATAL_FAILURE(run_peer(folder, "/usr/bin/python3 compare.py"));
  std::ifstream answers(folder.path() / "answers.bin", std::ios::binary);
  for (const System& s : draw()) {
    std::vector<Method> methods = {Method::zoh, Method::foh, Method::euler, Method::backward_euler,
                                   Method::tustin};
    if (s.plant.D.isZero(0)) methods.push_back(Method::impulse);
    for (const Method method : methods)
      expect_agreement(discretize(s.plant, s.dt, method), take_like(answers, s.plant),
                       to_string(method));
    if (HasFailure()) return;
  }
}

}  // namespace
}  // namespace quadtune
