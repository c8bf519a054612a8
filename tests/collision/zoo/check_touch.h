// SPDX-License-Identifier: Apache-2.0
// collide() and contacts() of one pose, against what is true.
#pragma once

#include "tests/collision/zoo/findings.h"
#include "tests/collision/zoo/placed_pair.h"
#include "tests/collision/zoo/tolerances.h"

namespace standoff::testing {

inline void check_collide(const PlacedPair& at, Findings& found) {
  const CollisionResult answer = collide(at.model_a, at.pose_a, at.model_b, at.pose_b),
                        turned = collide(at.model_b, at.pose_b, at.model_a, at.pose_a);
  found.count("poses");
  found.count("poses that touch", at.touch());
  found.expect(answer.hit() || !at.touch(), "collide: free, but they touch");
  found.expect(!answer.hit() || at.touch(), "collide: hit, but they do not touch");
  found.expect(answer.hit() == turned.hit(), "collide: another answer with a and b swapped");
  const auto named = [&](std::uint32_t s, std::uint32_t t) { return touch(at.a.triangle(s), at.b.triangle(t)); };
  if (at.touch() && answer.hit())
    found.expect(named(answer.triangle_a, answer.triangle_b), "collide: the triangles it names do not touch");
  if (at.touch() && turned.hit())
    found.expect(named(turned.triangle_b, turned.triangle_a), "collide: the triangles it names do not touch");
}

inline void check_certified(const PlacedPair& at, double margin, Findings& found) {
  const CollideOptions options{.margin = margin, .mode = CollideMode::certified};
  const Verdict answer = collide(at.model_a, at.pose_a, at.model_b, at.pose_b, options).verdict;
  found.count("certified answers");
  found.count("certified free", answer == Verdict::free);
  const double slack = margin > 0 ? at.allowed.distance() : 0;
  if (answer == Verdict::free)
    found.expect(!at.touch() && (margin == 0 || at.distance() > margin - slack), "certified: free, but they are not");
  if (answer == Verdict::hit)
    found.expect(margin > 0 && at.distance() <= margin + slack, "certified: hit, but they are not within the margin");
}

/// With a margin near which the distance is not.
inline void check_margin(const PlacedPair& at, double margin, Findings& found) {
  const double slack = at.allowed.distance();
  if (std::abs(at.distance() - margin) <= slack) return;
  const bool expected = at.distance() <= margin;
  found.count("margins");
  const CollideOptions options{.margin = margin};
  const bool answer = collide(at.model_a, at.pose_a, at.model_b, at.pose_b, options).hit(),
             turned = collide(at.model_b, at.pose_b, at.model_a, at.pose_a, options).hit();
  found.expect(answer || !expected,
               at.touch() ? "margin: free, but they touch" : "margin: free, but they are within it");
  found.expect(!answer || expected, "margin: hit, but they are not within it");
  found.expect(answer == turned, "margin: another answer with a and b swapped");
}

inline Corners moved_by(const Corners& t, Vec3 by) { return {t[0] + by, t[1] + by, t[2] + by}; }

/// A contact of two triangles that touch: its point is on both, and they part along its normal.
inline void check_contact(const PlacedPair& at, const ContactPoint& it, Findings& found) {
  const Corners &p = at.a.triangle(it.triangle_a), &q = at.b.triangle(it.triangle_b);
  const Allowed allowed(p, q);
  found.count("contacts");
  found.off("contacts: length of a normal", std::abs(length(it.normal) - 1), kUnitLengthOff);
  found.expect(it.depth >= 0 && it.depth <= 2 * allowed.extent, "contacts: a depth below 0 or past both triangles");
  const auto from = [&](const Corners& t) { return root_of(point_triangle_sq(it.point, t)); };
  found.off("contacts: a point from its triangles", std::max(from(p), from(q)), allowed.contact());
  // How far beyond the depth it takes, by powers of two.
  double share = 0x1p-30;
  while (share < 0x1p30 && touch(p, moved_by(q, it.normal * (it.depth + share * allowed.contact())))) share *= 2;
  found.off("contacts: beyond the depth, until a pair is apart", share * allowed.contact(), allowed.contact());
}

inline TrianglePairs sorted_pairs(const ContactResult& found, bool turned) {
  TrianglePairs pairs;
  for (const ContactPoint& it : found.contacts)
    pairs.emplace_back(turned ? it.triangle_b : it.triangle_a, turned ? it.triangle_a : it.triangle_b);
  std::sort(pairs.begin(), pairs.end());
  return pairs;
}

/// How many pairs of `some` the others lack.
inline long lacking(const TrianglePairs& some, const TrianglePairs& others) {
  TrianglePairs rest;
  std::set_difference(some.begin(), some.end(), others.begin(), others.end(), std::back_inserter(rest));
  return static_cast<long>(rest.size());
}

/// With room for half of them: so many, all of them true, none twice.
inline void check_half_of_contacts(const PlacedPair& at, Findings& found) {
  const std::size_t half = at.touching.size() / 2;
  if (half == 0) return;
  const ContactOptions options{.most = static_cast<std::int64_t>(half)};
  const ContactResult answer = contacts(at.model_a, at.pose_a, at.model_b, at.pose_b, options);
  const TrianglePairs pairs = sorted_pairs(answer, false);
  found.count("contacts with too little room");
  found.expect(answer.overflow && pairs.size() == half, "contacts: no overflow, or not as many as there is room for");
  found.wrong("contacts: a pair is there that does not touch", lacking(pairs, at.touching));
  found.expect(std::adjacent_find(pairs.begin(), pairs.end()) == pairs.end(), "contacts: a pair comes twice");
}

inline void check_contacts(const PlacedPair& at, bool geometry, Findings& found) {
  const ContactOptions all{.most = 1'000'000};
  const ContactResult answer = contacts(at.model_a, at.pose_a, at.model_b, at.pose_b, all);
  const TrianglePairs pairs = sorted_pairs(answer, false),
                      turned = sorted_pairs(contacts(at.model_b, at.pose_b, at.model_a, at.pose_a, all), true);
  found.count("pairs of triangles that touch", static_cast<long>(at.touching.size()));
  found.wrong("contacts: a pair that touches is not there", lacking(at.touching, pairs));
  found.wrong("contacts: a pair is there that does not touch", lacking(pairs, at.touching));
  found.expect(std::adjacent_find(pairs.begin(), pairs.end()) == pairs.end(), "contacts: a pair comes twice");
  found.wrong("contacts: others with a and b swapped", lacking(pairs, turned) + lacking(turned, pairs));
  found.expect(!answer.overflow, "contacts: overflow, but there is room");
  check_half_of_contacts(at, found);
  if (!geometry) return;
  for (const ContactPoint& it : answer.contacts)
    if (touch(at.a.triangle(it.triangle_a), at.b.triangle(it.triangle_b))) check_contact(at, it, found);
}

/// Within a margin: all pairs nearer than it by more than rounding, none farther by more.
inline void check_contacts_within(const PlacedPair& at, double margin, Findings& found) {
  const ContactOptions all{.most = 1'000'000, .margin = margin};
  const ContactResult answer = contacts(at.model_a, at.pose_a, at.model_b, at.pose_b, all);
  const TrianglePairs pairs = sorted_pairs(answer, false),
                      turned = sorted_pairs(contacts(at.model_b, at.pose_b, at.model_a, at.pose_a, all), true);
  TrianglePairs least, most;
  const double slack = at.allowed.distance();
  for_close_boxes(at.a, at.b, margin + slack, [&](std::uint32_t s, std::uint32_t t) {
    const double apart = gap(at.a.triangle(s), at.b.triangle(t));
    if (apart <= margin + slack) most.emplace_back(s, t);
    if (apart > 0 && apart <= margin - slack) least.emplace_back(s, t);
  });
  std::sort(least.begin(), least.end());
  std::sort(most.begin(), most.end());
  found.count("pairs within a margin, and apart", static_cast<long>(least.size()));
  for (const TrianglePairs* some : {&pairs, &turned}) {
    found.wrong("contacts: with a margin, a pair that touches is not there", lacking(at.touching, *some));
    found.wrong("contacts: a pair within the margin is not there", lacking(least, *some));
    found.wrong("contacts: a pair beyond the margin is there", lacking(*some, most));
    found.expect(std::adjacent_find(some->begin(), some->end()) == some->end(), "contacts: a pair comes twice");
  }
  for (const ContactPoint& it : answer.contacts) {
    const Corners &p = at.a.triangle(it.triangle_a), &q = at.b.triangle(it.triangle_b);
    const double apart = gap(p, q);
    if (apart == 0) continue;
    const Allowed allowed(p, q);
    found.off("contacts: minus the depth of pairs apart", std::abs(apart + it.depth), allowed.distance());
    found.off("contacts: length of a normal", std::abs(length(it.normal) - 1), kUnitLengthOff);
    const double from = root_of(std::max(point_triangle_sq(it.point, p), point_triangle_sq(it.point, q)));
    found.off("contacts: a point from the middle of a gap", std::abs(from - apart / 2), allowed.point());
  }
}

}  // namespace standoff::testing
