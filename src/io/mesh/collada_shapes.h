// SPDX-License-Identifier: Apache-2.0
// How large the shapes of a COLLADA file are.
#pragma once

#include <cstdint>
#include <map>
#include <string_view>

#include "files/xml_scan.h"

namespace standoff {

/// Counts the corners of each geometry's faces. A controller (a skin, a morph) has those of the geometry it moves.
class ColladaShapes {
 public:
  /// Sees every tag.
  void see(const XmlTag& tag);
  /// More corners of the geometry at hand.
  void add_corners(std::uint64_t corners);
  /// Another list of faces in the geometry at hand, of which assimp makes a mesh of its own.
  void add_part();

  struct Size {
    double corners = 0, parts = 0;
  };
  /// What an instance of it adds; nothing for what is not there, which assimp leaves out.
  Size size(std::string_view id) const;

 private:
  Size* at_hand_ = nullptr;
  std::string_view controller_;
  std::map<std::string_view, Size> geometries_;           // of several with one id, all together
  std::map<std::string_view, std::string_view> sources_;  // of controllers
};

}  // namespace standoff
