// SPDX-License-Identifier: Apache-2.0
// A question about two bodies as a word: the query and the placing of the second body.
#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include "standoff/vec.h"

namespace standoff::bench {

enum class Query { collide, contacts, all_contacts, distance, sweep };

/// `QUERY` or `QUERY@WORD,WORD,..`, where the words are
/// - `X,Y,Z`: b moved by this from its own place, one pose; or one of
/// - `gap=G`: b moved towards a until they are G apart, world units
/// - `depth=D`: b moved until they touch, and D farther
/// - `turn=DEGREES`: b rotated about its middle by up to this angle, with its middle at a's middle
/// - `hits=SHARE`: b anywhere in a's box, so that this share of the poses touches
/// - `spin=DEGREES`: b in its own place, turned about its y axis by up to this angle; with `dx=L`, `dy=L`, `dz=L` also
///   moved by up to L to either side;
/// - `poses=N`: the number of poses
/// - `way=LENGTH`: the length of a sweep
/// - `rotate=DEGREES`: by how much b turns about its y axis during a sweep.
/// The settings give all values that are not named.
struct Question {
  Query query;
  std::string name;          ///< the name of the query
  std::string placing = {};  ///< its words for where b is, if any
  std::optional<Vec3> place = {};
  std::optional<double> gap = {}, depth = {}, turn_degrees = {}, hits = {}, spin_degrees = {}, dx = {}, dy = {},
                        dz = {}, way = {}, rotate_degrees = {};
  std::optional<std::size_t> poses = {};
};
/// Throws invalid_argument.
Question parse_question(const std::string& text);

}  // namespace standoff::bench
