# `cmake --install` and `find_package(sonopose)`.
include(CMakePackageConfigHelpers)

# The component `estimation` needs only Eigen; `dds` is everything else.
foreach(component estimation dds)
  get_property(installed_targets GLOBAL PROPERTY SONOPOSE_INSTALLED_${component})
  install(TARGETS ${installed_targets} EXPORT sonopose_${component} ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
  install(EXPORT sonopose_${component} NAMESPACE sonopose:: DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/sonopose)
endforeach()
if(SONOPOSE_BUILD_SHARED)
  include(${CMAKE_CURRENT_LIST_DIR}/SonoposeShared.cmake)
endif()
install(DIRECTORY include/sonopose DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} FILES_MATCHING PATTERN "*.hpp")
install(DIRECTORY qos config DESTINATION ${CMAKE_INSTALL_DATADIR}/sonopose PATTERN cyclonedds-loopback.xml EXCLUDE)
install(FILES config/cyclonedds-loopback.xml DESTINATION ${CMAKE_INSTALL_DATADIR}/sonopose)
install(FILES idl/sonopose.idl DESTINATION ${CMAKE_INSTALL_DATADIR}/sonopose/idl)
install(DIRECTORY idl/ros2 DESTINATION ${CMAKE_INSTALL_DATADIR}/sonopose/idl FILES_MATCHING PATTERN "*.idl")
configure_package_config_file(cmake/sonoposeConfig.cmake.in ${PROJECT_BINARY_DIR}/sonoposeConfig.cmake
  INSTALL_DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/sonopose)
write_basic_package_version_file(${PROJECT_BINARY_DIR}/sonoposeConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/sonoposeConfig.cmake ${PROJECT_BINARY_DIR}/sonoposeConfigVersion.cmake
              ${CMAKE_CURRENT_LIST_DIR}/SonoposeCxx.cmake
        DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/sonopose)
