/* SPDX-License-Identifier: Apache-2.0 */
#pragma once
#include <uORB/topics.hpp>

namespace uORB {
template <class T>
class Publication {
 public:
  explicit Publication(orb_metadata<T>) {}
  bool publish(const T &message) {
    Topic<T>::newest = message;
    Topic<T>::has = true;
    return true;
  }
};
}  // namespace uORB
