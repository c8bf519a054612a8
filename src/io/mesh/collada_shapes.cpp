// SPDX-License-Identifier: Apache-2.0
#include "io/mesh/collada_shapes.h"

#include <algorithm>

namespace standoff {

void ColladaShapes::see(const XmlTag& tag) {
  const bool close = tag.kind == XmlTag::Kind::close;
  if (tag.name == "geometry") at_hand_ = close ? nullptr : &geometries_[tag.attribute("id")];
  if (tag.name == "controller") controller_ = close ? std::string_view() : tag.attribute("id");
  if ((tag.name != "skin" && tag.name != "morph") || close || controller_.empty()) return;
  const std::string_view source = tag.attribute("source");
  sources_[controller_] = source.substr(std::min<std::size_t>(source.size(), 1));
}

void ColladaShapes::add_corners(std::uint64_t corners) {
  if (at_hand_) at_hand_->corners += static_cast<double>(corners);
}

void ColladaShapes::add_part() {
  if (at_hand_) ++at_hand_->parts;
}

ColladaShapes::Size ColladaShapes::size(std::string_view id) const {
  constexpr int kMostControllers = 10;  // that move each other
  for (int n = 0; n < kMostControllers; ++n) {
    if (const auto found = geometries_.find(id); found != geometries_.end()) return found->second;
    const auto source = sources_.find(id);
    if (source == sources_.end()) return {};
    id = source->second;
  }
  return {};
}

}  // namespace standoff
