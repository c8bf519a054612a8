// SPDX-License-Identifier: Apache-2.0
// The public functions of pictures.
#include <string>

#include "core/execution.h"
#include "core/guarded.h"
#include "core/threads.h"
#include "render/stage.h"
#include "standoff/error.h"

namespace standoff {
namespace {

constexpr const char* kWhatToDo = "draw fewer pixels, or provide more memory";

// Runs drawing on the threads that the options ask for.
template <class Work>
auto on_threads(const PictureOptions& options, const Work& work) {
  validate("picture", {.threads = options.threads}, Runs::on_the_cpu);
  return Threads(options.threads).run(work);
}

Drawing drawing_of(MeshView mesh) {
  Drawing drawing;
  drawing.meshes.push_back({.mesh = mesh});
  return drawing;
}

}  // namespace

Image draw_picture(const Drawing& drawing, const PictureOptions& options) {
  return on_threads(options, [&] {
    const Stage stage(drawing, options);
    const Camera camera(options);
    return stage.draw(camera, stage.extent(camera));
  });
}

Image draw_mesh(MeshView mesh, const PictureOptions& options) { return draw_picture(drawing_of(mesh), options); }

void write_picture(const std::filesystem::path& path, const Drawing& drawing, const PictureOptions& options,
                   Existing existing) try {
  require_png();
  write_png(path, draw_picture(drawing, options), existing);
} catch (...) {
  throw_as_error("picture", kWhatToDo);
}

void write_mesh_png(const std::filesystem::path& path, MeshView mesh, const PictureOptions& options,
                    Existing existing) try {
  require_png();
  write_png(path, draw_mesh(mesh, options), existing);
} catch (...) {
  throw_as_error("picture", kWhatToDo);
}

void write_turntable(const std::filesystem::path& path, const Drawing& drawing, int count,
                     const PictureOptions& options, Existing existing) try {
  require_png();
  if (count < 1 || count > 10000)
    throw Error(ErrorCode::usage, "picture: a turntable has 1 to 10000 pictures; 36 is usual");
  const auto camera_of = [&](int n) {
    PictureOptions turned = options;
    turned.azimuth_deg += 360.0 * n / count;
    return Camera(turned);
  };
  std::vector<std::filesystem::path> written;
  try {
    on_threads(options, [&] {
      const Stage stage(drawing, options);
      Stage::Extent extent;
      for (int n = 0; n < count; ++n) extent.include(stage.extent(camera_of(n)));
      for (int n = 0; n < count; ++n) {
        std::string number = std::to_string(n);
        number.insert(0, number.size() < 3 ? 3 - number.size() : 0, '0');
        std::filesystem::path file = path;
        file.replace_filename(path.stem().string() + "-" + number + path.extension().string());
        write_png(file, stage.draw(camera_of(n), extent), existing);
        written.push_back(file);
      }
    });
  } catch (...) {
    std::error_code ignored;
    for (const auto& file : written) std::filesystem::remove(file, ignored);
    throw;
  }
} catch (...) {
  throw_as_error("picture", kWhatToDo);
}

}  // namespace standoff
