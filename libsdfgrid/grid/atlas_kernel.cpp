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

void scale(const float* in, double factor, std::int32_t count, float* out) {
  for (std::int32_t i = 0; i < count; ++i) out[i] = static_cast<float>(in[i] * factor);
}

// Whether a sample has a successor in its row; from any place in the row on.
alignas(64) constexpr std::int32_t kGoesOn[kEdge + kLanes] = {-1, -1, -1, -1, -1, -1, -1, -1, 0,
                                                              -1, -1, -1, -1, -1, -1, -1, -1, 0,
                                                              -1, -1, -1, -1, -1, -1, -1};

// Where sixteen of `count` items begin; the last of them may be met twice.
inline int lanes_at(int i, int count) { return i + kLanes <= count ? i : count - kLanes; }

inline F16 difference(const float* p, int stride) { return abs(load(p + stride) - load(p)); }

inline float largest(F16 v) {
  float lane[kLanes];
  store(lane, v);
  for (int half = kLanes / 2; half > 0; half /= 2) {
    for (int i = 0; i < half; ++i) lane[i] = lane[i + half] > lane[i] ? lane[i + half] : lane[i];
  }
  return lane[0];
}

// Of a leaf's values by vectors of two rows: lane 8 y + z.
void parts(const float* values, PartRanges& out) {
  constexpr int kVectors = kBrick * kBrick * kBrick / kLanes;
  // Of the planes x = 0 (the first vectors) and y = 0 (each fourth, lanes 0 to 7).
  F16 low[4];
  F16 high[4];
  for (int n = 0; n < 4; ++n) low[n] = high[n] = load(values);
  for (int i = 0; i < kVectors; ++i) {
    const F16 v = load(values + i * kLanes);
    low[0] = min(low[0], v);
    high[0] = max(high[0], v);
    if (i % 4 == 0) {
      low[1] = min(low[1], v);
      high[1] = max(high[1], v);
    }
    if (i < 4) {
      low[2] = min(low[2], v);
      high[2] = max(high[2], v);
    }
  }
  // The part with bits x, y, z set is that of x = 0, y = 0, z = 0.
  for (int n = 0; n < 4; ++n) {
    const int part = (n & 1) << 1 | (n & 2) << 1;
    float lows[kLanes];
    float highs[kLanes];
    store(lows, low[n]);
    store(highs, high[n]);
    const int rows = (n & 1) != 0 ? 1 : 2;
    for (int z = 0; z < 2; ++z) {
      float least = lows[0];
      float most = highs[0];
      for (int row = 0; row < rows; ++row) {
        for (int i = 0; i < (z != 0 ? 1 : kBrick); ++i) {
          least = lows[row * kBrick + i] < least ? lows[row * kBrick + i] : least;
          most = highs[row * kBrick + i] > most ? highs[row * kBrick + i] : most;
        }
      }
      out.low[part | z] = least;
      out.high[part | z] = most;
    }
  }
}

void range(const float* samples, SampleRange& out) {
  F16 low = load(samples);
  F16 high = low;
  F16 zero = splat(0.0F);  // a NaN where a sample is not finite
  F16 x = splat(0.0F);
  F16 y = splat(0.0F);
  F16 z = splat(0.0F);
  for (int i = 0; i < kSamples; i += kLanes) {
    const F16 v = load(samples + lanes_at(i, kSamples));
    low = min(low, v);
    high = max(high, v);
    zero = zero + v * 0.0F;
  }
  for (int i = 0; i < kSamples - kPlane; i += kLanes) {
    x = max(x, difference(samples + lanes_at(i, kSamples - kPlane), kPlane));
  }
  for (int plane = 0; plane < kSamples; plane += kPlane) {
    for (int i = 0; i < kPlane - kEdge; i += kLanes) {
      y = max(y, difference(samples + plane + lanes_at(i, kPlane - kEdge), kEdge));
    }
  }
  for (int i = 0; i < kSamples - 1; i += kLanes) {
    const int at = lanes_at(i, kSamples - 1);
    z = max(z, select(load(kGoesOn + at % kEdge), difference(samples + at, 1), splat(0.0F)));
  }
  out.low = -largest(-low);
  out.high = largest(high);
  out.step[0] = largest(x);
  out.step[1] = largest(y);
  out.step[2] = largest(z);
  out.finite = all(zero == 0.0F);
}

constexpr int kWords = (kSamples + 63) / 64 + 2;  // of a bit a sample, zeros behind them

// Of each sample the bit whether its cell's eight samples are all set. Sets some bits that belong
// to no cell.
inline void fill_cells(std::uint64_t* words) {
  constexpr int kStrides[] = {1, kEdge, kPlane};
  for (const int stride : kStrides) {
    const int whole = stride >> 6;
    const int rest = stride & 63;
    for (int w = 0; w + whole + 1 < kWords; ++w) {
      words[w] &= words[w + whole] >> rest | words[w + whole + 1] << (64 - rest);
    }
  }
}

inline std::uint64_t bits_from(const std::uint64_t* words, int bit) {
  const int w = bit >> 6;
  const int s = bit & 63;
  return s == 0 ? words[w] : words[w] >> s | words[w + 1] << (64 - s);
}

// The cells that are not full of samples on one side: word x, bit y * 8 + z.
inline void find_crossing(const float* samples, float margin, std::uint64_t* crossing) {
  std::uint64_t above[kWords] = {};
  std::uint64_t below[kWords] = {};
  for (int i = 0; i < kSamples; i += kLanes) {
    const int at = lanes_at(i, kSamples);
    const F16 v = load(samples + at);
    const auto add = [&](std::uint64_t* words, I16 mask) {
      words[i >> 6] |= static_cast<std::uint64_t>(bits(mask) >> (i - at)) << (i & 63);
    };
    add(above, v > margin);
    add(below, v < -margin);
  }
  fill_cells(above);
  fill_cells(below);
  for (int w = 0; w < kWords; ++w) above[w] |= below[w];
  for (int x = 0; x < kBrick; ++x) {
    const std::uint64_t rows = bits_from(above, x * kPlane);  // of nine bits each
    std::uint64_t full = bits_from(above, x * kPlane + 7 * kEdge) << 56;
    for (int y = 0; y < 7; ++y) full |= rows >> y & std::uint64_t{0xff} << (8 * y);
    crossing[x] = ~full;
  }
}

// The cells of a brick, a lane for each x: bit y * 8 + z.
typedef std::uint64_t Cells __attribute__((vector_size(64)));
typedef std::int64_t Lanes __attribute__((vector_size(64)));

inline Cells mirror_x(Cells c) { return __builtin_shuffle(c, Lanes{7, 6, 5, 4, 3, 2, 1, 0}); }
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
  c = c | __builtin_shuffle(c, Cells{}, Lanes{1, 2, 3, 4, 5, 6, 7, 8});
  c = c | (c >> 1 & 0x7f7f7f7f7f7f7f7fU);
  return c | c >> 8;
}

// Of sixteen bits, four rows of four, the columns.
inline std::uint32_t transposed(std::uint32_t v) {  // in both halves at once
  std::uint32_t t = (v ^ v >> 3) & 0x0a0a0a0aU;
  v ^= t ^ t << 3;
  t = (v ^ v >> 6) & 0x00cc00ccU;
  return v ^ t ^ t << 6;
}

// A cell's hop is the number of times that the crossing ones must grow to reach it, at most eight.
void fill_octant(Cells reached, std::uint32_t* hops) {
  Cells left[kBrick];  // after so many times
  for (Cells& cells : left) {
    cells = ~reached;
    reached = grow_back(reached);
  }
  // Those sets hold each other, so the bits of the number of sets that a cell is in are:
  const Cells fours = left[3] ^ left[7];
  const Cells twos = left[1] ^ left[5] ^ fours;
  const Cells ones = left[0] ^ left[2] ^ left[4] ^ left[6] ^ twos;
  const Cells eights = left[7];
  // Of each row of eight cells those bits side by side, first of the lower four cells.
  constexpr std::uint64_t kLower = 0x0f0f0f0f0f0f0f0fU;
  const Cells digits[4] = {
      (ones & kLower) | (twos & kLower) << 4, (fours & kLower) | (eights & kLower) << 4,
      (ones >> 4 & kLower) | (twos & ~kLower), (fours >> 4 & kLower) | (eights & ~kLower)};
  std::uint8_t bytes[4][kBrick * kBrick];
  __builtin_memcpy(bytes, digits, sizeof bytes);
  for (int i = 0; i < kBrick * kBrick; ++i) {
    const auto lower = static_cast<std::uint16_t>(bytes[0][i] | bytes[1][i] << 8);
    const auto upper = static_cast<std::uint16_t>(bytes[2][i] | bytes[3][i] << 8);
    hops[i] = transposed(lower | static_cast<std::uint32_t>(upper) << 16);
  }
}

void hops(const float* samples, float margin, std::uint32_t* out) {
  std::uint64_t crossing[kBrick];
  find_crossing(samples, margin, crossing);
  std::uint64_t some = 0;
  for (const std::uint64_t plane : crossing) some |= plane;
  if (some == 0) {
    for (int i = 0; i < kOctants * kBrick * kBrick; ++i) out[i] = 0x88888888U;
    return;
  }
  Cells cells[kOctants];
  __builtin_memcpy(&cells[0], crossing, sizeof crossing);
  cells[1] = mirror_z(cells[0]);
  for (int i = 0; i < 2; ++i) cells[2 + i] = mirror_y(cells[i]);
  for (int i = 0; i < 4; ++i) cells[4 + i] = mirror_x(cells[i]);
  for (int octant = 0; octant < kOctants; ++octant) {
    fill_octant(cells[octant], out + octant * kBrick * kBrick);
  }
}

}  // namespace

extern const AtlasKernel kAtlasKernel;
const AtlasKernel kAtlasKernel = {scale, parts, range, hops};

}  // namespace sdfgrid::SDFGRID_ISA
