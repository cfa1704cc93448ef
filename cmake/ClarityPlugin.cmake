# clarity_add_plugin(accel|importer ID [LIBRARIES lib...]): one folder, one plugin, one shared library.
#
# Compiles every .cpp/.c of the folder. For an accel plugin, ID.cl and ID_types.h are embedded: the plugin includes
# "ID.inc", rows of {path, text}. The library lands in lib/clarity/plugins/{importers,accel} beside bin/.
function(clarity_add_plugin kind id)
  cmake_parse_arguments(arg "" "" "LIBRARIES" ${ARGN})
  set(folder ${kind})
  if(kind STREQUAL "importer")
    set(folder importers)
  endif()
  file(GLOB sources CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/*.cpp ${CMAKE_CURRENT_SOURCE_DIR}/*.c)
  set(target ${kind}_${id})
  add_library(${target} MODULE ${sources})
  set_target_properties(${target} PROPERTIES PREFIX "" OUTPUT_NAME ${id}
    LIBRARY_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/lib/clarity/plugins/${folder})
  target_link_libraries(${target} PRIVATE clarity_sdk ${arg_LIBRARIES})
  target_link_options(${target} PRIVATE -Wl,--no-undefined)
  file(GLOB embedded CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/${id}_types.h ${CMAKE_CURRENT_SOURCE_DIR}/${id}.cl)
  if(embedded)
    clarity_embed(${target} NAME ${id} BASE ${CMAKE_CURRENT_SOURCE_DIR} FILES ${embedded})
  endif()
  if(DEFINED CMAKE_INSTALL_LIBDIR)
    install(TARGETS ${target} LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR}/clarity/plugins/${folder})
  endif()
endfunction()

# Every folder under plugins/{importers,accel} that has a CMakeLists.txt; nobody edits a list.
function(clarity_add_all_plugins)
  file(GLOB lists CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/plugins/*/*/CMakeLists.txt)
  foreach(list IN LISTS lists)
    get_filename_component(folder ${list} DIRECTORY)
    add_subdirectory(${folder})
  endforeach()
endfunction()
