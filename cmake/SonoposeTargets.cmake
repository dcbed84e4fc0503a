# How every target of the project is made: one place for language, warnings and sanitizers.

# sonopose_compile_options(TARGET): the flags that all of our own code is built with.
function(sonopose_compile_options target)
  target_compile_features(${target} PUBLIC cxx_std_20)
  set_target_properties(${target} PROPERTIES CXX_EXTENSIONS OFF)
  # Contracted multiply-adds would make the same log give other bits on another machine.
  target_compile_options(${target} PRIVATE
    $<$<COMPILE_LANGUAGE:CXX>:-Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wsign-conversion
                              -Wnon-virtual-dtor -Woverloaded-virtual -ffp-contract=off>
    $<$<AND:$<BOOL:${SONOPOSE_WARNINGS_AS_ERRORS}>,$<COMPILE_LANGUAGE:CXX>>:-Werror>)
  if(CMAKE_CXX_COMPILER_ID STREQUAL GNU)  # a tenth of the compile time for 200 MB: collect garbage less often
    target_compile_options(${target} PRIVATE --param=ggc-min-expand=300 --param=ggc-min-heapsize=1048576)
    if(CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)  # false alarms with -O3, sanitizers and precompiled headers
      target_compile_options(${target} PRIVATE
        $<$<COMPILE_LANGUAGE:CXX>:-Wno-array-bounds -Wno-maybe-uninitialized -Wno-restrict -Wno-stringop-overflow
                                  -Wno-stringop-overread>)
    endif()
  endif()
  if(SONOPOSE_SANITIZE)
    target_compile_options(${target} PRIVATE -fsanitize=${SONOPOSE_SANITIZE} -fno-omit-frame-pointer)
    if(SONOPOSE_SANITIZE MATCHES undefined)
      target_compile_options(${target} PRIVATE -fno-sanitize-recover=undefined)
    endif()
    target_link_options(${target} PUBLIC -fsanitize=${SONOPOSE_SANITIZE})
    if(SONOPOSE_SANITIZE MATCHES fuzzer)  # scripts/fuzz prints the coverage
      target_compile_options(${target} PRIVATE
        -fsanitize-ignorelist=${PROJECT_SOURCE_DIR}/fuzz/ignored.txt
        -fprofile-instr-generate -fcoverage-mapping)
      target_link_options(${target} PUBLIC -fprofile-instr-generate)
    endif()
  endif()
endfunction()

# Code off the path from a sample to its pose compiles in two thirds of the time with -Og. Releases optimise everything.
function(sonopose_cold target)
  if(SONOPOSE_SANITIZE MATCHES fuzzer)
    return()  # fuzzing needs speed
  endif()
  target_compile_options(${target} PRIVATE $<$<CONFIG:RelWithDebInfo>:-Og>)
endfunction()

# Products of small matrices take a third less time with -O3. Without precompiled headers, which are made with -O2.
function(sonopose_hot target)
  if(NOT SONOPOSE_SANITIZE)
    target_compile_options(${target} PRIVATE $<$<CONFIG:RelWithDebInfo>:-O3>)
  endif()
endfunction()

# The sources of a target compile together where SONOPOSE_UNITY is on: what they include is read once.
function(sonopose_unity target)
  set_target_properties(${target} PROPERTIES UNITY_BUILD ${SONOPOSE_UNITY} UNITY_BUILD_BATCH_SIZE 0)
endfunction()

# sonopose_precompile(TARGET OWNER HEADERS ...): where SONOPOSE_PRECOMPILE is on, headers that nearly every file of a
# target includes are compiled once, in OWNER, which has the same flags: up to two thirds of a file's compile time.
function(sonopose_precompile target owner)
  if(NOT SONOPOSE_PRECOMPILE)
    return()
  endif()
  # g++ 12 warns about system headers when they are precompiled.
  target_compile_options(${target} PRIVATE $<$<COMPILE_LANGUAGE:CXX>:-Wno-ignored-attributes>)
  if(target STREQUAL owner)
    target_precompile_headers(${target} PRIVATE ${ARGN})
  else()
    target_precompile_headers(${target} REUSE_FROM ${owner})
  endif()
endfunction()

# sonopose_module(NAME [COLD | HOT] [SOURCES ...] [USES ...] [PRIVATELY_USES ...]): one library `sonopose::NAME` for the
# folder of its CMakeLists.txt; without sources it is headers alone. USES and PRIVATELY_USES are the dependency rule: a
# module includes only what is listed there (tests/architecture/dependencies_test.cpp). COLD: not on the path
# from a sample to its pose, in DDS or ROS 2. HOT: most of the work for a sample, or for a run of the doctor.
function(sonopose_module name)
  cmake_parse_arguments(module "COLD;HOT" "" "SOURCES;USES;PRIVATELY_USES" ${ARGN})
  set(includes $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/include> $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
  foreach(group core platform formats tools nodes/shared nodes)
    list(APPEND includes $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/src/${group}>)
  endforeach()
  if(module_SOURCES)
    add_library(sonopose_${name} STATIC ${module_SOURCES})
    target_include_directories(sonopose_${name} PUBLIC ${includes})
    target_link_libraries(sonopose_${name} PUBLIC ${module_USES} PRIVATE ${module_PRIVATELY_USES})
    set_target_properties(sonopose_${name} PROPERTIES POSITION_INDEPENDENT_CODE ON)
    sonopose_unity(sonopose_${name})
    sonopose_compile_options(sonopose_${name})
    if(module_COLD)
      sonopose_cold(sonopose_${name})
      sonopose_precompile(sonopose_${name} sonopose_precompiled_cold)
    elseif(module_HOT)
      sonopose_hot(sonopose_${name})
    else()
      sonopose_precompile(sonopose_${name} sonopose_precompiled)
    endif()
  else()
    add_library(sonopose_${name} INTERFACE)
    target_include_directories(sonopose_${name} INTERFACE ${includes})
    target_link_libraries(sonopose_${name} INTERFACE ${module_USES})
    target_compile_features(sonopose_${name} INTERFACE cxx_std_20)
  endif()
  add_library(sonopose::${name} ALIAS sonopose_${name})
  set_target_properties(sonopose_${name} PROPERTIES EXPORT_NAME ${name})
  # A module is installed if it has public headers.
  cmake_path(RELATIVE_PATH CMAKE_CURRENT_SOURCE_DIR BASE_DIRECTORY ${PROJECT_SOURCE_DIR}/src OUTPUT_VARIABLE folder)
  set(component dds)
  if(folder MATCHES "^core/")
    set(component estimation)
  endif()
  string(REGEX REPLACE "^(nodes/shared|[a-z]+)/(.*)$" "\\2" folder "${folder}")
  if(EXISTS ${PROJECT_SOURCE_DIR}/include/sonopose/${folder})
    set_property(GLOBAL APPEND PROPERTY SONOPOSE_INSTALLED_${component} sonopose_${name})
  endif()
endfunction()
