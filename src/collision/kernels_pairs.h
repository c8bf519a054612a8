// The kernels for pairs of triangles, eight at a time, included after kernels_body.h.
//
// Whether they touch: Guigue and Devillers, Fast and robust triangle-triangle overlap test using orientation predicates
// (2003).
//
// Triangles whose corners are not all on one side of the other's plane both cross the line in which the planes meet.
// Let a0 be the corner of p that is alone on its side of q's plane: the edges a0 a1 and a0 a2 pass the line at two
// points, and so do b0 b1 and b0 b2. The triangles touch unless both points of one come before both of the other. Which
// of two points comes first is the sign of det(a_i - a0, b0 - a0, b_j - a0): with a0 = A - s u and b0 = B - t w, u and
// w the edges' directions and A and B the points, it is (u x w).(A - B) or its negative, and since both edges from a0
// pass to the same side, and those from b0, that has one sign for all four.
//
// Determinants are wrong by 7e-16 times the sum of their products' magnitudes at the most (Shewchuk's first stage), of
// which there are six, none larger than the product of the extents. What lies within that is left to others.

// Eight doubles, and eight answers: what geometry's templates need of a number.
struct EightFlags {
  using Flags = std::int64_t __attribute__((vector_size(8 * kPairs)));
  Flags all;
  friend EightFlags operator&(const EightFlags& a, const EightFlags& b) { return {a.all & b.all}; }
  friend EightFlags operator|(const EightFlags& a, const EightFlags& b) { return {a.all | b.all}; }
  friend EightFlags operator^(const EightFlags& a, const EightFlags& b) { return {a.all ^ b.all}; }
  friend EightFlags operator~(const EightFlags& a) { return {~a.all}; }
};
struct Eight {
  using Doubles = double __attribute__((vector_size(8 * kPairs)));
  Doubles all;
  Eight() = default;
  explicit Eight(double value) : all(Doubles{} + value) {}
  explicit Eight(const Doubles& values) : all(values) {}
  static Eight load(const double* from) { return Eight(*reinterpret_cast<const Doubles*>(from)); }
  void store(double* to) const { *reinterpret_cast<Doubles*>(to) = all; }
  friend Eight operator+(const Eight& a, const Eight& b) { return Eight(a.all + b.all); }
  friend Eight operator-(const Eight& a, const Eight& b) { return Eight(a.all - b.all); }
  friend Eight operator*(const Eight& a, const Eight& b) { return Eight(a.all * b.all); }
  friend Eight operator/(const Eight& a, const Eight& b) { return Eight(a.all / b.all); }
  friend Eight operator-(const Eight& a) { return Eight(-a.all); }
  friend EightFlags less(const Eight& a, const Eight& b) { return {a.all < b.all}; }
  friend Eight select(const EightFlags& which, const Eight& yes, const Eight& no) {
    return Eight(which.all ? yes.all : no.all);
  }
  friend Eight min(const Eight& a, const Eight& b) { return Eight(a.all < b.all ? a.all : b.all); }
  friend Eight max(const Eight& a, const Eight& b) { return Eight(a.all > b.all ? a.all : b.all); }
  friend Eight sqrt(const Eight& a) {
    Eight root;
    for (int n = 0; n < kPairs; ++n) root.all[n] = __builtin_sqrt(a.all[n]);
    return root;
  }
};
using Points = Triple<Eight>;

inline std::uint32_t bits_of(const EightFlags& flags) {
#if defined(__AVX512F__)
  return _mm512_movepi64_mask(reinterpret_cast<__m512i>(flags.all));
#else
  std::uint32_t bits = 0;
  for (int n = 0; n < kPairs; ++n) bits |= static_cast<std::uint32_t>(flags.all[n] & 1) << n;
  return bits;
#endif
}
inline Points load(const double (&corner)[3][kPairs]) {
  return {Eight::load(corner[0]), Eight::load(corner[1]), Eight::load(corner[2])};
}
inline void store(const Points& points, double (&to)[3][kPairs]) {
  points.x.store(to[0]), points.y.store(to[1]), points.z.store(to[2]);
}

// In the order of apply() for poses, so that all answers are about the same corners.
inline Points placed(const DoublePlace* place, const Points& at) {
  if (!place) return at;
  const auto row = [&](int n) {
    const double* r = place->rotation + 3 * n;
    return Eight(r[0]) * at.x + Eight(r[1]) * at.y + Eight(r[2]) * at.z + Eight(place->translation[n]);
  };
  return {row(0), row(1), row(2)};
}

struct EightPairs {
  Points p[3], q[3];
};
inline EightPairs placed(const TrianglePairs& pairs, const DoublePlace* place_p, const DoublePlace* place_q) {
  EightPairs result;
  for (int k = 0; k < 3; ++k)
    result.p[k] = placed(place_p, load(pairs.p[k])), result.q[k] = placed(place_q, load(pairs.q[k]));
  return result;
}

// How far the corners of a pair are apart along an axis.
inline Eight extent(const EightPairs& pair, Eight Points::*axis) {
  const auto *p = pair.p, *q = pair.q;
  return max(max(p[0].*axis, max(p[1].*axis, p[2].*axis)), max(q[0].*axis, max(q[1].*axis, q[2].*axis))) -
         min(min(p[0].*axis, min(p[1].*axis, p[2].*axis)), min(q[0].*axis, min(q[1].*axis, q[2].*axis)));
}

// Signs of three numbers, as far as they are beyond the bound.
struct Signs {
  EightFlags positive, negative;
};
inline Signs signs(const Eight& value, const Eight& bound) { return {less(bound, value), less(value, -bound)}; }

// A triangle against the other's plane, turned so that its first corner is alone on its side.
struct Turned {
  Points corner[3];
  Eight height[3];
  EightFlags sure, apart;  // all sides are certain; all corners are on one side
};
inline Turned turn(const Points (&corner)[3], const Eight (&height)[3], const Eight& bound) {
  const Signs s[3] = {signs(height[0], bound), signs(height[1], bound), signs(height[2], bound)};
  Turned t;
  t.sure = (s[0].positive | s[0].negative) & (s[1].positive | s[1].negative) & (s[2].positive | s[2].negative);
  t.apart = (s[0].positive & s[1].positive & s[2].positive) | (s[0].negative & s[1].negative & s[2].negative);
  const EightFlags first = ~(s[1].positive ^ s[2].positive), second = ~(s[0].positive ^ s[2].positive);
  for (int k = 0; k < 3; ++k) {
    const int next = (k + 1) % 3, last = (k + 2) % 3;
    t.corner[k] = select(first, corner[k], select(second, corner[next], corner[last]));
    t.height[k] = select(first, height[k], select(second, height[next], height[last]));
  }
  return t;
}

// Keeps the shallower of two ways out.
inline void lower(Eight& depth, Points& normal, const Eight& other, const Points& way) {
  const EightFlags shallower = less(other, depth);
  depth = select(shallower, other, depth);
  normal = select(shallower, way, normal);
}

void meet(const TrianglePairs& pairs, const DoublePlace* place_p, const DoublePlace* place_q, Meetings& out) {
  const EightPairs pair = placed(pairs, place_p, place_q);
  const auto &p = pair.p, &q = pair.q;
  constexpr double kRounding = 6e-15, kUnderflow = 1e-290;
  const Eight bound =
      extent(pair, &Points::x) * extent(pair, &Points::y) * extent(pair, &Points::z) * Eight(kRounding) +
      Eight(kUnderflow);
  const Points p_normal = plain_cross(p[1] - p[0], p[2] - p[0]), q_normal = plain_cross(q[1] - q[0], q[2] - q[0]);
  Eight p_height[3], q_height[3];
  for (int k = 0; k < 3; ++k)
    p_height[k] = plain_dot(q_normal, p[k] - q[0]), q_height[k] = plain_dot(p_normal, q[k] - p[0]);
  const Turned a = turn(p, p_height, bound), b = turn(q, q_height, bound);

  // Positions relative to a0: which of a's points on the common line come before which of b's?
  const Points a1 = a.corner[1] - a.corner[0], a2 = a.corner[2] - a.corner[0];
  const Points b0 = b.corner[0] - a.corner[0], b1 = b.corner[1] - a.corner[0], b2 = b.corner[2] - a.corner[0];
  const Points m1 = plain_cross(b0, b1), m2 = plain_cross(b0, b2);
  const Signs order[4] = {signs(plain_dot(a1, m1), bound), signs(plain_dot(a1, m2), bound),
                          signs(plain_dot(a2, m1), bound), signs(plain_dot(a2, m2), bound)};
  const EightFlags before = order[0].positive | order[1].positive | order[2].positive | order[3].positive;
  const EightFlags after = order[0].negative | order[1].negative | order[2].negative | order[3].negative;
  const EightFlags all_before = order[0].positive & order[1].positive & order[2].positive & order[3].positive;
  const EightFlags all_after = order[0].negative & order[1].negative & order[2].negative & order[3].negative;
  const EightFlags sure = a.sure & b.sure;
  const EightFlags apart = a.apart | b.apart | (sure & (all_before | all_after)),
                   touch = sure & ~apart & before & after;
  out.touching = bits_of(touch);
  out.unsure = bits_of(~(apart | touch));
  if (out.touching == 0) return;

  // The segment both share lies between the second and the third of the four points.
  const Points along = plain_cross(p_normal, q_normal);
  Points at[4] = {a1 * (a.height[0] / (a.height[0] - a.height[1])), a2 * (a.height[0] / (a.height[0] - a.height[2])),
                  b0 + (b1 - b0) * (b.height[0] / (b.height[0] - b.height[1])),
                  b0 + (b2 - b0) * (b.height[0] / (b.height[0] - b.height[2]))};
  Eight place[4] = {plain_dot(along, at[0]), plain_dot(along, at[1]), plain_dot(along, at[2]), plain_dot(along, at[3])};
  const auto ordered = [&](int i, int j) {
    const EightFlags swap = less(place[j], place[i]);
    const Points low = select(swap, at[j], at[i]), high = select(swap, at[i], at[j]);
    const Eight least_place = select(swap, place[j], place[i]), most_place = select(swap, place[i], place[j]);
    at[i] = low, at[j] = high, place[i] = least_place, place[j] = most_place;
  };
  ordered(0, 1);
  ordered(2, 3);
  ordered(0, 2);  // now 2 is the later of the first ones
  ordered(1, 3);  // and 1 the earlier of the last ones
  const Points point = a.corner[0] + (at[1] + at[2]) * Eight(0.5);

  // Along p's normal p itself is flat, and so is q along its own: the way out is how far the other reaches.
  const Eight p_size = Eight(1) / sqrt(plain_dot(p_normal, p_normal)),
              q_size = Eight(1) / sqrt(plain_dot(q_normal, q_normal));
  const Points p_unit = p_normal * p_size, q_unit = q_normal * q_size;
  const auto highest = [](const Eight(&h)[3]) { return max(h[0], max(h[1], h[2])); };
  const auto lowest = [](const Eight(&h)[3]) { return min(h[0], min(h[1], h[2])); };
  Eight depth = -lowest(q_height) * p_size;
  Points normal = p_unit;
  lower(depth, normal, highest(q_height) * p_size, p_unit * Eight(-1));
  lower(depth, normal, highest(p_height) * q_size, q_unit);
  lower(depth, normal, -lowest(p_height) * q_size, q_unit * Eight(-1));

  store(point, out.point);
  store(normal, out.normal);
  depth.store(out.depth);
}

void closest(const TrianglePairs& pairs, const DoublePlace* place_p, const DoublePlace* place_q, ClosestOfPairs& out) {
  const EightPairs pair = placed(pairs, place_p, place_q);
  const PairPoints<Eight> found = closest_pair(pair.p, pair.q);
  found.distance_sq.store(out.distance_sq);
  store(found.on_p, out.on_p);
  store(found.on_q, out.on_q);
}
