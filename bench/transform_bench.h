// bench/transform_bench.h: what the parts of transform_bench share.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <glm/vec3.hpp>
#include <string>
#include <vector>

namespace sdfgrid::bench {

// The processor's seconds of this process.
double cpu_seconds();
// The clock's, for what runs on more than one thread.
double wall_seconds();
// The least seconds of the repetitions, by `clock`.
double best_seconds(int repetitions, const std::function<void()>& work,
                    double (*clock)() = cpu_seconds);
void print_speed(const std::string& what, std::size_t samples, double seconds, int threads);

// ITK's exact and chamfer transforms of a mask, where this program has ITK.
void run_itk(const glm::ivec3& dims, const std::vector<std::uint8_t>& mask, int repetitions);

// Bands of a mesh by the feature and marching transforms, beside exact conversion.
void run_mesh(const std::string& path, int dim, double width, int repetitions);

}  // namespace sdfgrid::bench
