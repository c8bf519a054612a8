// SPDX-License-Identifier: Apache-2.0
// standoff devices: where fields can be computed.
#include <memory>
#include <thread>

#include "cli/console.h"
#include "cli/text.h"
#include "cli/verb.h"
#include "standoff/cuda.h"

namespace standoff::cli {
namespace {

constexpr const char* kDevicesExamples = R"(  standoff devices          what --device can name here
  standoff devices --json   the same for programs
)";

void run(const Console& console) {
  const auto gpus = cuda::devices();
  if (console.json()) {
    Json list = Json::array();
    list.push_back({{"device", "cpu"}, {"threads", std::thread::hardware_concurrency()}});
    for (std::size_t n = 0; n < gpus.size(); ++n)
      list.push_back({{"device", "cuda:" + std::to_string(n)},
                      {"name", gpus[n].name},
                      {"compute_capability", std::to_string(gpus[n].major) + "." + std::to_string(gpus[n].minor)},
                      {"memory_bytes", gpus[n].memory_bytes}});
    list.push_back({{"device", "emulated"}});
    Json all = json_answer("devices");
    all["devices"] = list;
    if (gpus.empty()) all["why_no_gpu"] = cuda::why_no_device();
    return print(all);
  }
  std::string text = "cpu       " + std::to_string(std::thread::hardware_concurrency()) + " hardware threads\n";
  for (std::size_t n = 0; n < gpus.size(); ++n)
    text += "cuda:" + std::to_string(n) + "    " + gpus[n].name + ", " + bytes_text(gpus[n].memory_bytes) +
            ", compute capability " + std::to_string(gpus[n].major) + "." + std::to_string(gpus[n].minor) + "\n";
  if (gpus.empty()) text += "cuda      none: " + cuda::why_no_device() + "\n";
  print(text + "emulated  the GPU's kernels on the CPU, slow, to find faults with\n");
}

}  // namespace

void add_devices(CLI::App& program) {
  auto* verb = add_verb(program, "devices", "list the devices that fields can be computed on", kDevicesExamples);
  const auto console = std::make_shared<Console>();
  console->add_to(*verb, Console::kJson);
  verb->callback([console] { run(*console); });
}

}  // namespace standoff::cli
