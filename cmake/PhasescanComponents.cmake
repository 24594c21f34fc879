# The libraries, and which of the others each stands on.
set(PHASESCAN_ALL_COMPONENTS match fft_icp slam io)
set(PHASESCAN_NEEDS_fft_icp match)
set(PHASESCAN_NEEDS_slam match)
set(PHASESCAN_NEEDS_io match fft_icp slam)  # its configuration file names all their options

set(PHASESCAN_COMPONENTS "match;fft_icp;slam;io" CACHE STRING "Libraries to build: match, fft_icp, slam, io; what they stand on comes along")
set(wanted "")
foreach(component IN LISTS PHASESCAN_COMPONENTS)
  if(NOT component IN_LIST PHASESCAN_ALL_COMPONENTS)
    message(FATAL_ERROR "PHASESCAN_COMPONENTS has '${component}'; expected some of ${PHASESCAN_ALL_COMPONENTS}")
  endif()
  list(APPEND wanted ${component} ${PHASESCAN_NEEDS_${component}})
endforeach()
# In the order in which they stand on each other.
set(PHASESCAN_BUILT "")
foreach(component IN LISTS PHASESCAN_ALL_COMPONENTS)
  if(component IN_LIST wanted)
    list(APPEND PHASESCAN_BUILT ${component})
  endif()
endforeach()
# The command, the tests and the benchmarks are about all of them.
set(PHASESCAN_COMPLETE OFF)
if(PHASESCAN_BUILT STREQUAL PHASESCAN_ALL_COMPONENTS)
  set(PHASESCAN_COMPLETE ON)
endif()
