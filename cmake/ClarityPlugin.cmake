# clarity_add_plugin(accel|importer|primitive|surface ID [LIBRARIES lib...]): builds the current folder as one plugin, which is one shared library.
#
# Compiles every .cpp and .c file of the folder. ID.cl, ID_types.h and ID_build.cl (kernels that build: rt_device.h) of an accel plugin, or ID.cl of a primitive or surface, are embedded, with
# the parts that they include, ID_*.cl and ID_*.h. The plugin includes "ID.inc", which has rows of {path, text}.
# LIBRARIES clarity::bvh links the builders' library (docs/clarity_bvh.md).
# In clarity's tree the library is written to lib/clarity/plugins/{importers,accel,primitives,surfaces} beside bin/. Elsewhere (with
# find_package(clarity)) it is ID.so in the build folder: add that folder to CLARITY_PLUGIN_PATH, or run
# `cmake --install build --prefix ~/.local`, which installs the plugin where clarity looks for it.
set(CLARITY_PLUGIN_EXPORTS ${CMAKE_CURRENT_LIST_DIR}/rt_plugin.map)
function(clarity_add_plugin kind id)
  cmake_parse_arguments(arg "" "" "LIBRARIES" ${ARGN})
  set(folders_accel accel)
  set(folders_importer importers)
  set(folders_primitive primitives)
  set(folders_surface surfaces)
  if(NOT DEFINED folders_${kind})
    message(FATAL_ERROR "clarity_add_plugin(${kind} ${id}): expected accel, importer, primitive or surface, found '${kind}'")
  endif()
  set(folder ${folders_${kind}})
  if(NOT id MATCHES "^[a-z][a-z0-9_]*$")
    message(FATAL_ERROR "clarity_add_plugin(${kind} ${id}): an id has lower-case letters, digits and _, a letter first")
  endif()
  file(GLOB sources CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/*.cpp ${CMAKE_CURRENT_SOURCE_DIR}/*.c)
  if(NOT sources)
    message(FATAL_ERROR "clarity_add_plugin(${kind} ${id}): no .cpp or .c file in ${CMAKE_CURRENT_SOURCE_DIR}")
  endif()
  set(target ${kind}_${id})
  if(CLARITY_PLUGINS_STAND_ALONE) # found by find_package(clarity)
    set(libraries ${CMAKE_BINARY_DIR})
  else()
    set(libraries ${CMAKE_BINARY_DIR}/lib/clarity/plugins/${folder})
  endif()
  add_library(${target} MODULE ${sources})
  if(kind STREQUAL importer AND COMMAND clarity_unity) # builders are measured, so each of their files is compiled as it stands
    clarity_unity(${target} ${sources})
  endif()
  set_target_properties(${target} PROPERTIES PREFIX "" OUTPUT_NAME ${id} C_VISIBILITY_PRESET hidden CXX_VISIBILITY_PRESET hidden
    LIBRARY_OUTPUT_DIRECTORY ${libraries} LINK_DEPENDS ${CLARITY_PLUGIN_EXPORTS})
  target_compile_features(${target} PRIVATE cxx_std_17)
  target_link_libraries(${target} PRIVATE clarity::sdk ${arg_LIBRARIES})
  # The map also hides the templates of libstdc++, which stay visible in spite of hidden visibility.
  target_link_options(${target} PRIVATE -Wl,--no-undefined "-Wl,--version-script=${CLARITY_PLUGIN_EXPORTS}")
  file(GLOB embedded CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/${id}_types.h ${CMAKE_CURRENT_SOURCE_DIR}/${id}.cl
    ${CMAKE_CURRENT_SOURCE_DIR}/${id}_build.cl)
  if(embedded)
    # The host watches the kernels there: see host/device/kernel_files.hpp. The note is not installed.
    file(WRITE ${libraries}/${id}.sources "${CMAKE_CURRENT_SOURCE_DIR}\n")
    file(GLOB parts CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/${id}_*.h ${CMAKE_CURRENT_SOURCE_DIR}/${id}_*.cl)
    clarity_embed(${target} NAME ${id} BASE ${CMAKE_CURRENT_SOURCE_DIR} FILES ${embedded} SHOWN plugins/${folder}/${id} PARTS ${parts})
  endif()
  if(CLARITY_PLUGIN_INSTALL_DIR)
    install(TARGETS ${target} LIBRARY DESTINATION ${CLARITY_PLUGIN_INSTALL_DIR}/${folder})
  endif()
endfunction()

# clarity_quiet_vectors(TARGET...): for code that passes vectors and 32-byte records by value, and whatever includes its headers.
# GCC otherwise notes at each of them that versions before 4.6 passed them differently, which does not matter here.
function(clarity_quiet_vectors)
  foreach(target IN LISTS ARGN)
    target_compile_options(${target} PUBLIC $<$<CXX_COMPILER_ID:GNU>:-Wno-psabi>)
  endforeach()
endfunction()

# Adds every folder under plugins/{importers,accel,primitives,surfaces} that has a CMakeLists.txt, so that there is no list to edit.
function(clarity_add_all_plugins)
  file(GLOB lists CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/plugins/*/*/CMakeLists.txt)
  foreach(list IN LISTS lists)
    get_filename_component(folder ${list} DIRECTORY)
    add_subdirectory(${folder})
  endforeach()
endfunction()
