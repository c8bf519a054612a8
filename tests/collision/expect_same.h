// SPDX-License-Identifier: Apache-2.0
// Answers of collision queries that must have the same bits.
#pragma once

#include <gtest/gtest.h>

#include <vector>

#include "standoff/collision.h"

namespace standoff::testing {

inline void expect_same(const CollisionResult& a, const CollisionResult& b) {
  EXPECT_EQ(a.verdict, b.verdict);
  EXPECT_EQ(a.triangle_a, b.triangle_a);
  EXPECT_EQ(a.triangle_b, b.triangle_b);
  EXPECT_EQ(a.containment, b.containment);
}

inline void expect_same(const DistanceResult& a, const DistanceResult& b) {
  EXPECT_EQ(a.lower, b.lower);
  EXPECT_EQ(a.upper, b.upper);
  EXPECT_EQ(a.point_a, b.point_a);
  EXPECT_EQ(a.point_b, b.point_b);
  EXPECT_EQ(a.triangle_a, b.triangle_a);
  EXPECT_EQ(a.triangle_b, b.triangle_b);
  EXPECT_EQ(a.finished, b.finished);
}

inline void expect_same(const ContactResult& a, const ContactResult& b) {
  EXPECT_EQ(a.overflow, b.overflow);
  ASSERT_EQ(a.contacts.size(), b.contacts.size());
  for (std::size_t k = 0; k < a.contacts.size(); ++k) {
    EXPECT_EQ(a.contacts[k].point, b.contacts[k].point);
    EXPECT_EQ(a.contacts[k].normal, b.contacts[k].normal);
    EXPECT_EQ(a.contacts[k].depth, b.contacts[k].depth);
    EXPECT_EQ(a.contacts[k].triangle_a, b.contacts[k].triangle_a);
    EXPECT_EQ(a.contacts[k].triangle_b, b.contacts[k].triangle_b);
  }
}

inline void expect_same(const SweepResult& a, const SweepResult& b) {
  EXPECT_EQ(a.hit, b.hit);
  EXPECT_EQ(a.time, b.time);
  EXPECT_EQ(a.finished, b.finished);
  EXPECT_EQ(a.point, b.point);
  EXPECT_EQ(a.normal, b.normal);
  EXPECT_EQ(a.triangle_a, b.triangle_a);
  EXPECT_EQ(a.triangle_b, b.triangle_b);
}

template <class Result>
void expect_same(const std::vector<Result>& a, const std::vector<Result>& b) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t n = 0; n < a.size(); ++n) expect_same(a[n], b[n]);
}

}  // namespace standoff::testing
