// SPDX-License-Identifier: Apache-2.0
/// Encoding of texts and numbers for a web page, such that they cannot be interpreted as markup.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace quadtune::report {

/// Escapes text for the content of an HTML element: `&`, `<`, `>` and quotes become references,
/// control characters become U+FFFD, and bytes that are not UTF-8 become \xff.
[[nodiscard]] std::string html_text(std::string_view text);

/// Serializes JSON for the content of a `<script>` element: ASCII only, without `<`, `>` and `&`,
/// so that it cannot contain `</script>` or `<!--`. Otherwise as internal::dump_json(); values that
/// are not finite become null.
[[nodiscard]] std::string script_json(const nlohmann::json& value);

/// Encodes bytes in base64 with padding.
[[nodiscard]] std::string base64(std::span<const unsigned char> bytes);

/// Encodes numbers as 32-bit floats, little-endian, in base64. A number beyond the range of a float
/// becomes NaN.
[[nodiscard]] std::string float32_base64(const std::vector<double>& values);

/// Encodes numbers as 64-bit floats, little-endian, in base64.
[[nodiscard]] std::string float64_base64(const std::vector<double>& values);

/// The source expression of an inline script or style in a content security policy: 'sha256-…',
/// with the quotes.
[[nodiscard]] std::string policy_hash(const std::string& text);

}  // namespace quadtune::report
