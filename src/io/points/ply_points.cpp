// SPDX-License-Identifier: Apache-2.0
// Points from PLY: the vertices of a point cloud or mesh, as they stand there; all else is passed over.
#include "io/mesh/ply_data.h"
#include "io/points/format.h"

namespace standoff {
namespace {

template <class Body>
class PlyPoints : public PointReader {
 public:
  PlyPoints(std::unique_ptr<FileView> file, PlyHeader header, InvalidPoints invalid)
      : file_(std::move(file)),
        header_(std::move(header)),
        row_{*file_},
        body_(*file_, header_, row_),
        invalid_(invalid) {
    for (const PlyElement& element : header_.elements) {
      row_.element = &element;
      if (element.name == "vertex") break;
      row_.element = nullptr;
    }
    if (!row_.element)
      file_->fail("header", "there are no vertices, which would be the points; write the file again with them");
    axes_ = position_axes(*file_, *row_.element);
    pass_over_what_is_before(*row_.element);
    check_count(*file_, *row_.element, body_);
  }

  std::size_t read(std::span<Vec3> points) override {
    std::size_t n = 0;
    for (; n < points.size() && row_.number < row_.element->count; ++n, ++row_.number) {
      points[n] = read_position(body_, row_, axes_);
      if (!check_point(points[n], invalid_) && invalid_ == InvalidPoints::reject)
        file_->fail("vertex " + std::to_string(row_.number), invalid_point(row_.number, points[n]));
    }
    const std::uint64_t end = file_->size() - body_.bytes_left();
    file_->forget(file_->text(forgotten_, end - forgotten_));
    forgotten_ = end;
    return n;
  }
  std::optional<std::uint64_t> count() const override { return row_.element->count; }
  double fraction() const override {
    const std::uint64_t all = row_.element->count;
    return all > 0 ? static_cast<double>(row_.number) / static_cast<double>(all) : 1;
  }

 private:
  void pass_over_what_is_before(const PlyElement& vertices) {
    for (const PlyElement& element : header_.elements) {
      row_.element = &element;
      row_.number = 0;
      if (&element == &vertices) return;
      check_count(*file_, element, body_);
      if (element.least_bytes(Body::kAscii) == 0) continue;  // rows without content, however many
      for (; row_.number < element.count; ++row_.number) {
        for (const PlyProperty& property : element.properties) skip_property(body_, row_, property);
        body_.end_row();
      }
    }
  }

  std::unique_ptr<FileView> file_;
  PlyHeader header_;
  PlyRow row_;
  Body body_;
  std::array<int, 3> axes_{};
  InvalidPoints invalid_;
  std::uint64_t forgotten_ = 0;
};

}  // namespace

std::unique_ptr<PointReader> ply_points(std::unique_ptr<FileView> file, InvalidPoints invalid) {
  PlyHeader header = read_ply_header(*file);
  switch (header.encoding) {
    case PlyHeader::Encoding::little_endian:
      return std::make_unique<PlyPoints<PlyBinaryBody<false>>>(std::move(file), std::move(header), invalid);
    case PlyHeader::Encoding::big_endian:
      return std::make_unique<PlyPoints<PlyBinaryBody<true>>>(std::move(file), std::move(header), invalid);
    case PlyHeader::Encoding::ascii:
      break;
  }
  return std::make_unique<PlyPoints<PlyAsciiBody>>(std::move(file), std::move(header), invalid);
}

}  // namespace standoff
