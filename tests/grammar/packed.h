// SPDX-License-Identifier: Apache-2.0
// Bytes as zip and gzip pack them, archives of zip, and arrays of NumPy.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "tests/grammar/choices.h"

namespace standoff::grammar {

/// Deflated at any level, in any of deflate's kinds of blocks; damaged at tricks.
std::string deflated(Choices& c, const std::string& content);
/// The same as a zlib stream.
std::string zlibbed(Choices& c, const std::string& content);
/// The same as a gzip file, of one stream or of several in a row. At tricks a bomb: zeros until a few bytes are very
/// many.
std::string gzipped(Choices& c, const std::string& content);

/// The archive of these members, by name, deflated or as they are. Good ones differ in what lies between members, in
/// extra fields and comments, in 64-bit sizes and data descriptors; bad ones in anything else: members that overlap or
/// lie outside, sizes that contradict each other, damaged packed bytes, encryption.
std::string make_zip(Choices& c, const std::vector<std::pair<std::string, std::string>>& members);

/// The bytes of a .npy file: `type` and `shape` as NumPy writes them, "<f8" and "(3, 2)".
std::string npy_array(Choices& c, const std::string& type, const std::string& shape, bool fortran, std::string bytes);

}  // namespace standoff::grammar
