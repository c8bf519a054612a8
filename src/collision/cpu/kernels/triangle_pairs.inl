// The kernels for pairs of triangles, eight at a time, included after close_triangles.inl: meeting.h, crossing.h and
// closest_pair.h for eight doubles.

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

void meet(const TrianglePairs& pairs, const DoublePlace* place_p, const DoublePlace* place_q, Meetings& out) {
  const EightPairs pair = placed(pairs, place_p, place_q);
  const Meeting<Eight> m = meeting(pair.p, pair.q);
  out.touching = bits_of(m.touch);
  out.unsure = bits_of(m.unsure);
  out.inaccurate = 0;
  if (out.touching == 0) return;
  const Crossing<Eight> c = crossing(m, pair.p, pair.q);
  out.inaccurate = out.touching & ~bits_of(c.accurate);
  store(c.point, out.point);
  store(c.normal, out.normal);
  c.depth.store(out.depth);
}

void closest(const TrianglePairs& pairs, const DoublePlace* place_p, const DoublePlace* place_q, ClosestOfPairs& out) {
  const EightPairs pair = placed(pairs, place_p, place_q);
  const PairPoints<Eight> found = closest_pair(pair.p, pair.q);
  found.distance_sq.store(out.distance_sq);
  store(found.on_p, out.on_p);
  store(found.on_q, out.on_q);
}
