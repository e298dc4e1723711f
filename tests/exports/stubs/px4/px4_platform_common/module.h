/* SPDX-License-Identifier: Apache-2.0 */
#pragma once
#include <atomic>
#include <cmath>
#include <cstdint>
#include <cstdio>

#define PX4_OK 0
#define PX4_ERROR (-1)
#define PX4_ISFINITE(x) std::isfinite(x)
#define PX4_WARN(...) std::printf(__VA_ARGS__)
#define PRINT_MODULE_DESCRIPTION(text) std::puts(text)
#define PRINT_MODULE_USAGE_NAME(name, kind) std::puts(name)
#define PRINT_MODULE_USAGE_COMMAND(name) std::puts(name)
#define PRINT_MODULE_USAGE_DEFAULT_COMMANDS() std::puts("stop, status")
#define MODULE_NAME "module"
#define __EXPORT

template <class T>
class ModuleBase {
 public:
  static int main(int argc, char *argv[]) { return T::task_spawn(argc, argv); }
  static inline bool asked_to_exit = false;
  static T *instance() { return _object.load(); }

 protected:
  static constexpr int task_id_is_work_queue = -2;
  static inline std::atomic<T *> _object{nullptr};
  static inline int _task_id = -1;
  bool should_exit() const { return asked_to_exit; }
  static void exit_and_cleanup() {}
};
