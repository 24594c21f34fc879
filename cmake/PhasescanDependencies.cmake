# Every dependency is a Debian 12 package (scripts/lib/packages.sh lists them); nothing is downloaded. Each component asks
# for its own only. phasescanConfig.cmake.in and the .pc files name the same ones for those who use an installed library.
set(CMAKE_FIND_PACKAGE_TARGETS_GLOBAL ON)  # a project that adds this one as a folder links what our libraries link

# match
find_package(Eigen3 3.4 REQUIRED NO_MODULE)
find_package(Threads REQUIRED)
find_package(PkgConfig REQUIRED)
pkg_check_modules(HWY REQUIRED IMPORTED_TARGET GLOBAL libhwy)

if("fft_icp" IN_LIST PHASESCAN_BUILT)
  if(PHASESCAN_FFT STREQUAL "fftw")
    pkg_check_modules(FFTW3F REQUIRED IMPORTED_TARGET GLOBAL fftw3f)
  elseif(PHASESCAN_FFT STREQUAL "kiss")
    find_package(kissfft REQUIRED COMPONENTS SHARED float)
  else()
    message(FATAL_ERROR "PHASESCAN_FFT is '${PHASESCAN_FFT}'; expected fftw or kiss")
  endif()
  find_path(NANOFLANN_INCLUDE_DIR nanoflann.hpp REQUIRED)
endif()

if("slam" IN_LIST PHASESCAN_BUILT)
  find_package(Ceres 2.1 REQUIRED)
endif()

# Saved states and packed logs.
if("slam" IN_LIST PHASESCAN_BUILT OR "io" IN_LIST PHASESCAN_BUILT)
  find_package(ZLIB REQUIRED)
  pkg_check_modules(ZSTD REQUIRED IMPORTED_TARGET GLOBAL libzstd)
endif()

# Files and formats.
if("io" IN_LIST PHASESCAN_BUILT)
  find_package(nlohmann_json 3.11 REQUIRED)
  find_package(yaml-cpp REQUIRED)
  find_package(BZip2 REQUIRED)
  find_package(SQLite3 REQUIRED)
  pkg_check_modules(LZ4 REQUIRED IMPORTED_TARGET GLOBAL liblz4)
  find_package(fmt REQUIRED)
endif()

# Serial ports.
if("live" IN_LIST PHASESCAN_BUILT)
  pkg_check_modules(SERIALPORT REQUIRED IMPORTED_TARGET GLOBAL libserialport)
endif()

# A host without ROS on a network of ROS 2: built where CycloneDDS is found.
find_package(CycloneDDS 0.10 QUIET)
option(PHASESCAN_DDS "Build `phasescan live --ros2` (CycloneDDS)" ${CycloneDDS_FOUND})
if(PHASESCAN_DDS AND NOT CycloneDDS_FOUND)
  message(FATAL_ERROR "PHASESCAN_DDS is ON and CycloneDDS was not found (Debian: cyclonedds-dev)")
endif()

# The command's reports and maps.
if(PHASESCAN_COMPLETE)
  find_package(PNG REQUIRED)
endif()

# The server of `live --serve`: Boost.Beast, headers alone.
if(PHASESCAN_COMPLETE)
  find_path(BOOST_BEAST_INCLUDE_DIR boost/beast/websocket.hpp)
  if(NOT BOOST_BEAST_INCLUDE_DIR)
    message(STATUS "Boost.Beast (libboost-dev) was not found: this build has no `live --serve`")
  endif()
endif()
