// SPDX-License-Identifier: Apache-2.0
// PLY: headers of every kind, text and both endians. Positions of any type, properties and elements nobody asked for,
// lists of every count and index type.
#include <cmath>

#include "tests/grammar/hostile.h"
#include "tests/grammar/shape.h"

namespace standoff::grammar {
namespace {

enum class Type { int8, uint8, int16, uint16, int32, uint32, float32, float64 };
constexpr const char* kNames[][2] = {{"char", "int8"}, {"uchar", "uint8"}, {"short", "int16"},   {"ushort", "uint16"},
                                     {"int", "int32"}, {"uint", "uint32"}, {"float", "float32"}, {"double", "float64"}};
constexpr Type kTypes[] = {Type::int8,  Type::uint8,  Type::int16,   Type::uint16,
                           Type::int32, Type::uint32, Type::float32, Type::float64};

class Ply {
 public:
  explicit Ply(Choices& c) : c_(c) {}

  File make() {
    shape_ = make_shape(c_, Polygons::some, true);
    encoding_ = c_.below(3);
    // A whole-number type can only hold whole positions.
    if (c_.one_in(6)) {
      coordinate_ = c_.one_in(2) ? Type::int32 : Type::int16;
      for (Vec3& p : shape_.points) p = {whole_part(p.x), whole_part(p.y), whole_part(p.z)};
    } else if (c_.one_in(3)) {
      coordinate_ = Type::float64;
    }
    if (c_.trick()) spoil_shape();
    begin();
    const bool faces_first = c_.one_in(4);
    for (int part = 0; part < 2; ++part) {
      extra_element();
      if ((part == 1) == faces_first)
        vertices();
      else if (c_.one_in(4))
        strips();
      else
        faces();
    }
    extra_element();
    if (c_.trick()) many_elements();
    if (!c_.trick()) header_ += word(c_, "end_header") + (encoding_ == 0 ? line_ : header_line_);
    File file{header_ + body_, {}, {}};
    damage(c_, file.bytes);
    if (strips_)
      add_strips(file.truth.triangles);
    else
      add_triangles(shape_, file.truth.triangles);
    return file;
  }

 private:
  void add_strips(std::vector<Corners>& to) const {
    for (const auto& face : shape_.faces) {
      const auto add = [&](std::size_t a, std::size_t b, std::size_t c) {
        to.push_back({shape_.points[face[a]], shape_.points[face[b]], shape_.points[face[c]]});
      };
      add(1, 2, 0);
      if (face.size() == 4) add(0, 2, 3);
    }
  }
  static double whole_part(double x) { return std::abs(x) < 30000 ? std::trunc(x) : 7; }

  void begin() {
    constexpr const char* kLines[] = {"\n", "\r\n", "\r"};
    line_ = header_line_ = c_.pick(kLines);
    constexpr const char* kEncodings[] = {"ascii", "binary_little_endian", "binary_big_endian"};
    header_ = word(c_, "ply") + line_;
    if (!c_.trick()) {
      header_ += "format " + word(c_, kEncodings[encoding_]) + " " + word(c_, "1.0") + line_;
    }
    comment();
  }
  void comment() {
    if (c_.one_in(4)) header_ += "comment made of end_header words" + line_;
    if (c_.one_in(8)) header_ += "obj_info 1 2 3" + line_;
    header_ += noise(c_);
  }

  std::string type(Type t) { return word(c_, kNames[static_cast<int>(t)][c_.below(2)]); }

  void element(const std::string& name, std::size_t count) {
    header_ += "element " + word(c_, name) + " " + whole(c_, static_cast<std::int64_t>(count)) + line_;
    if (c_.trick()) header_ += "element " + name + " 1" + line_;
    comment();
  }
  void property(Type t, const std::string& name) {
    header_ += "property " + type(t) + " " + word(c_, name) + line_;
    if (c_.trick()) header_ += "property " + type(t) + " " + name + line_;
  }
  void list(Type count, Type t, const std::string& name) {
    header_ += "property list " + type(count) + " " + type(t) + " " + word(c_, name) + line_;
  }

  template <class T>
  void put(T value) {
    if (encoding_ == 0) {
      body_ += std::is_floating_point_v<T> ? real(c_, static_cast<double>(value))
                                           : whole(c_, static_cast<std::int64_t>(value));
      body_ += c_.one_in(10) ? line_ : " ";
    } else {
      body_ += raw(stored(c_, value), encoding_ == 2);
    }
  }
  void put(Type t, double value) {
    switch (t) {
      case Type::int8:
        return put(static_cast<std::int8_t>(static_cast<std::int64_t>(value)));
      case Type::uint8:
        return put(static_cast<std::uint8_t>(static_cast<std::int64_t>(value)));
      case Type::int16:
        return put(static_cast<std::int16_t>(static_cast<std::int64_t>(value)));
      case Type::uint16:
        return put(static_cast<std::uint16_t>(static_cast<std::int64_t>(value)));
      case Type::int32:
        return put(static_cast<std::int32_t>(static_cast<std::int64_t>(value)));
      case Type::uint32:
        return put(static_cast<std::uint32_t>(static_cast<std::int64_t>(value)));
      case Type::float32:
        return put(static_cast<float>(value));
      case Type::float64:
        return put(value);
    }
  }
  // Values that the header does not tell of may follow those of a row on their line.
  void end_row() {
    if (encoding_ != 0) return;
    if (body_.ends_with(' ') && c_.one_in(16)) body_ += "7 more";
    body_ += line_ + noise(c_);
  }

  // Properties that are read over: numbers and lists of them.
  struct Extra {
    bool list;
    Type count, type;
  };
  std::vector<Extra> extras(const std::string& prefix, std::uint32_t most) {
    std::vector<Extra> made;
    for (std::uint32_t n = c_.below(most + 1); n > 0; --n) {
      const Extra extra{c_.one_in(3), kTypes[c_.below(6)], c_.pick(kTypes)};
      const std::string name = prefix + std::to_string(n);
      if (extra.list)
        list(extra.count, extra.type, name);
      else
        property(extra.type, name);
      made.push_back(extra);
    }
    return made;
  }
  void put(const std::vector<Extra>& extras) {
    for (const Extra& extra : extras) {
      const std::uint32_t count = extra.list ? c_.below(5) : 1;
      if (extra.list) put(extra.count, count);
      for (std::uint32_t n = 0; n < count; ++n) put(extra.type, c_.below(100));
    }
  }

  void vertices() {
    element("vertex", shape_.points.size());
    const auto before = extras("a", 2);
    for (const char* axis : {"x", "y", "z"})
      if (!c_.trick()) property(coordinate_, axis);
    const auto after = extras("b", 3);
    for (const Vec3& p : shape_.points) {
      put(before);
      for (const double x : {p.x, p.y, p.z}) put(coordinate_, x);
      put(after);
      end_row();
    }
  }

  void faces() {
    element("face", shape_.faces.size());
    const auto before = extras("a", 1);
    // Types that can hold the numbers.
    const std::size_t points = shape_.points.size();
    const Type count = kTypes[c_.below(6)];
    const Type index = points > 32767 ? (c_.one_in(2) ? Type::int32 : Type::uint32)
                                      : kTypes[(points > 127 ? 2 : 0) + c_.below(points > 127 ? 4 : 6)];
    if (!c_.trick()) list(count, index, c_.one_in(3) ? "vertex_index" : "vertex_indices");
    const auto after = extras("b", 2);
    for (const auto& face : shape_.faces) {
      put(before);
      put(count, static_cast<double>(face.size()));
      for (const auto corner : face) put(index, corner);
      put(after);
      end_row();
    }
  }

  // Each face as a strip that goes to and fro between its two ends, one after the other in one list.
  void strips() {
    for (auto& face : shape_.faces)
      if (face.size() > 4 || face.size() < 3) face = {0, 1, 2};
    element("tristrips", 1);
    list(Type::int32, Type::int32, "vertex_indices");
    std::vector<std::int64_t> corners;
    for (const auto& face : shape_.faces) {
      for (const std::size_t corner : {1, 2, 0, 3})
        if (corner < face.size()) corners.push_back(face[corner]);
      corners.push_back(-1);
    }
    put(static_cast<std::int32_t>(corners.size()));
    for (const auto corner : corners) put(static_cast<std::int32_t>(corner));
    end_row();
    strips_ = true;
  }

  void extra_element() {
    if (!c_.one_in(4)) return;
    const std::uint32_t rows = c_.below(4);
    element("extra" + std::to_string(named_++), rows);
    const auto columns = extras("p", 3);
    for (std::uint32_t n = 0; n < rows; ++n) {
      put(columns);
      end_row();
    }
  }

  void many_elements() {
    const std::uint32_t count = c_.many();
    const bool elements = c_.one_in(2);
    for (std::uint32_t n = 0; n < count; ++n)
      header_ +=
          (elements ? "element e" + std::to_string(n) + " 9000000000000000000" : "property list int int p") + line_;
  }

  // A polygon past what is cut at leisure: corners in no order, on a line, or as a comb.
  void spoil_shape() {
    const std::uint32_t corners = c_.many(), kind = c_.below(4);
    std::vector<std::uint32_t> face;
    for (std::uint32_t k = 0; k < corners; ++k) {
      face.push_back(static_cast<std::uint32_t>(shape_.points.size()));
      const double even = k % 2, step = k;
      const Vec3 kinds[] = {{double(c_.below(1000)), double(c_.below(1000)), 0},
                            {step, 0, 0},
                            {step, even * 1000, 0},
                            {(1 + even) * std::cos(step), (1 + even) * std::sin(step), 0}};
      shape_.points.push_back(kinds[kind]);
    }
    shape_.faces.push_back(face);
  }

  Choices& c_;
  Shape shape_;
  std::uint32_t encoding_ = 0;
  Type coordinate_ = Type::float32;
  std::string line_, header_line_, header_, body_;
  int named_ = 0;
  bool strips_ = false;
};

}  // namespace

File make_ply(Choices& c) { return Ply(c).make(); }

}  // namespace standoff::grammar
