// The kernels for pairs of triangles, eight at a time, included after kernels_body.h: triangle_overlap.h, crossing.h
// and closest_pair.h for eight doubles.

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
inline EightPairs transformed(const TrianglePairs& pairs, const DoubleTransform* transform_p,
                              const DoubleTransform* transform_q) {
  EightPairs result;
  for (int k = 0; k < 3; ++k) {
    result.p[k] = load(pairs.p[k]), result.q[k] = load(pairs.q[k]);
    if (transform_p) result.p[k] = transformed(*transform_p, result.p[k]);
    if (transform_q) result.q[k] = transformed(*transform_q, result.q[k]);
  }
  return result;
}

void overlap_pairs(const TrianglePairs& pairs, const DoubleTransform* transform_p, const DoubleTransform* transform_q,
                   PairOverlaps& out) {
  const EightPairs pair = transformed(pairs, transform_p, transform_q);
  const TriangleOverlap<Eight> m = triangle_overlap(pair.p, pair.q);
  out.intersecting = bits_of(m.intersecting);
  out.unsure = bits_of(m.unsure);
  out.inaccurate = 0;
  if (out.intersecting == 0) return;
  const OverlapPenetration<Eight> c = penetration(m, pair.p, pair.q);
  out.inaccurate = out.intersecting & ~bits_of(c.accurate);
  store(c.point, out.point);
  store(c.normal, out.normal);
  c.depth.store(out.depth);
}

void closest(const TrianglePairs& pairs, const DoubleTransform* transform_p, const DoubleTransform* transform_q,
             ClosestOfPairs& out) {
  const EightPairs pair = transformed(pairs, transform_p, transform_q);
  const PairPoints<Eight> found = closest_pair(pair.p, pair.q);
  found.distance_sq.store(out.distance_sq);
  store(found.on_p, out.on_p);
  store(found.on_q, out.on_q);
}
