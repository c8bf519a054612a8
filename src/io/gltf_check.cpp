#include "io/gltf_check.h"

#include <algorithm>
#include <bit>
#include <cstdint>
#include <cstring>
#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "io/json_view.h"

namespace difi {
namespace {

static_assert(std::endian::native == std::endian::little);

constexpr std::size_t kHeader = 12, kChunkHeader = 8;
// Ten times what scenes need; each level takes a frame of the reader's stack.
constexpr int kDeepest = 200;

std::uint32_t number_at(std::string_view bytes, std::size_t at) {
  std::uint32_t number;
  std::memcpy(&number, bytes.data() + at, sizeof number);
  return number;
}

std::string at_byte(std::size_t byte) { return "byte " + std::to_string(byte); }

// The whole number under a name, as assimp reads it: 0 or what is given where there is none.
std::uint32_t whole(const JsonView& object, std::string_view name, std::uint32_t otherwise = 0) {
  const JsonView* value = object.find(name);
  return value ? value->whole().value_or(otherwise) : otherwise;
}

// Assimp takes the corners of a primitive for granted: without positions it reads through a null pointer, and of a
// strip it takes one or two from the number of corners, be there none. It closes a loop of lines through its first one,
// also where it has dropped that for an index that is no vertex; to find this, one would have to read the buffers.
class PrimitiveCheck {
 public:
  PrimitiveCheck(const FileView& file, const JsonView& scene) : file_(file), accessors_(scene.find("accessors")) {}

  void operator()(const JsonView& primitive, const std::string& where) const {
    const JsonView* attributes = primitive.find("attributes");
    const JsonView* position = attributes ? attributes->find("POSITION") : nullptr;
    if (!position || !position->whole())
      file_.fail(where, "no POSITION in its attributes; it has no shape, write the file again without it");
    const JsonView* indices = primitive.find("indices");
    const bool indexed = indices && indices->whole();
    constexpr std::uint32_t kLineLoop = 2, kLineStrip = 3, kTriangles = 4, kStrip = 5, kFan = 6;
    const std::uint32_t mode = whole(primitive, "mode", kTriangles);
    if (indexed && mode == kLineLoop)
      file_.fail(where, "a loop of lines with indices is not read; leave the lines out, or write them one by one");
    const JsonView& corners = indexed ? *indices : *position;
    const std::uint32_t least = mode == kStrip || mode == kFan ? 3 : mode == kLineLoop || mode == kLineStrip ? 2 : 0;
    for (const JsonView* of : {position, &corners})
      if (const auto count = counted(*of); count && *count < least)
        file_.fail(where, std::to_string(*count) + " corners are too few for its mode, " + std::to_string(mode) +
                              "; repair the mesh");
  }

 private:
  // Elements of the accessor; nothing where it is not there, which assimp tells.
  std::optional<std::uint32_t> counted(const JsonView& index) const {
    const JsonView* accessor = accessors_ ? accessors_->at(*index.whole()) : nullptr;
    return accessor ? std::optional(whole(*accessor, "count")) : std::nullopt;
  }

  const FileView& file_;
  const JsonView* accessors_;
};

std::string_view text(const JsonView& object, std::string_view name) {
  const JsonView* value = object.find(name);
  return value ? value->text() : std::string_view();
}

// Whether a media type has both its halves, written without escapes but "\/": of others assimp looks for the second
// half at the address 1.
bool is_media_type(std::string_view type) {
  for (std::size_t at = type.find('\\'); at != type.npos; at = type.find('\\', at + 2))
    if (!type.substr(at).starts_with("\\/")) return false;
  return type.empty() || type.find('/') != type.npos;
}

// Of an element of "buffers" or "images". Assimp keeps in the first bytes of a data URI where its parts begin, each in
// a byte with a sign, and takes one that begins with the byte 16 for one of these.
void check_uri(const FileView& file, const JsonView& element, const std::string& where) {
  constexpr std::size_t kLongest = 100;  // far from 127; "data:application/octet-stream;base64," has 37
  constexpr std::string_view kData = "data:";
  const auto fail = [&](const std::string& what) {
    file.fail(where, what + "; write the file again in the program that made it");
  };
  const std::string_view uri = text(element, "uri");
  if (!uri.empty() && (uri[0] == '\\' || static_cast<unsigned char>(uri[0]) < ' '))
    fail("its uri begins with an escape");
  if (!is_media_type(text(element, "mimeType"))) fail("its mimeType is not of the form image/png");
  if (!uri.starts_with(kData)) return;
  const std::size_t comma = uri.find(',');
  if (comma > kLongest) fail("its data has no beginning of the form data:image/png;base64,");
  const std::string_view head = uri.substr(kData.size(), comma - kData.size());
  if (!is_media_type(head.substr(0, head.find(';')))) fail("the type of its data is not of the form image/png");
}

// Of an element of "accessors": assimp holds the length of its numbers against that of their view, but not where they
// begin there, and writes sparse ones wherever their indices say.
void check_accessor(const FileView& file, const JsonView& scene, const JsonView& accessor, const std::string& where) {
  constexpr std::pair<std::string_view, std::uint64_t> kTypes[] = {{"SCALAR", 1}, {"VEC2", 2}, {"VEC3", 3}, {"VEC4", 4},
                                                                   {"MAT2", 4},   {"MAT3", 9}, {"MAT4", 16}};
  constexpr std::uint32_t kByte = 5120, kShort = 5122, kUnsignedInt = 5125, kFloat = 5126;
  const std::uint32_t component = whole(accessor, "componentType");
  const auto* const type =
      std::ranges::find(kTypes, text(accessor, "type"), &std::pair<std::string_view, std::uint64_t>::first);
  if (type == std::end(kTypes) || component < kByte || component > kFloat)
    file.fail(where, "its type or componentType is none of glTF's; repair the file");
  if (accessor.find("sparse"))
    file.fail(where, "sparse accessors are not read; write the file without in the program that made it");
  const JsonView* index = accessor.find("bufferView");
  const JsonView* views = scene.find("bufferViews");
  const JsonView* view = index && index->whole() && views ? views->at(*index->whole()) : nullptr;
  if (!view) return;  // assimp tells
  const std::uint64_t width = type->second * (component >= kUnsignedInt ? 4 : component >= kShort ? 2 : 1);
  const std::uint64_t count = whole(accessor, "count"),
                      stride = std::max<std::uint64_t>(whole(*view, "byteStride"), width);
  const std::uint64_t room = whole(*view, "byteLength");
  if (count > 0 && whole(accessor, "byteOffset") + (count - 1) * stride + width > room)
    file.fail(where, "its numbers reach past the " + std::to_string(room) + " bytes of their view; repair the file");
}

// check(element, "NOUN 3") for the elements of a list.
template <class Check>
void for_each(const JsonView& parent, std::string_view list, const std::string& noun, Check check) {
  const JsonView* found = parent.find(list);
  for (std::size_t n = 0; found && n < found->elements().size(); ++n)
    check(found->elements()[n], noun + " " + std::to_string(n));
}

// Notes the names of these members; those with escapes too, for they may say the same.
void hide(const FileView& file, const JsonView& object, std::initializer_list<std::string_view> names,
          std::vector<std::size_t>& hidden) {
  for (const auto& [name, value] : object.members())
    if (name.find('\\') != name.npos || std::ranges::find(names, name) != names.end())
      hidden.push_back(static_cast<std::size_t>(name.data() - file.bytes().data()));
}

// Skins are not read: assimp takes it for granted that they have matrices, which they may leave out, and that the
// joints which vertices name are there. Nor are animations.
std::vector<std::size_t> hidden_names(const FileView& file, const JsonView& scene) {
  std::vector<std::size_t> hidden;
  hide(file, scene, {"skins", "animations"}, hidden);
  if (const JsonView* nodes = scene.find("nodes"))
    for (const JsonView& node : nodes->elements()) hide(file, node, {"skin"}, hidden);
  return hidden;
}

std::vector<std::size_t> check_scene(const FileView& file, std::size_t begin, std::size_t end) {
  const JsonView scene = JsonView::read(file, file.bytes().substr(begin, end - begin), begin, kDeepest);
  const PrimitiveCheck check_primitive(file, scene);
  for_each(scene, "meshes", "mesh", [&](const JsonView& mesh, const std::string& where) {
    for_each(mesh, "primitives", where + " primitive", check_primitive);
  });
  const auto check = [&](const JsonView& element, const std::string& where) { check_uri(file, element, where); };
  for_each(scene, "accessors", "accessor",
           [&](const JsonView& accessor, const std::string& where) { check_accessor(file, scene, accessor, where); });
  for_each(scene, "buffers", "buffer", check);
  for_each(scene, "images", "image", check);
  return hidden_names(file, scene);
}

}  // namespace

std::vector<std::size_t> check_glb(const FileView& file) {
  std::vector<std::size_t> hidden;
  const std::string_view bytes = file.bytes();
  if (!bytes.starts_with("glTF")) file.fail(at_byte(0), "a binary glTF starts with glTF; check that it is one");
  if (bytes.size() < kHeader + kChunkHeader)
    file.fail(at_byte(bytes.size()), "the file ends in its header; it is cut off, get all of it");
  if (const auto version = number_at(bytes, 4); version != 2)
    file.fail(at_byte(4), "version " + std::to_string(version) + " of glTF; convert it to version 2");
  const std::size_t length = number_at(bytes, 8);
  if (length > bytes.size() || length < kHeader + kChunkHeader)
    file.fail(at_byte(8), "it promises " + std::to_string(length) + " bytes and has " + std::to_string(bytes.size()) +
                              "; it is cut off or damaged, get all of it");
  for (std::size_t at = kHeader; length - at >= kChunkHeader;) {
    const std::size_t chunk = number_at(bytes, at), left = length - at - kChunkHeader;
    if (chunk > left)
      file.fail(at_byte(at), "a chunk of " + std::to_string(chunk) + " bytes, where " + std::to_string(left) +
                                 " are left; the file is cut off or damaged, get all of it");
    const std::size_t begin = at + kChunkHeader;
    if (at == kHeader) hidden = check_scene(file, begin, begin + chunk);
    at = std::min(length, begin + (chunk + 3) / 4 * 4);  // chunks are padded
  }
  return hidden;
}

std::vector<std::size_t> check_gltf(const FileView& file) { return check_scene(file, 0, file.size()); }

}  // namespace difi
