# Relocatable install: find_package(phasescan) gives phasescan::phasescan, COMPONENTS slam also phasescan::slam (needs Ceres).
include(CMakePackageConfigHelpers)
install(TARGETS phasescan EXPORT phasescanTargets ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR}
  LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR} RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
install(TARGETS phasescan_slam EXPORT phasescanSlamTargets ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR}
  LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR} RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
foreach(folder core scan image spectrum rotation translation refine match odometry graph map slam)
  if(EXISTS "${PROJECT_SOURCE_DIR}/include/phasescan/${folder}")
    install(DIRECTORY "${PROJECT_SOURCE_DIR}/include/phasescan/${folder}" DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/phasescan)
  endif()
endforeach()
install(EXPORT phasescanTargets NAMESPACE phasescan:: DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/phasescan)
install(EXPORT phasescanSlamTargets NAMESPACE phasescan:: DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/phasescan)
configure_package_config_file("${PROJECT_SOURCE_DIR}/cmake/phasescanConfig.cmake.in"
  "${PROJECT_BINARY_DIR}/phasescanConfig.cmake" INSTALL_DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/phasescan)
write_basic_package_version_file("${PROJECT_BINARY_DIR}/phasescanConfigVersion.cmake" COMPATIBILITY SameMinorVersion)
install(FILES "${PROJECT_BINARY_DIR}/phasescanConfig.cmake" "${PROJECT_BINARY_DIR}/phasescanConfigVersion.cmake"
  DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/phasescan)
