# SPDX-License-Identifier: Apache-2.0
# cmake -DSYMBOL=kName -DFILE=font.ttf -DOUTPUT=font.cpp -P embed_file.cmake: the bytes of a file as C++ (cmake/embed.cmake).
file(READ ${FILE} bytes HEX)
string(REGEX REPLACE "(................................)" "\\1\n" bytes "${bytes}")  # 16 a line
string(REGEX REPLACE "([0-9a-f][0-9a-f])" "'\\\\x\\1'," bytes "${bytes}")
file(WRITE ${OUTPUT} "#include <string_view>
namespace standoff {
namespace {
constexpr char ${SYMBOL}Bytes[] = {
${bytes}};
}
extern const std::string_view ${SYMBOL};
constinit const std::string_view ${SYMBOL}{${SYMBOL}Bytes, sizeof(${SYMBOL}Bytes)};
}  // namespace standoff
")
