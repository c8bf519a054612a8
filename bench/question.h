// SPDX-License-Identifier: Apache-2.0
// What is asked about two bodies, and where the second one is then, as a word.
#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include "standoff/vec.h"

namespace standoff::bench {

enum class Query { collide, contacts, all_contacts, distance, sweep };

/// `QUERY` or `QUERY@WORD,WORD,..`, where the words are
/// - `X,Y,Z`: b moved so far from its own place, one pose; or one of
/// - `gap=G`: b brought near a until they are G apart, world units
/// - `depth=D`: until they touch, and D farther
/// - `turn=DEGREES`: b turned about its middle by up to so much, where a's middle is
/// - `hits=SHARE`: b anywhere in a's box, until that share of the poses touches;
/// - `poses=N`: how many poses
/// - `way=LENGTH`: of a sweep.
/// What is not said is as the settings have it.
struct Question {
  Query query;
  std::string name;          ///< of the query
  std::string placing = {};  ///< its word of gap, depth, turn or hits, if any
  std::optional<Vec3> place = {};
  std::optional<double> gap = {}, depth = {}, turn_degrees = {}, hits = {}, way = {};
  std::optional<std::size_t> poses = {};
};
/// Errors: invalid_argument.
Question parse_question(const std::string& text);

}  // namespace standoff::bench
