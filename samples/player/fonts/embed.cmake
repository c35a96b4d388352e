# cmake -D FONT=FILE.ttf -D NAME=name -D OUT=FILE.cpp -P embed.cmake: the bytes of a file as a C++ array.
file(READ ${FONT} bytes HEX)
string(REGEX REPLACE "(................................)" "\\1\n" bytes "${bytes}")
string(REGEX REPLACE "([0-9a-f][0-9a-f])" "0x\\1," bytes "${bytes}")
file(WRITE ${OUT} "extern const unsigned char ${NAME}[];\nextern const unsigned ${NAME}_size;\n"
  "const unsigned char ${NAME}[] = {\n${bytes}};\nconst unsigned ${NAME}_size = sizeof ${NAME};\n")
