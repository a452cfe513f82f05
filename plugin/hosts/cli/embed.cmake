# SPDX-License-Identifier: MIT
# How does a file get into the program? As an array of its bytes with a zero after them:
#
#     cmake -D FROM=page.html -D TO=page.h -D NAME=PAGE [-D PLOTS=piece.html] -P embed.cmake
#
# With PLOTS, that file stands where FROM says @PLOTS@.
file(READ ${FROM} hex HEX)
if(PLOTS)
  file(READ ${PLOTS} piece HEX)
  string(REPLACE 40504c4f545340 "${piece}" hex "${hex}") # the sign itself would be one of CMake's
endif()
string(REGEX REPLACE "(................................)" "\\1\n" hex "${hex}")
string(REGEX REPLACE "([0-9a-f][0-9a-f])" "0x\\1," bytes "${hex}")
file(WRITE ${TO} "static const unsigned char ${NAME}[] = {\n${bytes}0x00 };\n")
