// Sixteen columns in lockstep: the least over a column of v' + w (y - y')^2, exactly.
//
// The row y' that is nearest to y never decreases with y (Meijster, Roerdink and Hesselink 2000),
// so the nearest row of a middle bounds those of both halves: divide and conquer, with one range of
// rows for all sixteen columns. No stack of parabolas, no division, and no lane goes its own way;
// each level of the division looks at each row about once, and neighbouring columns seldom differ
// by more than a few rows.
#include "sdfgrid/transform/parabola_kernel.h"

#include "sdfgrid/core/simd.h"

namespace sdfgrid::SDFGRID_ISA {
namespace {

template <class Number>
struct LanesOf;
template <>
struct LanesOf<float> {
  using Type = F16;
};
template <>
struct LanesOf<std::int32_t> {
  using Type = I16;
};

constexpr int kLeaf = 4;  // rows between two known ones that need no range of their own

inline int lowest(I16 v) {
#if defined(__AVX512F__)
  return _mm512_reduce_min_epi32((__m512i)v);
#else
  int r = v[0];
  for (int i = 1; i < kLanes; ++i) r = v[i] < r ? v[i] : r;
  return r;
#endif
}
inline int highest(I16 v) { return -lowest(-v); }

// One side of sixteen columns.
template <class Number>
class Columns {
  using V = typename LanesOf<Number>::Type;

 public:
  Columns(const ParabolaPass<Number>& pass, const Number* in, Number* out, std::int32_t* range)
      : pass_(pass), in_(in), out_(out), first_(range), last_(range + pass.rows) {}

  void solve() {
    int begin = 0;
    int end = pass_.rows;
    const V far = splat(pass_.far);
    while (begin < end && all(row(begin) >= far)) ++begin;
    if (begin == end) {
      for (int y = 0; y < pass_.rows; ++y) put(y, far);
      return;
    }
    while (all(row(end - 1) >= far)) --end;
    if (pass_.windowed) {
      solve_directly(begin, end);
      return;
    }
    nearest(0, begin, end - 1);
    if (pass_.rows == 1) return;
    nearest(pass_.rows - 1, first_[0], end - 1);
    divide(0, pass_.rows - 1);
  }

 private:
  V row(int y) const { return load(in_ + kLanes * y); }
  void put(int y, V v) { store(out_ + kLanes * y, v); }

  // The least over rows [from, to] for row y, and the range of rows where the lanes attain it.
  void nearest(int y, int from, int to) {
    V best = row(y);
    if (all(best <= splat(Number{0}))) {
      put(y, best);
      first_[y] = last_[y] = y;
      return;
    }
    best = splat(pass_.far);
    I16 place = splat(from);
    I16 at = splat(from);
    const Number* square = pass_.square - y;
    for (int from_row = from; from_row <= to; ++from_row) {
      const V candidate = row(from_row) + splat(square[from_row]);
      const I16 nearer = candidate < best;
      best = min(best, candidate);
      place = select(nearer, at, place);
      at += splat(1);
    }
    put(y, best);
    // A column that is far at one row is far at all.
    const I16 found = best < splat(pass_.far);
    first_[y] = lowest(select(found, place, splat(to)));
    last_[y] = highest(select(found, place, splat(from)));
  }

  // The rows between two whose nearest rows are known.
  void divide(int low, int high) {
    const int between = high - low - 1;
    if (between <= 0) return;
    const int from = first_[low];
    const int to = last_[high];
    if (between < kLeaf) {
      leaf(low + 1, between, from, to);
      return;
    }
    const int middle = low + (high - low) / 2;
    nearest(middle, from, to);
    divide(low, middle);
    divide(middle, high);
  }

  // Up to three rows from y on, all with the same range.
  void leaf(int y, int count, int from, int to) {
    const V far = splat(pass_.far);
    V best0 = far;
    V best1 = far;
    V best2 = far;
    const Number* square = pass_.square - y;  // one row further is one square back
    for (int from_row = from; from_row <= to; ++from_row) {
      const V v = row(from_row);
      best0 = min(best0, v + splat(square[from_row]));
      best1 = min(best1, v + splat(square[from_row - 1]));
      best2 = min(best2, v + splat(square[from_row - 2]));
    }
    put(y, best0);
    if (count > 1) put(y + 1, best1);
    if (count > 2) put(y + 2, best2);
  }

  // Few rows are in reach: outwards from each, as long as they can be nearer. Rows outside
  // [begin, end) are far.
  void solve_directly(int begin, int end) {
    const V far = splat(pass_.far);
    int next = begin;  // the first row at or after y - reach that is not far
    for (int y = 0; y < pass_.rows; ++y) {
      while (next < end && (next < y - pass_.reach || all(row(next) >= far))) ++next;
      if (next > y + pass_.reach || next >= end) {
        put(y, far);
        continue;
      }
      V best = min(row(y), far);
      for (int d = 1; d <= pass_.reach; ++d) {
        const V apart = splat(pass_.square[d]);
        if (!any(best > apart)) break;
        if (y - d >= begin) best = min(best, row(y - d) + apart);
        if (y + d < end) best = min(best, row(y + d) + apart);
      }
      put(y, best);
    }
  }

  const ParabolaPass<Number>& pass_;
  const Number* in_;
  Number* out_;
  std::int32_t* first_;  // for each row that was asked for: its nearest rows
  std::int32_t* last_;
};

inline F16 as_float(F16 v) { return v; }
inline F16 as_float(I16 v) { return to_float(v); }

// The lanes of a group that it has, of sixteen.
template <class V, class Number>
V load_some(const Number* from, int lanes) {
  if (lanes >= kLanes) return load(from);
  V v = splat(Number{0});
  __builtin_memcpy(&v, from, sizeof(Number) * static_cast<std::size_t>(lanes));
  return v;
}
template <class V>
void store_some(void* to, int lanes, V v) {
  if (lanes >= kLanes) {
    __builtin_memcpy(to, &v, sizeof v);
  } else {
    __builtin_memcpy(to, &v, sizeof(std::int32_t) * static_cast<std::size_t>(lanes));
  }
}

// Groups of sixteen columns side by side, copied out of the volume together: its rows may be a
// power of two apart, so that they push each other out of the cache.
template <class Number>
class Block {
  using V = typename LanesOf<Number>::Type;

 public:
  Block(const ParabolaPass<Number>& pass, int lanes, const ParabolaScratch& scratch)
      : pass_(pass),
        lanes_(lanes),
        size_(static_cast<std::ptrdiff_t>(kLanes) * pass.rows),
        copy_(static_cast<Number*>(scratch.numbers)),
        side_(copy_ + kColumnGroups * size_),
        range_(scratch.range) {}

  void run(Number* columns) {
    if (lanes_ == kColumns) {
      gather<kColumnGroups>(columns);
    } else {
      gather<0>(columns);
    }
    for (int group = 0; group < groups(); ++group) solve(group);
    if (lanes_ == kColumns) {
      scatter<kColumnGroups>(columns);
    } else {
      scatter<0>(columns);
    }
  }

 private:
  [[nodiscard]] int groups() const {
    const int count = (lanes_ + kLanes - 1) / kLanes;
    return count < kColumnGroups ? count : kColumnGroups;
  }

  // kFull: the number of groups if all have sixteen columns, else 0.
  template <int kFull>
  void gather(const Number* columns) {
    V low[kColumnGroups];
    V high[kColumnGroups];
    for (int g = 0; g < kColumnGroups; ++g) low[g] = high[g] = splat(Number{0});
    const int count = kFull > 0 ? kFull : groups();
    for (int y = 0; y < pass_.rows; ++y) {
      const Number* from = columns + y * pass_.stride;
      Number* to = copy_ + static_cast<std::ptrdiff_t>(kLanes) * y;
#pragma GCC unroll 4
      for (int g = 0; g < kColumnGroups; ++g) {
        if (g >= count) break;
        const V v = kFull > 0 ? load(from + kLanes * g)
                              : load_some<V>(from + kLanes * g, lanes_ - kLanes * g);
        low[g] = min(low[g], v);
        high[g] = max(high[g], v);
        store(to + g * size_, v);
      }
    }
    for (int g = 0; g < kColumnGroups; ++g) {
      has_inside_[g] = any(low[g] < splat(Number{0}));
      has_outside_[g] = any(high[g] > splat(Number{0}));
    }
  }

  template <int kFull>
  void scatter(Number* columns) const {
    const int count = kFull > 0 ? kFull : groups();
    for (int y = 0; y < pass_.rows; ++y) {
      Number* to = columns + y * pass_.stride;
      const Number* from = copy_ + static_cast<std::ptrdiff_t>(kLanes) * y;
#pragma GCC unroll 4
      for (int g = 0; g < count; ++g) {
        const V v = load(from + g * size_);
        if (kFull > 0) {
          store(to + kLanes * g, v);
        } else {
          store_some(to + kLanes * g, lanes_ - kLanes * g, v);
        }
      }
    }
  }

  // From the copy into the copy, side by side.
  void solve(int group) {
    if (!has_outside_[group] && !has_inside_[group]) return;  // zero stays zero
    Number* copy = copy_ + group * size_;
    Number* outside = side_ + size_;
    Number* inside = side_ + 2 * size_;
    if (has_outside_[group]) {
      const Number* in = has_inside_[group] ? split(copy, splat(Number{1})) : copy;
      Columns<Number>(pass_, in, outside, range_).solve();
    }
    if (has_inside_[group]) {
      Columns<Number>(pass_, split(copy, splat(Number{-1})), inside, range_).solve();
    }
    merge(has_outside_[group] ? outside : nullptr, has_inside_[group] ? inside : nullptr, copy);
  }

  // The squares of one side, zero on the other.
  const Number* split(const Number* copy, V sign) {
    for (std::ptrdiff_t i = 0; i < size_; i += kLanes) {
      store(side_ + i, max(load(copy + i) * sign, splat(Number{0})));
    }
    return side_;
  }

  F16 finished(V square) const {
    const ParabolaFinish<Number>& finish = pass_.finish;
    const F16 distance = sqrt(as_float(square)) * finish.scale - finish.shift;
    const F16 cut = select(square >= splat(finish.limit), splat(finish.cut), distance);
    return select(square > splat(Number{0}), cut, splat(0.0F));
  }

  // Either side may be null, for all zero.
  void merge(const Number* outside, const Number* inside, Number* result) const {
    const V zero = splat(Number{0});
    for (std::ptrdiff_t i = 0; i < size_; i += kLanes) {
      const V out = outside != nullptr ? load(outside + i) : zero;
      const V in = inside != nullptr ? load(inside + i) : zero;
      if (pass_.finish.wanted) {
        const F16 v = finished(out) + finished(in) * pass_.finish.inside_sign;
        __builtin_memcpy(result + i, &v, sizeof v);
      } else {
        store(result + i, out - in);
      }
    }
  }

  const ParabolaPass<Number>& pass_;
  int lanes_;
  std::ptrdiff_t size_;  // numbers of a group
  Number* copy_;         // kColumnGroups groups
  Number* side_;         // one group, and one for the result of each side
  std::int32_t* range_;
  bool has_outside_[kColumnGroups];
  bool has_inside_[kColumnGroups];
};

template <class Number>
void columns(const ParabolaPass<Number>& pass, int lanes, void* data,
             const ParabolaScratch& scratch) {
  Block<Number>(pass, lanes, scratch).run(static_cast<Number*>(data));
}

inline I16 squared(I16 v, I16) { return v * v; }
inline F16 squared(I16 v, F16) { return to_float(v) * to_float(v); }

// Fills out[begin, end), a run of samples on one side, with squares to its ends; `sign` is +1
// outside, -1 inside, 0 for a side that is not wanted. Writes up to 15 numbers more.
template <class Number>
void fill_run(const ParabolaPass<Number>& pass, int begin, int end, bool open_begin, bool open_end,
              Number sign, Number* out) {
  using V = typename LanesOf<Number>::Type;
  static constexpr std::int32_t kCount[kLanes] = {0, 1, 2,  3,  4,  5,  6,  7,
                                                  8, 9, 10, 11, 12, 13, 14, 15};
  const Number unit = pass.square[1];
  if (sign == Number{0} || (open_begin && open_end)) {
    const Number v = sign == Number{0} ? sign : sign * pass.far;
    for (int k = begin; k < end; k += kLanes) store(out + k, splat(v));
    return;
  }
  // Steps to the sample before the run and to the one behind it; an open end is further than any.
  const std::int32_t before = open_begin ? -2 * pass.rows : begin - 1;
  const std::int32_t behind = open_end ? 3 * pass.rows : end;
  for (int k = begin; k < end; k += kLanes) {
    const I16 at = load(kCount) + splat(k);
    const I16 steps = min(min(at - splat(before), splat(behind) - at), splat(pass.reach + 1));
    const V square = squared(steps, V{}) * splat(unit);
    store(out + k, min(square, splat(pass.far)) * splat(sign));
  }
}

// The first index in [begin, count) where `inside` is on the other side of `side`; else count.
inline int run_end(const std::uint8_t* inside, int begin, int count, bool side) {
  int k = begin;
#if defined(__AVX2__)
  for (; k + 32 <= count; k += 32) {
    const __m256i v = _mm256_loadu_si256(reinterpret_cast<const __m256i*>(inside + k));
    const auto zeros = static_cast<std::uint32_t>(
        _mm256_movemask_epi8(_mm256_cmpeq_epi8(v, _mm256_setzero_si256())));
    const std::uint32_t other = side ? zeros : ~zeros;
    if (other != 0) return k + __builtin_ctz(other);
  }
#endif
  while (k < count && (inside[k] != 0) == side) ++k;
  return k;
}

template <class Number>
void row(const ParabolaPass<Number>& pass, const std::uint8_t* inside, Number* out) {
  const int count = pass.rows;
  const Number outside_sign{(static_cast<int>(pass.sides) & 1) != 0 ? Number{1} : Number{0}};
  const Number inside_sign{(static_cast<int>(pass.sides) & 2) != 0 ? Number{-1} : Number{0}};
  for (int begin = 0; begin < count;) {
    const bool side = inside[begin] != 0;
    const int end = run_end(inside, begin, count, side);
    fill_run(pass, begin, end, begin == 0, end == count, side ? inside_sign : outside_sign, out);
    begin = end;
  }
}

}  // namespace

extern const ParabolaKernel<float> kParabolaOfFloats;
const ParabolaKernel<float> kParabolaOfFloats = {row<float>, columns<float>};
extern const ParabolaKernel<std::int32_t> kParabolaOfInts;
const ParabolaKernel<std::int32_t> kParabolaOfInts = {row<std::int32_t>, columns<std::int32_t>};

}  // namespace sdfgrid::SDFGRID_ISA
