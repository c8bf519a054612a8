// 3DS, glTF and COLLADA through assimp, which only ever sees those: its readers of STL, PLY, OBJ and OFF
// fail in worse ways than ours. Of what it returns nothing is trusted.
#ifdef DIFI_HAVE_ASSIMP

#include <assimp/BaseImporter.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <array>
#include <assimp/Importer.hpp>
#include <new>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "difi/error.h"
#include "io/3ds_check.h"
#include "io/assimp_files.h"
#include "io/assimp_losses.h"
#include "io/collada_check.h"
#include "io/gltf_check.h"
#include "io/mesh_builder.h"
#include "io/mesh_format.h"
#include "io/mesh_text.h"

namespace difi {
namespace {

// Rows of a node's placement in the world.
using Placement = std::array<std::array<double, 4>, 3>;
constexpr Placement kWorld{{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}};

Vec3 placed(const Placement& m, const aiVector3D& p) {
  const auto row = [&](const std::array<double, 4>& r) {
    return r[0] * double(p.x) + r[1] * double(p.y) + r[2] * double(p.z) + r[3];
  };
  return {row(m[0]), row(m[1]), row(m[2])};
}

Placement within(const Placement& outer, const aiMatrix4x4& inner) {
  Placement m{};
  for (unsigned r = 0; r < 3; ++r)
    for (unsigned c = 0; c < 4; ++c) {
      for (unsigned k = 0; k < 3; ++k) m[r][c] += outer[r][k] * double(inner[k][c]);
      if (c == 3) m[r][c] += outer[r][3];
    }
  return m;
}

// Walks the tree of nodes; a mesh that hangs on several nodes appears several times.
class SceneReader {
 public:
  SceneReader(const FileView& file, const aiScene& scene) : file_(file), scene_(scene), builder_(file) {}

  Mesh read() {
    if (scene_.mRootNode) add(*scene_.mRootNode, kWorld, 0);
    return builder_.finish([](std::size_t v) { return "vertex " + std::to_string(v); });
  }

 private:
  void add(const aiNode& node, const Placement& outer, int depth) {
    // Deeper than any scene that was meant; a file can nest until the stack ends.
    constexpr int kDeepest = 1000;
    if (depth > kDeepest)
      file_.fail("", "its nodes are nested too deep; flatten the scene in the program that wrote it");
    const Placement placement = within(outer, node.mTransformation);
    for (unsigned m = 0; m < node.mNumMeshes; ++m) {
      if (node.mMeshes[m] >= scene_.mNumMeshes)
        file_.fail("", "a node names a mesh that is not there; repair the file");
      add(*scene_.mMeshes[node.mMeshes[m]], placement);
    }
    for (unsigned c = 0; c < node.mNumChildren; ++c) add(*node.mChildren[c], placement, depth + 1);
  }

  void add(const aiMesh& mesh, const Placement& placement) {
    const std::size_t first = builder_.vertices.size();
    check_counts(file_, std::uint64_t{first} + mesh.mNumVertices,
                 std::uint64_t{builder_.triangles.size()} + mesh.mNumFaces);
    for (unsigned v = 0; v < mesh.mNumVertices; ++v) builder_.vertices.push_back(placed(placement, mesh.mVertices[v]));
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
  MeshBuilder builder_;
};

// Assimp's messages can be of several lines and hold bytes of the file.
[[noreturn]] void fail(const FileView& file, std::string message) {
  for (char& c : message)
    if (c < 0x20 || c > 0x7e) c = ' ';
  message.erase(message.find_last_not_of(' ') + 1);
  file.fail("", "assimp cannot read it: " + message + "; repair the file or convert it to STL, PLY or OBJ");
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

// Finds what would make assimp crash or take all memory; returns the bytes to hide from it.
std::vector<std::size_t> check_before(const FileView& file, std::string_view extension) {
  if (extension == "3ds") check_3ds(file);
  if (extension == "glb") return check_glb(file);
  if (extension == "gltf") return check_gltf(file);
  if (extension == "dae") check_collada(file);
  return {};
}

}  // namespace

Mesh read_with_assimp(const FileView& file, const char* extension) {
  const std::vector<std::size_t> hidden = check_before(file, extension);
  try {
    const AssimpLosses losses;
    Assimp::Importer importer;
    importer.SetIOHandler(new AssimpFiles(file, hidden));  // the importer deletes it
    keep_importers(importer, extension);
    const aiScene* scene = importer.ReadFile(file.path().string(), aiProcess_ValidateDataStructure);
    if (!scene) fail(file, importer.GetErrorString());
    if (!losses.first().empty()) fail(file, losses.first());
    return SceneReader(file, *scene).read();
  } catch (const Error&) {
    throw;
  } catch (const std::bad_alloc&) {
    throw Error(ErrorCode::limit, file.path().string() + ": not enough memory to read it; split the mesh");
  } catch (const std::exception& failure) {
    fail(file, failure.what());
  }
}

}  // namespace difi

#endif  // DIFI_HAVE_ASSIMP
