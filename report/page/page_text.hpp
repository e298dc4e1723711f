// SPDX-License-Identifier: Apache-2.0
/// Text that goes into a web page and must not break out of its place.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace quadtune::report {

/// Text as the content of an HTML element: `&`, `<`, `>` and quotes as references, control
/// characters as U+FFFD, bytes that are not UTF-8 as \xff.
[[nodiscard]] std::string html_text(std::string_view text);

/// JSON as the content of a `<script>` element: ASCII only, no `<`, `>` or `&`, so that neither
/// `</script>` nor `<!--` can stand in it. Otherwise as internal::dump_json(); what is not finite
/// is null.
[[nodiscard]] std::string script_json(const nlohmann::json& value);

/// Bytes in base64 with padding.
[[nodiscard]] std::string base64(std::span<const unsigned char> bytes);

/// Numbers as 32-bit floats, little-endian, in base64. What no such float can hold becomes NaN.
[[nodiscard]] std::string float32_base64(const std::vector<double>& values);

/// Numbers as 64-bit floats, little-endian, in base64.
[[nodiscard]] std::string float64_base64(const std::vector<double>& values);

/// What a content security policy calls an inline script or style: 'sha256-…', quotes included.
[[nodiscard]] std::string policy_hash(const std::string& text);

}  // namespace quadtune::report
