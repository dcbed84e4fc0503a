# zstd and lz4 of Debian: the one has no CMake configuration in older releases, the other has none at all.

# sonopose_compression_library(TARGET HEADER LIBRARY)
function(sonopose_compression_library target header library)
  find_path(${library}_INCLUDE_DIR ${header} REQUIRED)
  find_library(${library}_LIBRARY ${library} REQUIRED)
  mark_as_advanced(${library}_INCLUDE_DIR ${library}_LIBRARY)
  add_library(${target} UNKNOWN IMPORTED GLOBAL)
  set_target_properties(${target} PROPERTIES
    IMPORTED_LOCATION ${${library}_LIBRARY} INTERFACE_INCLUDE_DIRECTORIES ${${library}_INCLUDE_DIR})
endfunction()

find_package(ZLIB REQUIRED)
sonopose_compression_library(Zstd::Zstd zstd.h zstd)
sonopose_compression_library(Lz4::Lz4 lz4frame.h lz4)
