# Installs everything besides the program and the plugins: the SDK, its pages, and the package for find_package(clarity), which
# provides the targets clarity::sdk and clarity::bvh, clarity_add_plugin() and clarity_embed(). No file contains the prefix, so the
# tree may be moved.
include(CMakePackageConfigHelpers)

set_target_properties(clarity_sdk PROPERTIES EXPORT_NAME sdk)
target_include_directories(clarity_sdk INTERFACE $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}/clarity>)
set_target_properties(clarity_bvh PROPERTIES EXPORT_NAME bvh)
install(TARGETS clarity_sdk clarity_bvh EXPORT clarityTargets ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT sdk)
install(DIRECTORY sdk/clarity_bvh sdk/clarity_space DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/clarity COMPONENT sdk FILES_MATCHING PATTERN "*.hpp")
install(FILES sdk/rt_plugin.h sdk/rt_refit.h sdk/rt_surface.h sdk/rt_surface.hpp sdk/rt_device.h sdk/rt_device.hpp sdk/rt_digest.h sdk/rt_plugin.hpp sdk/rt_cost.hpp cl/rt_shared.h DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/clarity COMPONENT sdk)
# `clarity new-plugin` finds the templates at ../share/clarity/template relative to itself, in a build folder too.
install(DIRECTORY sdk/template/ DESTINATION ${CMAKE_INSTALL_DATADIR}/clarity/template COMPONENT sdk)
file(MAKE_DIRECTORY ${PROJECT_BINARY_DIR}/share/clarity)
file(CREATE_LINK ${PROJECT_SOURCE_DIR}/sdk/template ${PROJECT_BINARY_DIR}/share/clarity/template SYMBOLIC)
# The pages, and the kernels and structures that they name, lie as in the sources, so that links between them hold.
install(FILES README.md CONTRIBUTING.md DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT sdk)
install(DIRECTORY docs cl DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT sdk PATTERN "*.sh" EXCLUDE)
install(DIRECTORY plugins/accel plugins/primitives plugins/surfaces DESTINATION ${CMAKE_INSTALL_DOCDIR}/plugins COMPONENT sdk)
install(FILES scenes/README.md DESTINATION ${CMAKE_INSTALL_DOCDIR}/scenes COMPONENT sdk)

set(package ${CMAKE_INSTALL_LIBDIR}/cmake/clarity)
install(EXPORT clarityTargets NAMESPACE clarity:: DESTINATION ${package} COMPONENT sdk)
file(STRINGS ${PROJECT_SOURCE_DIR}/sdk/rt_plugin.h CLARITY_ABI_VERSION REGEX "^#define RT_ABI_VERSION")
string(REGEX REPLACE "^#define RT_ABI_VERSION ([0-9]+)u$" "\\1" CLARITY_ABI_VERSION "${CLARITY_ABI_VERSION}")
configure_package_config_file(${PROJECT_SOURCE_DIR}/cmake/clarityConfig.cmake.in ${PROJECT_BINARY_DIR}/package/clarityConfig.cmake
  INSTALL_DESTINATION ${package} NO_CHECK_REQUIRED_COMPONENTS_MACRO)
# Plugins depend on the ABI version, which the host checks, and not on the program's version.
write_basic_package_version_file(${PROJECT_BINARY_DIR}/package/clarityConfigVersion.cmake COMPATIBILITY SameMajorVersion)
install(FILES ${PROJECT_BINARY_DIR}/package/clarityConfig.cmake ${PROJECT_BINARY_DIR}/package/clarityConfigVersion.cmake
  cmake/ClarityPlugin.cmake cmake/ClarityEmbed.cmake cmake/embed_text.cmake cmake/rt_plugin.map DESTINATION ${package} COMPONENT sdk)
