// SPDX-License-Identifier: Apache-2.0
// 3DS: chunks within chunks.
#include "tests/grammar/hostile.h"
#include "tests/grammar/shape.h"

namespace standoff::grammar {
namespace {

class Studio {
 public:
  explicit Studio(Choices& c) : c_(c) {}

  File make() {
    std::string objects;
    const std::uint32_t count = 1 + c_.below(3);
    for (std::uint32_t n = 0; n < count; ++n) objects += object("o" + std::to_string(n));
    if (c_.one_in(4)) objects += chunk(0x0100, raw(1.0f));
    if (c_.one_in(4)) objects += material();
    std::string content = c_.one_in(2) ? chunk(0x0002, raw(std::uint32_t{3})) : "";
    content += chunk(0x3d3d, objects);
    if (c_.one_in(3)) content += keyframer(count);
    if (c_.trick()) content += nested();
    file_.bytes = chunk(0x4d4d, content);
    damage(c_, file_.bytes);
    // The main chunk's length tells the format: it has to be right for the reader to look further.
    if (file_.bytes.size() >= 6 && !c_.one_in(4)) {
      const auto size = static_cast<std::uint32_t>(file_.bytes.size());
      std::memcpy(file_.bytes.data() + 2, &size, sizeof size);
    }
    return file_;
  }

 private:
  std::string chunk(std::uint16_t id, const std::string& content) {
    if (c_.trick()) id = static_cast<std::uint16_t>(c_.one_in(2) ? c_.below(65536) : 0x4000 + 0x10 * c_.below(64));
    return raw(id) + raw(stored(c_, static_cast<std::uint32_t>(6 + content.size()))) + content;
  }

  std::string object(const std::string& name) {
    const Shape shape = make_shape(c_, Polygons::none, false);
    // From z up to y up.
    for (const auto& face : shape.faces) {
      Corners corners;
      for (std::size_t k = 0; k < 3; ++k) {
        const Vec3 p = shape.points[face[k]];
        corners[k] = {p.x, p.z, -p.y};
      }
      file_.truth.triangles.push_back(corners);
    }
    std::string points = raw(stored(c_, static_cast<std::uint16_t>(shape.points.size()))), faces;
    for (const Vec3& p : shape.points)
      for (const double x : {p.x, p.y, p.z}) points += raw(stored(c_, static_cast<float>(x)));
    faces = raw(stored(c_, static_cast<std::uint16_t>(shape.faces.size())));
    for (const auto& face : shape.faces) {
      for (const auto corner : face) faces += raw(stored(c_, static_cast<std::uint16_t>(corner)));
      faces += raw(static_cast<std::uint16_t>(c_.below(8)));
    }
    if (c_.one_in(4)) faces += smoothing(shape.faces.size());
    std::string mesh = chunk(0x4110, points) + chunk(0x4120, faces);
    if (c_.one_in(3)) {
      std::string matrix;
      for (int n = 0; n < 12; ++n) matrix += raw(stored(c_, n % 4 == 0 && n < 12 ? 1.0f : 0.0f));
      mesh += chunk(0x4160, matrix);
    }
    if (c_.one_in(4)) mesh += mapping(shape.points.size());
    return chunk(0x4000, word(c_, name) + '\0' + chunk(0x4100, mesh));
  }

  std::string smoothing(std::size_t faces) {
    std::string groups;
    for (std::size_t n = 0; n < faces; ++n) groups += raw(std::uint32_t{1});
    return chunk(0x4150, groups);
  }
  std::string mapping(std::size_t points) {
    std::string places = raw(stored(c_, static_cast<std::uint16_t>(points)));
    for (std::size_t n = 0; n < 2 * points; ++n) places += raw(stored(c_, 0.5f));
    return chunk(0x4140, places);
  }
  std::string material() {
    return chunk(0xafff, chunk(0xa000, word(c_, "m") + '\0') + chunk(0xa200, chunk(0xa300, bad_path(c_) + '\0')));
  }

  std::string keyframer(std::uint32_t objects) {
    std::string nodes;
    for (std::uint32_t n = 0; n < objects; ++n) {
      const auto parent = stored(c_, std::uint16_t{0xffff});
      std::string node = chunk(0xb030, raw(stored(c_, static_cast<std::uint16_t>(n)))) +
                         chunk(0xb010, word(c_, "o" + std::to_string(n)) + '\0' + raw(std::uint32_t{0}) + raw(parent));
      if (c_.trick()) node += track();
      nodes += chunk(0xb002, node);
    }
    if (c_.trick()) nodes += tree();
    return chunk(0xb000, nodes);
  }
  // Nodes of objects, cameras and lights, each below the one before, beside it, or anywhere.
  std::string tree() {
    constexpr std::uint16_t kKinds[] = {0xb002, 0xb002, 0xb003, 0xb005};
    const bool chain = c_.one_in(2), alike = c_.one_in(3);
    const std::uint16_t kind = c_.pick(kKinds);
    std::string nodes;
    const std::uint32_t count = c_.many();
    for (std::uint32_t n = 0; n < count; ++n) {
      const std::string name = (alike ? "o0" : "n" + std::to_string(n)) + '\0';
      const std::uint32_t place = chain ? n : c_.below(n + 2);
      const std::string content = name + raw(std::uint32_t{0}) + raw(static_cast<std::uint16_t>(place));
      const std::string header =
          raw(std::uint16_t{0xb010}) + raw(static_cast<std::uint32_t>(6 + content.size())) + content;
      nodes += raw(kind) + raw(static_cast<std::uint32_t>(6 + header.size())) + header;
    }
    return nodes;
  }
  // Moves an object: what becomes of it is not asked here.
  std::string track() {
    constexpr std::uint16_t kTracks[] = {0xb020, 0xb021, 0xb022, 0xb013, 0xb029};
    const std::uint32_t keys = c_.below(4);
    std::string content = std::string(10, '\0') + raw(stored(c_, keys));
    for (std::uint32_t n = 0; n < keys; ++n) {
      content += raw(stored(c_, n)) + raw(stored(c_, std::uint16_t{0}));
      for (int k = 0; k < 3; ++k) content += raw(stored(c_, 1.0f));
    }
    return chunk(c_.pick(kTracks), content);
  }

  std::string nested() {
    constexpr std::uint16_t kIds[] = {0x4d4d, 0x3d3d, 0x4000, 0x4100, 0xafff, 0xb000, 0xb002, 0xa200};
    const std::uint16_t id = c_.pick(kIds);
    const std::uint32_t deep = c_.many();
    std::string bytes;
    for (std::uint32_t n = 0; n < deep; ++n) bytes += raw(id) + raw(6 * (deep - n));
    return bytes;
  }

  Choices& c_;
  File file_;
};

}  // namespace

File make_3ds(Choices& c) { return Studio(c).make(); }

}  // namespace standoff::grammar
