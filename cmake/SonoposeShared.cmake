# libsonopose.so: every installed module in one shared library, with its public names alone, and sonopose.pc.
set(archives "")
foreach(component estimation dds)
  get_property(installed_targets GLOBAL PROPERTY SONOPOSE_INSTALLED_${component})
  foreach(target ${installed_targets})
    get_target_property(type ${target} TYPE)
    if(type STREQUAL STATIC_LIBRARY)
      list(APPEND archives ${target})
    endif()
  endforeach()
endforeach()
file(WRITE ${PROJECT_BINARY_DIR}/shared.cpp "")
add_library(sonopose_shared SHARED ${PROJECT_BINARY_DIR}/shared.cpp)
add_dependencies(sonopose_shared ${archives})
list(TRANSFORM archives REPLACE "(.+)" "$<TARGET_FILE:\\1>" OUTPUT_VARIABLE archive_files)
set(names ${CMAKE_CURRENT_LIST_DIR}/shared_names.map)
target_link_options(sonopose_shared PRIVATE
  LINKER:--version-script=${names} LINKER:--whole-archive ${archive_files} LINKER:--no-whole-archive)
target_link_libraries(sonopose_shared
  PUBLIC CycloneDDS::ddsc Eigen3::Eigen PRIVATE fmt::fmt pugixml::pugixml Threads::Threads)
target_compile_features(sonopose_shared INTERFACE cxx_std_20)
target_include_directories(sonopose_shared INTERFACE $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
# The names may change with each minor version before 1.0, and the packages depend on that (debian/).
set_target_properties(sonopose_shared PROPERTIES
  OUTPUT_NAME sonopose EXPORT_NAME shared VERSION ${PROJECT_VERSION} SOVERSION ${PROJECT_VERSION_MAJOR}
  LINK_DEPENDS "${archive_files};${names}")
install(TARGETS sonopose_shared EXPORT sonopose_dds LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR})
foreach(name sonopose sonopose-cxx)  # the second adds <dds/dds.hpp>
  configure_file(${CMAKE_CURRENT_LIST_DIR}/${name}.pc.in ${PROJECT_BINARY_DIR}/${name}.pc @ONLY)
endforeach()
install(FILES ${PROJECT_BINARY_DIR}/sonopose.pc ${PROJECT_BINARY_DIR}/sonopose-cxx.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig)
