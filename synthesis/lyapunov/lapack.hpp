// SPDX-License-Identifier: Apache-2.0
/// LAPACKE with the complex types of C++.
#pragma once

#include <complex>

#define lapack_complex_float std::complex<float>
#define lapack_complex_double std::complex<double>
#include <lapacke.h>
