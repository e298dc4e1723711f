# SPDX-License-Identifier: Apache-2.0
# Installs what belongs to the program and is no binary: man page, completion, the files that commands
# read, and the documentation. CMAKE_INSTALL_COMPONENT names are those of Packages.cmake.

# The program writes both by itself.
set(written ${PROJECT_BINARY_DIR}/install_files)
if(NOT CMAKE_CROSSCOMPILING)
  install(CODE "
    file(MAKE_DIRECTORY \"${written}\")
    execute_process(COMMAND \"$<TARGET_FILE:quadtune>\" help --man
                    OUTPUT_FILE \"${written}/quadtune.1\" COMMAND_ERROR_IS_FATAL ANY)
    execute_process(COMMAND \"$<TARGET_FILE:quadtune>\" help --completion
                    OUTPUT_FILE \"${written}/quadtune\" COMMAND_ERROR_IS_FATAL ANY)"
    COMPONENT program)
  set(man ${written}/quadtune.1)
  if(QUADTUNE_PACKAGE)
    install(CODE "
      execute_process(COMMAND gzip -9nf \"${written}/quadtune.1\" COMMAND_ERROR_IS_FATAL ANY)"
      COMPONENT program)
    string(APPEND man .gz)
  endif()
  install(FILES ${man} DESTINATION ${CMAKE_INSTALL_MANDIR}/man1 COMPONENT program)
  install(FILES ${written}/quadtune
          DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions COMPONENT program)
endif()

foreach(folder vehicles missions designs filters campaigns)
  install(DIRECTORY ${folder} DESTINATION ${CMAKE_INSTALL_DATADIR}/quadtune COMPONENT program
          FILES_MATCHING PATTERN *.toml)
  # Where the links of the other pages expect it.
  install(FILES ${folder}/README.md DESTINATION ${CMAKE_INSTALL_DOCDIR}/${folder}
          COMPONENT documentation)
endforeach()
install(FILES README.md DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT documentation)
install(DIRECTORY docs DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT documentation)
install(DIRECTORY examples DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT documentation
        PATTERN CMakeLists.txt EXCLUDE)
