# SPDX-License-Identifier: MIT
# How does hemibake become a package of Debian? 'cpack -G DEB' in the build folder makes hemibake_VERSION_ARCH.deb of what is
# installed; what the libraries need is found by dpkg-shlibdeps.
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME hemibake)
set(CPACK_PACKAGE_VENDOR hemibake)
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "bakes diffuse global illumination into glTF vertex colours")
set(CPACK_RESOURCE_FILE_LICENSE ${PROJECT_SOURCE_DIR}/LICENSE)
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_PRE_BUILD_SCRIPTS ${CMAKE_CURRENT_SOURCE_DIR}/package_shells.cmake)
set(CPACK_STRIP_FILES ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_MAINTAINER "the authors of hemibake <hemibake@localhost>")
set(CPACK_DEBIAN_PACKAGE_SECTION graphics)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
# Python runs the reader of USD, its package the rest; baking glTF needs neither.
set(CPACK_DEBIAN_PACKAGE_SUGGESTS python3)
include(CPack)
