// SPDX-License-Identifier: Apache-2.0
// What is asked of two bodies, as drivers of the benchmarks read it.
#include "bench/question.h"

#include <gtest/gtest.h>

#include <stdexcept>

namespace {

using standoff::Vec3;
using standoff::bench::parse_question;
using standoff::bench::Query;

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

TEST(Question, OfPosesPlaced) {
  const auto near = parse_question("sweep@gap=0.1,way=3,poses=50");
  EXPECT_EQ(near.query, Query::sweep);
  EXPECT_EQ(near.gap, 0.1);
  EXPECT_EQ(near.way, 3);
  EXPECT_EQ(near.poses, 50u);
  EXPECT_EQ(near.placing, "gap=0.1");
  EXPECT_EQ(near.depth, std::nullopt);
  EXPECT_EQ(parse_question("contacts@depth=2").depth, 2);
  EXPECT_EQ(parse_question("contacts@turn=180").turn_degrees, 180);
  EXPECT_EQ(parse_question("collide@hits=0").hits, 0);
  EXPECT_EQ(parse_question("distance@poses=7").placing, "");
  const auto moved = parse_question("sweep@0,1,-2,way=0.5");
  EXPECT_EQ(moved.place, (Vec3{0, 1, -2}));
  EXPECT_EQ(moved.way, 0.5);
}

TEST(Question, Mistakes) {
  for (const char* text : {"",
                           "touch",
                           "collide@",
                           "collide@1,2",
                           "collide@1,2,3,4",
                           "collide@1,2,x",
                           "@1,2,3",
                           "collide@gap=0",
                           "collide@gap=",
                           "collide@gap=1x",
                           "collide@depth=-1",
                           "collide@turn=181",
                           "collide@hits=1.1",
                           "collide@poses=0",
                           "collide@poses=1.5",
                           "sweep@way=inf",
                           "sweep@far=1",
                           "collide@gap=1,gap=2",
                           "collide@gap=1,depth=1",
                           "collide@1,2,3,gap=1",
                           "collide@gap=1,"})
    EXPECT_THROW(parse_question(text), std::invalid_argument) << text;
}

}  // namespace
