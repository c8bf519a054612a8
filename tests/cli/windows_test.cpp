// SPDX-License-Identifier: Apache-2.0
// standoff compute --window and --decision: windows that programs of their own compute, by a sign that one decided.
#include <gtest/gtest.h>

#include <string>

#include "standoff/sign_decision.h"
#include "tests/cli/program.h"

namespace standoff::testing {
namespace {

class WindowOptions : public ProgramTest {
 protected:
  Ran window(const std::string& options, const std::string& output) const {
    return run(words("compute " + options + " -f -o " + output));
  }
  std::string bytes(const std::string& file) const { return read_bytes(folder / file); }
  void expect_refused(const std::string& options, const std::string& says) const {
    refused(words("compute " + options + " -f -o refused.vti"), 2, says);
    EXPECT_FALSE(folder.names().contains("refused.vti"));
  }
};

TEST_F(WindowOptions, SayWhichNumberIsWrong) {
  expect_refused("scene:box -r 20 --window 0,0,0,16,x,16",
                 "NY, the samples along y, is 'x'; give a whole number from 1");
  expect_refused("scene:box -r 20 --window 0,0,0,16,16,0", "NZ, the samples along z, is '0'");
  expect_refused("scene:box -r 20 --window 0,-4,0,16,16,16",
                 "J, the first sample along y, is '-4'; give a whole number from 0");
  expect_refused("scene:box -r 20 --window 0,0,0,1,1", "six whole numbers");
}

TEST_F(WindowOptions, OutsideTheGridAreRefused) {
  write_bytes(folder / "damaged.obj", "v nothing");
  const char* const says = "16 samples from sample 16 on along y are not within the grid, which has 21 there";
  // Before the mesh is read, where numbers alone give the grid.
  expect_refused("damaged.obj --size 20,21,22 --window 0,16,0,16,16,16", says);
  expect_refused("damaged.obj --bounds 0,0,0,19,20,21 --spacing 1 --window 0,16,0,16,16,16", says);
  expect_refused("scene:box -r 20 --window 0,0,99,1,1,1", "1 samples from sample 99 on along z");
  EXPECT_EQ(window("damaged.obj --size 20,21,22 --window 0,0,0,16,16,16", "a.vti").code, 3);
}

TEST_F(WindowOptions, ByOneDecision) {
  for (const std::string sign : {"auto", "winding", "flood", "normal", "none"})
    for (const std::string mesh : {"scene:open", "scene:nested", "scene:soup:2000"}) {
      const std::string options = mesh + " -r 40 -t 2s --window 16,0,11,16,16,16 --sign " + sign,
                        file = sign + mesh.substr(6);
      ASSERT_EQ(window(options, "alone.vti").code, 0) << options;
      ASSERT_EQ(window(options + " --decision " + file, "first.vti").code, 0);
      const std::string decided = bytes(file);
      EXPECT_LT(decided.size(), sign == "none" ? 200u : 3'000'000u);
      ASSERT_EQ(window(options + " --decision " + file, "second.vti").code, 0);
      EXPECT_EQ(bytes("first.vti"), bytes("alone.vti")) << options;
      EXPECT_EQ(bytes("second.vti"), bytes("alone.vti")) << options;
      EXPECT_EQ(bytes(file), decided);
    }
}

TEST_F(WindowOptions, ByADecisionOfSomethingElse) {
  const std::string options = "scene:nested -r 40 -t 2s --window 0,0,0,16,16,16 ";
  ASSERT_EQ(window(options + "--decision kept", "a.vti").code, 0);
  expect_refused("scene:box -r 40 -t 2s --window 0,0,0,16,16,16 --decision kept",
                 "kept: compute: the sign decision was made for another mesh");
  expect_refused(options + "--sign flood --decision kept",
                 "kept: compute: the sign decision was made for the sign method auto, not flood");
  expect_refused("scene:nested -r 40 --decision kept", "--decision: it is for the windows of a field");
  expect_refused(options + "--decision .", "is no file");
  // Of which grid a flood is.
  ASSERT_EQ(window(options + "--sign flood --decision flood", "a.vti").code, 0);
  expect_refused("scene:nested -r 41 -t 2s --window 0,0,0,16,16,16 --sign flood --decision flood", "another grid");
  write_bytes(folder / "kept", bytes("kept") + "x");
  const Ran ran = window(options + "--decision kept", "b.vti");
  EXPECT_EQ(ran.code, 3) << ran.err;
  EXPECT_TRUE(ran.says("kept: sign decision: its bytes are damaged (their checksum is wrong)")) << ran.err;
}

// Programs that begin at once write the same file, whole.
TEST_F(WindowOptions, TwoDecideAtOnce) {
  const auto command = [](int n) {
    return words("compute scene:nested -r 64 -t 2s --window 0,0," + std::to_string(16 * n) +
                 ",16,16,16 --decision kept -o " + std::to_string(n) + ".vti");
  };
  Process one(command(0), setup()), two(command(1), setup()), three(command(2), setup());
  for (Process* const process : {&one, &two, &three}) EXPECT_EQ(process->wait().code, 0);
  const std::string kept = bytes("kept");
  EXPECT_NO_THROW(SignDecision::from_bytes(std::as_bytes(std::span(kept))));
  EXPECT_EQ(folder.names(), (std::set<std::string>{"0.vti", "1.vti", "2.vti", "kept"}));
}

}  // namespace
}  // namespace standoff::testing
