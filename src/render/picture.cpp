// SPDX-License-Identifier: Apache-2.0
// The public functions of pictures.
#include <deque>
#include <string>

#include "core/guarded.h"
#include "core/threads.h"
#include "files/atomic_file.h"
#include "render/stage.h"
#include "standoff/error.h"

namespace standoff {
namespace {

constexpr int kMostTurns = 720;  // each is an open file
constexpr const char* kFewerPixels = "draw fewer pixels, or provide more memory";

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
  throw_as_error("picture", kFewerPixels);
}

void write_mesh_png(const std::filesystem::path& path, MeshView mesh, const PictureOptions& options,
                    Existing existing) try {
  require_png();
  write_png(path, draw_mesh(mesh, options), existing);
} catch (...) {
  throw_as_error("picture", kFewerPixels);
}

std::filesystem::path turntable_file(const std::filesystem::path& path, int n) {
  std::string number = std::to_string(n);
  number.insert(0, number.size() < 3 ? 3 - number.size() : 0, '0');
  std::filesystem::path file = path;
  return file.replace_filename(path.stem().string() + "-" + number + path.extension().string());
}

void write_turntable(const std::filesystem::path& path, const Drawing& drawing, int count,
                     const PictureOptions& options, Existing existing) try {
  require_png();
  if (count < 1 || count > kMostTurns)
    throw Error(ErrorCode::usage,
                "picture: a turntable has 1 to " + std::to_string(kMostTurns) + " pictures; 36 is usual");
  const auto camera_of = [&](int n) {
    PictureOptions turned = options;
    turned.azimuth_deg += 360.0 * n / count;
    return Camera(turned);
  };
  // None has a name before all are drawn.
  std::deque<AtomicFile> files;
  for (int n = 0; n < count; ++n) files.emplace_back(turntable_file(path, n), existing);
  on_threads(options, [&] {
    const Stage stage(drawing, options);
    Stage::Extent extent;
    for (int n = 0; n < count; ++n) extent.include(stage.extent(camera_of(n)));
    for (int n = 0; n < count; ++n) {
      const std::vector<std::uint8_t> bytes = png_of(stage.draw(camera_of(n), extent));
      files[static_cast<std::size_t>(n)].write(bytes.data(), bytes.size());
    }
  });
  for (AtomicFile& file : files) file.commit();
} catch (...) {
  throw_as_error("picture", kFewerPixels);
}

}  // namespace standoff
