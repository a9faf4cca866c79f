# Files inside the program, so that nothing has to be found at run time.
#
# embed_files(TARGET NAMESPACE [BASE FOLDER] FILES...): adds to TARGET a source that holds the bytes of FILES (relative to the current
# folder) and a header <NAMESPACE>.hpp that declares, in talus::<module>::NAMESPACE,
#   - a std::string_view per file, named as the file with every other character than letters and digits as "_",
#   - `files`: all of them with their names, in the order given. With BASE, names are paths relative to that folder.
# The source is made again when a file changes.

if(CMAKE_SCRIPT_MODE_FILE)
  # Called as `cmake -DMODULE=... -DSPACE=... -DOUTPUT=... -DFILES=a|b -P embed.cmake` by the command below.
  string(REPLACE "|" ";" FILES "${FILES}")
  set(bodies "")
  set(views "")
  set(rows "")
  foreach(path IN LISTS FILES)
    if(BASE)
      file(RELATIVE_PATH file_name "${BASE}" "${path}")
    else()
      get_filename_component(file_name "${path}" NAME)
    endif()
    string(REGEX REPLACE "[^A-Za-z0-9]" "_" symbol "${file_name}")
    file(READ "${path}" bytes HEX)
    string(LENGTH "${bytes}" digits)
    math(EXPR size "${digits} / 2")
    string(REGEX REPLACE "(................................................................)" "\\1\n" bytes "${bytes}")
    string(REGEX REPLACE "([0-9a-f][0-9a-f])" "0x\\1," bytes "${bytes}")
    string(APPEND bodies "const unsigned char ${symbol}_bytes[] = {\n${bytes}0};\n")
    string(APPEND views "const std::string_view ${symbol}{reinterpret_cast<const char*>(${symbol}_bytes), ${size}};\n")
    string(APPEND rows "    {\"${file_name}\", {reinterpret_cast<const char*>(${symbol}_bytes), ${size}}},\n")
  endforeach()
  file(WRITE "${OUTPUT}" "#include \"${SPACE}.hpp\"\n\nnamespace talus::${MODULE}::${SPACE} {\nnamespace {\n${bodies}}\n${views}\
const std::array<File, file_count> files = {{\n${rows}}};\n}  // namespace talus::${MODULE}::${SPACE}\n")
  return()
endif()

set(talus_embed_script ${CMAKE_CURRENT_LIST_FILE})

function(embed_files target space)
  cmake_parse_arguments(PARSE_ARGV 2 embed "" "BASE" "")
  string(REGEX REPLACE "^talus_" "" module ${target})
  set(folder ${CMAKE_CURRENT_BINARY_DIR}/embedded)
  set(paths "")
  set(declarations "")
  foreach(file IN LISTS embed_UNPARSED_ARGUMENTS)
    get_filename_component(path "${file}" ABSOLUTE)
    if(embed_BASE)
      file(RELATIVE_PATH file_name "${embed_BASE}" "${path}")
    else()
      get_filename_component(file_name "${path}" NAME)
    endif()
    string(REGEX REPLACE "[^A-Za-z0-9]" "_" symbol "${file_name}")
    list(APPEND paths "${path}")
    string(APPEND declarations "extern const std::string_view ${symbol};\n")
  endforeach()
  list(LENGTH paths count)
  file(CONFIGURE OUTPUT ${folder}/${space}.hpp @ONLY CONTENT "#pragma once

#include <array>
#include <string_view>

namespace talus::@module@::@space@ {

struct File {
    std::string_view name, content;
};
inline constexpr std::size_t file_count = @count@;
extern const std::array<File, file_count> files;
@declarations@
}  // namespace talus::@module@::@space@
")
  list(JOIN paths "|" joined)
  add_custom_command(
    OUTPUT ${folder}/${space}.cpp
    COMMAND ${CMAKE_COMMAND} -DMODULE=${module} -DSPACE=${space} -DOUTPUT=${folder}/${space}.cpp -DBASE=${embed_BASE} "-DFILES=${joined}"
            -P ${talus_embed_script}
    DEPENDS ${paths} ${talus_embed_script}
    COMMENT "Embedding ${space}" VERBATIM)
  target_sources(${target} PRIVATE ${folder}/${space}.cpp)
  add_custom_target(${space}_source DEPENDS ${folder}/${space}.cpp)
  add_dependencies(generated_sources ${space}_source)
  target_include_directories(${target} PRIVATE ${folder})
endfunction()
