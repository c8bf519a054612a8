# SPDX-License-Identifier: Apache-2.0
# The library's components: object libraries, all of which together are standoff::standoff. A program of this project may link
# one alone, with those it stands on. A component's optional packages are its own business (cmake/dependencies.cmake).

# What every component is compiled with.
add_library(standoff_settings INTERFACE)
target_include_directories(standoff_settings INTERFACE ${PROJECT_SOURCE_DIR}/include ${PROJECT_SOURCE_DIR}/src)
target_compile_features(standoff_settings INTERFACE cxx_std_20)
target_link_libraries(standoff_settings INTERFACE TBB::tbb)
if(NOT BUILD_SHARED_LIBS)
  target_compile_definitions(standoff_settings INTERFACE STANDOFF_STATIC)
endif()

add_library(standoff)
add_library(standoff::standoff ALIAS standoff)
set_target_properties(standoff PROPERTIES VERSION ${PROJECT_VERSION} LINKER_LANGUAGE CXX
                      SOVERSION ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR})
target_include_directories(standoff PUBLIC $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/include> $<INSTALL_INTERFACE:include>)
target_compile_features(standoff PUBLIC cxx_std_20)
target_link_libraries(standoff PRIVATE TBB::tbb)
set(STANDOFF_OBJECTS "")

# What our own programs, tests and benchmarks link: they use what a shared libstandoff does not export. It takes the shared
# library's place there, and is never linked beside it: what there is once in a process would be there twice.
if(BUILD_SHARED_LIBS)
  add_library(standoff_whole STATIC EXCLUDE_FROM_ALL)
  target_link_libraries(standoff_whole PUBLIC standoff_settings)
  set(STANDOFF_LIBRARIES standoff standoff_whole)
else()
  target_compile_definitions(standoff PUBLIC STANDOFF_STATIC)
  add_library(standoff_whole ALIAS standoff)
  set(STANDOFF_LIBRARIES standoff)
endif()

# standoff_component(NAME FILES ...): the component NAME of all files that match, below src.
function(standoff_component name)
  cmake_parse_arguments(PARSE_ARGV 1 component "" "" "FILES;WITHOUT;LIBRARIES")
  list(TRANSFORM component_FILES PREPEND ${PROJECT_SOURCE_DIR}/src/)
  file(GLOB sources CONFIGURE_DEPENDS ${component_FILES})
  if(component_WITHOUT)
    list(FILTER sources EXCLUDE REGEX "${component_WITHOUT}")
  endif()
  add_library(standoff_${name} OBJECT ${sources})
  target_link_libraries(standoff_${name} PUBLIC standoff_settings ${component_LIBRARIES} PRIVATE standoff_warnings)
  # Hidden but for what is marked STANDOFF_API (include/standoff/export.h).
  set_target_properties(standoff_${name} PROPERTIES CXX_VISIBILITY_PRESET hidden CUDA_VISIBILITY_PRESET hidden VISIBILITY_INLINES_HIDDEN ON)
  foreach(whole IN LISTS STANDOFF_LIBRARIES)
    target_sources(${whole} PRIVATE $<TARGET_OBJECTS:standoff_${name}>)
    foreach(library IN LISTS component_LIBRARIES)
      target_link_libraries(${whole} PRIVATE $<LINK_ONLY:${library}>)
    endforeach()
  endforeach()
  set(STANDOFF_OBJECTS ${STANDOFF_OBJECTS} $<TARGET_OBJECTS:standoff_${name}> PARENT_SCOPE)
endfunction()

include(cmake/rooms.cmake)

# Meshes, grids, fields and their files: what every reader and writer stands on.
standoff_component(core FILES ${STANDOFF_GROUND_FILES} io/mesh/*.cpp io/field/*.cpp io/zarr/*.cpp io/points/*.cpp io/arrays/*.cpp
                   LIBRARIES ZLIB::ZLIB ${STANDOFF_BLOSC})
if(STANDOFF_BLOSC)
  target_compile_definitions(standoff_core PRIVATE STANDOFF_HAVE_BLOSC)
endif()

# CUDA kernels, or what says that there are none.
if(STANDOFF_HAVE_CUDA)
  set(STANDOFF_CUDA_FILES *.cu)
else()
  set(STANDOFF_CUDA_FILES without_cuda.cpp)
endif()

# Fields of meshes on the CPU and on CUDA.
standoff_component(field FILES ${STANDOFF_FIELD_FILES} gpu/${STANDOFF_CUDA_FILES} backends/cuda/${STANDOFF_CUDA_FILES}
                   points/cuda/${STANDOFF_CUDA_FILES} WITHOUT /thesis/algorithm_2
                   LIBRARIES ${STANDOFF_CUDA_RUNTIME})

# What programs that go through many meshes share.
standoff_component(batch FILES batch/*.cpp)

# Surfaces out of fields and meshes.
standoff_component(surface FILES surface/*.cpp)

if("collision" IN_LIST STANDOFF_COMPONENTS)
  standoff_component(collision FILES ${STANDOFF_COLLISION_FILES} collision/cuda/${STANDOFF_CUDA_FILES})
endif()
if("render" IN_LIST STANDOFF_COMPONENTS)
  standoff_component(render FILES render/*.cpp LIBRARIES ${STANDOFF_PNG})
  if(STANDOFF_PNG)
    target_compile_definitions(standoff_render PRIVATE STANDOFF_HAVE_PNG)
  endif()
  standoff_embed(standoff_render kInterFont src/render/font/inter.ttf)
  # Pages take the pictures' colours.
  standoff_component(page FILES page/*.cpp LIBRARIES ${STANDOFF_MESHOPT})
  if(STANDOFF_MESHOPT)
    target_compile_definitions(standoff_page PRIVATE STANDOFF_HAVE_MESHOPT)
  endif()
  include(cmake/page.cmake)
endif()
if("emulation" IN_LIST STANDOFF_COMPONENTS)
  set(emulated gpu/*_emulated.cpp gpu/emulation/*.cpp backends/cuda/*_emulated.cpp points/cuda/*_emulated.cpp)
  if(TARGET standoff_collision)
    list(APPEND emulated collision/cuda/*_emulated.cpp)
  endif()
  standoff_component(emulation FILES ${emulated} LIBRARIES ${STANDOFF_BOOST_CONTEXT})
  set_target_properties(standoff_emulation PROPERTIES UNITY_BUILD OFF)  # its files are the kernels, each compiled as one whole
  if(STANDOFF_BOOST_CONTEXT)
    target_compile_definitions(standoff_emulation PRIVATE STANDOFF_HAVE_BOOST_CONTEXT)
  endif()
  set_source_files_properties(src/backends/fields.cpp src/backends/streams.cpp src/backends/collision.cpp PROPERTIES COMPILE_DEFINITIONS STANDOFF_HAVE_EMULATION)
endif()

include(cmake/simd.cmake)
standoff_kernels(STANDOFF_FIELD_KERNELS ${STANDOFF_FIELD_TABLES})
target_sources(standoff_field PRIVATE ${STANDOFF_FIELD_KERNELS})
if(TARGET standoff_collision)
  standoff_kernels(STANDOFF_COLLISION_KERNELS ${STANDOFF_COLLISION_TABLES})
  target_sources(standoff_collision PRIVATE ${STANDOFF_COLLISION_KERNELS})
endif()
# It takes in all of the namespace cpu, whose cells are not those of its neighbours.
set_source_files_properties(src/points/nearest.cpp PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
if(STANDOFF_HAVE_CUDA)
  file(GLOB STANDOFF_CUDA_SOURCES CONFIGURE_DEPENDS src/gpu/*.cu src/backends/cuda/*.cu src/points/cuda/*.cu src/collision/cuda/*.cu)
  set_source_files_properties(${STANDOFF_CUDA_SOURCES} PROPERTIES COMPILE_OPTIONS "${STANDOFF_CUDA_FLAGS}")
endif()
