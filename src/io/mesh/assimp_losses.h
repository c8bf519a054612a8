// SPDX-License-Identifier: Apache-2.0
// What assimp leaves out of a mesh and mentions in its log alone.
#pragma once
#ifdef STANDOFF_HAVE_ASSIMP

#include <memory>
#include <string>

namespace standoff {

/// While one lives it hears assimp's warnings of this thread. Assimp's log is one for the whole process, so only one
/// lives at a time: the next one blocks until then. A logger that the program itself has given assimp is left in place.
class AssimpLosses {
 public:
  AssimpLosses();
  AssimpLosses(const AssimpLosses&) = delete;
  AssimpLosses& operator=(const AssimpLosses&) = delete;
  ~AssimpLosses();

  /// The first warning that triangles were left out, or nothing.
  const std::string& first() const;

 private:
  struct Listener;
  std::unique_ptr<Listener> listener_;
  bool own_logger_;
};

}  // namespace standoff

#endif  // STANDOFF_HAVE_ASSIMP
