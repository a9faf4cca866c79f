# scripts/package.sh: five packages for Debian, and an archive of everything.
set(TALUS_MAINTAINER "The talus developers <talus@example.org>" CACHE STRING
    "Who answers for Debian packages, as NAME <ADDRESS>; the default is a placeholder")
if(NOT TALUS_MAINTAINER MATCHES "^[^<>@]*[^<>@ ] <[^<>@ ]+@[^<>@ ]+[.][a-z]+>$")
  message(FATAL_ERROR "TALUS_MAINTAINER = \"${TALUS_MAINTAINER}\"; it must be NAME <ADDRESS>, as \"The talus developers <talus@example.org>\"")
endif()

set(CPACK_PACKAGE_VENDOR "talus")
set(CPACK_PACKAGE_CONTACT ${TALUS_MAINTAINER})
set(CPACK_RESOURCE_FILE_LICENSE ${PROJECT_SOURCE_DIR}/LICENSE)
# Every package has a summary of its own; CPack would put any other than this one before it.
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "${CMAKE_PROJECT_NAME} built using CMake")
set(CPACK_STRIP_FILES ON)
set(CPACK_ARCHIVE_COMPONENT_INSTALL OFF)

set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_COMPONENTS_GROUPING IGNORE)
set(CPACK_COMPONENTS_ALL talus library development python documentation)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SOURCE talus)
set(CPACK_DEBIAN_PACKAGE_GENERATE_SHLIBS ON)
set(CPACK_DEBIAN_PACKAGE_GENERATE_SHLIBS_POLICY ">=")
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ
                                                WORLD_EXECUTE)
set(CPACK_POST_BUILD_SCRIPTS ${CMAKE_CURRENT_LIST_DIR}/debian/finish.cmake)

set(library_package libtalus${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR})  # as its soname
set(same_library "${library_package} (= ${PROJECT_VERSION})")
configure_file(${CMAKE_CURRENT_LIST_DIR}/debian/changelog.in debian/changelog @ONLY)
execute_process(COMMAND gzip -9 --no-name --force --keep ${CMAKE_CURRENT_BINARY_DIR}/debian/changelog)

# talus_debian_package(COMPONENT NAME SECTION SUMMARY DESCRIPTION): its changelog and its copyright are in the package alone.
function(talus_debian_package component name section summary description)
  string(TOUPPER ${component} upper)
  set(CPACK_DEBIAN_${upper}_PACKAGE_NAME ${name} PARENT_SCOPE)
  set(CPACK_DEBIAN_${upper}_PACKAGE_SECTION ${section} PARENT_SCOPE)
  set(CPACK_DEBIAN_${upper}_DESCRIPTION "${summary}\n${description}" PARENT_SCOPE)
  install(FILES ${CMAKE_CURRENT_BINARY_DIR}/debian/changelog.gz ${PROJECT_SOURCE_DIR}/cmake/debian/copyright
          DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/${name} COMPONENT ${component} EXCLUDE_FROM_ALL)
endfunction()

set(what "talus simulates landslides and debris flows on a terrain model with\nposition-based dynamics.")  # lines of at most 80 characters

talus_debian_package(talus talus science "landslides and debris flows on real terrain, live in the browser"
    "${what} It writes hazard maps, tables and a report, and shows\na run live in the browser.\n.\nThis package has the program, its scenes and a plugin for QGIS.")
set(CPACK_DEBIAN_TALUS_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_TALUS_PACKAGE_DEPENDS "proj-data")  # which libproj only recommends
set(CPACK_DEBIAN_TALUS_PACKAGE_RECOMMENDS "xdg-utils")
set(CPACK_DEBIAN_TALUS_PACKAGE_SUGGESTS "talus-doc, python3-talus, qgis")

talus_debian_package(library ${library_package} libs "landslides and debris flows on real terrain: library"
    "${what}\n.\nThis package has the library of the engine, which has a C interface.")
set(CPACK_DEBIAN_LIBRARY_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_LIBRARY_PACKAGE_DEPENDS "proj-data")
set(CPACK_DEBIAN_LIBRARY_PACKAGE_CONTROL_EXTRA ${CMAKE_CURRENT_LIST_DIR}/debian/library/triggers)

talus_debian_package(development libtalus-dev libdevel "landslides and debris flows on real terrain: development files"
    "${what}\n.\nThis package has what a program needs that is built on the library: its\nheader, and files for CMake and pkg-config.")
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_DEPENDS ${same_library})
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SUGGESTS "talus-doc")

talus_debian_package(python python3-talus python "landslides and debris flows on real terrain: Python package"
    "${what}\n.\nThis package runs and changes simulations from Python. Results are NumPy\narrays.")
set(CPACK_DEBIAN_PYTHON_PACKAGE_ARCHITECTURE all)
set(CPACK_DEBIAN_PYTHON_PACKAGE_DEPENDS "python3, python3-numpy, ${same_library}")
set(CPACK_DEBIAN_PYTHON_PACKAGE_SUGGESTS "python3-matplotlib, python3-xarray, python3-geopandas, talus-doc")
set(CPACK_DEBIAN_PYTHON_PACKAGE_CONTROL_EXTRA ${CMAKE_CURRENT_LIST_DIR}/debian/python/postinst
                                              ${CMAKE_CURRENT_LIST_DIR}/debian/python/prerm)

talus_debian_package(documentation talus-doc doc "landslides and debris flows on real terrain: documentation"
    "${what}\n.\nThis package has the documentation that manual pages and messages name, a\nprogram in C and notebooks for Python.")
set(CPACK_DEBIAN_DOCUMENTATION_PACKAGE_ARCHITECTURE all)

include(CPack)
