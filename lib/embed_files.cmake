# SPDX-License-Identifier: Apache-2.0
# cmake -DKIND=vehicle -DFOLDER=… -DNAMES=a,b -DSUFFIX=.toml -DOUTPUT=… -P embed_files.cmake: writes files of a
# folder as raw string literals into one C++ source, so that the installed program needs no files.
string(REPLACE "," ";" names "${NAMES}")
get_filename_component(folder "${FOLDER}" NAME)
set(source "// Generated from ${folder}/*${SUFFIX} by lib/embed_files.cmake.\n")
string(APPEND source "#include \"quadtune/internal/built_in.hpp\"\n\nnamespace quadtune::internal {\n\n")
string(APPEND source "const std::vector<BuiltInFile>& built_in_${KIND}_files() {\n")
string(APPEND source "  static const std::vector<BuiltInFile> files = {\n")
foreach(name IN LISTS names)
  # Through hexadecimal, as CMake would take semicolons and brackets in the text for its own.
  file(READ "${FOLDER}/${name}${SUFFIX}" bytes HEX)
  string(REGEX REPLACE "([0-9a-f][0-9a-f])" "\\\\x\\1" literal "${bytes}")
  # A literal per line: hexadecimal escapes end at the quote, whatever follows.
  string(REPLACE "\\x0a" "\\n\"\n       \"" literal "${literal}")
  string(APPEND source "      {\"${name}\", \"${folder}/${name}${SUFFIX}\",\n       \"${literal}\"},\n")
endforeach()
string(APPEND source "  };\n  return files;\n}\n\n}  // namespace quadtune::internal\n")
file(WRITE "${OUTPUT}" "${source}")
