// SPDX-License-Identifier: Apache-2.0
// Bytes as zip and gzip pack them.
#pragma once

#include <string>

#include "tests/grammar/choices.h"

namespace standoff::grammar {

/// Deflated at any level, in any of deflate's kinds of blocks; damaged at tricks.
std::string deflated(Choices& c, const std::string& content);
/// The same as a zlib stream.
std::string zlibbed(Choices& c, const std::string& content);
/// The same as a gzip file, of one stream or of several in a row. At tricks a bomb: zeros until a few bytes are very
/// many.
std::string gzipped(Choices& c, const std::string& content);

}  // namespace standoff::grammar
