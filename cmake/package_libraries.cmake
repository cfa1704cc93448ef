# Run by cpack before it packs the .tar.gz: copies the libraries that the program and its plugins need, and that a Debian system of minimal
# size lacks, into the folder that the program's RPATH names. The C library, its loader, the compiler's libraries and zlib are part of
# each system, and OpenCL drivers need the system's own.
set(base "^(ld-linux.*|libc|libm|libdl|libpthread|librt|libresolv|libutil|libgcc_s|libstdc[+][+]|libz)[.]so")
file(GLOB program "${CPACK_TEMPORARY_INSTALL_DIRECTORY}/bin/clarity")
file(GLOB plugins "${CPACK_TEMPORARY_INSTALL_DIRECTORY}/lib*/clarity/plugins/*/*.so"
  "${CPACK_TEMPORARY_INSTALL_DIRECTORY}/lib*/*/clarity/plugins/*/*.so")
file(GLOB api "${CPACK_TEMPORARY_INSTALL_DIRECTORY}/lib*/libclarity.so.?" "${CPACK_TEMPORARY_INSTALL_DIRECTORY}/lib*/*/libclarity.so.?")
if(NOT program OR NOT plugins)
  message(FATAL_ERROR "the package has no program or no plugins in ${CPACK_TEMPORARY_INSTALL_DIRECTORY}: build the target `program` first")
endif()
file(GET_RUNTIME_DEPENDENCIES EXECUTABLES ${program} LIBRARIES ${api} MODULES ${plugins} RESOLVED_DEPENDENCIES_VAR found
  UNRESOLVED_DEPENDENCIES_VAR missing PRE_EXCLUDE_REGEXES ${base})
if(missing)
  message(FATAL_ERROR "libraries that the program or a plugin needs are not on this machine: ${missing}")
endif()
set(notices "${CPACK_TEMPORARY_INSTALL_DIRECTORY}/share/doc/clarity/libraries")
foreach(library IN LISTS found)
  file(INSTALL "${library}" DESTINATION "${CPACK_TEMPORARY_INSTALL_DIRECTORY}/${CPACK_CLARITY_LIBRARY_FOLDER}" FOLLOW_SYMLINK_CHAIN)
  # Who passes a library on has to pass its licence on. Debian's list has some files below /lib, and others below /usr/lib.
  file(REAL_PATH "${library}" path)
  string(REGEX REPLACE "^/usr/" "/" short "${path}")
  foreach(name "${path}" "${short}")
    execute_process(COMMAND dpkg-query -S "${name}" OUTPUT_VARIABLE owner ERROR_QUIET RESULT_VARIABLE code)
    string(REGEX REPLACE "[:,].*" "" package "${owner}")
    if(code EQUAL 0 AND EXISTS "/usr/share/doc/${package}/copyright")
      configure_file("/usr/share/doc/${package}/copyright" "${notices}/${package}.txt" COPYONLY)
      break()
    endif()
  endforeach()
endforeach()
