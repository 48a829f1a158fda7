// Converts a tetrahedron, writes the grid and reads it back; writes a picture.
#include <sdfgrid/grid/convert.h>
#include <sdfgrid/grid/grid.h>
#include <sdfgrid/image/image.h>

int main() {
  sdfgrid::TriangleSoup soup;
  soup.points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  soup.triangles = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}};
  sdfgrid::ConvertOptions options;
  options.dim = 32;
  sdfgrid::write_grid(sdfgrid::convert_mesh(soup, options, sdfgrid::Job()).grid, "consumer.vdb");
  sdfgrid::write_image("consumer.png", {1, 1, {"R", "G", "B"}, {1, 1, 1}});
  const sdfgrid::Grid grid = sdfgrid::read_grid("consumer.vdb");
  const glm::ivec3 inside(grid.lattice().to_index({0.2, 0.2, 0.2}));
  return grid.is_level_set() && grid.active_voxels() > 1000 && grid.value(inside) < 0 ? 0 : 1;
}
