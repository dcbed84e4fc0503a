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
  if(SONOPOSE_SANITIZE)
    target_compile_options(${target} PRIVATE -fsanitize=${SONOPOSE_SANITIZE} -fno-omit-frame-pointer
      -Wno-maybe-uninitialized -Wno-stringop-overflow)  # g++ 12 is often wrong in instrumented code
    target_link_options(${target} PUBLIC -fsanitize=${SONOPOSE_SANITIZE})
  endif()
endfunction()

# sonopose_room(NAME SOURCES ... USES ...): one library `sonopose::NAME`. USES is the wall:
# a room sees only what stands there.
function(sonopose_room name)
  cmake_parse_arguments(room "" "" "SOURCES;USES;PRIVATELY_USES" ${ARGN})
  add_library(sonopose_${name} STATIC ${room_SOURCES})
  add_library(sonopose::${name} ALIAS sonopose_${name})
  set_target_properties(sonopose_${name} PROPERTIES EXPORT_NAME ${name} POSITION_INDEPENDENT_CODE ON)
  target_include_directories(sonopose_${name} PUBLIC
    $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/include> $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
  target_link_libraries(sonopose_${name} PUBLIC ${room_USES} PRIVATE ${room_PRIVATELY_USES})
  sonopose_compile_options(sonopose_${name})
  set_property(GLOBAL APPEND PROPERTY SONOPOSE_INSTALLED_TARGETS sonopose_${name})
endfunction()
