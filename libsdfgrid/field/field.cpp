#include "sdfgrid/field/field.h"

#include <algorithm>
#include <new>

#include "sdfgrid/field/batch_kernel.h"
#include "sdfgrid/field/program_data.h"
#include "sdfgrid/field/slope.h"

namespace sdfgrid {
namespace {

constexpr int kLanes = 16;

// The memory that a kernel works in, one a thread.
float* scratch(std::size_t floats) {
  struct Aligned {
    float* memory = nullptr;
    std::size_t size = 0;
    ~Aligned() { release(); }
    void release() { ::operator delete[](memory, std::align_val_t{64}); }
  };
  thread_local Aligned block;
  if (block.size < floats) {
    block.release();
    block = {};
    block.memory =
        static_cast<float*>(::operator new[](floats * sizeof(float), std::align_val_t{64}));
    block.size = floats;
  }
  return block.memory;
}

void sample(const Sampler* sampler, int n, const float* const p[3], float* out) {
  sampler->evaluate(n, p[0], p[1], p[2], out);
}

// One block of less than whole lanes: filled up with its last point.
struct PartBlock {
  alignas(64) float p[3][kBatch];
  alignas(64) float out[kBatch];
};

}  // namespace

std::size_t Field::size() const { return program_->code.size(); }

void Field::evaluate(std::size_t n, const float* x, const float* y, const float* z,
                     float* out) const {
  const Program& p = *program_;
  std::vector<const Sampler*> samplers;
  for (const auto& s : p.pool->samplers) samplers.push_back(s.get());
  const BatchProgram program = {p.code.data(), static_cast<int>(p.code.size()),
                                p.pool->constants.data(), samplers.data(), sample};
  const auto run = field_kernel().run;
  float* memory = scratch(static_cast<std::size_t>(kBatch) * (p.values + 3 * p.points));
  std::size_t done = 0;
  for (; done + kLanes <= n;) {
    const std::size_t take = std::min<std::size_t>(kBatch, (n - done) / kLanes * kLanes);
    const float* const at[3] = {x + done, y + done, z + done};
    run(program, static_cast<int>(take), at, out + done, memory, p.values);
    done += take;
  }
  if (done == n) return;
  PartBlock part;
  const float* const from[3] = {x, y, z};
  const float* at[3];
  for (int a = 0; a < 3; ++a) {
    for (int i = 0; i < kLanes; ++i) part.p[a][i] = from[a][std::min(done + i, n - 1)];
    at[a] = part.p[a];
  }
  run(program, kLanes, at, part.out, memory, p.values);
  std::copy_n(part.out, n - done, out + done);
}

float Field::operator()(const glm::vec3& p) const {
  float out = 0;
  evaluate(1, &p.x, &p.y, &p.z, &out);
  return out;
}

double Field::slope(const Box& box) const { return std::min(1.0, slope_over(*program_, box)); }

Field Field::tagged(int tag) const {
  auto program = std::make_shared<Program>(*program_);
  for (Instruction& at : program->code) {
    if (at.tag < 0) at.tag = tag;
  }
  return Field(std::move(program));
}

}  // namespace sdfgrid
