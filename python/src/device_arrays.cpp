// SPDX-License-Identifier: Apache-2.0
// Arrays in a GPU's memory, as addresses: Python finds out where they lie, and nothing here looks into them.
#include <iterator>
#include <span>
#include <variant>

#include "common.h"
#include "computed.h"
#include "errors.h"
#include "lock.h"
#include "options.h"
#include "standoff/cuda_compute.h"
#include "standoff/testing/emulation.h"

namespace standoff::python {
namespace {

/// An address, the type as numpy writes it ("f4", "i8"), how many rows of three there are, and the bytes between them.
using DeviceRows = std::tuple<std::uintptr_t, std::string, std::size_t, std::int64_t>;

template <class Number>
VertexArray vertices_of(const DeviceRows& rows) {
  const auto& [at, type, count, stride] = rows;
  return {reinterpret_cast<const Number*>(at), count, static_cast<std::ptrdiff_t>(stride)};
}
template <class Index>
TriangleArray triangles_of(const DeviceRows& rows) {
  const auto& [at, type, count, stride] = rows;
  return {reinterpret_cast<const Index*>(at), count, static_cast<std::ptrdiff_t>(stride)};
}

MeshView device_view_of(const DeviceRows& vertices, const DeviceRows& faces) {
  const std::string &v = std::get<1>(vertices), &f = std::get<1>(faces);
  MeshView view;
  if (v == "f8")
    view.vertices = vertices_of<double>(vertices);
  else if (v == "f4")
    view.vertices = vertices_of<float>(vertices);
  else
    throw nb::type_error("vertices: must be f4 or f8");
  if (f == "u4")
    view.triangles = triangles_of<std::uint32_t>(faces);
  else if (f == "i4")
    view.triangles = triangles_of<std::int32_t>(faces);
  else if (f == "u8")
    view.triangles = triangles_of<std::uint64_t>(faces);
  else if (f == "i8")
    view.triangles = triangles_of<std::int64_t>(faces);
  else
    throw nb::type_error("faces: must be u4, i4, u8 or i8");
  return view;
}

// The pool of a library of Python (_device_arrays.py, Pool). What goes wrong there counts as no memory.

void* allocate_by(const nb::handle& pool, std::int64_t bytes) {
  const Locked held;
  const nb::object size = nb::int_(bytes), name = nb::str("allocate");
  const auto given =
      nb::steal(ask_python([&] { return PyObject_CallMethodObjArgs(pool.ptr(), name.ptr(), size.ptr(), nullptr); }));
  if (given.is_valid()) return PyLong_AsVoidPtr(given.ptr());
  if (PyErr_ExceptionMatches(PyExc_KeyboardInterrupt)) PyErr_SetInterrupt();  // told again, later
  PyErr_Clear();
  return nullptr;
}
void release_by(const nb::handle& pool, void* memory) {
  const Locked held;
  const nb::object at = nb::steal(PyLong_FromVoidPtr(memory)), name = nb::str("release");
  const auto done =
      nb::steal(ask_python([&] { return PyObject_CallMethodObjArgs(pool.ptr(), name.ptr(), at.ptr(), nullptr); }));
  if (!done.is_valid()) PyErr_Clear();
}

/// Which GPU, its stream, and the streams to be waited for first, as CUDA's handles; and the pool, or None.
struct StreamInput {
  bool emulated;
  int device;
  std::vector<cuda::Stream> streams;  // the first one, then the others
  nb::object pool;

  cuda::OnStream on() const {
    cuda::OnStream on{.backend = emulated ? testing::kEmulated : Backend::cuda,
                      .device = device,
                      .stream = streams[0],
                      .after = std::span(streams).subspan(1)};
    if (!pool.is_none()) {
      // Without a count of its own: it is called, copied and dropped without the lock.
      const nb::handle from = pool;
      on.memory = {[from](std::int64_t bytes) { return allocate_by(from, bytes); },
                   [from](void* memory) { release_by(from, memory); }};
    }
    return on;
  }
};

void make_stream(StreamInput* at, bool emulated, int device, std::uintptr_t stream,
                 const std::vector<std::uintptr_t>& after, const nb::object& pool) {
  const auto handle = [](std::uintptr_t number) { return reinterpret_cast<cuda::Stream>(number); };
  std::vector<cuda::Stream> streams{handle(stream)};
  for (const std::uintptr_t other : after) streams.push_back(handle(other));
  new (at) StreamInput{emulated, device, std::move(streams), pool};
}

using DeviceMeshInput = std::tuple<DeviceRows, DeviceRows>;
/// Vertices, faces, grid, thickness, and the address of the values.
using DeviceFieldInput = std::tuple<DeviceRows, DeviceRows, GridInput, double, std::uintptr_t>;

/// A list of answers, in which exceptions stand for those that are not there.
template <class Answer, class Convert>
nb::list list_of(const std::vector<cuda::OrError<Answer>>& answers, const Convert& convert) {
  nb::list all;
  for (const auto& answer : answers) {
    if (const Error* const error = std::get_if<Error>(&answer))
      all.append(exception_of(*error));
    else
      all.append(convert(std::get<Answer>(answer)));
  }
  return all;
}

// These wait on the caller's thread: a stream of CUDA's may be that of its thread.
nb::list bounds_on_device(const std::vector<DeviceMeshInput>& meshes, const StreamInput& stream) {
  std::vector<MeshView> views;
  for (const auto& [vertices, faces] : meshes) views.push_back(device_view_of(vertices, faces));
  std::vector<cuda::OrError<Box>> boxes;
  {
    const Unlocked released;
    boxes = cuda::bounds_of_each(views, stream.on());
  }
  return list_of(boxes, [](const Box& box) {
    return nb::make_tuple(nb::make_tuple(box.min.x, box.min.y, box.min.z),
                          nb::make_tuple(box.max.x, box.max.y, box.max.z));
  });
}

nb::list compute_on_device(const std::vector<DeviceFieldInput>& fields, const nb::object& sign,
                           const std::string& method, const StreamInput& stream) {
  const Method chosen = method_of(method);
  const SignOptions asked = sign_of(sign);
  std::vector<cuda::FieldRequest> requests;
  for (const auto& [vertices, faces, grid, thickness, values] : fields)
    requests.push_back(
        {device_view_of(vertices, faces), grid.grid(), thickness, reinterpret_cast<float*>(values), chosen, asked});
  double seconds = 0;
  std::vector<cuda::OrError<ComputeReport>> reports;
  {
    const Unlocked released;
    const Timed timed(seconds);
    reports = cuda::compute_each(requests, stream.on());
  }
  return list_of(reports, [&](const ComputeReport& report) { return computation_dict(report, seconds); });
}

void copy_to_host(std::uintptr_t values, const nb::ndarray<float, nb::f_contig, nb::device::cpu>& out,
                  const StreamInput& stream) {
  const Unlocked released;
  cuda::copy_to_host(reinterpret_cast<const float*>(values), {out.data(), out.size()}, stream.on());
}

/// An array of DLPack, whatever its device. Keeps its memory.
struct ImportedArray {
  nb::ndarray<> array;

  std::string type() const {
    constexpr const char* kKinds[] = {"i", "u", "f"};  // DLPack's first codes
    const nb::dlpack::dtype t = array.dtype();
    return (t.code < std::size(kKinds) && t.lanes == 1 ? kKinds[t.code] : "V") + std::to_string(t.bits / 8);
  }
  std::vector<std::int64_t> shape() const {
    return per_axis([&](std::size_t n) { return array.shape(n); });
  }
  std::vector<std::int64_t> strides() const {
    return per_axis([&](std::size_t n) { return array.stride(n) * static_cast<std::int64_t>(array.itemsize()); });
  }

 private:
  template <class Get>
  std::vector<std::int64_t> per_axis(Get get) const {
    std::vector<std::int64_t> all;
    for (std::size_t n = 0; n < array.ndim(); ++n) all.push_back(static_cast<std::int64_t>(get(n)));
    return all;
  }
};

}  // namespace

void add_device_arrays(nb::module_& m) {
  nb::class_<StreamInput>(m, "Stream")
      .def("__init__", &make_stream, "emulated"_a, "device"_a, "stream"_a, "after"_a, "pool"_a.none() = nb::none());
  nb::class_<ImportedArray>(m, "ImportedArray")
      .def(
          "__init__", [](ImportedArray* at, nb::ndarray<> capsule) { new (at) ImportedArray{std::move(capsule)}; },
          "capsule"_a.noconvert())
      .def_prop_ro("pointer", [](const ImportedArray& a) { return reinterpret_cast<std::uintptr_t>(a.array.data()); })
      .def_prop_ro("type", &ImportedArray::type)
      .def_prop_ro("shape", &ImportedArray::shape)
      .def_prop_ro("strides", &ImportedArray::strides);
  m.def("bounds_on_device", &bounds_on_device, "meshes"_a, "stream"_a);
  m.def("compute_on_device", &compute_on_device, "fields"_a, "sign"_a, "method"_a, "stream"_a);
  m.def("copy_to_host", &copy_to_host, "values"_a, "out"_a.noconvert(), "stream"_a);
}

}  // namespace standoff::python
