// SPDX-License-Identifier: Apache-2.0
// Errors of the library become the exceptions of standoff/_errors.py, with the data of their details.
#include "errors.h"

#include <string_view>

namespace standoff::python {
namespace {

const char* name_of(ErrorCode code) {
  switch (code) {
    case ErrorCode::internal:
      return "internal";
    case ErrorCode::usage:
      return "usage";
    case ErrorCode::input:
      return "input";
    case ErrorCode::output:
      return "output";
    case ErrorCode::limit:
      return "limit";
    case ErrorCode::device:
      return "device";
    case ErrorCode::verify:
      return "verify";
    case ErrorCode::doubt:
      return "doubt";
    case ErrorCode::interrupted:
      return "interrupted";
  }
  return "internal";
}

// Names of files may hold any bytes: in paths as os.fsdecode makes them, in messages so that they can be printed.
nb::object path_of(std::string_view file) {
  return nb::steal(PyUnicode_DecodeFSDefaultAndSize(file.data(), static_cast<Py_ssize_t>(file.size())));
}
nb::object message_of(std::string_view message) {
  return nb::steal(PyUnicode_DecodeUTF8(message.data(), static_cast<Py_ssize_t>(message.size()), "backslashreplace"));
}

}  // namespace

nb::object exception_of(const Error& error) {
  const ErrorDetails& d = error.details();
  const nb::object file = d.file.empty() ? nb::none() : path_of(d.file);
  return nb::module_::import_("standoff._errors")
      .attr("make")(name_of(error.code()), message_of(error.what()), "triangle"_a = d.triangle,
                    "bytes_needed"_a = d.bytes_needed, "bytes_limit"_a = d.bytes_limit, "file"_a = file,
                    "line"_a = d.line, "byte"_a = d.byte);
}

void add_errors(nb::module_&) {
  nb::register_exception_translator([](const std::exception_ptr& thrown, void*) {
    try {
      std::rethrow_exception(thrown);
    } catch (const Error& error) {
      const nb::object exception = exception_of(error);
      PyErr_SetObject(exception.type().ptr(), exception.ptr());
    }
  });
}

}  // namespace standoff::python
