/* SPDX-License-Identifier: Apache-2.0 */
#pragma once
#include <stdint.h>
typedef uint32_t TickType_t;
#define M2T(ms) ((TickType_t)(ms))
