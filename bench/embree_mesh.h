// SPDX-License-Identifier: Apache-2.0
// The common part of Embree's drivers: the mesh in single precision, its scene, and the search of a point query.
#pragma once

#include <embree3/rtcore.h>

#include <cmath>
#include <limits>
#include <vector>

#include "standoff/mesh.h"

namespace standoff::bench {

struct Float3 {
  float x, y, z;
};
inline Float3 operator+(Float3 a, Float3 b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
inline Float3 operator-(Float3 a, Float3 b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
inline Float3 operator*(float s, Float3 a) { return {s * a.x, s * a.y, s * a.z}; }
inline float dot(Float3 a, Float3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }

/// Squared distance of p to triangle abc by Voronoi regions (Ericson, Real-Time Collision Detection, 5.1.5).
inline float triangle_distance_sq(Float3 p, Float3 a, Float3 b, Float3 c) {
  const Float3 ab = b - a, ac = c - a, ap = p - a, bp = p - b, cp = p - c;
  const auto to = [&](Float3 q) { return dot(p - q, p - q); };
  const float d1 = dot(ab, ap), d2 = dot(ac, ap);
  if (d1 <= 0 && d2 <= 0) return to(a);
  const float d3 = dot(ab, bp), d4 = dot(ac, bp);
  if (d3 >= 0 && d4 <= d3) return to(b);
  const float vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return to(a + (d1 / (d1 - d3)) * ab);
  const float d5 = dot(ab, cp), d6 = dot(ac, cp);
  if (d6 >= 0 && d5 <= d6) return to(c);
  const float vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return to(a + (d2 / (d2 - d6)) * ac);
  const float va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) return to(b + ((d4 - d3) / ((d4 - d3) + (d5 - d6))) * (c - b));
  const float scale = 1 / (va + vb + vc);
  return to(a + (vb * scale) * ab + (vc * scale) * ac);
}

/// The mesh in single precision. Made before the timing.
struct FloatMesh {
  std::vector<Float3> vertices;
  std::vector<Triangle> triangles;

  explicit FloatMesh(const Mesh& mesh) : triangles(mesh.triangles) {
    vertices.reserve(mesh.vertices.size() + 1);
    for (Vec3 v : mesh.vertices) vertices.push_back({float(v.x), float(v.y), float(v.z)});
    vertices.push_back({0, 0, 0});  // Embree reads 16 bytes at the last vertex.
  }
  float distance_sq(Float3 p, unsigned triangle) const {
    const auto& t = triangles[triangle];
    return triangle_distance_sq(p, vertices[t[0]], vertices[t[1]], vertices[t[2]]);
  }
};

struct Search {
  const FloatMesh* mesh;
  float distance_sq;
  unsigned triangle;
};

inline bool visit(RTCPointQueryFunctionArguments* arguments) {
  auto& search = *static_cast<Search*>(arguments->userPtr);
  RTCPointQuery& query = *arguments->query;
  const float distance_sq = search.mesh->distance_sq({query.x, query.y, query.z}, arguments->primID);
  if (distance_sq >= search.distance_sq) return false;
  search.distance_sq = distance_sq;
  search.triangle = arguments->primID;
  query.radius = std::sqrt(distance_sq);
  return true;
}

inline RTCScene build(RTCDevice device, const FloatMesh& mesh, RTCBuildQuality quality) {
  const RTCScene scene = rtcNewScene(device);
  const RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
  rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, mesh.vertices.data(), 0,
                             sizeof(Float3), mesh.vertices.size() - 1);
  rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, mesh.triangles.data(), 0,
                             sizeof(Triangle), mesh.triangles.size());
  rtcSetGeometryBuildQuality(geometry, quality);
  rtcCommitGeometry(geometry);
  rtcAttachGeometry(scene, geometry);
  rtcReleaseGeometry(geometry);
  rtcSetSceneBuildQuality(scene, quality);
  rtcCommitScene(scene);
  return scene;
}

}  // namespace standoff::bench
