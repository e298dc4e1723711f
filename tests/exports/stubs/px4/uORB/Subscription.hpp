/* SPDX-License-Identifier: Apache-2.0 */
#pragma once
#include <uORB/topics.hpp>

namespace uORB {
class Subscription {
 public:
  template <class T>
  explicit Subscription(orb_metadata<T>) {}
  template <class T>
  bool copy(T *to) {
    if (Topic<T>::has) *to = Topic<T>::newest;
    return Topic<T>::has;
  }
};
}  // namespace uORB
