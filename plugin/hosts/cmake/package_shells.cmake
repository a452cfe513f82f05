# SPDX-License-Identifier: MIT
# Where do Debian's shells look for what a package brings? CPack runs this on what is to be packed. Debian's zsh reads
# site-functions below /usr/local alone, where 'cmake --install' puts it; packages have a folder of their own.
if(NOT CPACK_GENERATOR STREQUAL DEB)
  return()
endif()
set(zsh ${CPACK_TEMPORARY_INSTALL_DIRECTORY}${CPACK_PACKAGING_INSTALL_PREFIX}/share/zsh)
file(RENAME ${zsh}/site-functions ${zsh}/vendor-completions)
