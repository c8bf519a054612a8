// SPDX-License-Identifier: Apache-2.0
#include "render/stage.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <array>
#include <deque>
#include <string>

#include "core/guarded.h"
#include "core/memory.h"
#include "core/threads.h"
#include "files/atomic_file.h"
#include "render/image.h"
#include "render/light.h"
#include "render/part.h"
#include "render/text.h"
#include "render/tile.h"
#include "standoff/error.h"

namespace standoff {
namespace {

constexpr double kLength = 38, kWidth = 2.2, kLetter = 14, kLetterGap = 9;  // pixels at scale 1

// A line with round ends and smooth edges.
void draw_line(Image& image, Float3 from, Float3 to, double width, Color color) {
  const Float3 d = to - from;
  const float length_sq = dot(d, d);
  const auto before = [&](float a, float b) { return static_cast<int>(std::min(a, b) - width); };
  const auto after = [&](float a, float b) { return static_cast<int>(std::max(a, b) + width); };
  for (int y = before(from.y, to.y); y <= after(from.y, to.y); ++y)
    for (int x = before(from.x, to.x); x <= after(from.x, to.x); ++x) {
      const Float3 p = Float3{static_cast<float>(x) + 0.5F, static_cast<float>(y) + 0.5F, 0} - from;
      const float t = length_sq > 0 ? std::clamp(dot(p, d) / length_sq, 0.0F, 1.0F) : 0;
      const double covered = std::clamp(0.5 * width + 0.5 - length(p - d * t), 0.0, 1.0);
      if (covered > 0) image.blend(x, y, color, covered);
    }
}

// Three small arrows in the lower left corner show where x, y and z point: `margin` pixels from the picture's edges,
// all as large as `scale` says.
void draw_triad(Image& image, const Camera& camera, const Theme& theme, int margin, double scale) {
  struct Arrow {
    const char* name;
    Float3 seen;
    Color color;
  };
  std::array<Arrow, 3> arrows{{{"x", camera.turned({1, 0, 0}), {214, 60, 52}},
                               {"y", camera.turned({0, 1, 0}), {46, 150, 72}},
                               {"z", camera.turned({0, 0, 1}), {52, 110, 214}}}};
  // The one that points at the eye comes last, over the others.
  std::ranges::stable_sort(arrows, {}, [](const Arrow& arrow) { return arrow.seen.z; });
  const double reach = (kLength + kLetterGap + kLetter / 2) * scale;
  const Float3 middle{static_cast<float>(margin + reach), static_cast<float>(image.height - margin - reach), 0};
  for (const Arrow& arrow : arrows) {
    const Float3 along{arrow.seen.x, -arrow.seen.y, 0};
    const Float3 tip = middle + along * static_cast<float>(kLength * scale);
    draw_line(image, middle, tip, kWidth * scale, arrow.color);
    const Float3 at = tip + unit_or(along, {0, -1, 0}) * static_cast<float>(kLetterGap * scale);
    const double size = kLetter * scale;
    draw_text(image, at.x - 0.5 * text_width(arrow.name, size), at.y + 0.35 * cap_height(size), arrow.name, size,
              theme.ink);
  }
}

constexpr double kMargin = 0.04;                     // of the picture's shorter side, on all sides
constexpr double kLegendGap = 24, kUsualSide = 720;  // pixels at scale 1; the shorter side of a usual picture

void check(const PictureOptions& options) {
  const auto refuse = [](const char* what) { throw Error(ErrorCode::usage, std::string("picture: ") + what); };
  for (const int side : {options.width, options.height})
    if (side < 16 || side > 8192) refuse("width and height must be 16 to 8192 pixels; 1280 by 960 is usual");
  if (!std::isfinite(options.azimuth_deg)) refuse("the azimuth must be finite; give degrees");
  if (!(std::abs(options.elevation_deg) <= 90)) refuse("the elevation must be -90 to 90 degrees; 0 is level");
  if (options.up && *options.up != Axis::x && *options.up != Axis::y && *options.up != Axis::z)
    refuse("there is no such axis; take x, y or z");
  if (!(options.zoom >= 0.01 && options.zoom <= 100)) refuse("the zoom must be 0.01 to 100; 1 shows everything");
  if (static_cast<int>(sample_places(options.samples).size()) != options.samples)
    refuse("a pixel has 1, 2, 4, 8 or 16 samples; 4 is usual");
  if (options.background != Background::white && options.background != Background::dark &&
      options.background != Background::transparent)
    refuse("there is no such background; take white, dark or transparent");
}

// An upper bound for the field of shadows, wherever its triangles lie.
std::size_t bytes_of_shadows(const Drawing& drawing) {
  std::int64_t triangles = 0, vertices = 0;
  for (const MeshLayer& layer : drawing.meshes) {
    triangles += static_cast<std::int64_t>(layer.mesh.triangles.size());
    vertices += static_cast<std::int64_t>(layer.mesh.vertices.size());
  }
  return triangles == 0 ? 0 : static_cast<std::size_t>(Occlusion::bytes(triangles, vertices));
}

// The half spaces that slices leave of a mesh: the far sides of the planes that cut.
std::vector<HalfSpace> kept_by(const Drawing& drawing, const UnitSpace& space, const Camera& camera) {
  std::vector<HalfSpace> kept;
  for (const SliceLayer& slice : drawing.slices) {
    if (!slice.cuts) continue;
    const auto along = [&](Float3 p) { return slice.axis == Axis::x ? p.x : slice.axis == Axis::y ? p.y : p.z; };
    const Vec3 on_plane = position_of(slice) * Vec3{1, 1, 1};
    kept.push_back({slice.axis, along(space.placed(on_plane)), along(camera.to_eye({})) < 0});
  }
  return kept;
}

// The opacity of all that shows numbers, if only slices do, and all have the same opacity.
std::optional<double> opacity_of_numbers(const Drawing& drawing) {
  const auto shows = [](const auto& layer) { return !layer.values.empty(); };
  if (drawing.slices.empty() || !drawing.bands.empty() || std::ranges::any_of(drawing.meshes, shows) ||
      std::ranges::any_of(drawing.points, shows) || std::ranges::any_of(drawing.paths, shows))
    return std::nullopt;
  const double first = drawing.slices.front().outside_opacity;
  const auto same = [first](const SliceLayer& slice) { return slice.outside_opacity == first; };
  return std::ranges::all_of(drawing.slices, same) ? std::optional(first) : std::nullopt;
}

bool any_sign(const Drawing& drawing) {
  const auto has_sign = [](const auto& layer) { return layer.field->has_sign(); };
  return std::ranges::any_of(drawing.slices, has_sign) || std::ranges::any_of(drawing.bands, has_sign);
}

std::vector<std::vector<char>> unused_of(const Drawing& drawing) {
  std::vector<std::vector<char>> unused;
  for (const MeshLayer& layer : drawing.meshes) unused.push_back(unused_vertices(layer.mesh));
  return unused;
}

}  // namespace

void Stage::Extent::include(const Extent& other) {
  least_u = std::min(least_u, other.least_u);
  least_v = std::min(least_v, other.least_v);
  most_u = std::max(most_u, other.most_u);
  most_v = std::max(most_v, other.most_v);
}

Stage::Stage(const Drawing& drawing, const Drawing& whole, const PictureOptions& options)
    : options_(options),
      words_(std::max(1.0, std::min(options.width, options.height) / kUsualSide)),
      theme_(theme_of(options.background)) {
  check(options);
  standoff::check(drawing);
  std::vector<std::vector<char>> unused = unused_of(drawing);
  const Box box = bounds_of(whole, &whole == &drawing ? unused : unused_of(whole));
  if (box.empty())
    throw Error(ErrorCode::usage, "picture: there is nothing to draw; give a mesh, a field, points, a path or a box");
  space_ = std::make_unique<UnitSpace>(box);
  add_numbers(whole);

  // The unit sphere about fills the shorter side.
  const float pixel = pixel_ = 2.0F / static_cast<float>(std::min(options.width, options.height));
  MemoryBudget budget("picture", memory_limit_of(options.memory_limit),
                      "draw fewer pixels or layers, or without shadows or edges");
  budget.take(bytes_of_parts(drawing, *space_, pixel) + sizeof(Color) * pixels());
  if (options.shadows) budget.take(bytes_of_shadows(drawing));
  const std::vector<HalfSpace> kept = kept_by(drawing, *space_, Camera(options));
  std::vector<DrawnPart> lines;
  for (std::size_t n = 0; n < drawing.meshes.size(); ++n) {
    const MeshLayer& layer = drawing.meshes[n];
    DrawnPart part = made_of(layer, std::move(unused[n]));
    for (const HalfSpace& space : kept) cut(part, space);
    if (layer.edges) {
      const auto edges = feature_edges(part);
      budget.take(bytes_of_lines(edges.size()));
      lines.push_back(edge_lines(part, edges, pixel));
    }
    parts_.push_back(std::move(part));
  }
  const std::size_t meshes = parts_.size();
  add_bands(drawing, *space_, pixel, parts_);
  for (std::size_t n = meshes; n < parts_.size(); ++n)
    for (const HalfSpace& space : kept) cut(parts_[n], space);
  if (options.shadows) occlusion_ = std::make_unique<Occlusion>(parts_);
  add_points(drawing, *space_, pixel, parts_);
  add_paths(drawing, *space_, pixel, parts_);
  add_slices(drawing, *space_, parts_);
  add_boxes(drawing, *space_, pixel, parts_);
  for (DrawnPart& part : lines) parts_.push_back(std::move(part));
  if (!occlusion_) occlusion_ = std::make_unique<Occlusion>(std::span<const DrawnPart>());
  std::erase_if(parts_, [](const DrawnPart& part) { return part.triangles.empty(); });
  standing_ = parts_.size();
}

DrawnPart Stage::made_of(const MeshLayer& layer, std::vector<char> unused) const {
  DrawnPart part = part_of(layer, *space_, std::move(unused));
  if (layer.shading == Shading::flat)
    part.normals = {};
  else if (part.normals.empty() && part.triangles.size() <= pixels())
    smooth(part);
  return part;
}

void Stage::move(const Drawing& moving) {
  standoff::check(moving);
  parts_.resize(standing_);
  for (const MeshLayer& layer : moving.meshes) parts_.push_back(made_of(layer, unused_vertices(layer.mesh)));
  add_points(moving, *space_, pixel_, parts_);
  add_paths(moving, *space_, pixel_, parts_);
  std::erase_if(parts_, [](const DrawnPart& part) { return part.triangles.empty(); });
  for (std::size_t n = standing_; n < parts_.size(); ++n) parts_[n].moves = true;
}

void Stage::keep(const Camera& camera, const Extent& extent) {
  parts_.resize(standing_);
  kept_.reset();
  kept_ = draw_parts(camera, framing(extent), theme_.paper);
}

void Stage::add_numbers(const Drawing& drawing) {
  const NumberRange range = number_range(drawing);
  if (range.empty()) return;
  Colormap map = drawing.colormap;
  if (map == Colormap::automatic) map = range.least < 0 || any_sign(drawing) ? Colormap::diverging : Colormap::viridis;
  legend_.emplace(range.least, range.greatest, static_cast<float>(range.thickness), map, theme_, drawing.quantity);
  if (range.ends_early) legend_->end_early();
  if (const auto opacity = opacity_of_numbers(drawing)) legend_->show_through(*opacity);
  ramp_ = Ramp(*legend_, range.least, range.greatest, theme_);
  if (const auto& ticks = legend_->ticks(); ticks.size() > 1) contour_step_ = ticks[1].value - ticks[0].value;
}

Float3 Stage::up() const {
  const Axis up = options_.up.value_or(Axis::z);
  return {up == Axis::x ? 1.0F : 0.0F, up == Axis::y ? 1.0F : 0.0F, up == Axis::z ? 1.0F : 0.0F};
}

Framing::Room Stage::room() const {
  const double margin = kMargin * std::min(options_.width, options_.height);
  const bool has_legend = options_.legend && legend_;
  const double beside = has_legend ? legend_->width(words_) + kLegendGap * words_ : 0;
  return {margin, margin, std::max(1.0, options_.width - 2 * margin - beside), options_.height - 2 * margin};
}

Stage::Extent Stage::extent(const Camera& camera) const {
  Extent all;
  for (const DrawnPart& part : parts_)
    all.include(tbb::parallel_reduce(
        tbb::blocked_range<std::size_t>(0, part.places.size(), 1 << 14), Extent{},
        [&](const auto& range, Extent extent) {
          for (std::size_t v = range.begin(); v < range.end(); ++v) {
            if (!part.is_used(v)) continue;
            const Camera::Seen seen = camera.seen(part.places[v]);
            extent.include({seen.u, seen.v, seen.u, seen.v});
          }
          return extent;
        },
        [](Extent a, const Extent& b) {
          a.include(b);
          return a;
        }));
  return all;
}

Framing Stage::framing(const Extent& extent) const {
  return {extent.least_u, extent.least_v, extent.most_u, extent.most_v, room(), options_.zoom};
}

Image Stage::draw_parts(const Camera& camera, const Framing& framing, Color paper) const {
  std::vector<SeenPart> seen;
  std::uint64_t triangles = 0;
  for (const DrawnPart& part : parts_) {
    seen.push_back({&part, std::vector<ScreenPoint>(part.places.size()), static_cast<std::uint32_t>(triangles)});
    triangles += part.triangles.size();
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, part.places.size(), 1 << 14), [&](const auto& range) {
      for (std::size_t v = range.begin(); v < range.end(); ++v)
        if (part.is_used(v)) seen.back().points[v] = framing.on_picture(camera.seen(part.places[v]));
    });
  }
  if (triangles > kMaxTriangles)
    throw Error(ErrorCode::limit, "picture: it would have " + std::to_string(triangles) +
                                      " triangles, more than 4,000,000,000; draw fewer layers");

  const auto places = sample_places(options_.samples);
  const Bins opaque(seen, options_.width, options_.height, places, [](const DrawnPart& p) { return p.opacity >= 1; });
  const Bins clear(seen, options_.width, options_.height, places, [](const DrawnPart& p) { return p.opacity < 1; });
  const Float3 lamp = to_lamp(camera);
  const Shadow shadow(*occlusion_, lamp);
  const Scenery scenery{camera,
                        *occlusion_,
                        shadow,
                        lamp,
                        ramp_,
                        up(),
                        static_cast<float>(1 / std::max(1.0, framing.pixels_per_unit())),
                        contour_step_,
                        linear_of(theme_.outside),
                        linear_of(theme_.inside),
                        options_.perspective};
  Image image = kept_ ? *kept_ : Image(options_.width, options_.height, paper);
  const Bins moving(seen, options_.width, options_.height, places, [](const DrawnPart& p) { return p.moves; });
  PerThread<TileDrawer> drawers([&] { return TileDrawer(seen, places); });
  tbb::parallel_for(0, opaque.tiles(), [&](int tile) {
    if (kept_) {
      bool moves = false;
      moving.for_each(tile, [&](const SeenPart&, std::uint32_t) { moves = true; });
      if (!moves) return;
      const PixelRange pixels = moving.pixels(tile);
      image.fill(pixels.left, pixels.top, pixels.right - pixels.left + 1, pixels.bottom - pixels.top + 1, paper);
    }
    drawers.local().draw(opaque, clear, tile, scenery, image);
  });
  return image;
}

Image Stage::draw(const Camera& camera, const Extent& extent) const {
  if (options_.background != Background::transparent) return draw_on(theme_.paper, camera, extent);
  return without_paper(draw_on({255, 255, 255}, camera, extent), draw_on({0, 0, 0}, camera, extent));
}

Image Stage::draw_on(Color paper, const Camera& camera, const Extent& extent) const {
  Image image = draw_parts(camera, framing(extent), paper);
  const int margin = static_cast<int>(kMargin * std::min(options_.width, options_.height));
  if (options_.legend && legend_)
    legend_->draw(image, options_.width - margin - legend_->width(words_), options_.height / 5, options_.height * 3 / 5,
                  words_);
  if (options_.axes) draw_triad(image, camera, theme_, margin, words_);
  return image;
}

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

PictureOptions upright(const Drawing& drawing, const PictureOptions& options) {
  PictureOptions found = options;
  const auto try_field = [&](const DistanceField* field) {
    if (field && !found.up) found.up = field->provenance().up;
  };
  for (const MeshLayer& mesh : drawing.meshes)
    if (!found.up) found.up = mesh.up;
  for (const SliceLayer& slice : drawing.slices) try_field(slice.field);
  for (const BandLayer& band : drawing.bands) try_field(band.field);
  if (!found.up) found.up = drawing.meshes.empty() ? Axis::z : up_axis(drawing.meshes[0].mesh);
  return found;
}

Image draw_picture(const Drawing& drawing, const PictureOptions& given) {
  return on_threads(given, [&] {
    const PictureOptions options = upright(drawing, given);
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

void write_turntable(const std::filesystem::path& path, const Drawing& drawing, int count, const PictureOptions& given,
                     Existing existing) try {
  require_png();
  if (count < 1 || count > kMostTurns)
    throw Error(ErrorCode::usage,
                "picture: a turntable has 1 to " + std::to_string(kMostTurns) + " pictures; 36 is usual");
  const PictureOptions options = upright(drawing, given);
  const auto camera_of = [&](int n) {
    PictureOptions turned = options;
    turned.azimuth_deg += 360.0 * n / count;
    return Camera(turned);
  };
  // No picture gets its name before all are drawn.
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
