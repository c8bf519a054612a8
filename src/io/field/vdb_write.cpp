// SPDX-License-Identifier: Apache-2.0
// VDB: OpenVDB's files, of version 224: a header, and one grid: its facts, its transform, the nodes of its tree from the
// root down (topology), the values of the leaves (buffers). Inactive values are not written: they are + or -background.
#include <array>
#include <cstdint>
#include <string>

#include "core/number_text.h"
#include "io/field/format.h"
#include "io/field/vdb_format.h"
#include "io/field/vdb_tree.h"

namespace standoff {
namespace {

using namespace vdb;

class Writer {
 public:
  Writer(AtomicFile& file, const DistanceField& field)
      : file_(file), field_(field), tree_(tree_of(field)), far_(background_of(field)) {}

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
    facts.text("class", is_signed(field_) ? "level set" : "unknown");
    facts.text("name", "distance");
    facts.text("creator", "standoff");
    facts.flag("is_saved_as_half_float", false);
    facts.numbers(kSizeFact, "vec3i",
                  std::array<std::int32_t, 3>{static_cast<std::int32_t>(grid.size.x),
                                              static_cast<std::int32_t>(grid.size.y),
                                              static_cast<std::int32_t>(grid.size.z)});
    facts.numbers(kThicknessFact, "double", std::array<double, 1>{field_.thickness()});
    facts.text(kMethodFact, field_.provenance().method);
    facts.text(kHashFact, hash_text(field_.provenance().mesh_hash));
    facts.text(kVersionFact, field_.provenance().version);
    facts.text(kSignFact, field_.provenance().sign);
    return facts.grid_front(grid.origin, grid.spacing);
  }

  // A node's values that are not active are one of two: what a leaf or a tile has inside, and the background.
  template <int log>
  void values_front(const Mask<log>& outside, bool any_inside, bool any_outside) {
    const auto kind = any_inside ? (any_outside ? ValuesKind::background_or_negative : ValuesKind::negative)
                                 : ValuesKind::background;
    number(kind);
    if (kind == ValuesKind::background_or_negative) raw(outside.bytes());
  }

  template <int log>
  void node_front(const Node<log>& node) {
    raw(node.child.bytes());
    raw(Mask<log>().bytes());  // no tile is active
    Mask<log> outside;
    for (std::size_t n = 0; n < outside.words.size(); ++n) outside.words[n] = ~(node.inside.words[n] | node.child.words[n]);
    values_front(outside, !node.inside.none(), !outside.none());
  }

  void coordinates(const Size3& at) {
    number(std::array<std::int32_t, 3>{static_cast<std::int32_t>(at.x), static_cast<std::int32_t>(at.y),
                                       static_cast<std::int32_t>(at.z)});
  }

  void topology() {
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
        for (std::size_t leaf = lower.first; leaf < lower.first + lower.count; ++leaf)
          raw(leaf_values(field_, tree_.leaves[leaf], far_).active.bytes());
      }
    }
  }

  void buffers() {
    std::array<float, 512> active;
    for (const Tree::Leaf& leaf : tree_.leaves) {
      const LeafValues found = leaf_values(field_, leaf, far_);
      raw(found.active.bytes());
      Mask<kLeafLog> outside;
      std::size_t count = 0;
      for (std::size_t n = 0; n < 512; ++n) {
        if (found.active[n])
          active[count++] = found.values[n];
        else if (!std::signbit(found.values[n]))
          outside.set(n);
      }
      values_front(outside, found.any_inside, found.any_outside);
      file_.write(active.data(), count * sizeof active[0]);
    }
  }

  AtomicFile& file_;
  const DistanceField& field_;
  const Tree tree_;
  const float far_;
};

}  // namespace

void write_vdb(AtomicFile& file, const DistanceField& field, const FieldWriteOptions&) {
  vdb::check_indices(field, "vdb");
  Writer(file, field).write();
}

}  // namespace standoff
