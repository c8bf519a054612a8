// What a CollisionModel holds.
#pragma once

#include "collision/body/bvh16.h"
#include "collision/body/device_copies.h"
#include "collision/body/field_bounds.h"
#include "standoff/collision.h"

namespace standoff {

class FileView;
enum class BodyChecksum;

struct CollisionModel::Data {
  Mesh mesh;
  Box box;            ///< of the corners
  Vec3 middle;        ///< tree and field are relative to it
  double radius = 0;  ///< of a ball about the middle that holds all corners
  collision::FieldBounds field;
  collision::FieldView view{};  ///< of `field`
  collision::Tree tree;
  collision::BigVector<Corners> corners;  ///< of the triangles, in tree order
  collision::DeviceCopies copies;         ///< what GPUs keep of all this

  /// Everything that follows from mesh, field and tree order. Called once all three are there.
  void finish();

  /// What load() makes of a file's bytes: model_file.h.
  static CollisionModel read(const FileView& file, BodyChecksum checksum);
};

}  // namespace standoff
