// The arithmetic of atlas_kernel.h. Compiled once for each instruction set: include nothing here
// that emits functions shared with other files.
#include "sdfgrid/grid/atlas_kernel.h"

#include "sdfgrid/core/simd.h"

namespace sdfgrid::SDFGRID_ISA {
namespace {

constexpr int kBrick = 8;  // cells a side
constexpr int kEdge = 9;   // samples a side
constexpr int kPlane = kEdge * kEdge;
constexpr int kSamples = kEdge * kPlane;
constexpr int kOctants = 8;

using F8 = float __attribute__((vector_size(32)));
using D8 = double __attribute__((vector_size(64)));
using I8 = std::int32_t __attribute__((vector_size(32)));

// Sets eight samples; `changed` gets a bit wherever one was another before.
inline void copy_row(const float* from, double factor, float* to, I8& changed) {
  F8 v;
  I8 before;
  __builtin_memcpy(&v, from, sizeof v);
  __builtin_memcpy(&before, to, sizeof before);
  const F8 scaled = __builtin_convertvector(__builtin_convertvector(v, D8) * factor, F8);
  changed |= (I8)scaled ^ before;
  __builtin_memcpy(to, &scaled, sizeof scaled);
}

inline bool copy_sample(const float* from, double factor, float* to) {
  const auto scaled = static_cast<float>(*from * factor);
  const bool changed = !(scaled == *to);
  *to = scaled;
  return changed;
}

bool copy(const float* values, double factor, std::int32_t part, float* samples) {
  const int columns = (part & 4) != 0 ? 1 : kBrick;
  const int rows = (part & 2) != 0 ? 1 : kBrick;
  float* first = samples + ((part & 4) != 0 ? kBrick * kPlane : 0) +
                 ((part & 2) != 0 ? kBrick * kEdge : 0) + ((part & 1) != 0 ? kBrick : 0);
  I8 changed = {};
  bool any_changed = false;
  for (int x = 0; x < columns; ++x) {
    const float* from = values + x * kBrick * kBrick;
    float* to = first + x * kPlane;
    for (int y = 0; y < rows; ++y, from += kBrick, to += kEdge) {
      if ((part & 1) != 0) {
        any_changed |= copy_sample(from, factor, to);
      } else {
        copy_row(from, factor, to, changed);
      }
    }
  }
  for (int i = 0; i < 8; ++i) any_changed |= changed[i] != 0;
  return any_changed;
}

// Of sixteen bits each, the first lowest.
inline void put_bits(std::uint64_t* words, int group, I16 mask) {
  words[group >> 2] |= static_cast<std::uint64_t>(bits(mask)) << (group & 3) * kLanes;
}

void negatives(const float* values, std::uint64_t* words) {
  for (int x = 0; x < kBrick; ++x) words[x] = 0;
  for (int g = 0; g < kBrick * kBrick * kBrick / kLanes; ++g) {
    put_bits(words, g, load(values + g * kLanes) < 0.0F);
  }
}

// For sixteen samples from any place in a plane on, of the absolute difference to the next row (of
// nine) or to the next sample: all bits but the sign's where there is one, else none.
constexpr std::int32_t kAbs = 0x7fffffff;
struct DifferenceMasks {
  alignas(64) std::int32_t row[kPlane + kLanes];
  alignas(64) std::int32_t sample[kEdge + kLanes];
};
constexpr DifferenceMasks difference_masks() {
  DifferenceMasks m{};
  for (int i = 0; i < kPlane + kLanes; ++i) m.row[i] = i % kPlane < kPlane - kEdge ? kAbs : 0;
  for (int i = 0; i < kEdge + kLanes; ++i) m.sample[i] = i % kEdge < kEdge - 1 ? kAbs : 0;
  return m;
}
constexpr DifferenceMasks kMasks = difference_masks();

inline float largest(F16 v) {
#if defined(__AVX512F__)
  return _mm512_reduce_max_ps((__m512)v);
#else
  float lane[kLanes];
  store(lane, v);
  for (int half = kLanes / 2; half > 0; half /= 2) {
    for (int i = 0; i < half; ++i) lane[i] = lane[i + half] > lane[i] ? lane[i + half] : lane[i];
  }
  return lane[0];
#endif
}

// What a survey gathers, sixteen samples at a time. Sets of samples have a bit a sample.
struct Gathered {
  F16 low, high;
  F16 zero;  // a NaN where a sample is not finite
  F16 step[3];
  std::uint8_t above[kSamples / 8 + 16];  // of 81 bits a plane
  std::uint8_t below[kSamples / 8 + 16];
};

inline void put_bits_at(std::uint8_t* set, int at, I16 mask) {  // `at` is a multiple of eight
  const auto sixteen = static_cast<std::uint16_t>(bits(mask));
  __builtin_memcpy(set + at / 8, &sixteen, sizeof sixteen);
}

inline void take_values(const F16& v, Gathered& g) {
  g.low = min(g.low, v);
  g.high = max(g.high, v);
  g.zero = g.zero + v * 0.0F;
}

// The samples from `at` on; differences along `axes` of the axes, the last ones.
template <int axes>
inline void take(const float* samples, int at, float margin, Gathered& g) {
  const float* p = samples + at;
  const F16 v = load(p);
  take_values(v, g);
  put_bits_at(g.above, at, v > margin);
  put_bits_at(g.below, at, v < -margin);
  const auto add = [&](int axis, int stride, const I16& mask) {
    const F16 d = load(p + stride) - v;
    I16 b;
    __builtin_memcpy(&b, &d, sizeof b);
    b = b & mask;
    F16 masked;
    __builtin_memcpy(&masked, &b, sizeof masked);
    g.step[axis] = max(g.step[axis], masked);
  };
  if (axes > 2) add(0, kPlane, splat(kAbs));
  if (axes > 1) add(1, kEdge, load(kMasks.row + at % kPlane));
  add(2, 1, load(kMasks.sample + at % kEdge));
}

struct PlaneSet {
  std::uint64_t low, high;  // 64 and 17 bits
};
inline PlaneSet operator&(const PlaneSet& a, const PlaneSet& b) {
  return {a.low & b.low, a.high & b.high};
}
inline PlaneSet operator>>(const PlaneSet& a, int shift) {
  return {a.low >> shift | a.high << (64 - shift), a.high >> shift};
}

// The squares between the samples of a plane of which all four corners are in the set.
inline PlaneSet full_squares(const std::uint8_t* set, int plane) {
  PlaneSet s;
  const int bit = plane * kPlane;
  __builtin_memcpy(&s.low, set + bit / 8, sizeof s.low);
  __builtin_memcpy(&s.high, set + bit / 8 + sizeof s.low, sizeof s.high);
  if (bit % 8 != 0) s = s >> bit % 8;
  s = s & s >> 1;
  return s & s >> kEdge;
}

void find_crossing(const Gathered& g, std::uint64_t* crossing) {
  PlaneSet above = full_squares(g.above, 0);
  PlaneSet below = full_squares(g.below, 0);
  for (int x = 0; x < kBrick; ++x) {
    const PlaneSet next_above = full_squares(g.above, x + 1);
    const PlaneSet next_below = full_squares(g.below, x + 1);
    const PlaneSet a = above & next_above;
    const PlaneSet b = below & next_below;
    const PlaneSet full = {a.low | b.low, a.high | b.high};
    std::uint64_t cells = (full >> 7 * kEdge).low << 56;
    for (int y = 0; y < 7; ++y) cells |= full.low >> y & std::uint64_t{0xff} << (8 * y);
    crossing[x] = ~cells;
    above = next_above;
    below = next_below;
  }
}

// All in one pass: reading is most of the work. Some samples are met twice.
void survey(const float* samples, float margin, SampleSurvey& out) {
  const F16 first = load(samples);
  const F16 none = splat(0.0F);
  Gathered g;
  g.low = g.high = first;
  g.zero = g.step[0] = g.step[1] = g.step[2] = none;
  constexpr int kLastPlane = kSamples - kPlane;
  constexpr int kLastRow = kSamples - kEdge;
  for (int i = 0; i + kLanes <= kLastPlane; i += kLanes) take<3>(samples, i, margin, g);
  take<3>(samples, kLastPlane - kLanes, margin, g);
  for (int i = kLastPlane; i + kLanes <= kLastRow; i += kLanes) take<2>(samples, i, margin, g);
  take<2>(samples, kLastRow - kLanes, margin, g);
  take<1>(samples, kSamples - 1 - kLanes, margin, g);
  take_values(load(samples + kSamples - kLanes), g);
  const float last = samples[kSamples - 1];
  g.above[kSamples / 8] = last > margin ? 1 : 0;
  g.below[kSamples / 8] = last < -margin ? 1 : 0;
  const bool finite = all(g.zero == 0.0F);
  out.low = finite ? -largest(-g.low) : -__builtin_inff();
  out.high = finite ? largest(g.high) : __builtin_inff();
  for (int a = 0; a < 3; ++a) out.step[a] = largest(g.step[a]);
  find_crossing(g, out.crossing);
}

// The cells of a brick, a lane for each x: bit y * 8 + z.
using Cells = std::uint64_t __attribute__((vector_size(64)));
using Lanes = std::int64_t __attribute__((vector_size(64)));

inline Cells mirror_x(Cells c) { return __builtin_shufflevector(c, c, 7, 6, 5, 4, 3, 2, 1, 0); }
inline Cells mirror_y(Cells c) {
  c = (c >> 8 & 0x00ff00ff00ff00ffU) | (c & 0x00ff00ff00ff00ffU) << 8;
  c = (c >> 16 & 0x0000ffff0000ffffU) | (c & 0x0000ffff0000ffffU) << 16;
  return c >> 32 | c << 32;
}
inline Cells mirror_z(Cells c) {
  c = (c >> 4 & 0x0f0f0f0f0f0f0f0fU) | (c & 0x0f0f0f0f0f0f0f0fU) << 4;
  c = (c >> 2 & 0x3333333333333333U) | (c & 0x3333333333333333U) << 2;
  return (c >> 1 & 0x5555555555555555U) | (c & 0x5555555555555555U) << 1;
}

// The cells from which one of `c` is at most one ahead, on all axes.
inline Cells grow_back(Cells c) {
  c = c | __builtin_shufflevector(c, Cells{}, 1, 2, 3, 4, 5, 6, 7, 8);
  c = c | (c >> 1 & 0x7f7f7f7f7f7f7f7fU);
  return c | c >> 8;
}

// The numbers 0 to 8 of a brick's cells, by their binary digits.
struct Digits {
  Cells ones, twos, fours, eights;
};

// A cell's hop is the number of times that the crossing ones must grow to reach it, at most eight.
inline Digits count_hops(Cells reached) {
  Cells left[kBrick];  // after so many times
  for (Cells& cells : left) {
    cells = ~reached;
    reached = grow_back(reached);
  }
  // Those sets hold each other, so the bits of the number of sets that a cell is in are:
  const Cells fours = left[3] ^ left[7];
  const Cells twos = left[1] ^ left[5] ^ fours;
  const Cells ones = left[0] ^ left[2] ^ left[4] ^ left[6] ^ twos;
  return {ones, twos, fours, left[7]};
}

// Puts the digits of each row of eight cells side by side, four bits a cell.
#if defined(__AVX512BW__)
inline void write_hops(const Digits& digits, std::uint32_t* hops) {
  // Rows by fours, so that the interleaving below, which stays within quarters, leaves them in
  // order.
  const __m512i quarters = _mm512_setr_epi32(0, 4, 8, 12, 1, 5, 9, 13, 2, 6, 10, 14, 3, 7, 11, 15);
  // Byte k of a row's word holds cells 2 k and 2 k + 1. The tables take two digits of both, ones
  // (or fours) in the lower two bits, twos (or eights) in the upper two.
  const __m512i lower =
      _mm512_broadcast_i32x4(_mm_setr_epi8(0x00, 0x01, 0x10, 0x11, 0x02, 0x03, 0x12, 0x13, 0x20,
                                           0x21, 0x30, 0x31, 0x22, 0x23, 0x32, 0x33));
  const __m512i upper = _mm512_slli_epi16(lower, 2);
  const __m512i even = _mm512_set1_epi8(0x33);
  const __m512i nibble = _mm512_set1_epi8(0x0f);
  struct Pair {
    __m512i even, odd;  // indices for bytes 0 and 2, for 1 and 3
  };
  const auto pair = [&](const Cells& a, const Cells& b) {
    const __m512i low = _mm512_permutexvar_epi32(quarters, (__m512i)a);
    const __m512i high = _mm512_permutexvar_epi32(quarters, (__m512i)b);
    return Pair{_mm512_or_si512(_mm512_and_si512(low, even),
                                _mm512_andnot_si512(even, _mm512_slli_epi16(high, 2))),
                _mm512_or_si512(_mm512_and_si512(_mm512_srli_epi16(low, 2), even),
                                _mm512_andnot_si512(even, high))};
  };
  const auto bytes = [&](__m512i low, __m512i high) {
    return _mm512_or_si512(_mm512_shuffle_epi8(lower, _mm512_and_si512(low, nibble)),
                           _mm512_shuffle_epi8(upper, _mm512_and_si512(high, nibble)));
  };
  const Pair low = pair(digits.ones, digits.twos);
  const Pair high = pair(digits.fours, digits.eights);
  const __m512i b0 = bytes(low.even, high.even);
  const __m512i b1 = bytes(low.odd, high.odd);
  const __m512i b2 = bytes(_mm512_srli_epi16(low.even, 4), _mm512_srli_epi16(high.even, 4));
  const __m512i b3 = bytes(_mm512_srli_epi16(low.odd, 4), _mm512_srli_epi16(high.odd, 4));
  const __m512i first = _mm512_unpacklo_epi8(b0, b1);
  const __m512i second = _mm512_unpacklo_epi8(b2, b3);
  const __m512i third = _mm512_unpackhi_epi8(b0, b1);
  const __m512i fourth = _mm512_unpackhi_epi8(b2, b3);
  _mm512_storeu_si512(hops, _mm512_unpacklo_epi16(first, second));
  _mm512_storeu_si512(hops + 16, _mm512_unpackhi_epi16(first, second));
  _mm512_storeu_si512(hops + 32, _mm512_unpacklo_epi16(third, fourth));
  _mm512_storeu_si512(hops + 48, _mm512_unpackhi_epi16(third, fourth));
}
#else
// Of sixteen bits, four rows of four, the columns.
inline std::uint32_t transposed(std::uint32_t v) {  // in both halves at once
  std::uint32_t t = (v ^ v >> 3) & 0x0a0a0a0aU;
  v ^= t ^ t << 3;
  t = (v ^ v >> 6) & 0x00cc00ccU;
  return v ^ t ^ t << 6;
}

inline void write_hops(const Digits& d, std::uint32_t* hops) {
  // Of each row of eight cells the digits side by side, first of the lower four cells.
  constexpr std::uint64_t kLower = 0x0f0f0f0f0f0f0f0fU;
  const Cells halves[4] = {
      (d.ones & kLower) | (d.twos & kLower) << 4, (d.fours & kLower) | (d.eights & kLower) << 4,
      (d.ones >> 4 & kLower) | (d.twos & ~kLower), (d.fours >> 4 & kLower) | (d.eights & ~kLower)};
  std::uint8_t bytes[4][kBrick * kBrick];
  __builtin_memcpy(bytes, halves, sizeof bytes);
  for (int i = 0; i < kBrick * kBrick; ++i) {
    const auto lower = static_cast<std::uint16_t>(bytes[0][i] | bytes[1][i] << 8);
    const auto upper = static_cast<std::uint16_t>(bytes[2][i] | bytes[3][i] << 8);
    hops[i] = transposed(lower | static_cast<std::uint32_t>(upper) << 16);
  }
}
#endif

void hops(const std::uint64_t* crossing, std::uint32_t* out) {
  std::uint64_t some = 0;
  for (int x = 0; x < kBrick; ++x) some |= crossing[x];
  if (some == 0) {
    for (int i = 0; i < kOctants * kBrick * kBrick; ++i) out[i] = 0x88888888U;
    return;
  }
  Cells cells[kOctants];
  __builtin_memcpy(&cells[0], crossing, sizeof cells[0]);
  cells[1] = mirror_z(cells[0]);
  for (int i = 0; i < 2; ++i) cells[2 + i] = mirror_y(cells[i]);
  for (int i = 0; i < 4; ++i) cells[4 + i] = mirror_x(cells[i]);
  for (int octant = 0; octant < kOctants; ++octant) {
    write_hops(count_hops(cells[octant]), out + octant * kBrick * kBrick);
  }
}

// Those whose hop is zero, by the first octant.
void crossing_of(const std::uint32_t* hops, std::uint64_t* crossing) {
  std::uint8_t rows[kBrick * kBrick];
  for (int i = 0; i < kBrick * kBrick; ++i) {
    std::uint32_t w = hops[i];
    w = (w | w >> 1) & 0x55555555U;
    w = (w | w >> 2) & 0x11111111U;  // of each cell whether it is not zero
    w = (w | w >> 3) & 0x03030303U;
    w = (w | w >> 6) & 0x000f000fU;
    rows[i] = static_cast<std::uint8_t>(~(w | w >> 12));
  }
  __builtin_memcpy(crossing, rows, sizeof rows);
}

}  // namespace

extern const AtlasKernel kAtlasKernel;
const AtlasKernel kAtlasKernel = {copy, negatives, survey, hops, crossing_of};

}  // namespace sdfgrid::SDFGRID_ISA
