// SPDX-License-Identifier: Apache-2.0
// A saved query holds the mesh and the decisions about its sign, which take long to find. The BVH is built again, which
// takes no longer than reading it would.
//
// The reader trusts nothing: it checks sizes against the file's size, indices against the mesh, and finds the boundary
// of an open mesh again. A damaged or hostile file gives an error or a query with wrong signs, but never an access out
// of range.
#include "points/query_file.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "core/guarded.h"
#include "core/threads.h"
#include "files/array_file.h"
#include "points/query_data.h"
#include "sign/diagnosis/boundary.h"
#include "standoff/error.h"

namespace standoff {

struct QueryAccess {
  static MeshQuery query(std::shared_ptr<const MeshQuery::Data> data) { return MeshQuery(std::move(data)); }
  static const MeshQuery::Data& data(const MeshQuery& query) { return *query.data_; }
};

namespace {

constexpr std::uint32_t kQueryVersion = 1;
constexpr std::uint64_t kLongestWhy = 4096;

struct QueryHeader {
  char magic[8];
  std::uint32_t version;
  std::uint8_t method, rule, invert, outer;  // as in SignOptions, but `method` is the one that was used
  std::uint8_t sure, open, padding[6];       // open: the method needs the boundary of an open mesh
  double shell;
  std::int64_t flipped, left_out, boundary_edges, internal, cut;  // as in SignReport
  std::uint64_t vertices, triangles, use, exposed, why;
};
static_assert(sizeof(QueryHeader::magic) == kQueryMagic.size());
static_assert(sizeof(QueryHeader) == 112 && sizeof(Vec3) == 24 && sizeof(Triangle) == 12);

bool is_method_of_points(std::uint8_t method) {
  const SignMethodInfo* const info = find_info(static_cast<SignMethod>(method));
  return info && info->at_points && info->method != SignMethod::automatic;
}

void check_header(const ArrayFileReader& arrays, const QueryHeader& h) {
  if (h.version != kQueryVersion)
    arrays.fail("header", "version " + std::to_string(h.version) + " is not known to this standoff, which knows " +
                              std::to_string(kQueryVersion));
  if (!is_method_of_points(h.method) || h.rule > static_cast<std::uint8_t>(WindingRule::odd) || h.invert > 1 ||
      h.outer > 1 || h.sure > 1 || h.open > 1 || h.why > kLongestWhy)
    arrays.fail("header", "its sign is none that is known");
  const bool shell = static_cast<SignMethod>(h.method) == SignMethod::shell;
  if (shell ? !(h.shell > 0 && std::isfinite(h.shell)) : h.shell != 0)
    arrays.fail("header", "the thickness of its shell is not positive and finite");
  if (h.open && static_cast<SignMethod>(h.method) != SignMethod::winding)
    arrays.fail("header", "its sign has no use for a boundary");
  for (const std::int64_t count : {h.flipped, h.left_out, h.boundary_edges, h.internal, h.cut})
    if (count < 0) arrays.fail("header", "a count is negative");
  if ((h.use != 0 && h.use != h.triangles) || h.exposed > h.triangles)
    arrays.fail("header", "it has more or fewer orientations than triangles");
}

void check_mesh(const ArrayFileReader& arrays, const Mesh& mesh) {
  try {
    validate(mesh);
  } catch (const Error& error) {
    arrays.fail("mesh", std::string(diagnosis(error.what())));
  }
  const Box box = bounds(mesh);
  if (!(std::max(max_norm(box.min), max_norm(box.max)) <= kMaxCoordinate))
    arrays.fail("mesh", "it reaches beyond what is allowed");
}

void check_plan(const ArrayFileReader& arrays, const SignPlan& plan, std::uint64_t triangles) {
  for (const std::int8_t use : plan.use)
    if (use < -1 || use > 1) arrays.fail("orientations", "one is none of -1, 0 and 1");
  for (std::size_t n = 0; n < plan.exposed.size(); ++n)
    if (plan.exposed[n] >= triangles || (n > 0 && plan.exposed[n] <= plan.exposed[n - 1]))
      arrays.fail("exposed triangles", "they do not ascend, or one is none of the mesh");
}

}  // namespace

MeshQuery read_query_file(const FileView& file, ArrayChecksum checksum) {
  QueryHeader header{};
  if (file.size() < sizeof header + sizeof(std::uint64_t) || !file.bytes().starts_with(kQueryMagic))
    file.fail("", "this is no query that standoff saved; give a mesh, or save a query again");
  ArrayFileReader arrays(file, "query");
  arrays.take_header(header);
  check_header(arrays, header);
  Mesh mesh;
  SignPlan plan;
  arrays.take(mesh.vertices, header.vertices);
  arrays.take(mesh.triangles, header.triangles);
  arrays.take(plan.exposed, header.exposed);
  arrays.take(plan.use, header.use);
  arrays.take(plan.report.why, header.why);
  arrays.end(checksum);
  check_mesh(arrays, mesh);
  check_plan(arrays, plan, header.triangles);

  SignOptions sign;
  plan.report.method = sign.method = static_cast<SignMethod>(header.method);
  sign.rule = static_cast<WindingRule>(header.rule);
  sign.invert = header.invert != 0;
  sign.outer = header.outer != 0;
  sign.shell = header.shell;
  plan.report.sure = header.sure != 0;
  plan.report.flipped = header.flipped;
  plan.report.left_out = header.left_out;
  plan.report.boundary_edges = header.boundary_edges;
  plan.report.internal = header.internal;
  plan.report.cut = header.cut;
  std::shared_ptr<const MeshQuery::Data> data;
  Threads threads(0);
  threads.run([&] {
    if (header.open) plan.boundary = net_boundary({mesh, plan.use}, MeshEdges(mesh));
    data = std::make_shared<const MeshQuery::Data>(std::move(mesh), sign, std::move(plan), threads.count(),
                                                   Simd::automatic);
  });
  return QueryAccess::query(std::move(data));
}

MeshQuery MeshQuery::load(const std::filesystem::path& path) try {
  return read_query_file(FileView(path), ArrayChecksum::checked);
} catch (...) {
  throw_as_error("points");
}

void MeshQuery::save(const std::filesystem::path& path, Existing existing) const try {
  const Data& data = *data_;
  const SignReport& report = data.plan.report;
  const std::string why = report.why.substr(0, kLongestWhy);
  QueryHeader header{};
  kQueryMagic.copy(header.magic, sizeof header.magic);
  header.version = kQueryVersion;
  header.method = static_cast<std::uint8_t>(report.method);
  header.rule = static_cast<std::uint8_t>(data.sign.rule);
  header.invert = data.sign.invert;
  header.outer = data.sign.outer;
  header.sure = report.sure;
  header.open = report.method == SignMethod::winding && !data.plan.boundary.edges.empty();
  header.shell = report.method == SignMethod::shell ? data.sign.shell : 0;
  header.flipped = report.flipped;
  header.left_out = report.left_out;
  header.boundary_edges = report.boundary_edges;
  header.internal = report.internal;
  header.cut = report.cut;
  header.vertices = data.mesh.vertices.size();
  header.triangles = data.mesh.triangles.size();
  header.exposed = data.plan.exposed.size();
  header.use = data.plan.use.size();
  header.why = why.size();
  ArrayFileWriter file(path, existing);
  file.put(&header, sizeof header);
  file.put_all(data.mesh.vertices);
  file.put_all(data.mesh.triangles);
  file.put_all(data.plan.exposed);
  file.put_all(data.plan.use);
  file.put_all(why);
  file.commit();
} catch (...) {
  throw_as_error("points");
}

}  // namespace standoff
