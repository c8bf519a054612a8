// SPDX-License-Identifier: Apache-2.0
// NPZ: arrays of NumPy in a zip archive.
#include <cmath>

#include "tests/grammar/hostile.h"
#include "tests/grammar/packed.h"
#include "tests/grammar/shape.h"

namespace standoff::grammar {
namespace {

std::string bad_shape(Choices& c) {
  if (c.one_in(3)) return "(" + std::string(c.many(), '(');
  std::string text = "(";
  for (std::uint32_t n = c.below(6); n > 0; --n) text += bad_number(c) + ",";
  return text + ")";
}

}  // namespace

// The header is a Python dictionary; entries in any order, either quote, any spaces.
std::string npy_array(Choices& c, const std::string& type, const std::string& shape, bool fortran, std::string bytes) {
  const char quote = c.one_in(4) ? '"' : '\'';
  const auto quoted = [&](const std::string& text) { return quote + word(c, text) + quote; };
  const std::string entries[] = {quoted("descr") + ": " + quoted(type),
                                 quoted("fortran_order") + ": " + word(c, fortran ? "True" : "False"),
                                 quoted("shape") + ":" + (c.trick() ? bad_shape(c) : shape)};
  const std::uint32_t first = c.below(3);
  std::string text = "{";
  for (std::uint32_t n = 0; n < 3; ++n)
    if (!c.trick()) text += entries[(first + n) % 3] + (n < 2 || c.one_in(2) ? ", " : "");
  text += "}" + std::string(c.below(64), ' ') + (c.trick() ? "" : "\n");
  const std::uint32_t version = 1 + c.below(3);
  std::string header = word(c, "\x93NUMPY") + static_cast<char>(stored(c, static_cast<std::uint8_t>(version))) + '\0';
  header += version == 1 ? raw(stored(c, static_cast<std::uint16_t>(text.size())))
                         : raw(stored(c, static_cast<std::uint32_t>(text.size())));
  if (c.trick()) bytes.resize(c.below(static_cast<std::uint32_t>(bytes.size()) + 1));
  return header + text + bytes;
}

namespace {

class Npz {
 public:
  explicit Npz(Choices& c) : c_(c) {}

  File make() {
    const Truth field = make_field(c_, true);
    fortran_ = !c_.one_in(3);
    const Size3 size = field.grid.size;
    const std::string shape = "(" + whole(c_, size.x) + ", " + whole(c_, size.y) + ", " + whole(c_, size.z) + ")";
    const auto samples = [&](const char* name, const char* kind, const auto& values) {
      const bool big = c_.one_in(4);
      std::string bytes;
      for (std::int64_t n = 0; n < size.count(); ++n) {
        // With z fastest, number n is another sample.
        const std::int64_t k = n % size.z, j = n / size.z % size.y, i = n / (size.z * size.y);
        bytes += raw(stored(c_, values[static_cast<std::size_t>(fortran_ ? n : i + size.x * (j + size.y * k))]), big);
      }
      array(name, std::string(big ? ">" : "<") + kind, shape, fortran_, bytes);
    };
    const bool samples_first = c_.one_in(2);
    if (samples_first) samples("distance", "f4", field.values);
    vector("origin", field.grid.origin);
    vector("spacing", field.grid.spacing);
    if (!std::isinf(field.thickness) || c_.one_in(2))
      array("thickness", "<f8", "()", false, raw(stored(c_, field.thickness)));
    if (c_.one_in(2)) text("method", "tiles");
    if (c_.one_in(3)) text("version", "1.0");
    if (c_.one_in(3)) array("mesh_hash", "<u8", "()", false, raw(std::uint64_t{12345}));
    if (c_.one_in(3)) array("other", "|b1", "(2,)", false, "ab");
    if (!samples_first) samples("distance", "f4", field.values);
    if (!field.nearest.empty()) samples("nearest_triangle", "u4", field.nearest);
    File file{make_zip(c_, members_), {}, field};
    damage(c_, file.bytes);
    return file;
  }

 private:
  void array(const std::string& name, const std::string& type, const std::string& shape, bool fortran,
             std::string bytes) {
    members_.emplace_back(name + ".npy", npy_array(c_, type, shape, fortran, std::move(bytes)));
  }
  void vector(const char* name, const Vec3& v) {
    const bool narrow = c_.one_in(6) && Vec3{float(v.x), float(v.y), float(v.z)} == v;
    std::string bytes;
    for (const double x : {v.x, v.y, v.z})
      bytes += narrow ? raw(stored(c_, static_cast<float>(x))) : raw(stored(c_, x));
    array(name, narrow ? "<f4" : "<f8", "(3,)", false, bytes);
  }
  void text(const char* name, const std::string& value) {
    std::string bytes;
    for (const char letter : value) bytes += raw(stored(c_, std::uint32_t{static_cast<unsigned char>(letter)}));
    array(name, "<U" + whole(c_, static_cast<std::int64_t>(value.size())), "()", false, bytes);
  }

  Choices& c_;
  bool fortran_ = true;
  std::vector<std::pair<std::string, std::string>> members_;
};

}  // namespace

File make_npz(Choices& c) { return Npz(c).make(); }

}  // namespace standoff::grammar
