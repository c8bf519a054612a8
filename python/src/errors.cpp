// SPDX-License-Identifier: Apache-2.0
// Errors of the library become the exceptions of standoff/_errors.py, with the data of their details.
#include "errors.h"

#include <string_view>

#include "lock.h"

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

// A new object of Python's; throws Python's error if there is none.
nb::object made(PyObject* object) {
  if (object == nullptr) throw nb::python_error();
  return nb::steal(object);
}

}  // namespace

nb::object exception_of(const Error& error) {
  const ErrorDetails& d = error.details();
  const nb::object file = d.file.empty() ? nb::none() : path_of(d.file);
  nb::dict details;
  details["triangle"] = d.triangle;
  details["bytes_needed"] = d.bytes_needed;
  details["bytes_limit"] = d.bytes_limit;
  details["file"] = file;
  details["line"] = d.line;
  details["byte"] = d.byte;
  const nb::tuple arguments = nb::make_tuple(name_of(error.code()), message_of(error.what()));
  const nb::object errors = made(ask_python([] { return PyImport_ImportModule("standoff._errors"); }));
  const nb::object make = errors.attr("make");
  return made(ask_python([&] { return PyObject_Call(make.ptr(), arguments.ptr(), details.ptr()); }));
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
