// What is asked about two bodies, as a word.
#pragma once

#include <optional>
#include <string>

#include "difi/vec.h"

namespace difi::bench {

enum class Query { collide, contacts, all_contacts, distance, sweep };

/// `collide`: of all poses drawn; `collide@X,Y,Z`: with b moved so far from its own place.
struct Question {
  Query query;
  std::string name;  ///< of the query
  std::optional<Vec3> place = {};
};
/// Errors: invalid_argument.
Question parse_question(const std::string& text);

}  // namespace difi::bench
