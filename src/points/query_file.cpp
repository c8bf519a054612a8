// SPDX-License-Identifier: Apache-2.0
// A saved query holds the mesh and the decision of its sign, which takes long to find. The BVH is built again, which
// takes no longer than reading it would.
//
// The reader trusts nothing: it checks sizes against the file's size, and indices against the mesh. A damaged or
// hostile file gives an error or a query with wrong signs, but never an access out of range.
#include "points/query_file.h"

#include <algorithm>
#include <string>
#include <tuple>
#include <utility>

#include "core/guarded.h"
#include "core/threads.h"
#include "files/array_file.h"
#include "points/query_data.h"
#include "sign/decision.h"
#include "standoff/error.h"

namespace standoff {

struct QueryAccess {
  static MeshQuery query(std::shared_ptr<const MeshQuery::Data> data) { return MeshQuery(std::move(data)); }
};

namespace {

constexpr std::uint32_t kQueryVersion = 2;

struct QueryHeader {
  char magic[8];
  std::uint32_t version, invert;  // invert: as in SignOptions; decisions have no part in it
  std::uint64_t vertices, triangles, decision;
};
static_assert(sizeof(QueryHeader::magic) == kQueryMagic.size());
static_assert(sizeof(QueryHeader) == 40 && sizeof(Vec3) == 24 && sizeof(Triangle) == 12);

void check_mesh(const Mesh& mesh) {
  validate(mesh);
  const Box box = bounds(mesh);
  if (!(std::max(max_norm(box.min), max_norm(box.max)) <= kMaxCoordinate))
    throw Error(ErrorCode::input, "mesh: it reaches beyond what is allowed");
}

// The plan, and the options that it was made for.
std::pair<SignPlan, SignOptions> sign_in(std::vector<std::byte> decision, ArrayChecksum checksum, MeshView mesh) {
  if (checksum == ArrayChecksum::ignored && decision.size() >= kSealBytes)
    decision = sealed(std::span(decision).subspan(kSealBytes));
  const SignDecisionContent content(std::move(decision));
  SignOptions sign = content.made_for;
  validate(sign);
  const SignMethodInfo* const info = find_info(content.report.method);
  if (!info || !info->at_points || info->method == SignMethod::automatic || content.grid)
    throw Error(ErrorCode::input, "sign decision: it is none for points");
  return {plan_of(content, mesh, {}), sign};
}

}  // namespace

MeshQuery read_query_file(const FileView& file, ArrayChecksum checksum) {
  QueryHeader header{};
  ArrayFileReader arrays(file, "query");
  arrays.take_header(header, kQueryMagic, kQueryVersion);
  Mesh mesh;
  std::vector<std::byte> decision;
  arrays.take(mesh.vertices, header.vertices);
  arrays.take(mesh.triangles, header.triangles);
  arrays.take(decision, header.decision);
  arrays.end(checksum);
  std::shared_ptr<const MeshQuery::Data> data;
  Threads threads(0);
  threads.run([&] {
    SignPlan plan;
    SignOptions sign;
    try {
      check_mesh(mesh);
      std::tie(plan, sign) = sign_in(std::move(decision), checksum, mesh);
    } catch (const Error& error) {
      arrays.fail("", std::string(diagnosis(error.what())));
    }
    sign.invert = header.invert != 0;
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
  // The checksum of the file says that the mesh is the decision's: no hash needs to.
  const std::vector<std::byte> decision = decision_of(data.plan, data.mesh, 0, data.sign, {}).bytes();
  QueryHeader header{
      {}, kQueryVersion, data.sign.invert, data.mesh.vertices.size(), data.mesh.triangles.size(), decision.size()};
  kQueryMagic.copy(header.magic, sizeof header.magic);
  ArrayFileWriter file(path, existing);
  file.put(&header, sizeof header);
  file.put_all(data.mesh.vertices);
  file.put_all(data.mesh.triangles);
  file.put_all(decision);
  file.commit();
} catch (...) {
  throw_as_error("points");
}

}  // namespace standoff
