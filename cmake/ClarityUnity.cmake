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

# clarity_no_hot_loops(TARGET): -Og in a release, which compiles in half of the time; for code whose loops over pixels, rays and
# primitives are elsewhere, or are not timed. With headers precompiled by -Og: GCC optimises what is in them as they say. GCC 12 then
# takes parts of std::regex for uninitialised; the preset `dev` keeps that warning.
set(CLARITY_NO_HOT_LOOPS $<$<AND:$<CONFIG:Release>,$<COMPILE_LANG_AND_ID:CXX,GNU>>:-Og;-Wno-maybe-uninitialized>)
function(clarity_no_hot_loops target)
  target_compile_options(${target} PRIVATE ${CLARITY_NO_HOT_LOOPS})
  target_precompile_headers(${target} REUSE_FROM clarity_headers_calm)
endfunction()

# clarity_hot_loops(SOURCE...): but for these sources of such a target. GCC 12 crashes over headers that were precompiled with less
# optimisation, so they are compiled without, and alone.
function(clarity_hot_loops)
  set_source_files_properties(${ARGN} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON SKIP_PRECOMPILE_HEADERS ON
    COMPILE_OPTIONS $<$<NOT:$<CONFIG:Debug>>:-O3>)
endfunction()
