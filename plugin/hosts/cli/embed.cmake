# SPDX-License-Identifier: MIT
# How does a file get into the program? As an array of its bytes with a zero after them:
#
#     cmake -D FROM=page.html -D TO=page.h -D NAME=PAGE -P embed.cmake
file(READ ${FROM} hex HEX)
string(REGEX REPLACE "(................................)" "\\1\n" hex "${hex}")
string(REGEX REPLACE "([0-9a-f][0-9a-f])" "0x\\1," bytes "${hex}")
file(WRITE ${TO} "static const unsigned char ${NAME}[] = {\n${bytes}0x00 };\n")
