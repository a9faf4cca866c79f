# What every target of the project shares, and a one-line way to declare a module.

add_library(talus_options INTERFACE)
target_include_directories(talus_options INTERFACE ${PROJECT_SOURCE_DIR}/src)
# Results must not depend on the optimiser: no -ffast-math, no contraction of a*b+c.
set(talus_cxx_options -Wall -Wextra -Wpedantic -Wshadow -Wnon-virtual-dtor -ffp-contract=off -fno-math-errno
    -Wno-psabi  # vectors wider than the baseline's registers never cross an interface
    -Wno-restrict)  # g++ 12 warns of std::string concatenation wrongly (GCC bug 105651)
if(TALUS_WARNINGS_AS_ERRORS)
  list(APPEND talus_cxx_options -Werror)
endif()
target_compile_options(talus_options INTERFACE "$<$<COMPILE_LANGUAGE:CXX>:${talus_cxx_options}>")
if(TALUS_SANITIZE)
  # Instrumented code makes g++ warn of std::regex's own variables; GCC documents such false alarms. What is left out takes
  # half the time to compile: null, object-size and vptr find little that the address sanitizer does not, and x86 reads
  # unaligned.
  target_compile_options(talus_options INTERFACE -fsanitize=${TALUS_SANITIZE} -fno-sanitize=null,alignment,object-size,vptr
                         -fno-omit-frame-pointer -Wno-maybe-uninitialized)
  target_link_options(talus_options INTERFACE -fsanitize=${TALUS_SANITIZE})
  if(TALUS_SANITIZE STREQUAL "thread")
    # Asio has fences, which the thread sanitizer does not see: one thread alone runs the server's loop, so none is needed.
    target_compile_options(talus_options INTERFACE -Wno-tsan)
  endif()
endif()

if(TALUS_FUZZ)
  target_compile_options(talus_options INTERFACE -fsanitize=fuzzer-no-link -Wno-unknown-warning-option)
endif()

# For what is compiled once per instruction set. SSSE3 alone is on no processor that anybody still has. Sanitized builds take
# minutes per instruction set and look at AVX2, which is on all of them, and at the baseline that every build has.
set(talus_disabled_instruction_sets HWY_SSSE3)
if(TALUS_SANITIZE)
  set(talus_disabled_instruction_sets "(HWY_SSSE3 | HWY_SSE4 | HWY_AVX3 | HWY_AVX3_DL)")
endif()

# talus_module(NAME DEPENDS... ): the library talus_NAME from every .cpp below the current folder.
# A module without a .cpp is an interface library.
function(talus_module name)
  file(GLOB_RECURSE sources CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/*.cpp)
  set(wanted "")
  if(TALUS_SANITIZE)
    set(wanted EXCLUDE_FROM_ALL)  # for the tests of a sanitized build, if one of them needs it
  endif()
  if(sources)
    add_library(talus_${name} STATIC ${wanted} ${sources})
    target_link_libraries(talus_${name} PUBLIC talus_options ${ARGN})
  else()
    add_library(talus_${name} INTERFACE)
    target_link_libraries(talus_${name} INTERFACE talus_options ${ARGN})
  endif()
endfunction()

# talus_glue(TARGET): reads, writes and puts together; no loop of it is hot. -O1 compiles it in two thirds of the time.
function(talus_glue target)
  if(CMAKE_BUILD_TYPE STREQUAL "Release")
    target_compile_options(${target} PRIVATE -O1)
  endif()
endfunction()

# talus_test(NAME LABEL DEPENDS...): the program test_NAME from every .cpp in the current folder, its tests labelled. A folder
# may set before it:
#   talus_measured_tests   regular expression of tests that measure time: each has the machine for itself
#   talus_memory_tests     googletest pattern of what the address sanitizer looks at: what reads what others wrote, indexes
#                          arrays, or owns memory across threads
#   talus_thread_tests     the same for the thread sanitizer
# Sanitized builds have these tests alone. A folder without such tests is not built there.
function(talus_test name label)
  file(GLOB sources CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/*.cpp)
  set(filter "")
  if(TALUS_SANITIZE)
    set(pattern "${talus_memory_tests}")
    if(TALUS_SANITIZE STREQUAL "thread")
      set(pattern "${talus_thread_tests}")
    endif()
    if(NOT pattern)
      return()
    endif()
    set(filter TEST_FILTER "${pattern}")
  endif()
  add_executable(test_${name} ${sources})
  target_link_libraries(test_${name} PRIVATE ${ARGN} GTest::gtest GTest::gtest_main GTest::gmock)
  target_include_directories(test_${name} PRIVATE ${PROJECT_SOURCE_DIR}/tests)
  target_compile_definitions(test_${name} PRIVATE TALUS_SOURCE_DIR="${PROJECT_SOURCE_DIR}"
                             TALUS_PROGRAM="${CMAKE_BINARY_DIR}/bin/talus")
  # A test spends its time in the libraries, which are optimised; those labelled `physics` call laws themselves.
  if(label STREQUAL physics OR label STREQUAL threads)
    target_compile_options(test_${name} PRIVATE -O1)
  else()
    target_compile_options(test_${name} PRIVATE -O0)
  endif()
  gtest_discover_tests(test_${name} TEST_PREFIX ${name}. ${filter} PROPERTIES LABELS ${label} TIMEOUT 300
                       DISCOVERY_TIMEOUT 60)
  if(talus_measured_tests)
    # Names are known once the program is built: ctest reads this after the list of them.
    set(properties ${CMAKE_CURRENT_BINARY_DIR}/measured_tests.cmake)
    file(WRITE ${properties} "foreach(name IN LISTS test_${name}_TESTS)
  if(name MATCHES \"${talus_measured_tests}\")
    set_tests_properties(\${name} PROPERTIES RUN_SERIAL ON)
  endif()
endforeach()
")
    set_property(DIRECTORY APPEND PROPERTY TEST_INCLUDE_FILES ${properties})
  endif()
endfunction()

# talus_reads_foreign(TARGET): a test program that has untrusted files read, and sees what is opened for it.
function(talus_reads_foreign target)
  if(NOT TARGET ${target})
    return()
  endif()
  target_sources(${target} PRIVATE ${PROJECT_SOURCE_DIR}/tests/support/witness.cpp ${PROJECT_SOURCE_DIR}/tests/support/witness_log.cpp)
  target_link_libraries(${target} PRIVATE ${CMAKE_DL_LIBS})
  target_compile_definitions(${target} PRIVATE FOREIGN_CHILD="$<TARGET_FILE:foreign_child>")
  add_dependencies(${target} foreign_child)
endfunction()
