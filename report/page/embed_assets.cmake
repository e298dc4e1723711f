# SPDX-License-Identifier: Apache-2.0
# cmake -DFOLDER=… -DNAMES=a,b -DOUTPUT=… -P embed_assets.cmake: writes the files of the report's page
# as string literals into one C++ source.
string(REPLACE "," ";" names "${NAMES}")
set(source "// Generated from report/page/assets by embed_assets.cmake.\n")
string(APPEND source "#include \"report/page/assets.hpp\"\n\nnamespace quadtune::report {\n\n")
string(APPEND source "const std::vector<Asset>& assets() {\n")
string(APPEND source "  static const std::vector<Asset> files = {\n")
foreach(name IN LISTS names)
  # Through hexadecimal, as CMake would take semicolons and brackets in the text for its own.
  file(READ "${FOLDER}/${name}" bytes HEX)
  string(REGEX REPLACE "([0-9a-f][0-9a-f])" "\\\\x\\1" literal "${bytes}")
  # A literal per line: hexadecimal escapes end at the quote, whatever follows.
  string(REPLACE "\\x0a" "\\n\"\n       \"" literal "${literal}")
  string(APPEND source "      {\"${name}\",\n       \"${literal}\"},\n")
endforeach()
string(APPEND source "  };\n  return files;\n}\n\n}  // namespace quadtune::report\n")
file(WRITE "${OUTPUT}" "${source}")
