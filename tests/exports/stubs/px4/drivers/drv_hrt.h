/* SPDX-License-Identifier: Apache-2.0 */
#pragma once
#include <cstdint>

using hrt_abstime = uint64_t;
inline hrt_abstime stub_now = 1000000;  // [us]
inline hrt_abstime hrt_absolute_time() { return stub_now; }
