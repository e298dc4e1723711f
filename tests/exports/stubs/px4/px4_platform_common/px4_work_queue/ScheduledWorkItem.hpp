/* SPDX-License-Identifier: Apache-2.0 */
#pragma once
#include <cstdint>

namespace px4 {
namespace wq_configurations {
inline constexpr int rate_ctrl = 0;
}
class ScheduledWorkItem {
 public:
  ScheduledWorkItem(const char *, int) {}
  virtual ~ScheduledWorkItem() = default;
  void ScheduleOnInterval(uint32_t microseconds) { interval = microseconds; }
  void ScheduleClear() {}
  void now() { Run(); }
  uint32_t interval = 0;

 private:
  virtual void Run() = 0;
};
}  // namespace px4
