# SPDX-License-Identifier: Apache-2.0
# CPack runs this on the packages that it has made (CPACK_POST_BUILD_SCRIPTS). It packs them again with
# dpkg-deb, so that the same files give the same bytes: sorted, owned by root, no file newer than the
# commit. Two things that CPack writes are replaced: scripts that call ldconfig, where a trigger is
# enough, and a list of shared libraries that names each library once for every variant of it.
cmake_minimum_required(VERSION 3.25)

set(ENV{SOURCE_DATE_EPOCH} ${CPACK_QUADTUNE_COMMIT_TIME})
foreach(package IN LISTS CPACK_PACKAGE_FILES)
  set(folder ${package}.unpacked)
  file(REMOVE_RECURSE ${folder})
  execute_process(COMMAND dpkg-deb --raw-extract ${package} ${folder} COMMAND_ERROR_IS_FATAL ANY)

  foreach(script postinst postrm)
    if(EXISTS ${folder}/DEBIAN/${script})
      file(READ ${folder}/DEBIAN/${script} text)
      if(text MATCHES "ldconfig")
        file(REMOVE ${folder}/DEBIAN/${script})
      endif()
    endif()
  endforeach()
  if(EXISTS ${folder}/DEBIAN/shlibs)
    execute_process(COMMAND env LC_ALL=C sort -u -o shlibs shlibs
                    WORKING_DIRECTORY ${folder}/DEBIAN COMMAND_ERROR_IS_FATAL ANY)
  endif()
  execute_process(COMMAND env LC_ALL=C sort -k 2 -o md5sums md5sums
                  WORKING_DIRECTORY ${folder}/DEBIAN COMMAND_ERROR_IS_FATAL ANY)

  execute_process(
    COMMAND dpkg-deb --root-owner-group --uniform-compression -Zxz --build ${folder} ${package}
    OUTPUT_QUIET COMMAND_ERROR_IS_FATAL ANY)
  file(REMOVE_RECURSE ${folder})
endforeach()
