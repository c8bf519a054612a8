// SPDX-License-Identifier: Apache-2.0
#include "cli/point_answers.h"

#include <algorithm>
#include <cmath>
#include <future>
#include <limits>
#include <utility>
#include <vector>

#include "standoff/error.h"

namespace standoff::cli {
namespace {

// Points that are answered together share work: the more the better. Fewer where an answer takes much memory.
std::size_t block_size(const AskedAnswers& asked) { return std::size_t{1} << (asked.needs_closest() ? 19 : 20); }
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

class Answering {
 public:
  Answering(const MeshQuery& query, const AskedAnswers& asked, const Execution& execution)
      : query_(query), asked_(asked), execution_(execution) {}

  // Fills in the answers at the block's points.
  void answer(AnswerBlock& block, const ProgressCallback& progress) {
    const std::vector<std::size_t> invalid = take_out_invalid(block.points);
    const std::size_t count = block.size();
    if (asked_.needs_closest()) {
      block.closest.resize(count);
      query_.closest(block.points, block.closest, execution_, progress);
    } else {
      block.distances.resize(count);
      query_.distances(block.points, block.distances, execution_, progress);
    }
    if (asked_.gradient)
      for (std::size_t n = 0; n < count; ++n)
        block.gradients.push_back(query_.gradient(block.points[n], block.closest[n]));
    if (asked_.winding) {
      block.windings.resize(count);
      query_.winding_numbers(block.points, block.windings, {.threads = execution_.threads}, progress);  // the CPU's
    }
    for (const std::size_t n : invalid) put_nothing(block, n);
    count_block(block, static_cast<std::int64_t>(invalid.size()));
  }

  const PointCounts& counts() const { return counts_; }

 private:
  // Which points are NaN. A corner of the mesh takes the place of each, for the query knows no invalid points.
  std::vector<std::size_t> take_out_invalid(std::vector<Vec3>& points) const {
    std::vector<std::size_t> invalid;
    for (std::size_t n = 0; n < points.size(); ++n)
      if (std::isnan(points[n].x)) {
        invalid.push_back(n);
        points[n] = query_.mesh().corner(0, 0);
      }
    return invalid;
  }

  static void put_nothing(AnswerBlock& block, std::size_t n) {
    const Vec3 nothing{kNan, kNan, kNan};
    block.points[n] = nothing;
    if (!block.distances.empty()) block.distances[n] = kNan;
    if (!block.closest.empty())
      block.closest[n] = {.distance = kNan, .point = nothing, .triangle = kNoTriangle, .weights = {kNan, kNan, kNan}};
    if (!block.gradients.empty()) block.gradients[n] = nothing;
    if (!block.windings.empty()) block.windings[n] = kNan;
  }

  void count_block(const AnswerBlock& block, std::int64_t invalid) {
    for (std::size_t n = 0; n < block.size(); ++n) {
      const double distance = asked_.needs_closest() ? block.closest[n].distance : block.distances[n];
      counts_.inside += distance < 0;
      counts_.least = std::fmin(counts_.least, distance);
      counts_.largest = std::fmax(counts_.largest, distance);
    }
    counts_.points += static_cast<std::int64_t>(block.size());
    counts_.invalid += invalid;
  }

  const MeshQuery& query_;
  const AskedAnswers& asked_;
  const Execution& execution_;
  PointCounts counts_{.least = kNan, .largest = kNan};
};

std::vector<Vec3> next_points(PointReader& reader, const AskedAnswers& asked) {
  std::vector<Vec3> points(block_size(asked));
  points.resize(reader.read(points));
  return points;
}

// A thread of its own for `work`, where there is one to be had; else it is done when its result is taken.
template <class Work>
auto beside(Work work) {
  return std::async(std::launch::async | std::launch::deferred, std::move(work));
}

}  // namespace

PointCounts answer_points(const MeshQuery& query, PointReader& reader, AnswerWriter& writer, const AskedAnswers& asked,
                          const Execution& execution, const ProgressCallback& progress) {
  Answering answering(query, asked, execution);
  // At most three blocks: one is read, one is answered, one is written.
  AnswerBlock written;
  std::future<std::vector<Vec3>> reading = beside([&] { return next_points(reader, asked); });
  std::future<void> writing;
  for (;;) {
    AnswerBlock block;
    block.points = reading.get();
    const double before = reader.fraction();
    if (block.points.empty()) break;
    if (progress && !progress({"points", before})) throw Error(ErrorCode::interrupted, "interrupted");
    reading = beside([&] { return next_points(reader, asked); });
    answering.answer(block, {});
    if (writing.valid()) writing.get();
    written = std::move(block);
    writing = beside([&] { writer.write(written); });
  }
  if (writing.valid()) writing.get();
  writer.finish();
  return answering.counts();
}

}  // namespace standoff::cli
