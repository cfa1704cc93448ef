# Manual page, completion, desktop file, icon, recipes for farms, and what `cpack` makes of all that is installed: packages of Debian, and
# a .tar.gz of everything that runs from any folder. In build/release: cpack -G DEB, cpack -G TGZ.

# Made from the program's own help. --help-as opens no device and loads no plugin. A program that is compiled for another machine needs
# CMAKE_CROSSCOMPILING_EMULATOR.
set(page ${PROJECT_BINARY_DIR}/share/man/man1/clarity.1.gz)
set(completion ${PROJECT_BINARY_DIR}/share/bash-completion/completions/clarity)
file(MAKE_DIRECTORY ${PROJECT_BINARY_DIR}/share/man/man1 ${PROJECT_BINARY_DIR}/share/bash-completion/completions)
add_custom_command(OUTPUT ${page} ${completion} VERBATIM
  COMMAND sh -c "page=$1 completion=$2; shift 2; \"$@\" --help-as man > \"$page.text\" && gzip -9nc \"$page.text\" > \"$page\" &&\
    rm \"$page.text\" && \"$@\" --help-as bash > \"$completion\"" sh ${page} ${completion} ${CMAKE_CROSSCOMPILING_EMULATOR}
    $<TARGET_FILE:clarity>)
add_custom_target(manual ALL DEPENDS ${page} ${completion})
add_dependencies(program manual)
install(FILES ${page} DESTINATION ${CMAKE_INSTALL_MANDIR}/man1)
install(FILES ${completion} DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions)

# The program holds DejaVu (ui/widgets/fonts.cpp), whose licence asks to go with it.
set(font_licence /usr/share/doc/fonts-dejavu-core/copyright)
if(CLARITY_UI AND EXISTS ${font_licence})
  install(FILES ${font_licence} DESTINATION ${CMAKE_INSTALL_DOCDIR} RENAME fonts-dejavu.copyright)
endif()

install(DIRECTORY ${PROJECT_SOURCE_DIR}/share/ DESTINATION ${CMAKE_INSTALL_DATADIR} USE_SOURCE_PERMISSIONS)
file(CREATE_LINK ${PROJECT_SOURCE_DIR}/share/clarity/farm ${PROJECT_BINARY_DIR}/share/clarity/farm SYMBOLIC)

# The .tar.gz brings libraries along, in a folder of its own. RPATH, and not RUNPATH, is also asked for the libraries of libraries and of
# plugins. In the .deb the folder is missing and costs a look.
set(CLARITY_LIBRARY_FOLDER ${CMAKE_INSTALL_LIBDIR}/clarity/libraries)
file(RELATIVE_PATH from_program ${CMAKE_INSTALL_FULL_BINDIR} ${CMAKE_INSTALL_FULL_LIBDIR}/clarity/libraries)
set_target_properties(clarity PROPERTIES INSTALL_RPATH "$ORIGIN/${from_program}")
target_link_options(clarity PRIVATE -Wl,--disable-new-dtags)

set(CPACK_GENERATOR DEB TGZ)
set(CPACK_PACKAGE_NAME clarity)
set(CPACK_PACKAGE_VENDOR Clarity)
# Debian wants an address. The project has none for mail; the domain `invalid` says so (RFC 2606).
set(CPACK_PACKAGE_CONTACT "Clarity maintainers <maintainers@clarity.invalid>")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "ray-tracing workbench on OpenCL")
set(CPACK_PACKAGE_DESCRIPTION "Clarity renders scenes by ray tracing on GPUs, or on CPUs through PoCL. Its window shows what structures and
settings cost while it traces. The package has the program, its importers and structures, the SDK for more of
them, sample scenes, and recipes for farms of machines.")
set(CPACK_RESOURCE_FILE_README ${PROJECT_SOURCE_DIR}/README.md)
set(CPACK_STRIP_FILES ON)
set(CPACK_VERBATIM_VARIABLES ON)
set(CPACK_PROJECT_CONFIG_FILE ${PROJECT_SOURCE_DIR}/cmake/package_kind.cmake)
set(CPACK_CLARITY_LIBRARY_FOLDER ${CLARITY_LIBRARY_FOLDER})
set(CPACK_CLARITY_SCRIPT ${PROJECT_SOURCE_DIR}/cmake/package_libraries.cmake)

set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
# A .deb is for the release it is made on, whose libraries it asks for; its version and so its name say for which: 0.1.0-debian13.
cmake_host_system_information(RESULT release QUERY DISTRIB_ID DISTRIB_VERSION_ID)
string(REGEX REPLACE "[^a-z0-9.+~]" "" CPACK_DEBIAN_PACKAGE_RELEASE "${release}")
string(REGEX REPLACE "-$" "" deb_version "${PROJECT_VERSION}-${CPACK_DEBIAN_PACKAGE_RELEASE}")
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
# Four packages of Debian. The library depends on the program, whose importers and workers it starts, and not the other way round. All
# are of one version, because what the library and a worker say to each other may change with each.
get_target_property(soversion clarity_library SOVERSION)
set(CPACK_DEB_COMPONENT_INSTALL ON)
# debian_package(COMPONENT NAME SECTION DEPENDS DESCRIPTION)
macro(debian_package component name section depends description)
  string(TOUPPER ${component} upper)
  set(CPACK_DEBIAN_${upper}_PACKAGE_NAME ${name})
  set(CPACK_DEBIAN_${upper}_PACKAGE_SECTION ${section})
  set(CPACK_DEBIAN_${upper}_PACKAGE_DEPENDS "${depends}")
  set(CPACK_DEBIAN_${upper}_DESCRIPTION "${description}")
endmacro()
debian_package(clarity clarity graphics util-linux "${CPACK_PACKAGE_DESCRIPTION}")
debian_package(library libclarity${soversion} libs "clarity (= ${deb_version})" "This package has the library for programs in C and other
languages: scenes from files or arrays, ray queries and pictures.")
debian_package(dev libclarity-dev libdevel "libclarity${soversion} (= ${deb_version})" "This package has the header of the C library, and
what pkg-config and CMake need to find it.")
debian_package(python python3-clarity python "libclarity${soversion} (= ${deb_version}), python3, python3-numpy" "This package is for Python:
scenes from files or arrays of numpy, ray queries and pictures.")
set(CPACK_DEBIAN_PYTHON_PACKAGE_ARCHITECTURE all)
# The window draws with OpenGL, which GLFW and epoxy load while they run.
set(CPACK_DEBIAN_CLARITY_PACKAGE_RECOMMENDS "pocl-opencl-icd | opencl-icd, libgl1, libgl1-mesa-dri")
set(CPACK_DEBIAN_CLARITY_PACKAGE_SUGGESTS "python3-clarity, libclarity-dev, g++, cmake, slurm-client, openmpi-bin, ffmpeg, imagemagick")
set(CPACK_DEBIAN_PYTHON_PACKAGE_SUGGESTS python3-matplotlib)
include(CPack)
cpack_add_component(Unspecified GROUP clarity)
cpack_add_component(sdk GROUP clarity)
