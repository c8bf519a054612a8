// SPDX-License-Identifier: Apache-2.0
#include "view/film/film.h"

#include "standoff/error.h"
#include "view/film/flight_pictures.h"
#include "view/film/picture_folder.h"
#include "view/film/video.h"

namespace standoff::view {
namespace {

// Gives one picture after another to `add`.
template <class Add>
void draw_all(const Film& film, const ProgressCallback& progress, const Add& add) {
  FlightPictures pictures(film.subject, film.frames, film.frames_per_second, film.picture);
  const std::size_t count = film.frames.size();
  for (std::size_t n = 0; n < count; ++n) {
    if (progress && !progress({"draw", static_cast<double>(n) / static_cast<double>(count)}))
      throw Error(ErrorCode::interrupted, "interrupted");
    add(pictures.next());
  }
}

}  // namespace

void write_frames(const std::filesystem::path& folder, const Film& film, Existing existing,
                  const ProgressCallback& progress) {
  PictureFolder pictures(folder, film.frames.size(), existing);
  draw_all(film, progress, [&](const Image& image) { pictures.add(image); });
  pictures.commit();
}

void write_video(const std::filesystem::path& path, const Film& film, Existing existing,
                 const ProgressCallback& progress) {
  Video video(path, film.picture.width, film.picture.height, film.frames_per_second);
  draw_all(film, progress, [&](const Image& image) { video.add(image); });
  video.commit(existing);
}

}  // namespace standoff::view
