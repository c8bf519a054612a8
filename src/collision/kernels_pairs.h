// The kernels for pairs of triangles, eight at a time, included after kernels_body.h: meeting.h and closest_pair.h for
// eight doubles.

// Eight doubles, and eight answers: what geometry's templates need of a number.
struct EightFlags {
  using Flags = std::int64_t __attribute__((vector_size(8 * kPairs)));
  Flags all;
  friend EightFlags operator&(const EightFlags& a, const EightFlags& b) { return {a.all & b.all}; }
  friend EightFlags operator|(const EightFlags& a, const EightFlags& b) { return {a.all | b.all}; }
  friend EightFlags operator^(const EightFlags& a, const EightFlags& b) { return {a.all ^ b.all}; }
  friend EightFlags negated(const EightFlags& a) { return {~a.all}; }
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

struct EightPairs {
  Points p[3], q[3];
};
inline EightPairs placed(const TrianglePairs& pairs, const DoublePlace* place_p, const DoublePlace* place_q) {
  EightPairs result;
  for (int k = 0; k < 3; ++k) {
    result.p[k] = load(pairs.p[k]), result.q[k] = load(pairs.q[k]);
    if (place_p) result.p[k] = placed(*place_p, result.p[k]);
    if (place_q) result.q[k] = placed(*place_q, result.q[k]);
  }
  return result;
}

// Keeps the shallower of two ways out.
inline void lower(Eight& depth, Points& normal, const Eight& other, const Points& way) {
  const EightFlags shallower = less(other, depth);
  depth = select(shallower, other, depth);
  normal = select(shallower, way, normal);
}

// Below this a normal, in terms of the two edges it is made of, or the angle at which an edge passes through a plane,
// has lost so much to rounding that the place of a contact errs by more than 1e-9 of the pair's extent: by 8 roundings
// of it, each magnified by one over the normal's size, and again by one over the angle.
constexpr double kBlunt = 1e-3;

// The numbers of these pairs are right: no triangle is a sliver, and no edge grazes the other's plane.
inline EightFlags distinct(const Meeting<Eight>& m, const EightPairs& pair) {
  const Eight p_normal_sq = plain_dot(m.p_normal, m.p_normal), q_normal_sq = plain_dot(m.q_normal, m.q_normal),
              blunt_sq(kBlunt * kBlunt);
  const auto squared = [](const Points& v) { return plain_dot(v, v); };
  const auto fat = [&](const Points(&t)[3], const Eight& normal_sq) {
    return less(blunt_sq * squared(t[1] - t[0]) * squared(t[2] - t[0]), normal_sq);
  };
  const auto steep = [&](const Eight& from, const Eight& to, const Points& edge, const Eight& normal_sq) {
    const Eight drop = from - to;
    return less(blunt_sq * squared(edge) * normal_sq, drop * drop);
  };
  return fat(pair.p, p_normal_sq) & fat(pair.q, q_normal_sq) & steep(m.a.height[0], m.a.height[1], m.a1, q_normal_sq) &
         steep(m.a.height[0], m.a.height[2], m.a2, q_normal_sq) &
         steep(m.b.height[0], m.b.height[1], m.b1 - m.b0, p_normal_sq) &
         steep(m.b.height[0], m.b.height[2], m.b2 - m.b0, p_normal_sq);
}

void meet(const TrianglePairs& pairs, const DoublePlace* place_p, const DoublePlace* place_q, Meetings& out) {
  const EightPairs pair = placed(pairs, place_p, place_q);
  const Meeting<Eight> m = meeting(pair.p, pair.q);
  out.touching = bits_of(m.touch);
  out.unsure = bits_of(m.unsure);
  out.rough = 0;
  if (out.touching == 0) return;
  out.rough = out.touching & ~bits_of(distinct(m, pair));

  // The segment both share lies between the second and the third of the four points.
  const Points along = plain_cross(m.p_normal, m.q_normal);
  Points at[4] = {m.a1 * (m.a.height[0] / (m.a.height[0] - m.a.height[1])),
                  m.a2 * (m.a.height[0] / (m.a.height[0] - m.a.height[2])),
                  m.b0 + (m.b1 - m.b0) * (m.b.height[0] / (m.b.height[0] - m.b.height[1])),
                  m.b0 + (m.b2 - m.b0) * (m.b.height[0] / (m.b.height[0] - m.b.height[2]))};
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
  const Points point = m.a.corner[0] + (at[1] + at[2]) * Eight(0.5);

  // Along p's normal p itself is flat, and so is q along its own: the way out is how far the other reaches.
  const Eight p_size = Eight(1) / sqrt(plain_dot(m.p_normal, m.p_normal)),
              q_size = Eight(1) / sqrt(plain_dot(m.q_normal, m.q_normal));
  const Points p_unit = m.p_normal * p_size, q_unit = m.q_normal * q_size;
  const auto highest = [](const Eight(&h)[3]) { return max(h[0], max(h[1], h[2])); };
  const auto lowest = [](const Eight(&h)[3]) { return min(h[0], min(h[1], h[2])); };
  Eight depth = -lowest(m.q_height) * p_size;
  Points normal = p_unit;
  lower(depth, normal, highest(m.q_height) * p_size, p_unit * Eight(-1));
  lower(depth, normal, highest(m.p_height) * q_size, q_unit);
  lower(depth, normal, -lowest(m.p_height) * q_size, q_unit * Eight(-1));

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
