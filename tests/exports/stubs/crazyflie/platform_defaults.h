/* SPDX-License-Identifier: Apache-2.0 */
#pragma once
#define THRUST_MAX 0.12f /* of a motor [N] */
