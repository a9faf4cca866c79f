# cmake --install: program, library for other programs, scenes, manual pages, completion, and what a desktop needs. All of it can
# be moved together.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

install(TARGETS talus RUNTIME)
install(TARGETS libtalus EXPORT talus LIBRARY PUBLIC_HEADER)

# find_package(talus) and pkg-config.
set(package_folder ${CMAKE_INSTALL_LIBDIR}/cmake/talus)
install(EXPORT talus NAMESPACE talus:: FILE talusTargets.cmake DESTINATION ${package_folder})
configure_package_config_file(${CMAKE_CURRENT_LIST_DIR}/install/talusConfig.cmake.in talusConfig.cmake
                              INSTALL_DESTINATION ${package_folder})
write_basic_package_version_file(talusConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/talusConfig.cmake ${CMAKE_CURRENT_BINARY_DIR}/talusConfigVersion.cmake
        DESTINATION ${package_folder})
cmake_path(RELATIVE_PATH CMAKE_INSTALL_PREFIX BASE_DIRECTORY ${CMAKE_INSTALL_FULL_LIBDIR}/pkgconfig OUTPUT_VARIABLE to_prefix)
configure_file(${CMAKE_CURRENT_LIST_DIR}/install/talus.pc.in talus.pc @ONLY)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/talus.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig)

# From the program itself: what it prints with --help.
set(shared ${CMAKE_BINARY_DIR}/share)
add_custom_command(
  OUTPUT ${shared}/made
  COMMAND ${CMAKE_COMMAND} -E rm -rf ${shared}
  COMMAND ${CMAKE_COMMAND} -E make_directory ${shared}/man ${shared}/bash ${shared}/zsh
  COMMAND talus manual --folder ${shared}/man
  COMMAND talus completion bash > ${shared}/bash/talus
  COMMAND talus completion zsh > ${shared}/zsh/_talus
  COMMAND ${CMAKE_COMMAND} -E touch ${shared}/made
  DEPENDS talus
  COMMENT "Manual pages and completion"
  VERBATIM)
add_custom_target(manuals ALL DEPENDS ${shared}/made)
install(DIRECTORY ${shared}/man/ DESTINATION ${CMAKE_INSTALL_MANDIR}/man1)
install(FILES ${shared}/bash/talus DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions)
# Debian's zsh looks into the second folder, others into the first.
foreach(folder site-functions vendor-completions)
  install(FILES ${shared}/zsh/_talus DESTINATION ${CMAKE_INSTALL_DATADIR}/zsh/${folder})
endforeach()

# Where Debian's Python looks; elsewhere PYTHONPATH names it. The package finds the library from where it lies itself.
install(DIRECTORY ${PROJECT_SOURCE_DIR}/python/talus DESTINATION lib/python3/dist-packages PATTERN "__pycache__" EXCLUDE)

# Where Debian's QGIS looks; elsewhere QGIS_PLUGINPATH names the folder above it.
set(plugin_folder ${CMAKE_INSTALL_DATADIR}/qgis/python/plugins/talus_processing)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/qgis/talus_processing/ DESTINATION ${plugin_folder}
        PATTERN "__pycache__" EXCLUDE PATTERN "icon.svg" EXCLUDE)
install(FILES ${PROJECT_SOURCE_DIR}/web/src/style/mark.svg DESTINATION ${plugin_folder} RENAME icon.svg)
install(FILES ${PROJECT_SOURCE_DIR}/LICENSE DESTINATION ${plugin_folder})

install(DIRECTORY ${PROJECT_SOURCE_DIR}/scenes DESTINATION ${CMAKE_INSTALL_DATADIR}/talus PATTERN "*.py" EXCLUDE)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/examples/notebooks DESTINATION ${CMAKE_INSTALL_DOCDIR}/examples)
install(FILES ${PROJECT_SOURCE_DIR}/examples/embed.c ${PROJECT_SOURCE_DIR}/examples/fork.c DESTINATION ${CMAKE_INSTALL_DOCDIR}/examples)
install(FILES ${PROJECT_SOURCE_DIR}/README.md ${PROJECT_SOURCE_DIR}/LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR})
install(FILES ${CMAKE_CURRENT_LIST_DIR}/install/talus.desktop DESTINATION ${CMAKE_INSTALL_DATADIR}/applications)
install(FILES ${PROJECT_SOURCE_DIR}/web/src/style/mark.svg DESTINATION ${CMAKE_INSTALL_DATADIR}/icons/hicolor/scalable/apps
        RENAME talus.svg)

# scripts/package.sh: a package for Debian, and an archive.
set(CPACK_PACKAGE_VENDOR "talus")
set(CPACK_PACKAGE_CONTACT "The talus developers")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "landslides and debris flows on real terrain, live in the browser")
set(CPACK_PACKAGE_DESCRIPTION
    "talus simulates landslides and debris flows with position-based dynamics. It writes hazard maps, tables and a report, shows a run live in the browser, and comes with a C library.")
set(CPACK_RESOURCE_FILE_LICENSE ${PROJECT_SOURCE_DIR}/LICENSE)
set(CPACK_STRIP_FILES ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_DEPENDS "proj-data")  # which libproj only recommends
set(CPACK_DEBIAN_PACKAGE_RECOMMENDS "python3-numpy")
set(CPACK_DEBIAN_PACKAGE_GENERATE_SHLIBS ON)
set(CPACK_ARCHIVE_COMPONENT_INSTALL OFF)
include(CPack)
