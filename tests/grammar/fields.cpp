// SPDX-License-Identifier: Apache-2.0
// VTI and NRRD: a text header, then samples.
#include <array>
#include <charconv>
#include <cmath>
#include <limits>

#include "tests/grammar/hostile.h"
#include "tests/grammar/packed.h"
#include "tests/grammar/shape.h"
#include "tests/grammar/xml.h"

namespace standoff::grammar {

Truth make_field(Choices& c, bool may_have_nearest) {
  Truth field;
  const auto side = [&] { return std::int64_t{1} + c.below(c.one_in(6) ? 40 : 9); };
  field.grid.size = {side(), side(), c.one_in(2) ? 1 + c.below(4) : side()};
  const auto place = [&] { return double(make_coordinate(c, false)); };
  field.grid.origin = {place(), place(), place()};
  constexpr double kSpacings[] = {1, 0.5, 0.1, 1e-3, 3e5};
  field.grid.spacing = {c.pick(kSpacings), c.pick(kSpacings), c.pick(kSpacings)};
  constexpr double kThicknesses[] = {0.5, 2, 1e-3, std::numeric_limits<double>::infinity(), 100};
  field.thickness = c.pick(kThicknesses);
  const float far = static_cast<float>(field.thickness);
  const bool nearest = may_have_nearest && c.one_in(2);
  for (std::int64_t n = field.grid.sample_count(); n > 0; --n) {
    float value = c.one_in(3) ? far : static_cast<float>(c.below(1000)) / 2048 * (std::isinf(far) ? 9 : far);
    if (c.one_in(500)) value = -value;
    field.values.push_back(value);
    // Only a sample of the band has one: none farther than the thickness is stored.
    if (nearest) field.nearest.push_back(value < far ? c.below(1000) : kNoTriangle);
  }
  return field;
}

std::string real64(Choices& c, double value) {
  if (c.trick()) return bad_number(c);
  std::array<char, 64> text{};
  return {text.data(), std::to_chars(text.data(), text.data() + text.size(), value).ptr};
}

namespace {

std::string three(Choices& c, const Vec3& v, const char* between) {
  return real64(c, v.x) + between + real64(c, v.y) + between + real64(c, v.z);
}

template <class T>
std::string array_of(Choices& c, const std::vector<T>& values, bool big_endian) {
  std::string bytes;
  for (const T value : values) bytes += raw(stored(c, value), big_endian);
  if (c.trick()) bytes.resize(c.below(static_cast<std::uint32_t>(bytes.size()) + 1));
  return bytes;
}

// Arrays after the '_', each with its length before it.
class Appended {
 public:
  Appended(Choices& c, bool big_endian, bool wide) : c_(c), big_endian_(big_endian), wide_(wide) {}

  std::string add(const std::string& bytes) {
    if (c_.one_in(6)) data_ += "xyz";  // offsets need not be aligned
    const std::string offset = whole(c_, static_cast<std::int64_t>(data_.size()));
    data_ += wide_ ? raw(stored(c_, std::uint64_t{bytes.size()}), big_endian_)
                   : raw(stored(c_, static_cast<std::uint32_t>(bytes.size())), big_endian_);
    data_ += bytes;
    return offset;
  }
  const std::string& data() const { return data_; }

 private:
  Choices& c_;
  bool big_endian_, wide_;
  std::string data_;
};

}  // namespace

File make_vti(Choices& c) {
  const Truth field = make_field(c, true);
  const bool big = c.one_in(4), wide = c.one_in(2);
  Appended appended(c, big, wide);
  const auto array = [&](const char* type, const char* name, const std::string& bytes) {
    return Xml("DataArray", {{"type", type}, {"Name", name}, {"format", "appended"}, {"offset", appended.add(bytes)}});
  };
  Xml file("VTKFile", {{"type", "ImageData"}, {"version", "1.0"}, {"byte_order", big ? "BigEndian" : "LittleEndian"}});
  if (wide || c.one_in(2)) file.set("header_type", wide ? "UInt64" : "UInt32");
  if (c.trick()) file.set("compressor", "vtkZLibDataCompressor");
  const Size3 size = field.grid.size;
  std::string extent;
  for (const auto n : {size.x, size.y, size.z}) extent += whole(c, 0) + " " + whole(c, n - 1) + " ";
  Xml& image = file.add(Xml("ImageData", {{"WholeExtent", extent},
                                          {"Origin", three(c, field.grid.origin, " ")},
                                          {"Spacing", three(c, field.grid.spacing, " ")}}));
  if (c.one_in(6)) image.set("Direction", "1 0 0 0 1 0 0 0 1");
  Xml& facts = image.add(Xml("FieldData"));
  if (!std::isinf(field.thickness) || c.one_in(2))
    facts.add(array("Float64", "thickness", raw(stored(c, field.thickness), big))).set("NumberOfTuples", "1");
  if (c.one_in(2)) facts.add(array("String", "method", word(c, "tiles") + '\0'));
  if (c.one_in(3)) facts.add(array("String", "mesh_hash", word(c, "0x0123456789abcdef") + '\0'));
  Xml& piece = image.add(Xml("Piece", {{"Extent", extent}}));
  Xml& points = piece.add(Xml("PointData", {{"Scalars", "distance"}}));
  points.add(array("Float32", "distance", array_of(c, field.values, big)));
  if (!field.nearest.empty()) points.add(array("UInt32", "nearest_triangle", array_of(c, field.nearest, big)));
  if (c.one_in(4)) piece.add(Xml("CellData"));
  if (c.trick()) image.add(Xml("Piece", {{"Extent", extent}}));
  std::string text = file.text(c, c.one_in(3));
  // The appended data is the last element, of bytes instead of text.
  const auto close = text.rfind("</");
  if (close != text.npos) text.resize(close);
  File made{text + "<AppendedData encoding=\"" + word(c, "raw") + "\">" + (c.one_in(2) ? "\n  _" : "_") +
                appended.data() + "</AppendedData></VTKFile>",
            {},
            field};
  damage(c, made.bytes);
  return made;
}

File make_nrrd(Choices& c) {
  const Truth field = make_field(c, false);
  const bool big = c.one_in(4);
  const std::string line = c.one_in(4) ? "\r\n" : "\n";
  std::string text = word(c, "NRRD000") + std::to_string(1 + c.below(5)) + line;
  const auto say = [&](const char* name, const std::string& value) {
    if (c.trick()) return;
    for (int times = c.trick() ? 2 : 1; times > 0; --times) text += word(c, name) + ": " + value + line + noise(c);
    if (c.one_in(8)) text += "# remark" + line;
  };
  const Grid& grid = field.grid;
  say("type", word(c, "float"));
  say("dimension", whole(c, 3));
  say("sizes", whole(c, grid.size.x) + " " + whole(c, grid.size.y) + " " + whole(c, grid.size.z));
  if (c.one_in(2)) {
    say("space dimension", "3");
    const auto axis = [&](double x, double y, double z) {
      const std::string gap = c.one_in(4) ? ", " : ",";
      return "(" + real64(c, x) + gap + real64(c, y) + gap + real64(c, z) + ")";
    };
    say("space directions",
        axis(grid.spacing.x, 0, 0) + " " + axis(0, grid.spacing.y, 0) + " " + axis(0, 0, grid.spacing.z));
    say("space origin", axis(grid.origin.x, grid.origin.y, grid.origin.z));
  } else {
    say("spacings", three(c, grid.spacing, " "));
    say("axis mins", three(c, grid.origin, "  "));
  }
  say("endian", word(c, big ? "big" : "little"));
  const bool packed = c.one_in(4);
  say("encoding", word(c, !packed ? "raw" : c.one_in(2) ? "gz" : "gzip"));
  if (c.trick()) say(c.one_in(2) ? "data file" : "byte skip", bad_path(c));
  if (c.trick())
    for (std::uint32_t n = c.many(); n > 0; --n) text += "key" + std::to_string(n) + ":=" + line;
  text += "thickness:=" + real64(c, field.thickness) + line;
  if (c.one_in(2)) text += "method:=" + word(c, "tiles\\n") + line;
  if (!c.trick()) text += line;
  const std::string samples = array_of(c, field.values, big);
  File made{text + (packed ? gzipped(c, samples) : samples), {}, field};
  if (c.one_in(8)) made.bytes += "more";
  damage(c, made.bytes);
  return made;
}

}  // namespace standoff::grammar
