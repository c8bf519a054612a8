# Required: TBB. Optional: assimp and libpng, found or left out with a word. None shows in the public headers.
find_package(Threads REQUIRED)
find_package(TBB REQUIRED)
target_link_libraries(difi PRIVATE TBB::tbb)
set(DIFI_LINKED_PACKAGES Threads TBB)

# difi_optional(NAME TARGET DEFINITION LOSS): links TARGET of package NAME where it is found; LOSS says what is missed.
macro(difi_optional name target definition loss)
  find_package(${name} QUIET)
  if(${name}_FOUND)
    target_link_libraries(difi PRIVATE ${target})
    target_compile_definitions(difi PRIVATE ${definition})
    list(APPEND DIFI_LINKED_PACKAGES ${name})
  else()
    message(STATUS "${name} not found: ${loss}")
  endif()
endmacro()

if(DIFI_WITH_ASSIMP)
  difi_optional(assimp assimp::assimp DIFI_HAVE_ASSIMP "no 3DS, DAE (Debian: libassimp-dev)")
endif()
if(DIFI_WITH_PNG)
  difi_optional(PNG PNG::PNG DIFI_HAVE_PNG "no pictures (Debian: libpng-dev)")
endif()
