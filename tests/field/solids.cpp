#include "field/solids.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

Inside solid_of(const ExampleNode& node) {
  Inside found = leaf_solid(node);
  if (!found) found = combined_solid(node);
  if (!found) throw std::runtime_error("tests/field has no definition of the solid " + node.word);
  return found;
}

std::vector<double> Given::numbers(const char* name) const {
  for (const sdfgrid::Argument& each : node_.arguments) {
    const auto* list = std::get_if<std::vector<double>>(&each.value);
    if (each.name == name && list != nullptr) return *list;
  }
  for (const sdfgrid::Parameter& each : sdfgrid::find_op(node_.word)->parameters) {
    if (std::string(each.name) != name) continue;
    switch (each.kind) {
      case sdfgrid::ParameterKind::number:
      case sdfgrid::ParameterKind::whole:
        return {each.fallback[0]};
      case sdfgrid::ParameterKind::pair:
        return {each.fallback[0], each.fallback[1]};
      case sdfgrid::ParameterKind::vector:
        return {each.fallback[0], each.fallback[1], each.fallback[2]};
      default:
        return {};
    }
  }
  throw std::runtime_error(node_.word + " has no parameter " + name);
}

double Given::operator()(const char* name) const { return numbers(name).at(0); }

Vec Given::vector(const char* name) const {
  const std::vector<double> v = numbers(name);
  return v.size() == 1 ? Vec(v[0]) : Vec(v.at(0), v.at(1), v.at(2));
}

std::vector<Vec> Given::points(const char* name) const {
  const std::vector<double> v = numbers(name);
  std::vector<Vec> points;
  for (std::size_t i = 0; i + 2 < v.size(); i += 3) points.emplace_back(v[i], v[i + 1], v[i + 2]);
  return points;
}

std::string Given::text(const char* name, const char* fallback) const {
  for (const sdfgrid::Argument& each : node_.arguments) {
    if (each.name != name) continue;
    const auto* text = std::get_if<std::string>(&each.value);
    return text != nullptr ? *text
                           : std::to_string(std::get<std::vector<double>>(each.value).at(0));
  }
  return fallback;
}

namespace {

int modulo(long a, long n) { return static_cast<int>((a % n + n) % n); }
int permuted(int a) { return modulo((34L * a + 1) * a, 289); }

// Perlin's improved noise, a corner at a time: each adds its ramp, faded in each direction.
double noise_at(const Vec& p, int salt) {
  double sum = 0;
  for (int corner = 0; corner < 8; ++corner) {
    double weight = 1;
    double from[3];
    long cell[3];
    for (int a = 0; a < 3; ++a) {
      cell[a] = std::lround(std::floor(p[a])) + (corner >> a & 1);
      from[a] = p[a] - static_cast<double>(cell[a]);
      const double t = 1 - std::fabs(from[a]);
      weight *= t * t * t * (t * (6 * t - 15) + 10);
    }
    const int x = modulo(cell[0] + salt, 289);
    const int hash = permuted(permuted(permuted(x) + modulo(cell[1], 289)) + modulo(cell[2], 289));
    // Twelfths of the 289; to the middle of the edges of a cube: by x and y, x and z, y and z.
    const int kind = static_cast<int>((hash + 0.5) / 24.0834);
    const double u = kind < 8 ? from[0] : from[1];
    const double v = kind < 4 ? from[1] : from[2];
    sum += weight * ((kind & 1) != 0 ? -u : u);
    sum += weight * ((kind & 2) != 0 ? -v : v);
  }
  return sum;
}

}  // namespace

double NoiseSum::operator()(const Vec& p) const {
  double sum = 0;
  for (int i = 0; i < octaves; ++i) {
    const Vec q = p * (frequency * std::exp2(i)) + Vec(0.37 * i);
    sum += amplitude * std::exp2(-0.5 * beta * i) * noise_at(q, seed + 31 * i);
  }
  return sum;
}
