// SPDX-License-Identifier: Apache-2.0
// 3DS and COLLADA through assimp, which only ever sees those: its readers of STL, PLY, OBJ and OFF
// fail in worse ways than ours. Of what it returns nothing is trusted.
#ifdef STANDOFF_HAVE_ASSIMP

#include <assimp/BaseImporter.h>
#include <assimp/config.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <array>
#include <assimp/Importer.hpp>
#include <cmath>
#include <new>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "core/number_text.h"
#include "files/file_view.h"
#include "files/text_cursor.h"
#include "io/mesh/3ds_check.h"
#include "io/mesh/assimp_files.h"
#include "io/mesh/assimp_losses.h"
#include "io/mesh/builder.h"
#include "io/mesh/collada_check.h"
#include "io/mesh/format.h"
#include "io/mesh/placement.h"
#include "io/mesh/unfolding.h"
#include "standoff/error.h"

namespace standoff {
namespace {

Placement of_matrix(const aiMatrix4x4& matrix) {
  Placement placement;
  for (unsigned r = 0; r < 3; ++r)
    for (unsigned c = 0; c < 4; ++c) placement.rows[r][c] = double(matrix[r][c]);
  return placement;
}

// Assimp puts the turn to y up and the file's unit into the root of the scene. Where that is no such thing, but a place
// of the file's own making, nothing is reported.
void report_root(const aiMatrix4x4& root, MeshReadReport& report) {
  const float scale = std::hypot(root[0][0], root[0][1], root[0][2]);
  std::array<int, 3> axes{};
  for (unsigned row = 0; row < 3; ++row)
    for (unsigned column = 0; column < 3; ++column) {
      const float share = root[row][column] / scale;
      constexpr float kRounding = 1e-5f;
      if (std::abs(share) < kRounding) continue;
      if (std::abs(std::abs(share) - 1) > kRounding || axes[row] != 0) return;
      axes[row] = static_cast<int>(column + 1) * (share < 0 ? -1 : 1);
    }
  if (std::abs(axes[0] * axes[1] * axes[2]) != 6) return;
  report.axes = axes;
  report.unit_scale = number_in<double>(exact_text(scale)).value_or(1);  // 0.01, not the float's 0.00999999977...
}

// Walks the tree of nodes; a mesh that hangs on several nodes appears several times.
class SceneReader {
 public:
  SceneReader(const FileView& file, const aiScene& scene)
      : file_(file), scene_(scene), sizes_(scene.mNumMeshes), builder_(file) {}

  Mesh read() {
    if (scene_.mRootNode) {
      Unfolded unfolded;
      measure(*scene_.mRootNode, 0, unfolded);
      check_unfolded(file_, unfolded, file_.size());
      check_counts(file_, static_cast<std::uint64_t>(unfolded.vertices),
                   static_cast<std::uint64_t>(unfolded.triangles));
      add(*scene_.mRootNode, Placement());
    }
    return builder_.finish([](std::size_t v) { return "vertex " + std::to_string(v); });
  }

 private:
  // What add() will add: a face of n corners becomes n - 2 triangles.
  void measure(const aiNode& node, int depth, Unfolded& unfolded) {
    // Deeper than any scene that was meant; a file can nest until the stack ends.
    constexpr int kDeepest = 1000;
    if (depth > kDeepest)
      file_.fail("", "its nodes are nested too deep; flatten the scene in the program that wrote it");
    for (unsigned m = 0; m < node.mNumMeshes; ++m) {
      if (node.mMeshes[m] >= scene_.mNumMeshes)
        file_.fail("", "a node names a mesh that is not there; repair the file");
      const Unfolded once = size(node.mMeshes[m]);
      unfolded.vertices += once.vertices;
      unfolded.triangles += once.triangles;
    }
    for (unsigned c = 0; c < node.mNumChildren; ++c) measure(*node.mChildren[c], depth + 1, unfolded);
  }

  // Counted once, however many nodes place it.
  Unfolded size(unsigned number) {
    std::optional<Unfolded>& known = sizes_[number];
    if (known) return *known;
    const aiMesh& mesh = *scene_.mMeshes[number];
    Unfolded size{double(mesh.mNumVertices), 0};
    for (unsigned f = 0; f < mesh.mNumFaces; ++f)
      if (mesh.mFaces[f].mNumIndices > 2) size.triangles += mesh.mFaces[f].mNumIndices - 2;
    known = size;
    return size;
  }

  void add(const aiNode& node, const Placement& outer) {
    const Placement placement = outer * of_matrix(node.mTransformation);
    for (unsigned m = 0; m < node.mNumMeshes; ++m) add(*scene_.mMeshes[node.mMeshes[m]], placement);
    for (unsigned c = 0; c < node.mNumChildren; ++c) add(*node.mChildren[c], placement);
  }

  void add(const aiMesh& mesh, const Placement& placement) {
    const std::size_t first = builder_.vertices.size();
    for (unsigned v = 0; v < mesh.mNumVertices; ++v) {
      const aiVector3D& p = mesh.mVertices[v];
      builder_.vertices.push_back(placement({p.x, p.y, p.z}));
    }
    std::vector<std::uint32_t> corners;
    for (unsigned f = 0; f < mesh.mNumFaces; ++f) {
      const aiFace& face = mesh.mFaces[f];
      corners.clear();
      for (unsigned c = 0; c < face.mNumIndices; ++c) {
        if (face.mIndices[c] >= mesh.mNumVertices)
          file_.fail("mesh " + in_quotes(mesh.mName.C_Str()) + " face " + std::to_string(f),
                     "vertex index " + std::to_string(face.mIndices[c]) + " is out of range, there are " +
                         std::to_string(mesh.mNumVertices) + " vertices; repair the mesh");
        corners.push_back(static_cast<std::uint32_t>(first + face.mIndices[c]));
      }
      builder_.add_face(corners);
    }
  }

  const FileView& file_;
  const aiScene& scene_;
  std::vector<std::optional<Unfolded>> sizes_;
  MeshBuilder builder_;
};

[[noreturn]] void fail_for_memory(const FileView& file) {
  throw Error(ErrorCode::limit, file.path().string() + ": not enough memory to read it; split the mesh");
}

// Assimp's messages can be of many lines, hold bytes of the file, and be as long as it.
[[noreturn]] void fail(const FileView& file, std::string_view message) {
  constexpr std::size_t kLongest = 120;
  // Assimp catches what its readers throw, and keeps the text alone.
  if (message == "std::bad_alloc") fail_for_memory(file);
  if (message.find("is already referenced by this node") != message.npos)
    file.fail("", "one node places a geometry twice, which assimp does not read; give each place a node of its own");
  const std::string_view line = message.substr(0, message.find_first_of("\r\n"));
  file.fail("",
            "assimp cannot read it: " + shown(line, kLongest) + "; repair the file or convert it to STL, PLY or OBJ");
}

// Leaves the importers of the extension only, so that no other one is tried on its content.
void keep_importers(Assimp::Importer& importer, const std::string& extension) {
  for (std::size_t i = importer.GetImporterCount(); i-- > 0;) {
    Assimp::BaseImporter* other = importer.GetImporter(i);
    std::set<std::string> extensions;
    other->GetExtensionList(extensions);
    if (extensions.contains(extension)) continue;
    importer.UnregisterLoader(other);
    delete other;
  }
}

}  // namespace

Mesh read_with_assimp(const FileView& file, const char* extension, MeshReadReport& report) {
  // What would make assimp crash or take all memory.
  if (std::string_view(extension) == "3ds") check_3ds(file);
  if (std::string_view(extension) == "dae") check_collada(file);
  try {
    const AssimpLosses losses;
    Assimp::Importer importer;
    const std::string name = std::string("mesh.") + extension;
    importer.SetIOHandler(new AssimpFiles(file, name));  // the importer deletes it
    keep_importers(importer, extension);
    // Else a scene without meshes gets one, of its nodes' skeleton, which is not in the file.
    importer.SetPropertyBool(AI_CONFIG_IMPORT_NO_SKELETON_MESHES, true);
    const aiScene* scene = importer.ReadFile(name, aiProcess_ValidateDataStructure);
    if (!scene) fail(file, importer.GetErrorString());
    if (!losses.first().empty()) fail(file, losses.first());
    if (scene->mRootNode) report_root(scene->mRootNode->mTransformation, report);
    if (std::string_view(extension) == "dae") report.metres_per_unit = 1;  // which the unit was turned into
    return SceneReader(file, *scene).read();
  } catch (const Error&) {
    throw;
  } catch (const std::bad_alloc&) {
    fail_for_memory(file);
  } catch (const std::exception& failure) {
    fail(file, failure.what());
  }
}

}  // namespace standoff

#endif  // STANDOFF_HAVE_ASSIMP
