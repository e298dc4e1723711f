# SPDX-License-Identifier: Apache-2.0
# Prepares a header for Doxygen, line by line: the first sentence of a header describes the file, and
# what the compiler or every class defines in the same way needs no docstring in the source.
1s|^// SPDX.*|/// @file|
/bool operator==\(.*\) = default;$/s|$|  ///< Whether all members are equal.|
/^ +(\w+|\w+& operator=)\(\w+&&( \w+)?\)( noexcept)?( = default)?;$/s|$|  ///< Moves.|
/^ +(\w+|\w+& operator=)\(const \w+&( \w+)?\)( noexcept)?( = default)?;$/s|$|  ///< Copies.|
