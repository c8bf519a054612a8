// SPDX-License-Identifier: Apache-2.0
#include "sign/decision.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <limits>
#include <string>
#include <type_traits>
#include <unordered_map>
#include <utility>

#include "core/guarded.h"
#include "core/hashes.h"
#include "core/weld.h"
#include "sign/flood/flood.h"
#include "standoff/error.h"

namespace standoff {

static_assert(std::endian::native == std::endian::little, "decisions are written as the machine holds numbers");

// Bytes. A decision is
//   mark, 8 bytes; version, 4; checksum of all that follows, 8;
//   mesh hash, 8; triangles, 8; the options and the report; whether a grid follows, 1; the grid;
//   the lengths of four lists, 8 each; the lists: use, exposed, boundary, flood.
// Numbers of enumerations are those of standoff/sign.h: whoever changes them, or anything here, counts the version up.

namespace {

constexpr std::array<char, 8> kMark{'S', 'O', 'D', 'E', 'C', 'I', 'D', 'E'};
constexpr std::uint32_t kVersion = 1;
constexpr std::size_t kMostWords = 4096;  // bytes of SignReport::why

[[noreturn]] void fail_damaged(const char* what) {
  throw Error(ErrorCode::input, std::string("sign decision: its bytes are damaged (") + what + "); make a new one");
}

std::uint64_t checksum(std::span<const std::byte> bytes) {
  std::uint64_t sum = bytes.size();
  for (std::size_t at = 0; at < bytes.size(); at += 8) {
    std::uint64_t word = 0;
    std::memcpy(&word, bytes.data() + at, std::min<std::size_t>(8, bytes.size() - at));
    sum = folded_product(sum ^ word, 0x9e3779b97f4a7c15u) + kSplitmixStep;
  }
  return splitmix64(sum);
}

class Writer {
 public:
  template <class Number>
  void put(Number number) {
    static_assert(std::is_arithmetic_v<Number>);
    put_bytes(std::as_bytes(std::span(&number, 1)));
  }
  void put_bytes(std::span<const std::byte> bytes) { bytes_.insert(bytes_.end(), bytes.begin(), bytes.end()); }
  // Seven bits to a byte, the lowest ones first; all bytes but the last one have the highest bit.
  void put_small(std::uint64_t number) {
    for (; number >= 128; number >>= 7) bytes_.push_back(static_cast<std::byte>(number | 128));
    bytes_.push_back(static_cast<std::byte>(number));
  }
  // Of either sign: the sign in the lowest bit.
  void put_signed(std::int64_t number) {
    put_small(static_cast<std::uint64_t>(number) << 1 ^ static_cast<std::uint64_t>(number >> 63));
  }
  // Runs of equal numbers from 0 to 3, value(0), ..., value(count - 1).
  template <class Value>
  void put_runs(std::size_t count, const Value& value) {
    for (std::size_t begin = 0, end = 0; begin < count; begin = end) {
      const auto of_run = value(begin);
      while (end < count && value(end) == of_run) ++end;
      put_small(static_cast<std::uint64_t>(end - begin) << 2 | static_cast<std::uint64_t>(of_run));
    }
  }
  std::vector<std::byte> take() { return std::move(bytes_); }

 private:
  std::vector<std::byte> bytes_;
};

class Reader {
 public:
  explicit Reader(std::span<const std::byte> bytes) : rest_(bytes) {}

  std::span<const std::byte> take_bytes(std::uint64_t count) {
    if (count > rest_.size()) fail_damaged("they end too early");
    const auto taken = rest_.first(static_cast<std::size_t>(count));
    rest_ = rest_.subspan(taken.size());
    return taken;
  }
  template <class Number>
  Number take() {
    Number number;
    std::memcpy(&number, take_bytes(sizeof number).data(), sizeof number);
    return number;
  }
  bool take_flag() {
    const auto flag = take<std::uint8_t>();
    if (flag > 1) fail_damaged("a flag is no flag");
    return flag != 0;
  }
  std::int64_t take_count() {
    const auto count = take<std::int64_t>();
    if (count < 0) fail_damaged("a count is negative");
    return count;
  }
  std::uint64_t take_small() {
    std::uint64_t number = 0;
    for (int shift = 0; shift < 63; shift += 7) {
      const auto byte = take<std::uint8_t>();
      number |= static_cast<std::uint64_t>(byte & 127) << shift;
      if (byte < 128) return number;
    }
    fail_damaged("a number is too long");
  }
  std::int64_t take_signed() {
    const std::uint64_t number = take_small();
    return static_cast<std::int64_t>(number >> 1 ^ (0 - (number & 1)));
  }
  // Calls use(n, value) for `count` numbers in runs.
  template <class Use>
  void take_runs(std::size_t count, const Use& use) {
    for (std::size_t n = 0; n < count;) {
      const std::uint64_t run = take_small();
      if (run >> 2 == 0 || run >> 2 > count - n) fail_damaged("a list has another length");
      for (const std::size_t end = n + static_cast<std::size_t>(run >> 2); n < end; ++n)
        use(n, static_cast<int>(run & 3));
    }
  }
  void expect_end() const {
    if (!rest_.empty()) fail_damaged("they go on after their end");
  }

 private:
  std::span<const std::byte> rest_;
};

template <class Enum>
Enum enum_of(std::uint8_t number, Enum last) {
  if (number > static_cast<std::uint8_t>(last)) fail_damaged("a name is unknown");
  return static_cast<Enum>(number);
}

void put_sign(Writer& to, const SignOptions& options, const SignReport& report) {
  to.put(static_cast<std::uint8_t>(options.method));
  to.put(static_cast<std::uint8_t>(options.rule));
  to.put(static_cast<std::uint8_t>(options.as_oriented));
  to.put(static_cast<std::uint8_t>(options.outer));
  to.put(options.shell);
  to.put(static_cast<std::uint8_t>(report.method));
  to.put(static_cast<std::uint8_t>(report.sure));
  for (const std::int64_t count : {report.flipped, report.left_out, report.boundary_edges, report.internal, report.cut})
    to.put(count);
  const std::size_t words = std::min(report.why.size(), kMostWords);
  to.put(static_cast<std::uint32_t>(words));
  to.put_bytes(std::as_bytes(std::span(report.why).first(words)));
}

void take_sign(Reader& from, SignOptions& options, SignReport& report) {
  const auto last = std::ranges::max(kSignMethods, {}, &SignMethodInfo::method).method;
  options.method = enum_of(from.take<std::uint8_t>(), last);
  options.rule = enum_of(from.take<std::uint8_t>(), WindingRule::odd);
  options.as_oriented = from.take_flag();
  options.outer = from.take_flag();
  options.shell = from.take<double>();
  report.method = enum_of(from.take<std::uint8_t>(), last);
  report.sure = from.take_flag();
  for (std::int64_t* const count :
       {&report.flipped, &report.left_out, &report.boundary_edges, &report.internal, &report.cut})
    *count = from.take_count();
  const auto words = from.take<std::uint32_t>();
  if (words > kMostWords) fail_damaged("its reason is too long");
  for (const std::byte byte : from.take_bytes(words)) {
    if (byte < std::byte{32} || byte > std::byte{126}) fail_damaged("its reason is no text");
    report.why += static_cast<char>(byte);
  }
  // What was asked for is what was found, but for `automatic`, which finds one of these.
  const SignMethod found = report.method;
  if (options.method != SignMethod::automatic
          ? found != options.method
          : found != SignMethod::winding && found != SignMethod::flood && found != SignMethod::none)
    fail_damaged("another method was asked for");
}

void put_grid(Writer& to, const Grid& grid) {
  for (const std::int64_t n : {grid.size.x, grid.size.y, grid.size.z, grid.first.x, grid.first.y, grid.first.z})
    to.put(n);
  for (const Vec3& v : {grid.origin, grid.spacing})
    for (const double x : {v.x, v.y, v.z}) to.put(x);
}

Grid take_grid(Reader& from) {
  Grid grid;
  for (std::int64_t* const n : {&grid.size.x, &grid.size.y, &grid.size.z, &grid.first.x, &grid.first.y, &grid.first.z})
    *n = from.take_count();
  for (Vec3* const v : {&grid.origin, &grid.spacing})
    for (double* const x : {&v->x, &v->y, &v->z}) *x = from.take<double>();
  return grid;
}

}  // namespace

std::vector<std::byte> sealed(std::span<const std::byte> content) {
  Writer to;
  to.put_bytes(std::as_bytes(std::span(kMark)));
  to.put(kVersion);
  to.put(checksum(content));
  to.put_bytes(content);
  return to.take();
}

SignDecisionContent::SignDecisionContent(std::vector<std::byte> bytes) : bytes_(std::move(bytes)) {
  Reader from(bytes_);
  if (bytes_.size() < kSealBytes || !std::ranges::equal(from.take_bytes(8), std::as_bytes(std::span(kMark))))
    throw Error(ErrorCode::input, "sign decision: these bytes are no decision; give what was kept of one");
  if (const auto version = from.take<std::uint32_t>(); version != kVersion)
    throw Error(ErrorCode::input, "sign decision: it is of version " + std::to_string(version) +
                                      ", and this program reads version " + std::to_string(kVersion) +
                                      "; make a new one");
  if (from.take<std::uint64_t>() != checksum(std::span(bytes_).subspan(kSealBytes)))
    fail_damaged("their checksum is wrong");
  mesh_hash = from.take<std::uint64_t>();
  triangles = from.take<std::uint64_t>();
  take_sign(from, made_for, report);
  if (from.take_flag()) grid = take_grid(from);
  std::array<std::uint64_t, 4> length;
  for (std::uint64_t& one : length) one = from.take<std::uint64_t>();
  use = from.take_bytes(length[0]);
  exposed = from.take_bytes(length[1]);
  boundary = from.take_bytes(length[2]);
  flood = from.take_bytes(length[3]);
  from.expect_end();
}

// The lists.

namespace {

// Orientations, which are -1, 0 and 1.
std::vector<std::byte> packed_use(const SignPlan& plan) {
  Writer to;
  to.put_runs(plan.use.size(), [&](std::size_t n) { return plan.use[n] + 1; });
  return to.take();
}

std::vector<std::int8_t> unpacked_use(std::span<const std::byte> packed, std::size_t triangles) {
  std::vector<std::int8_t> use;
  if (packed.empty()) return use;
  use.resize(triangles);
  Reader from(packed);
  from.take_runs(triangles, [&](std::size_t n, int value) {
    if (value > 2) fail_damaged("an orientation is unknown");
    use[n] = static_cast<std::int8_t>(value - 1);
  });
  from.expect_end();
  return use;
}

std::vector<std::byte> packed_exposed(const SignPlan& plan, std::size_t triangles) {
  if (plan.exposed.empty()) return {};
  std::vector<bool> is_exposed(triangles);
  for (const std::uint32_t t : plan.exposed) is_exposed[t] = true;
  Writer to;
  to.put_runs(triangles, [&](std::size_t n) { return static_cast<bool>(is_exposed[n]); });
  return to.take();
}

std::vector<std::uint32_t> unpacked_exposed(std::span<const std::byte> packed, std::size_t triangles) {
  std::vector<std::uint32_t> exposed;
  if (packed.empty()) return exposed;
  Reader from(packed);
  from.take_runs(triangles, [&](std::size_t n, int value) {
    if (value > 1) fail_damaged("a flag is no flag");
    if (value == 1) exposed.push_back(static_cast<std::uint32_t>(n));
  });
  from.expect_end();
  if (exposed.empty()) fail_damaged("it leaves no triangle");  // to others an empty list means all
  return exposed;
}

// Positions by their bits, so that they come back as they were.
struct SameBits {
  std::size_t operator()(const Vec3& p) const { return static_cast<std::size_t>(position_hash(p)); }
  bool operator()(const Vec3& a, const Vec3& b) const { return std::memcmp(&a, &b, sizeof a) == 0; }
};

// Edges by the first vertices at their ends.
std::vector<std::byte> packed_boundary(const Boundary& boundary, MeshView mesh) {
  if (boundary.edges.empty()) return {};
  constexpr std::uint32_t kUnknown = std::numeric_limits<std::uint32_t>::max();
  std::unordered_map<Vec3, std::uint32_t, SameBits, SameBits> first;
  first.reserve(boundary.edges.size());
  for (const BoundaryEdge& edge : boundary.edges) {
    first.try_emplace(edge.from, kUnknown);
    first.try_emplace(edge.to, kUnknown);
  }
  for (std::uint32_t v = 0; v < mesh.vertices.size(); ++v)
    if (const auto at = first.find(mesh.vertices[v]); at != first.end()) at->second = std::min(at->second, v);
  Writer to;
  to.put_small(boundary.loops());
  std::int64_t last = 0;
  const auto put_vertex = [&](const Vec3& p) {
    const std::int64_t vertex = first.at(p);
    to.put_signed(vertex - last);
    last = vertex;
  };
  for (std::size_t n = 0; n < boundary.loops(); ++n) {
    to.put_small(boundary.loop(n).size());
    for (const BoundaryEdge& edge : boundary.loop(n)) {
      put_vertex(edge.from);
      put_vertex(edge.to);
      to.put_small(static_cast<std::uint64_t>(edge.weight));
    }
  }
  return to.take();
}

// Throws unless each loop goes out of every position as often as into it: whoever walks along the edges relies on it.
void expect_loops(const Boundary& boundary) {
  std::vector<std::uint32_t> ends(2 * boundary.edges.size());
  const std::uint32_t positions = weld(
      [&](std::uint32_t n) {
        const BoundaryEdge& edge = boundary.edges[n / 2];
        return n % 2 == 0 ? edge.from : edge.to;
      },
      ends);
  std::vector<std::int64_t> sum(positions);
  for (std::size_t loop = 0; loop < boundary.loops(); ++loop) {
    for (std::size_t n = boundary.begin[loop]; n < boundary.begin[loop + 1]; ++n) {
      if (ends[2 * n] == ends[2 * n + 1]) fail_damaged("a boundary edge has no length");
      sum[ends[2 * n]] += boundary.edges[n].weight;
      sum[ends[2 * n + 1]] -= boundary.edges[n].weight;
    }
    for (std::size_t n = 2 * boundary.begin[loop]; n < 2 * boundary.begin[loop + 1]; ++n)
      if (sum[ends[n]] != 0) fail_damaged("a boundary is not closed");
  }
}

Boundary unpacked_boundary(std::span<const std::byte> packed, MeshView mesh) {
  Boundary boundary;
  if (packed.empty()) return boundary;
  Reader from(packed);
  // Each half-edge of a triangle is in one edge at most.
  std::uint64_t half_edges = 3 * static_cast<std::uint64_t>(mesh.triangles.size());
  std::int64_t last = 0;
  const auto take_vertex = [&] {
    last += std::clamp<std::int64_t>(from.take_signed(), -(std::int64_t{1} << 33), std::int64_t{1} << 33);
    if (last < 0 || static_cast<std::uint64_t>(last) >= mesh.vertices.size()) fail_damaged("a vertex is not there");
    const Vec3 p = mesh.vertices[static_cast<std::size_t>(last)];
    if (!is_finite(p)) fail_damaged("a vertex of its boundary is not finite");
    return p;
  };
  for (std::uint64_t loops = from.take_small(); loops > 0; --loops) {
    const std::uint64_t edges = from.take_small();
    if (edges == 0 || edges > half_edges) fail_damaged("a boundary has another length");
    for (std::uint64_t n = 0; n < edges; ++n) {
      const Vec3 begin = take_vertex(), end = take_vertex();
      const std::uint64_t weight = from.take_small();
      if (weight == 0 || weight > half_edges || weight > std::numeric_limits<std::int32_t>::max())
        fail_damaged("a boundary has more edges than the mesh");
      half_edges -= weight;
      boundary.edges.push_back({begin, end, static_cast<std::int32_t>(weight)});
    }
    boundary.begin.push_back(boundary.edges.size());
  }
  from.expect_end();
  expect_loops(boundary);
  return boundary;
}

// For each tile of the lattice, whether it was reached, not or as a whole, or in parts; then the parts.
enum TileSide : std::uint8_t { inside, outside, divided };

std::vector<std::byte> packed_flood(const FloodSides& flood) {
  Writer to;
  to.put_small(flood.whole.size());
  to.put_runs(flood.whole.size(), [&](std::size_t tile) {
    return flood.tiles.has(tile) ? divided : flood.whole[tile] ? outside : inside;
  });
  to.put_bytes(std::as_bytes(std::span(flood.parts)));
  return to.take();
}

std::shared_ptr<const FloodSides> unpacked_flood(std::span<const std::byte> packed, std::size_t tiles) {
  Reader from(packed);
  if (from.take_small() != tiles) fail_damaged("its flood has another size");
  auto made = std::make_shared<FloodSides>(FloodSides{TileSet(tiles), {}, std::vector<bool>(tiles)});
  from.take_runs(tiles, [&](std::size_t tile, int side) {
    if (side > divided) fail_damaged("the side of a tile is unknown");
    if (side == divided) made->tiles.add(tile);
    made->whole[tile] = side == outside;
  });
  made->tiles.number_them();
  const auto parts = from.take_bytes(sizeof(TileBits) * made->tiles.count());
  from.expect_end();
  made->parts.resize(made->tiles.count());
  if (!parts.empty()) std::memcpy(made->parts.data(), parts.data(), parts.size());
  return made;
}

}  // namespace

SignDecision decision_of(const SignPlan& plan, MeshView mesh, std::uint64_t hash, const SignOptions& options,
                         const Grid& grid) {
  const std::vector<std::byte> use = packed_use(plan), exposed = packed_exposed(plan, mesh.triangles.size()),
                               boundary = packed_boundary(plan.boundary, mesh),
                               flood = plan.flood ? packed_flood(*plan.flood) : std::vector<std::byte>();
  Writer to;
  to.put(hash);
  to.put(static_cast<std::uint64_t>(mesh.triangles.size()));
  put_sign(to, options, plan.report);
  to.put(static_cast<std::uint8_t>(plan.flood ? 1 : 0));
  if (plan.flood) put_grid(to, grid);
  for (const auto* list : {&use, &exposed, &boundary, &flood}) to.put(static_cast<std::uint64_t>(list->size()));
  for (const auto* list : {&use, &exposed, &boundary, &flood}) to.put_bytes(*list);
  return SignDecisionAccess::made_of(sealed(to.take()));
}

namespace {

[[noreturn]] void fail_of_another(const std::string& what) {
  throw Error(ErrorCode::usage,
              "compute: the sign decision was made for " + what + "; take that one, or make a new one");
}

void expect_made_for(const SignDecisionContent& content, MeshView mesh, std::uint64_t hash, const SignOptions& options,
                     const Grid& grid) {
  if (content.mesh_hash != hash || content.triangles != mesh.triangles.size()) fail_of_another("another mesh");
  const SignOptions& made_for = content.made_for;
  if (made_for.method != options.method)
    fail_of_another(std::string("the sign method ") + find_info(made_for.method)->name + ", not " +
                    find_info(options.method)->name);
  if (made_for.rule != options.rule) fail_of_another("another winding rule");
  if (made_for.as_oriented != options.as_oriented)
    fail_of_another(made_for.as_oriented ? "triangles as they are oriented"
                                         : "triangles whose orientation is repaired");
  if (made_for.outer != options.outer)
    fail_of_another(made_for.outer ? "the outer surface alone" : "all triangles, not the outer surface alone");
  if (made_for.shell != options.shell) fail_of_another("a shell of another thickness");
  if (content.grid && *content.grid != grid) fail_of_another("another grid");
}

}  // namespace

SignPlan plan_of(const SignDecisionContent& content, MeshView mesh, const Grid& grid) {
  const std::size_t triangles = mesh.triangles.size();
  SignPlan plan;
  plan.report = content.report;
  plan.use = unpacked_use(content.use, triangles);
  plan.exposed = unpacked_exposed(content.exposed, triangles);
  plan.boundary = unpacked_boundary(content.boundary, mesh);
  if (content.grid)
    plan.flood = unpacked_flood(content.flood, TileLattice::around(grid, bounds(mesh)).tile_count());
  else if (!content.flood.empty())
    fail_damaged("its flood has no grid");
  return plan;
}

SignPlan plan_of(const SignDecision& decision, MeshView mesh, std::uint64_t hash, const SignOptions& options,
                 const Grid& grid) {
  const SignDecisionContent& content = SignDecisionAccess::content(decision);
  expect_made_for(content, mesh, hash, options, grid);
  SignPlan plan = plan_of(content, mesh, grid);
  expect_sure(plan, options);
  return plan;
}

// The public class.

SignDecision SignDecision::from_bytes(std::span<const std::byte> bytes) try {
  return SignDecisionAccess::made_of({bytes.begin(), bytes.end()});
} catch (...) {
  throw_as_error("sign decision");
}

std::vector<std::byte> SignDecision::bytes() const try {
  if (empty()) return {};
  return {content_->bytes().begin(), content_->bytes().end()};
} catch (...) {
  throw_as_error("sign decision");
}

const SignDecisionContent& SignDecision::expected() const {
  if (empty())
    throw Error(ErrorCode::usage, "sign decision: it is empty; take one of WindowComputation, or read its bytes");
  return *content_;
}
const SignReport& SignDecision::report() const { return expected().report; }
std::uint64_t SignDecision::mesh_hash() const { return expected().mesh_hash; }

}  // namespace standoff
