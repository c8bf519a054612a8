// The kernel that decides pairs of triangles, included after kernels_body.h: Guigue and Devillers, Fast and robust
// triangle-triangle overlap test using orientation predicates (2003), eight pairs at a time.
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

using Eight = double __attribute__((vector_size(8 * kPairs)));
using EightInts = std::int64_t __attribute__((vector_size(8 * kPairs)));
struct Points {
  Eight x, y, z;
};

inline Eight least(const Eight& a, const Eight& b) { return a < b ? a : b; }
inline Eight most(const Eight& a, const Eight& b) { return a > b ? a : b; }
inline Points operator-(const Points& a, const Points& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
inline Points operator+(const Points& a, const Points& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
inline Points operator*(const Points& a, const Eight& s) { return {a.x * s, a.y * s, a.z * s}; }
inline Eight dot(const Points& a, const Points& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
inline Points cross(const Points& a, const Points& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
inline Eight choose(const EightInts& which, const Eight& yes, const Eight& no) { return which ? yes : no; }
inline Points choose(const EightInts& which, const Points& yes, const Points& no) {
  return {which ? yes.x : no.x, which ? yes.y : no.y, which ? yes.z : no.z};
}
inline std::uint32_t bits_of(const EightInts& flags) {
#if defined(__AVX512F__)
  return _mm512_movepi64_mask(reinterpret_cast<__m512i>(flags));
#else
  std::uint32_t bits = 0;
  for (int n = 0; n < kPairs; ++n) bits |= static_cast<std::uint32_t>(flags[n] & 1) << n;
  return bits;
#endif
}
inline Points load(const double (&corner)[3][kPairs]) {
  const auto eight = [](const double* from) { return *reinterpret_cast<const Eight*>(from); };
  return {eight(corner[0]), eight(corner[1]), eight(corner[2])};
}
inline Eight sqrt(const Eight& value) {
  Eight root;
  for (int n = 0; n < kPairs; ++n) root[n] = __builtin_sqrt(value[n]);
  return root;
}
inline void store(const Eight& value, double* to) { *reinterpret_cast<Eight*>(to) = value; }

// In the order of apply() for poses, so that all answers are about the same corners.
inline Points placed(const DoublePlace* place, const Points& at) {
  if (!place) return at;
  const double *r = place->rotation, *t = place->translation;
  return {r[0] * at.x + r[1] * at.y + r[2] * at.z + t[0], r[3] * at.x + r[4] * at.y + r[5] * at.z + t[1],
          r[6] * at.x + r[7] * at.y + r[8] * at.z + t[2]};
}

inline Eight extent(const Eight& a, const Eight& b, const Eight& c, const Eight& d, const Eight& e, const Eight& f) {
  return most(most(a, most(b, c)), most(d, most(e, f))) - least(least(a, least(b, c)), least(d, least(e, f)));
}

// Signs of three numbers, as far as they are beyond the bound.
struct Signs {
  EightInts positive, negative;
};
inline Signs signs(const Eight& value, const Eight& bound) { return {value > bound, value < -bound}; }

// A triangle against the other's plane, turned so that its first corner is alone on its side.
struct Turned {
  Points corner[3];
  Eight height[3];
  EightInts sure, apart;  // all sides are certain; all corners are on one side
};
inline Turned turn(const Points (&corner)[3], const Eight (&height)[3], const Eight& bound) {
  const Signs s[3] = {signs(height[0], bound), signs(height[1], bound), signs(height[2], bound)};
  Turned t;
  t.sure = (s[0].positive | s[0].negative) & (s[1].positive | s[1].negative) & (s[2].positive | s[2].negative);
  t.apart = (s[0].positive & s[1].positive & s[2].positive) | (s[0].negative & s[1].negative & s[2].negative);
  const EightInts first = ~(s[1].positive ^ s[2].positive), second = ~(s[0].positive ^ s[2].positive);
  for (int k = 0; k < 3; ++k) {
    const int next = (k + 1) % 3, last = (k + 2) % 3;
    t.corner[k] = choose(first, corner[k], choose(second, corner[next], corner[last]));
    t.height[k] = choose(first, height[k], choose(second, height[next], height[last]));
  }
  return t;
}

// Keeps the shallower of two ways out.
inline void lower(Eight& depth, Points& normal, const Eight& other, const Points& way) {
  const EightInts less = other < depth;
  depth = choose(less, other, depth);
  normal = choose(less, way, normal);
}

void meet(const TrianglePairs& pairs, const DoublePlace* place_p, const DoublePlace* place_q, Meetings& out) {
  Points p[3], q[3];
  for (int k = 0; k < 3; ++k) p[k] = placed(place_p, load(pairs.p[k])), q[k] = placed(place_q, load(pairs.q[k]));
  constexpr double kRounding = 6e-15, kUnderflow = 1e-290;
  const Eight bound = extent(p[0].x, p[1].x, p[2].x, q[0].x, q[1].x, q[2].x) *
                          extent(p[0].y, p[1].y, p[2].y, q[0].y, q[1].y, q[2].y) *
                          extent(p[0].z, p[1].z, p[2].z, q[0].z, q[1].z, q[2].z) * kRounding +
                      kUnderflow;
  const Points p_normal = cross(p[1] - p[0], p[2] - p[0]), q_normal = cross(q[1] - q[0], q[2] - q[0]);
  Eight p_height[3], q_height[3];
  for (int k = 0; k < 3; ++k) p_height[k] = dot(q_normal, p[k] - q[0]), q_height[k] = dot(p_normal, q[k] - p[0]);
  const Turned a = turn(p, p_height, bound), b = turn(q, q_height, bound);

  // Positions relative to a0: which of a's points on the common line come before which of b's?
  const Points a1 = a.corner[1] - a.corner[0], a2 = a.corner[2] - a.corner[0];
  const Points b0 = b.corner[0] - a.corner[0], b1 = b.corner[1] - a.corner[0], b2 = b.corner[2] - a.corner[0];
  const Points m1 = cross(b0, b1), m2 = cross(b0, b2);
  const Signs order[4] = {signs(dot(a1, m1), bound), signs(dot(a1, m2), bound), signs(dot(a2, m1), bound),
                          signs(dot(a2, m2), bound)};
  const EightInts before = order[0].positive | order[1].positive | order[2].positive | order[3].positive;
  const EightInts after = order[0].negative | order[1].negative | order[2].negative | order[3].negative;
  const EightInts all_before = order[0].positive & order[1].positive & order[2].positive & order[3].positive;
  const EightInts all_after = order[0].negative & order[1].negative & order[2].negative & order[3].negative;
  const EightInts sure = a.sure & b.sure;
  const EightInts apart = a.apart | b.apart | (sure & (all_before | all_after)), touch = sure & ~apart & before & after;
  out.touching = bits_of(touch);
  out.unsure = bits_of(~(apart | touch));
  if (out.touching == 0) return;

  // The segment both share lies between the second and the third of the four points.
  const Points along = cross(p_normal, q_normal);
  Points at[4] = {a1 * (a.height[0] / (a.height[0] - a.height[1])), a2 * (a.height[0] / (a.height[0] - a.height[2])),
                  b0 + (b1 - b0) * (b.height[0] / (b.height[0] - b.height[1])),
                  b0 + (b2 - b0) * (b.height[0] / (b.height[0] - b.height[2]))};
  Eight place[4] = {dot(along, at[0]), dot(along, at[1]), dot(along, at[2]), dot(along, at[3])};
  const auto ordered = [&](int i, int j) {
    const EightInts swap = place[i] > place[j];
    const Points low = choose(swap, at[j], at[i]), high = choose(swap, at[i], at[j]);
    const Eight least_place = choose(swap, place[j], place[i]), most_place = choose(swap, place[i], place[j]);
    at[i] = low, at[j] = high, place[i] = least_place, place[j] = most_place;
  };
  ordered(0, 1);
  ordered(2, 3);
  ordered(0, 2);  // now 2 is the later of the first ones
  ordered(1, 3);  // and 1 the earlier of the last ones
  const Points point = a.corner[0] + (at[1] + at[2]) * (Eight{} + 0.5);

  // Along p's normal p itself is flat, and so is q along its own: the way out is how far the other reaches.
  const Eight p_size = 1 / sqrt(dot(p_normal, p_normal)), q_size = 1 / sqrt(dot(q_normal, q_normal));
  const Points p_unit = p_normal * p_size, q_unit = q_normal * q_size;
  const auto highest = [](const Eight(&h)[3]) { return most(h[0], most(h[1], h[2])); };
  const auto lowest = [](const Eight(&h)[3]) { return least(h[0], least(h[1], h[2])); };
  Eight depth = -lowest(q_height) * p_size;
  Points normal = p_unit;
  lower(depth, normal, highest(q_height) * p_size, p_unit * (Eight{} - 1));
  lower(depth, normal, highest(p_height) * q_size, q_unit);
  lower(depth, normal, -lowest(p_height) * q_size, q_unit * (Eight{} - 1));

  store(point.x, out.point[0]), store(point.y, out.point[1]), store(point.z, out.point[2]);
  store(normal.x, out.normal[0]), store(normal.y, out.normal[1]), store(normal.z, out.normal[2]);
  store(depth, out.depth);
}
