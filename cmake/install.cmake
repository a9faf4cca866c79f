# cmake --install: program, library for other programs, scenes, manual pages, completion, and what a desktop needs. All of it can
# be moved together. A component is a package of Debian (package.cmake); what is in `archive` Debian has elsewhere.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

install(TARGETS talus RUNTIME COMPONENT talus)
install(TARGETS libtalus EXPORT talus LIBRARY COMPONENT library NAMELINK_COMPONENT development
        PUBLIC_HEADER COMPONENT development)

# find_package(talus) and pkg-config.
set(package_folder ${CMAKE_INSTALL_LIBDIR}/cmake/talus)
install(EXPORT talus NAMESPACE talus:: FILE talusTargets.cmake DESTINATION ${package_folder} COMPONENT development)
configure_package_config_file(${CMAKE_CURRENT_LIST_DIR}/install/talusConfig.cmake.in talusConfig.cmake
                              INSTALL_DESTINATION ${package_folder})
write_basic_package_version_file(talusConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/talusConfig.cmake ${CMAKE_CURRENT_BINARY_DIR}/talusConfigVersion.cmake
        DESTINATION ${package_folder} COMPONENT development)
cmake_path(RELATIVE_PATH CMAKE_INSTALL_PREFIX BASE_DIRECTORY ${CMAKE_INSTALL_FULL_LIBDIR}/pkgconfig OUTPUT_VARIABLE to_prefix)
configure_file(${CMAKE_CURRENT_LIST_DIR}/install/talus.pc.in talus.pc @ONLY)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/talus.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig COMPONENT development)

# From the program itself: what it prints with --help. man reads compressed pages, and Debian wants them so.
set(shared ${CMAKE_BINARY_DIR}/share)
add_custom_command(
  OUTPUT ${shared}/made
  COMMAND ${CMAKE_COMMAND} -E rm -rf ${shared}
  COMMAND ${CMAKE_COMMAND} -E make_directory ${shared}/man ${shared}/bash ${shared}/zsh
  COMMAND talus manual --folder ${shared}/man
  COMMAND gzip -9 --no-name --recursive ${shared}/man
  COMMAND talus completion bash > ${shared}/bash/talus
  COMMAND talus completion zsh > ${shared}/zsh/_talus
  COMMAND ${CMAKE_COMMAND} -E touch ${shared}/made
  DEPENDS talus
  COMMENT "Manual pages and completion"
  VERBATIM)
add_custom_target(manuals ALL DEPENDS ${shared}/made)
install(DIRECTORY ${shared}/man/ DESTINATION ${CMAKE_INSTALL_MANDIR}/man1 COMPONENT talus)
install(FILES ${shared}/bash/talus DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions COMPONENT talus)
# Debian's zsh looks into the first folder, others into the second.
install(FILES ${shared}/zsh/_talus DESTINATION ${CMAKE_INSTALL_DATADIR}/zsh/vendor-completions COMPONENT talus)
install(FILES ${shared}/zsh/_talus DESTINATION ${CMAKE_INSTALL_DATADIR}/zsh/site-functions COMPONENT archive)

# Where Debian's Python looks; elsewhere PYTHONPATH names it. The package finds the library from where it lies itself.
install(DIRECTORY ${PROJECT_SOURCE_DIR}/python/talus DESTINATION lib/python3/dist-packages COMPONENT python
        PATTERN "__pycache__" EXCLUDE)

# Where Debian's QGIS looks; elsewhere QGIS_PLUGINPATH names the folder above it.
set(plugin_folder ${CMAKE_INSTALL_DATADIR}/qgis/python/plugins/talus_processing)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/qgis/talus_processing/ DESTINATION ${plugin_folder} COMPONENT talus
        PATTERN "__pycache__" EXCLUDE PATTERN "icon.svg" EXCLUDE)
set(mark ${PROJECT_SOURCE_DIR}/web/src/style/mark.svg)
install(FILES ${mark} DESTINATION ${plugin_folder} RENAME icon.svg COMPONENT talus)
install(FILES ${PROJECT_SOURCE_DIR}/LICENSE DESTINATION ${plugin_folder} COMPONENT archive)

# The engine of published twins, for a program that was built before it; scripts/package.sh builds it first.
install(FILES ${TALUS_ENGINE_FOLDER}/talus_engine.js ${TALUS_ENGINE_FOLDER}/talus_engine.wasm
        DESTINATION ${CMAKE_INSTALL_DATADIR}/talus/web_engine COMPONENT talus OPTIONAL)

install(DIRECTORY ${PROJECT_SOURCE_DIR}/scenes DESTINATION ${CMAKE_INSTALL_DATADIR}/talus COMPONENT talus PATTERN "*.py" EXCLUDE)
# What manual pages and errors call docs/..., with the links between them.
install(DIRECTORY ${PROJECT_SOURCE_DIR}/docs DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT documentation)
install(FILES ${PROJECT_SOURCE_DIR}/README.md DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT documentation)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/examples/notebooks DESTINATION ${CMAKE_INSTALL_DOCDIR}/examples COMPONENT documentation)
install(FILES ${PROJECT_SOURCE_DIR}/examples/embed.c ${PROJECT_SOURCE_DIR}/examples/fork.c DESTINATION ${CMAKE_INSTALL_DOCDIR}/examples COMPONENT documentation)
install(FILES ${PROJECT_SOURCE_DIR}/LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT archive)

install(FILES ${CMAKE_CURRENT_LIST_DIR}/install/talus.desktop DESTINATION ${CMAKE_INSTALL_DATADIR}/applications COMPONENT talus)
install(FILES ${CMAKE_CURRENT_LIST_DIR}/install/talus.xml DESTINATION ${CMAKE_INSTALL_DATADIR}/mime/packages COMPONENT talus)
install(FILES ${mark} DESTINATION ${CMAKE_INSTALL_DATADIR}/icons/hicolor/scalable/apps RENAME talus.svg COMPONENT talus)

include(${CMAKE_CURRENT_LIST_DIR}/package.cmake)
