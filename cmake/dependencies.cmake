# Required: TBB. Optional: assimp and libpng, found or left out with a word. None shows in the public headers.
find_package(Threads REQUIRED)
find_package(TBB REQUIRED)
target_link_libraries(standoff PRIVATE TBB::tbb)
set(STANDOFF_LINKED_PACKAGES Threads TBB)

# standoff_optional(NAME TARGET DEFINITION LOSS): links TARGET of package NAME where it is found; LOSS says what is missed.
macro(standoff_optional name target definition loss)
  find_package(${name} QUIET)
  if(${name}_FOUND)
    target_link_libraries(standoff PRIVATE ${target})
    target_compile_definitions(standoff PRIVATE ${definition})
    list(APPEND STANDOFF_LINKED_PACKAGES ${name})
  else()
    message(STATUS "${name} not found: ${loss}")
  endif()
endmacro()

if(STANDOFF_WITH_ASSIMP)
  standoff_optional(assimp assimp::assimp STANDOFF_HAVE_ASSIMP "no 3DS, DAE (Debian: libassimp-dev)")
endif()
if(STANDOFF_WITH_PNG)
  standoff_optional(PNG PNG::PNG STANDOFF_HAVE_PNG "no pictures (Debian: libpng-dev)")
endif()
