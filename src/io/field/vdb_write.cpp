// SPDX-License-Identifier: Apache-2.0
// VDB: OpenVDB's files, of version 224: a header, and one grid: its facts, its transform, the nodes of its tree from
// the root down (topology), the values of the leaves (buffers). Inactive values are not written: they are + or
// -background.
#include <array>
#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

#include "core/number_text.h"
#include "io/field/vdb_format.h"
#include "io/field/vdb_tree.h"

namespace standoff::vdb {
namespace {

/// The front of a grid: how it is compressed, facts, and the transform.
class FactWriter {
 public:
  void text(const std::string& name, const std::string& value) { fact(name, "string", value); }
  void flag(const std::string& name, bool value) { fact(name, "bool", std::string(1, value ? '\1' : '\0')); }
  template <class Numbers>
  void numbers(const std::string& name, const std::string& type, const Numbers& values) {
    fact(name, type, {reinterpret_cast<const char*>(values.data()), values.size() * sizeof values[0]});
  }

  std::string grid_front(const Vec3& origin, const Vec3& spacing) const {
    std::string front;
    add(front, kActiveMask);
    add(front, count_);
    front += bytes_;
    const Vec3 h = spacing;
    add_text(front, h.x == h.y && h.y == h.z ? "UniformScaleTranslateMap" : "ScaleTranslateMap");
    for (const Vec3& v : {origin, h, h, Vec3{1 / h.x, 1 / h.y, 1 / h.z},
                          Vec3{1 / h.x / h.x, 1 / h.y / h.y, 1 / h.z / h.z}, Vec3{0.5 / h.x, 0.5 / h.y, 0.5 / h.z}})
      for (const double x : {v.x, v.y, v.z}) add(front, x);
    return front;
  }

 private:
  template <class Number>
  static void add(std::string& to, Number value) {
    to.append(reinterpret_cast<const char*>(&value), sizeof value);
  }
  static void add_text(std::string& to, const std::string& text) {
    add(to, static_cast<std::uint32_t>(text.size()));
    to += text;
  }
  void fact(const std::string& name, const std::string& type, const std::string& value) {
    add_text(bytes_, name);
    add_text(bytes_, type);
    add_text(bytes_, value);
    ++count_;
  }

  std::string bytes_;
  std::uint32_t count_ = 0;
};

class VdbWriter {
 public:
  VdbWriter(AtomicFile& file, const DistanceField& field, int threads)
      : file_(file), field_(field), threads_(threads), tree_(tree_of(field, file)), far_(background_of(field)) {}

  void write() {
    number(kMagic);
    number(kVersion);
    number(std::uint32_t{10});  // of the library whose files these are like
    number(std::uint32_t{0});
    number(std::uint8_t{1});  // positions follow the grid's names
    raw(kNoId);
    number(std::uint32_t{0});  // facts of the file
    number(std::uint32_t{1});  // grids
    text("distance");
    text(kFloatTree);
    text("");  // the grid whose tree it shares
    const std::uint64_t positions = file_.size();
    constexpr std::uint64_t kPositions = 3 * sizeof(std::uint64_t);
    std::array<std::uint64_t, 3> at{positions + kPositions, 0, 0};
    for (const std::uint64_t position : at) number(position);
    const std::string front = facts();
    raw(front);
    topology();
    at[1] = file_.size();
    buffers();
    at[2] = file_.size();
    file_.overwrite(positions, at.data(), sizeof at);
  }

 private:
  template <class Number>
  void number(Number value) {
    file_.write(&value, sizeof value);
  }
  void raw(std::string_view bytes) { file_.write(bytes.data(), bytes.size()); }
  void raw(std::span<const std::byte> bytes) { file_.write(bytes.data(), bytes.size()); }
  void text(std::string_view words) {
    number(static_cast<std::uint32_t>(words.size()));
    raw(words);
  }

  // Compression, metadata and transform.
  std::string facts() const {
    const Grid& grid = field_.grid();
    FactWriter facts;
    facts.text("class", field_.has_sign() ? "level set" : "unknown");
    facts.text("name", "distance");
    facts.text("creator", "standoff");
    facts.flag("is_saved_as_half_float", false);
    facts.numbers(
        kSizeFact, "vec3i",
        std::array<std::int32_t, 3>{static_cast<std::int32_t>(grid.size.x), static_cast<std::int32_t>(grid.size.y),
                                    static_cast<std::int32_t>(grid.size.z)});
    facts.numbers(kThicknessFact, "double", std::array<double, 1>{field_.thickness()});
    facts.text(kMethodFact, field_.provenance().method);
    facts.text(kHashFact, hash_text(field_.provenance().mesh_hash));
    facts.text(kVersionFact, field_.provenance().version);
    facts.text(kSignFact, field_.provenance().sign);
    if (field_.provenance().up) facts.text(kUpFact, axis_text(field_.provenance().up));
    return facts.grid_front(grid.corner(), grid.spacing);
  }

  // Values that are not active are one of two: what a leaf or a tile has inside, and the background.
  static ValuesKind kind_of(bool any_inside, bool any_outside) {
    if (!any_inside) return ValuesKind::background;
    return any_outside ? ValuesKind::background_or_negative : ValuesKind::negative;
  }

  template <int log>
  void node_front(const Node<log>& node) {
    raw(node.child.bytes());
    raw(Mask<log>().bytes());  // no tile is active
    Mask<log> outside;
    for (std::size_t n = 0; n < outside.words.size(); ++n)
      outside.words[n] = ~(node.inside.words[n] | node.child.words[n]);
    const ValuesKind kind = kind_of(!node.inside.none(), !outside.none());
    number(kind);
    if (kind == ValuesKind::background_or_negative) raw(outside.bytes());
  }

  void coordinates(const Size3& at) {
    number(std::array<std::int32_t, 3>{static_cast<std::int32_t>(at.x), static_cast<std::int32_t>(at.y),
                                       static_cast<std::int32_t>(at.z)});
  }

  void topology() {
    masks_.resize(tree_.leaves.size());
    each_leaf(tree_, threads_, [&](std::size_t n) {
      if (n % 1024 == 0) file_.check();
      fetch_leaf_after(field_, tree_, n);
      masks_[n] = leaf_masks(field_, tree_.leaves[n]);
    });
    number(std::uint32_t{1});  // buffers of each leaf
    number(far_);
    number(static_cast<std::uint32_t>(tree_.inside.size()));
    number(static_cast<std::uint32_t>(tree_.uppers.size()));
    for (const Size3& at : tree_.inside) {
      coordinates(at);
      number(-far_);
      number(std::uint8_t{0});
    }
    for (const auto& upper : tree_.uppers) {
      coordinates(upper.at);
      node_front(upper);
      for (std::size_t n = upper.first; n < upper.first + upper.count; ++n) {
        const auto& lower = tree_.lowers[n];
        node_front(lower);
        for (std::size_t leaf = lower.first; leaf < lower.first + lower.count; ++leaf) raw(masks_[leaf].active.bytes());
      }
    }
  }

  void buffers() {
    constexpr std::size_t kMaskBytes = sizeof(Mask<kLeafLog>), kMost = 2 * kMaskBytes + 1 + 513 * sizeof(float);
    write_leaves(file_, tree_, threads_, kMost, [&](std::size_t leaf, char* const to) {
      const LeafMasks& masks = masks_[leaf];
      std::array<float, 512> values;
      fetch_leaf_after(field_, tree_, leaf);
      leaf_values(field_, tree_.leaves[leaf], far_, values);
      char* at = to;
      const auto add = [&](const auto& value) {
        std::memcpy(at, &value, sizeof value);
        at += sizeof value;
      };
      const ValuesKind kind = kind_of(masks.any_inside, masks.any_outside);
      add(masks.active.words);
      add(kind);
      if (kind == ValuesKind::background_or_negative) add(masks.outside.words);
      // All are written, and the next one over those that are not active: branches would be mispredicted.
      for (std::size_t x = 0; x < 8; ++x)
        for (std::size_t n = 0; n < 64; ++n) {
          std::memcpy(at, &values[64 * x + n], sizeof(float));
          at += sizeof(float) * (masks.active.words[x] >> n & 1);
        }
      return static_cast<std::size_t>(at - to);
    });
  }

  AtomicFile& file_;
  const DistanceField& field_;
  const int threads_;
  const Tree tree_;
  const float far_;
  std::vector<LeafMasks> masks_;
};

}  // namespace

void write_vdb(AtomicFile& file, const DistanceField& field, const FieldWriteOptions& options) {
  check_indices(field, "vdb");
  VdbWriter(file, field, options.threads).write();
}

}  // namespace standoff::vdb
