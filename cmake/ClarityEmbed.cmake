# clarity_embed(target NAME name BASE folder FILES file...): embeds text files as C strings.
# Generates NAME.inc in the target's binary folder. It has one row for each file, `{"path relative to BASE", R"...(text)..."},`.
# Long files are split into several literals, because compilers limit the length of one literal.
set(CLARITY_EMBED_SCRIPT ${CMAKE_CURRENT_LIST_DIR}/embed_text.cmake)
function(clarity_embed target)
  cmake_parse_arguments(arg "" "NAME;BASE" "FILES" ${ARGN})
  set(out ${CMAKE_CURRENT_BINARY_DIR}/embedded/${arg_NAME}.inc)
  string(REPLACE ";" "|" file_list "${arg_FILES}")
  add_custom_command(
    OUTPUT ${out}
    COMMAND ${CMAKE_COMMAND} -DOUT=${out} -DBASE=${arg_BASE} "-DFILES=${file_list}" -P ${CLARITY_EMBED_SCRIPT}
    DEPENDS ${arg_FILES} ${CLARITY_EMBED_SCRIPT}
    COMMENT "Embedding ${arg_NAME}"
    VERBATIM)
  target_sources(${target} PRIVATE ${out})
  target_include_directories(${target} PRIVATE ${CMAKE_CURRENT_BINARY_DIR}/embedded)
endfunction()
