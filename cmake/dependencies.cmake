# SPDX-License-Identifier: Apache-2.0
# Required: TBB and zlib. Optional: what each component may use, found or left out with a word. None shows in the public headers.
find_package(Threads REQUIRED)
find_package(TBB REQUIRED)
find_package(ZLIB REQUIRED)
set(STANDOFF_LINKED_PACKAGES Threads TBB ZLIB)

# standoff_optional(VARIABLE PACKAGE TARGET LOSS): VARIABLE is the target where the package is found; LOSS says what is missed.
macro(standoff_optional variable package target loss)
  set(${variable} "")
  find_package(${package} QUIET ${ARGN})
  if(${package}_FOUND)
    set(${variable} ${target})
    list(APPEND STANDOFF_LINKED_PACKAGES ${package})
  else()
    message(STATUS "${package} not found: ${loss}")
  endif()
endmacro()

if(STANDOFF_WITH_BLOSC)
  list(APPEND CMAKE_MODULE_PATH ${PROJECT_SOURCE_DIR}/cmake)
  standoff_optional(STANDOFF_BLOSC Blosc Blosc::blosc "Zarr stores are read and written uncompressed alone (Debian: libblosc-dev)")
endif()
if(STANDOFF_WITH_PNG AND "render" IN_LIST STANDOFF_COMPONENTS)
  standoff_optional(STANDOFF_PNG PNG PNG::PNG "no pictures (Debian: libpng-dev)")
endif()
if(STANDOFF_WITH_MESHOPT AND "render" IN_LIST STANDOFF_COMPONENTS)
  standoff_optional(STANDOFF_MESHOPT meshoptimizer meshoptimizer::meshoptimizer
                    "pages draw all triangles while the camera moves (Debian: libmeshoptimizer-dev)" CONFIG)
endif()
if("emulation" IN_LIST STANDOFF_COMPONENTS)
  standoff_optional(STANDOFF_BOOST_CONTEXT boost_context Boost::context
                    "the emulated GPU is slower (Debian: libboost-context-dev)" CONFIG)
endif()
