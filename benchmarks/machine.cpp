// SPDX-License-Identifier: Apache-2.0
#include "machine.hpp"

#include <dlfcn.h>
#include <fmt/format.h>

#include <Eigen/Core>
#include <climits>
#include <cstdlib>
#include <fstream>
#include <thread>

extern "C" {
void ilaver_(int* major, int* minor, int* patch);
}

namespace quadtune::bench {
namespace {

std::string processor() {
  std::ifstream info("/proc/cpuinfo");
  for (std::string line; std::getline(info, line);)
    if (line.starts_with("model name")) return line.substr(line.find(':') + 2);
  return "unknown processor";
}

// The file that contains `symbol` as called by the running program, with links resolved.
std::string library_of(const char* symbol) {
  void* address = dlsym(RTLD_DEFAULT, symbol);
  Dl_info info;
  if (!address || !dladdr(address, &info) || !info.dli_fname) return "not loaded";
  char resolved[PATH_MAX];
  return realpath(info.dli_fname, resolved) ? resolved : info.dli_fname;
}

std::string blas() {
  using Get = const char* (*)();
  const std::string library = library_of("dgemm_");
  const auto get = reinterpret_cast<Get>(dlsym(RTLD_DEFAULT, "openblas_get_config"));
  // OpenBLAS may be loaded by another library while the calls go elsewhere.
  const bool is_openblas = get && library.find("openblas") != std::string::npos;
  return is_openblas ? fmt::format("{} ({})", library, get()) : library;
}

std::string lapack_version() {
  int major = 0;
  int minor = 0;
  int patch = 0;
  ilaver_(&major, &minor, &patch);
  return fmt::format("{}.{}.{}", major, minor, patch);
}

}  // namespace

std::string describe_machine() {
  return fmt::format(
      "machine:  {}, {} logical processors\n"
      "compiler: {} {}\n"
      "Eigen:    {}.{}.{}, {} in the benchmark program\n"
      "BLAS:     {}\n"
      "LAPACK:   {} in {}\n"
#ifdef QUADTUNE_WITH_SLICOT
      "SLICOT:   {}\n",
#else
      "SLICOT:   not installed (apt-get install libslicot-dev){}\n",
#endif
      processor(), std::thread::hardware_concurrency(),
#ifdef __clang__
      "clang", __clang_version__,
#else
      "gcc", __VERSION__,
#endif
      EIGEN_WORLD_VERSION, EIGEN_MAJOR_VERSION, EIGEN_MINOR_VERSION,
      Eigen::SimdInstructionSetsInUse(), blas(), lapack_version(), library_of("dgees_"),
#ifdef QUADTUNE_WITH_SLICOT
      library_of("sb02md_")
#else
      ""
#endif
  );
}

void use_one_thread() {
  using Set = void (*)(int);
  if (const auto set = reinterpret_cast<Set>(dlsym(RTLD_DEFAULT, "openblas_set_num_threads")))
    set(1);
}

}  // namespace quadtune::bench
