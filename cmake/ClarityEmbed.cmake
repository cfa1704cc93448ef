# clarity_embed(target NAME name BASE folder FILES file... [SHOWN folder PARTS file...]): embeds text files as C strings.
# Generates NAME.inc in the target's binary folder. It has one row for each file, `{"path relative to BASE", R"...(text)..."},`.
# Long files are split into several literals, because compilers limit the length of one literal.
# SHOWN is the folder that compiler messages name. With it, files may include PARTS, which are files beside them without rows.
set(CLARITY_EMBED_SCRIPT ${CMAKE_CURRENT_LIST_DIR}/embed_text.cmake)
function(clarity_embed target)
  cmake_parse_arguments(arg "" "NAME;BASE;SHOWN" "FILES;PARTS" ${ARGN})
  set(out ${CMAKE_CURRENT_BINARY_DIR}/embedded/${arg_NAME}.inc)
  string(REPLACE ";" "|" file_list "${arg_FILES}")
  add_custom_command(
    OUTPUT ${out}
    COMMAND ${CMAKE_COMMAND} -DOUT=${out} -DBASE=${arg_BASE} "-DFILES=${file_list}" "-DSHOWN=${arg_SHOWN}" -P ${CLARITY_EMBED_SCRIPT}
    DEPENDS ${arg_FILES} ${arg_PARTS} ${CLARITY_EMBED_SCRIPT}
    COMMENT "Embedding ${arg_NAME}"
    VERBATIM)
  target_sources(${target} PRIVATE ${out})
  target_include_directories(${target} PRIVATE ${CMAKE_CURRENT_BINARY_DIR}/embedded)
endfunction()
