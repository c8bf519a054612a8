// SPDX-License-Identifier: Apache-2.0
// standoff devices, and compute on the device that every machine has: the emulated one.
#include <gtest/gtest.h>

#include "standoff/io.h"
#include "tests/cli/program.h"
#include "tests/support/fields.h"

namespace standoff::testing {
namespace {

class Devices : public ProgramTest {};

TEST_F(Devices, AreListed) {
  const Json list = done(words("devices --json")).json();
  ASSERT_GE(list["devices"].size(), 2u);
  EXPECT_EQ(list["devices"].front()["device"], "cpu");
  EXPECT_EQ(list["devices"].back()["device"], "emulated");
  // Either there are GPUs, or the reason why not.
  EXPECT_EQ(list["devices"].size() == 2, list.contains("why_no_gpu"));
  const std::string text = done(words("devices")).out;
  EXPECT_NE(text.find("\nemulated  "), std::string::npos) << text;
  EXPECT_NE(text.find("\ncuda"), std::string::npos) << text;
}

TEST_F(Devices, TheEmulatedOneGivesTheSameField) {
  for (const std::string method : {"tiles", "thesis"}) {
    const auto on = [&](const std::string& device) {
      return done(words("compute scene:box -r 14 -t 2s --with triangle --json --method " + method + " -f --device " +
                        device + " -o " + device + ".npz"))
          .json();
    };
    EXPECT_EQ(on("cpu")["device"], "cpu");
    EXPECT_EQ(on("emulated")["device"], "emulated");
    expect_same_bits(read_field(folder.path() / "cpu.npz"), read_field(folder.path() / "emulated.npz"));
  }
}

}  // namespace
}  // namespace standoff::testing
