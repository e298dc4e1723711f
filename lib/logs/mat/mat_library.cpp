// SPDX-License-Identifier: Apache-2.0
#include "logs/mat/mat_library.hpp"

#include <dlfcn.h>

#include "quadtune/errors.hpp"
#include "quadtune/logs/flight_log.hpp"

namespace quadtune {
namespace {

// Beside this library, wherever the tree was moved to; where the system says if it is not there. A
// variant for newer processors lies in a folder below (cmake/Variants.cmake).
void* load(std::string& why) {
  const std::string name = QUADTUNE_MAT_LIBRARY;
  Dl_info here{};
  if (::dladdr(reinterpret_cast<const void*>(&internal::mat_functions), &here) != 0 &&
      here.dli_fname != nullptr) {
    std::string path = here.dli_fname;
    path.erase(path.rfind('/') == std::string::npos ? 0 : path.rfind('/') + 1);
    path = path.substr(0, path.find("glibc-hwcaps/"));
    if (void* const library = ::dlopen((path + name).c_str(), RTLD_NOW | RTLD_LOCAL))
      return library;
    why = ::dlerror();
  }
  return ::dlopen(name.c_str(), RTLD_NOW | RTLD_LOCAL);
}

const internal::MatFunctions& loaded() {
  std::string why;
  void* const library = load(why);
  if (library == nullptr) throw FileError(QUADTUNE_MAT_LIBRARY, why.empty() ? ::dlerror() : why);
  void* const symbol = ::dlsym(library, "quadtune_mat_functions");
  if (symbol == nullptr) throw FileError(QUADTUNE_MAT_LIBRARY, ::dlerror());
  return *reinterpret_cast<decltype(&quadtune_mat_functions)>(symbol)();
}

}  // namespace

const internal::MatFunctions& internal::mat_functions() {
  static const MatFunctions& functions = loaded();
  return functions;
}

std::string bytes_of_mat(const LogTable& table) { return internal::mat_functions().bytes(table); }

LogTable table_of_mat(const std::string& bytes, const std::string& origin) {
  return internal::mat_functions().table(bytes, origin);
}

}  // namespace quadtune
