# sonopose::cxx: <dds/dds.hpp> of the ISO C++ PSM, and sonopose.hpp with the types of sonopose.idl. Both are our subset,
# or those of cyclonedds-cxx. Part of the build and of the installed package: SONOPOSE_IDL_FILE is sonopose.idl.
set(SONOPOSE_DDS auto CACHE STRING "C++ binding of sonopose::cxx: own, cyclonedds-cxx, or auto: that if it is found")
set_property(CACHE SONOPOSE_DDS PROPERTY STRINGS auto own cyclonedds-cxx)
if(NOT SONOPOSE_DDS MATCHES "^(auto|own|cyclonedds-cxx)$")
  message(FATAL_ERROR "SONOPOSE_DDS is '${SONOPOSE_DDS}': auto, own or cyclonedds-cxx is needed")
endif()
set(SONOPOSE_CXX_BINDING own)
if(NOT SONOPOSE_DDS STREQUAL own)
  find_package(iceoryx_binding_c QUIET)  # cyclonedds-cxx may link it, and does not look for it
  find_package(CycloneDDS-CXX QUIET)  # its version is in a file that CMake does not read
  if(CycloneDDS-CXX_FOUND)
    set(SONOPOSE_CXX_BINDING cyclonedds-cxx)
  elseif(SONOPOSE_DDS STREQUAL cyclonedds-cxx)
    message(FATAL_ERROR "SONOPOSE_DDS is cyclonedds-cxx, but find_package(CycloneDDS-CXX) does not find it")
  endif()
endif()
message(STATUS "C++ binding of sonopose::cxx: ${SONOPOSE_CXX_BINDING}")

# sonopose_idlcxx_generate(TARGET name FILES file.idl ... [INCLUDES ...] [WARNINGS ...] [DEFAULT_EXTENSIBILITY ...]): the
# library `name` with the types of IDL files for the binding of sonopose::cxx, as idlcxx_generate of cyclonedds-cxx makes
# them. Users include "file.hpp".
function(sonopose_idlcxx_generate)
  if(SONOPOSE_CXX_BINDING STREQUAL own)
    sonopose_psm_generate(${ARGN})
  else()
    idlcxx_generate(${ARGN})
  endif()
endfunction()

# The same for ours, sonopose::psm.
function(sonopose_psm_generate)
  cmake_parse_arguments(idl "" "TARGET;DEFAULT_EXTENSIBILITY" "FILES;INCLUDES;WARNINGS" ${ARGN})
  set(arguments FILES ${idl_FILES} INCLUDES ${idl_INCLUDES} WARNINGS ${idl_WARNINGS}
    DEFAULT_EXTENSIBILITY ${idl_DEFAULT_EXTENSIBILITY})
  idlc_generate(TARGET ${idl_TARGET}_c ${arguments})
  idlc_generate_generic(TARGET ${idl_TARGET} BACKEND $<TARGET_FILE:sonopose::idlcxx> ${arguments}
    SUFFIXES .hpp DEPENDS sonopose::idlcxx)
  target_link_libraries(${idl_TARGET} INTERFACE ${idl_TARGET}_c)
  add_dependencies(${idl_TARGET} ${idl_TARGET}_c_generate)
endfunction()

if(NOT TARGET sonopose::cxx)
  add_library(sonopose::cxx INTERFACE IMPORTED)
  if(SONOPOSE_CXX_BINDING STREQUAL own)
    target_link_libraries(sonopose::cxx INTERFACE sonopose::psm)
  else()
    if(NOT TARGET sonopose_cxx_types)
      idlcxx_generate(TARGET sonopose_cxx_types FILES ${SONOPOSE_IDL_FILE})
    endif()
    target_link_libraries(sonopose::cxx INTERFACE CycloneDDS-CXX::ddscxx sonopose_cxx_types)
  endif()
endif()
