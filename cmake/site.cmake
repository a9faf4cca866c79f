# The page: web/ built with npm, packed into one archive, taken into the program.
#
# embed_site(TARGET SOURCE): builds the page when its sources have changed and gives SOURCE of TARGET the archive's path as
# TALUS_SITE_ARCHIVE. Without TALUS_WEB nothing is defined, and the program says that it was built without the page.

set(talus_web_folder ${PROJECT_SOURCE_DIR}/web)
find_program(TALUS_NPM npm)
find_program(TALUS_NODE NAMES node nodejs)
if(EXISTS ${talus_web_folder}/package.json AND TALUS_NPM AND TALUS_NODE)
  set(talus_web_default ON)
else()
  set(talus_web_default OFF)
endif()
option(TALUS_WEB "Build the page of talus serve into the program" ${talus_web_default})
set(talus_site_packer ${CMAKE_CURRENT_LIST_DIR}/pack_site.mjs)

function(embed_site target source)
  if(NOT TALUS_WEB)
    message(STATUS "The page of talus serve is left out: TALUS_WEB is off (it needs web/package.json, npm and node)")
    return()
  endif()
  if(NOT EXISTS ${talus_web_folder}/package.json)
    message(FATAL_ERROR "TALUS_WEB is on, but there is no web/package.json; configure with -DTALUS_WEB=OFF")
  endif()
  if(NOT TALUS_NPM OR NOT TALUS_NODE)
    message(FATAL_ERROR "TALUS_WEB is on, but npm or node is missing: scripts/install_packages.sh build installs them; "
                        "or configure with -DTALUS_WEB=OFF to build without the page")
  endif()
  file(GLOB_RECURSE sources CONFIGURE_DEPENDS ${talus_web_folder}/src/* ${talus_web_folder}/public/*)
  file(GLOB settings CONFIGURE_DEPENDS ${talus_web_folder}/*.html ${talus_web_folder}/*.json ${talus_web_folder}/*.ts
       ${talus_web_folder}/*.mjs)
  set(installed ${talus_web_folder}/node_modules/.installed-lock.json)
  # Both are in the source tree, so that a second build folder finds them made.
  add_custom_command(
    OUTPUT ${installed}
    COMMAND ${TALUS_NPM} ci --no-audit --no-fund
    COMMAND ${CMAKE_COMMAND} -E copy package-lock.json node_modules/.installed-lock.json
    DEPENDS ${talus_web_folder}/package-lock.json
    WORKING_DIRECTORY ${talus_web_folder}
    COMMENT "Installing what the page is built with" VERBATIM)
  add_custom_command(
    OUTPUT ${talus_web_folder}/dist/index.html
    COMMAND ${TALUS_NPM} run build
    COMMAND ${CMAKE_COMMAND} -E touch dist/index.html
    DEPENDS ${installed} ${sources} ${settings}
    WORKING_DIRECTORY ${talus_web_folder}
    COMMENT "Building the page" VERBATIM)
  set(archive ${CMAKE_CURRENT_BINARY_DIR}/embedded/site.archive)
  add_custom_command(
    OUTPUT ${archive}
    COMMAND ${CMAKE_COMMAND} -E make_directory ${CMAKE_CURRENT_BINARY_DIR}/embedded
    COMMAND ${TALUS_NODE} ${talus_site_packer} ${talus_web_folder}/dist ${archive}
    DEPENDS ${talus_web_folder}/dist/index.html ${talus_site_packer}
    COMMENT "Packing the page" VERBATIM)
  set_source_files_properties(${source} PROPERTIES COMPILE_DEFINITIONS "TALUS_SITE_ARCHIVE=\"${archive}\""
                                                   OBJECT_DEPENDS ${archive})
endfunction()
