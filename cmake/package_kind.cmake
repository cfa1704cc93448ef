# Read by cpack for each kind of package: what the .deb and the .tar.gz do not have in common.
if(CPACK_GENERATOR STREQUAL "TGZ")
  set(CPACK_PACKAGING_INSTALL_PREFIX "/")
  set(CPACK_PRE_BUILD_SCRIPTS "${CPACK_CLARITY_SCRIPT}")
else()
  set(CPACK_PACKAGING_INSTALL_PREFIX "/usr")
endif()
