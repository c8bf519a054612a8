// SPDX-License-Identifier: Apache-2.0
// peer_nanovdb [--once] FILE.bin...: NanoVDB's MeshToGrid at the jobs that `measure --export` wrote (peer_file.h): from
// a mesh in device memory to a sparse grid of unsigned distances there, the median of some runs by CUDA events. A CSV
// line for each job, as peer_jobs.py prints: how far NanoVDB's distances are from ours at most, and how many of our
// samples in the band it lacks. Jobs without a thickness, or whose spacings differ, are left out with a line on stderr.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <vector>

#include <nanovdb/tools/cuda/MeshToGrid.cuh>

namespace {

using Build = nanovdb::ValueOnIndex;

void check(cudaError_t result) {
  if (result != cudaSuccess) throw std::runtime_error(std::string("CUDA: ") + cudaGetErrorString(result));
}

struct PeerJob {
  std::int64_t size[3];
  double origin[3], spacing[3], thickness;
  std::vector<double> vertices;
  std::vector<std::uint32_t> triangles;
  std::vector<float> values;
};

template <class Number>
void take(std::FILE* file, Number* to, std::size_t count) {
  if (std::fread(to, sizeof(Number), count, file) != count) throw std::runtime_error("the file ends too soon");
}

PeerJob read(const char* path) {
  std::FILE* const file = std::fopen(path, "rb");
  if (!file) throw std::runtime_error("cannot be opened");
  PeerJob job;
  std::int64_t counts[2];
  take(file, counts, 2);
  take(file, job.size, 3);
  take(file, job.origin, 3);
  take(file, job.spacing, 3);
  take(file, &job.thickness, 1);
  job.vertices.resize(3 * static_cast<std::size_t>(counts[0]));
  job.triangles.resize(3 * static_cast<std::size_t>(counts[1]));
  job.values.resize(static_cast<std::size_t>(job.size[0] * job.size[1] * job.size[2]));
  take(file, job.vertices.data(), job.vertices.size());
  take(file, job.triangles.data(), job.triangles.size());
  take(file, job.values.data(), job.values.size());
  std::fclose(file);
  return job;
}

// Device memory with a copy of a vector.
template <class Number>
struct OnDevice {
  explicit OnDevice(const std::vector<Number>& all) {
    check(cudaMalloc(&at, all.size() * sizeof(Number)));
    check(cudaMemcpy(at, all.data(), all.size() * sizeof(Number), cudaMemcpyHostToDevice));
  }
  ~OnDevice() { cudaFree(at); }
  OnDevice(const OnDevice&) = delete;
  OnDevice& operator=(const OnDevice&) = delete;
  Number* at = nullptr;
};

struct Difference {
  double largest = 0;        // world units, of the samples that both have
  std::int64_t missing = 0;  // samples in our band that NanoVDB does not have
};

template <class Handle, class Buffer>
Difference compare(const PeerJob& job, const Handle& handle, const Buffer& distances) {
  std::vector<char> bytes(handle.bufferSize());
  check(cudaMemcpy(bytes.data(), handle.deviceData(), bytes.size(), cudaMemcpyDeviceToHost));
  std::vector<float> found(distances.size() / sizeof(float));
  check(cudaMemcpy(found.data(), distances.deviceData(), distances.size(), cudaMemcpyDeviceToHost));
  const auto& tree = reinterpret_cast<const nanovdb::NanoGrid<Build>*>(bytes.data())->tree();
  Difference difference;
  std::vector<char> has(job.values.size());
  for (std::uint32_t leaf = 0; leaf < tree.nodeCount(0); ++leaf) {
    const auto& node = tree.getFirstLeaf()[leaf];
    for (std::uint32_t n = 0; n < 512; ++n) {
      if (!node.isActive(n)) continue;
      const nanovdb::Coord at = node.origin() + nanovdb::NanoLeaf<Build>::OffsetToLocalCoord(n);
      if (at[0] < 0 || at[1] < 0 || at[2] < 0 || at[0] >= job.size[0] || at[1] >= job.size[1] || at[2] >= job.size[2])
        continue;
      const auto sample = static_cast<std::size_t>(at[0] + job.size[0] * (at[1] + job.size[1] * at[2]));
      has[sample] = 1;
      const double theirs = std::min(double{found[node.getValue(n)]} * job.spacing[0], job.thickness);
      difference.largest = std::max(difference.largest, std::abs(theirs - double{job.values[sample]}));
    }
  }
  for (std::size_t n = 0; n < has.size(); ++n)
    difference.missing += !has[n] && double{job.values[n]} < job.thickness * (1 - 1e-6);
  return difference;
}

void measure(const char* path, bool once) {
  const PeerJob job = read(path);
  if (!std::isfinite(job.thickness) || job.spacing[0] != job.spacing[1] || job.spacing[0] != job.spacing[2]) {
    std::fprintf(stderr, "%s: MeshToGrid makes bands with one spacing: left out\n", path);
    return;
  }
  std::vector<nanovdb::Vec3f> points;  // in spacings, sample (0, 0, 0) at the origin
  for (std::size_t n = 0; n < job.vertices.size(); n += 3) {
    const auto along = [&](std::size_t axis) {
      return static_cast<float>((job.vertices[n + axis] - job.origin[axis]) / job.spacing[axis]);
    };
    points.emplace_back(along(0), along(1), along(2));
  }
  std::vector<nanovdb::Vec3i> corners;
  for (std::size_t n = 0; n < job.triangles.size(); n += 3)
    corners.emplace_back(static_cast<int>(job.triangles[n]), static_cast<int>(job.triangles[n + 1]),
                         static_cast<int>(job.triangles[n + 2]));
  const OnDevice<nanovdb::Vec3f> points_there(points);
  const OnDevice<nanovdb::Vec3i> corners_there(corners);
  cudaEvent_t start, end;
  check(cudaEventCreate(&start));
  check(cudaEventCreate(&end));
  const auto run = [&](const auto& use) {
    nanovdb::tools::cuda::MeshToGrid<Build> maker(points_there.at, static_cast<std::uint32_t>(points.size()),
                                                  corners_there.at, static_cast<std::uint32_t>(corners.size()));
    maker.setVerbose(0);
    maker.setNarrowBandWidth(static_cast<float>(job.thickness / job.spacing[0]));
    check(cudaEventRecord(start));
    auto [handle, distances] = maker.getHandleAndUDF();
    check(cudaEventRecord(end));
    check(cudaEventSynchronize(end));
    float milliseconds = 0;
    check(cudaEventElapsedTime(&milliseconds, start, end));
    use(handle, distances);
    return milliseconds;
  };
  Difference difference;
  run([&](const auto& handle, const auto& distances) { difference = compare(job, handle, distances); });
  std::vector<float> runs;
  constexpr std::size_t kMost = 20;
  for (float sum = 0; runs.empty() || (!once && runs.size() < kMost && sum < 3000); sum += runs.back())
    runs.push_back(run([](const auto&, const auto&) {}));
  std::sort(runs.begin(), runs.end());
  std::printf("%s,%zu,MeshToGrid,%lldx%lldx%lld,%g,%.4f,%.4f,%zu,0,%.6g,NanoVDB %d.%d.%d; %lld samples missing\n",
              std::filesystem::path(path).stem().c_str(), corners.size(), static_cast<long long>(job.size[0]),
              static_cast<long long>(job.size[1]), static_cast<long long>(job.size[2]), job.thickness,
              double{runs[runs.size() / 2]}, double{runs.front()}, runs.size(), difference.largest,
              NANOVDB_MAJOR_VERSION_NUMBER, NANOVDB_MINOR_VERSION_NUMBER, NANOVDB_PATCH_VERSION_NUMBER,
              static_cast<long long>(difference.missing));
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  bool once = false;
  int failed = 0;
  for (int n = 1; n < argc; ++n) {
    if (std::strcmp(argv[n], "--once") == 0) {
      once = true;
      continue;
    }
    try {
      measure(argv[n], once);
    } catch (const std::exception& error) {
      std::fprintf(stderr, "peer_nanovdb: %s: %s\n", argv[n], error.what());
      failed = 1;
    }
  }
  return failed;
}
