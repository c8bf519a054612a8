// What is asked of two bodies, as drivers of the benchmarks read it.
#include "bench/question.h"

#include <gtest/gtest.h>

#include <stdexcept>

namespace {

using difi::Vec3;
using difi::bench::parse_question;
using difi::bench::Query;

TEST(Question, OfPosesDrawn) {
  EXPECT_EQ(parse_question("collide").query, Query::collide);
  EXPECT_EQ(parse_question("contacts").query, Query::contacts);
  EXPECT_EQ(parse_question("all_contacts").query, Query::all_contacts);
  EXPECT_EQ(parse_question("distance").query, Query::distance);
  EXPECT_EQ(parse_question("sweep").query, Query::sweep);
  EXPECT_EQ(parse_question("sweep").place, std::nullopt);
}

TEST(Question, AtOnePlace) {
  const auto question = parse_question("all_contacts@0.1,-2,3e-2");
  EXPECT_EQ(question.query, Query::all_contacts);
  EXPECT_EQ(question.name, "all_contacts");
  EXPECT_EQ(question.place, (Vec3{0.1, -2, 0.03}));
}

TEST(Question, Mistakes) {
  for (const char* text : {"", "touch", "collide@", "collide@1,2", "collide@1,2,3,4", "collide@1,2,x", "@1,2,3"})
    EXPECT_THROW(parse_question(text), std::invalid_argument) << text;
}

}  // namespace
