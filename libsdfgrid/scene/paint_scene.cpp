#include "sdfgrid/scene/paint_scene.h"

#include <charconv>
#include <set>
#include <vector>

#include "sdfgrid/field/marks.h"
#include "sdfgrid/grid/paint.h"
#include "sdfgrid/grid/paint_field.h"

namespace sdfgrid {
namespace {

// The number that a name says, 0 if it says none that paint can have.
int number_in(const std::string& name) {
  int number = 0;
  const auto [end, error] = std::from_chars(name.data(), name.data() + name.size(), number);
  const bool whole = error == std::errc() && end == name.data() + name.size();
  return whole && number >= 1 && number <= kMostMaterial ? number : 0;
}

// Of each material the number that it gets as paint, 0 where there are no more.
std::vector<int> paint_numbers(const std::vector<std::string>& names) {
  std::vector<int> numbers;
  std::set<int> taken;
  for (const std::string& name : names) {
    const int number = number_in(name);
    numbers.push_back(taken.insert(number).second ? number : 0);
  }
  int next = 1;
  for (int& number : numbers) {
    if (number != 0) continue;
    while (taken.contains(next)) ++next;
    if (next <= kMostMaterial) number = next++;
  }
  return numbers;
}

PaintLook look_of(const Material& material, const std::string& name) {
  return {material.diffuse, material.specular, material.exponent, name};
}

}  // namespace

bool has_several_materials(const SceneModel& scene) {
  return !scene.materials.empty() && !only_mark(scene.field);
}

ScenePaint paint_scene(const SceneModel& scene, Grid& grid, const Job& job) {
  ScenePaint paint;
  const std::optional<int> only = only_mark(scene.field);
  if (scene.materials.empty() || only == -1) return paint;
  const std::vector<int> numbers = paint_numbers(scene.names);
  const std::set<int> used =
      only ? std::set{numbers[*only]} : paint_by_field(grid, scene.field, numbers, job);
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    paint.too_many += numbers[i] == 0 ? 1 : 0;
    if (numbers[i] == 0 || !used.contains(numbers[i])) continue;
    const bool painted = used.size() > 1;
    set_paint_look(grid, painted ? numbers[i] : 0, look_of(scene.materials[i], scene.names[i]));
    if (painted) paint.materials[numbers[i]] = scene.names[i];
  }
  return paint;
}

}  // namespace sdfgrid
