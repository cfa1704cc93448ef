# clarity_unity(TARGET SOURCE...): compiles the sources of each folder as one, in a third of the time. So no two files of a folder may
# define the same name, not even in unnamed namespaces. The presets lto, debug, asan and tsan compile each file alone: so a file
# that lacks an include is found.
option(CLARITY_UNITY "Compile the sources of each folder as one" ON)
function(clarity_unity target)
  if(NOT CLARITY_UNITY)
    return()
  endif()
  set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_MODE GROUP)
  foreach(source IN LISTS ARGN)
    get_filename_component(folder ${source} DIRECTORY)
    set_source_files_properties(${source} PROPERTIES UNITY_GROUP ${folder})
  endforeach()
endfunction()

# clarity_no_hot_loops(TARGET): -O1 in a release, which compiles in two thirds of the time; for code whose loops over pixels, rays
# and primitives are elsewhere, or are not timed.
function(clarity_no_hot_loops target)
  target_compile_options(${target} PRIVATE $<$<CONFIG:Release>:-O1>)
endfunction()
