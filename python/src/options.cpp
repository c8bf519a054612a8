// SPDX-License-Identifier: Apache-2.0
#include "options.h"

#include <algorithm>
#include <charconv>
#include <span>

#include "standoff/error.h"

namespace standoff::python {
namespace {

template <class Value>
Value value_of(const nb::handle& object, const char* attribute, const char* what) {
  Value value;
  if (const nb::object found = object.attr(attribute); !nb::try_cast(found, value))
    throw nb::type_error(
        (std::string("sign: its ") + attribute + " must be " + what + ", not " + nb::repr(found).c_str()).c_str());
  return value;
}

}  // namespace

std::size_t choice_of(const char* what, const std::string& name, std::span<const char* const> names) {
  std::string all;
  for (std::size_t n = 0; n < names.size(); ++n) {
    if (name == names[n]) return n;
    all += (n == 0 ? "" : n + 1 == names.size() ? " or " : ", ") + ("'" + std::string(names[n]) + "'");
  }
  throw Error(ErrorCode::usage, std::string(what) + ": there is no '" + name + "'; take " + all);
}

std::optional<Axis> up_of(const std::string& name) {
  constexpr const char* kAxes[] = {"x", "y", "z"};
  if (name.empty()) return std::nullopt;
  return static_cast<Axis>(choice_of("up", name, kAxes));
}

std::vector<int> devices_in(const std::string& device, Backend& backend) {
  const std::size_t colon = std::min(device.find(':'), device.size());
  const BackendInfo& info = row_of("device", device.substr(0, colon), kBackends);
  backend = info.backend;
  std::vector<int> devices;
  if (colon == device.size()) return devices;
  const auto fail = [&] {
    throw Error(ErrorCode::usage, "device '" + device +
                                      "': after 'cuda:' give the GPU's number, from 0, or several, as "
                                      "'cuda:0,1'");
  };
  if (!info.has_devices)
    throw Error(ErrorCode::usage, "device '" + device + "': only a GPU takes a number, as in 'cuda:1'");
  const char* const end = device.data() + device.size();
  for (const char* at = device.data() + colon; at != end;) {
    int number = -1;
    const auto [stop, error] = std::from_chars(at + 1, end, number);
    if (error != std::errc{} || number < 0 || (stop != end && *stop != ',')) fail();
    devices.push_back(number);
    at = stop;
  }
  return devices;
}

Execution execution_of(int threads, const std::string& device) {
  Execution execution{.threads = threads};
  const std::vector<int> devices = devices_in(device, execution.backend);
  if (devices.size() > 1)
    throw Error(ErrorCode::usage, "device '" + device + "': give one GPU here; so.field takes several");
  if (!devices.empty()) execution.device = devices[0];
  return execution;
}

SignOptions sign_of(const nb::handle& sign) {
  constexpr const char* kRules[] = {"positive", "nonzero", "odd"};
  return {.method = row_of("sign", value_of<std::string>(sign, "method", "a name"), kSignMethods).method,
          .rule = static_cast<WindingRule>(choice_of("rule", value_of<std::string>(sign, "rule", "a name"), kRules)),
          .invert = value_of<bool>(sign, "invert", "True or False"),
          .strict = value_of<bool>(sign, "strict", "True or False"),
          .as_oriented = value_of<bool>(sign, "as_oriented", "True or False"),
          .outer = value_of<bool>(sign, "outer", "True or False"),
          .shell = value_of<double>(sign, "shell", "a number")};
}

nb::dict sign_dict(const SignReport& r) {
  nb::dict d;
  d["method"] = r.method == SignMethod::none ? "none" : name_of(r.method);
  d["why"] = r.why;
  d["sure"] = r.sure;
  d["flipped"] = r.flipped;
  d["left_out"] = r.left_out;
  d["boundary_edges"] = r.boundary_edges;
  d["internal"] = r.internal;
  d["cut"] = r.cut;
  return d;
}

}  // namespace standoff::python
