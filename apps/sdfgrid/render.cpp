// sdfgrid render: a grid, a mesh, a volume or a scene to a picture.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <memory>
#include <numeric>
#include <optional>

#include "command.h"
#include "inputs.h"
#include "options.h"
#include "scenes.h"
#include "sdfgrid/core/error.h"
#include "sdfgrid/core/memory.h"
#include "sdfgrid/core/parallel.h"
#include "sdfgrid/field/parts.h"
#include "sdfgrid/grid/atlas.h"
#include "sdfgrid/grid/convert.h"
#include "sdfgrid/grid/convert_field.h"
#include "sdfgrid/grid/grid.h"
#include "sdfgrid/grid/recovered.h"
#include "sdfgrid/grid/steepened.h"
#include "sdfgrid/image/image.h"
#include "sdfgrid/trace/atlas_seen.h"
#include "sdfgrid/trace/camera.h"
#include "sdfgrid/trace/curvature.h"
#include "sdfgrid/trace/far_field.h"
#include "sdfgrid/trace/field_seen.h"
#include "sdfgrid/trace/field_trace.h"
#include "sdfgrid/trace/shade.h"
#include "sdfgrid/trace/trace.h"

namespace sdfgrid::cli {
namespace {

struct Options {
  std::string input;
  Output output;
  int dim = 0;  // of the grid that a mesh is converted to; 0: as the picture needs
  int width = 1024;
  int height = 1024;
  std::optional<glm::dvec3> eye;
  std::optional<glm::dvec3> target;
  View view;
  bool up_given = false;
  bool fov_given = false;
  bool turned = false;  // --turn or --tilt is given
  double time = 0;
  std::vector<std::string> aovs;
  Look look;
  SurfaceOptions surface;
};

const std::vector<std::string> kAovs = {"depth", "normal", "steps", "id", "curvature"};

glm::dvec3 parse_direction(const std::string& option, const std::string& text) {
  const bool minus = text.size() == 2 && text[0] == '-';
  const std::string axis = minus ? text.substr(1) : text;
  if (axis == "x" || axis == "y" || axis == "z") {
    glm::dvec3 v(0.0);
    v[axis[0] - 'x'] = minus ? -1 : 1;
    return v;
  }
  const glm::dvec3 v = parse_vector(option, text);
  if (!(glm::length(v) > 0)) throw CLI::ValidationError(option, "a direction cannot be 0,0,0");
  return v;
}

void parse_size(const std::string& text, int& width, int& height) {
  int used = 0;
  const bool two = std::sscanf(text.c_str(), "%6dx%6d%n", &width, &height, &used) == 2;
  if (!two || static_cast<std::size_t>(used) != text.size()) {
    throw CLI::ValidationError("--size", "'" + text + "' is not a size as in 1024x768");
  }
  if (width < 1 || height < 1 || width > 32768 || height > 32768) {
    throw CLI::ValidationError("--size", "a side must be 1 to 32768 pixels");
  }
}

void add_camera(CLI::App& app, Options& options) {
  const auto vector = [&](const std::string& name, auto& value, const std::string& help) {
    return app
        .add_option_function<std::string>(
            name, [name, &value](const std::string& text) { value = parse_vector(name, text); },
            help)
        ->type_name("X,Y,Z");
  };
  auto* eye =
      vector("--eye", options.eye, "where the camera is; framed on the content if not given");
  vector("--target", options.target, "what it looks at; the content's middle if not given");
  app.add_option_function<std::string>(
         "--up",
         [&options](const std::string& text) {
           options.view.up = parse_direction("--up", text);
           options.up_given = true;
         },
         "direction that is up: x, y, z, -x, -y, -z or three numbers")
      ->type_name("AXIS")
      ->default_str("y");
  const auto turned = [&options](const std::string&) { options.turned = true; };
  app.add_option("--turn", options.view.turn,
                 "degrees to go round the content, to the right; frames it, whatever the camera of "
                 "a scene")
      ->each(turned)
      ->capture_default_str()
      ->check(finite_number())
      ->excludes(eye);
  app.add_option("--tilt", options.view.tilt, "degrees to look from above; as --turn")
      ->each(turned)
      ->capture_default_str()
      ->check(CLI::Range(-90.0, 90.0) & finite_number())
      ->excludes(eye);
  app.add_option("--fov", options.view.fov, "degrees that the picture's height spans")
      ->each([&options](const std::string&) { options.fov_given = true; })
      ->capture_default_str()
      ->check(CLI::Range(0.01, 179.0) & finite_number());
}

// What is shown: a grid; of a scene the field itself, its grid tells where light gets to.
struct Content {
  Atlas atlas;
  std::unique_ptr<FieldTracer> scene;
  std::vector<Material> materials;  // of the scene
  Grid grid;                        // where there is no scene
};

// The grid itself, or the surface converted: two pixels or so a voxel, finer would not show.
Grid load(const Options& options, Context& context) {
  if (extension_of(options.input) == ".vdb" && !options.surface.iso) {
    return read_distances(options.input, true);  // rays hit where the sign changes
  }
  const Surface surface = load_surface(options.input, options.surface, context);
  ConvertOptions convert;
  const int pixels = std::max(options.width, options.height);
  convert.dim = options.dim > 0 ? options.dim : std::clamp(pixels / 2, 64, 2048);
  Conversion conversion = convert_mesh(surface.soup, convert, context.job());
  for (const std::string& warning : conversion.warnings) context.warn(warning);
  return conversion.grid;
}

// Parts of a scene without end are shown within a box around what the camera, the scene's own if
// none is given, looks at. The others stay as they are, a union that rays take apart.
Field with_end(const Field& field, const std::optional<glm::dvec3>& eye,
               const std::optional<glm::dvec3>& looked_at) {
  if (field.bounds().finite()) return field;
  const glm::dvec3 target = looked_at.value_or(glm::dvec3(0));
  const double size = eye ? 4 * glm::distance(*eye, target) : 10;
  const Field room = make_field("translate", {{"by", {target.x, target.y, target.z}}},
                                {make_field("box", {{"size", {size, size, size}}})});
  std::vector<Field> nodes;
  for (const FieldPart& part : parts_of(field)) {
    nodes.push_back(part.box.finite() ? part.field
                                      : make_field("intersection", {}, {part.field, room}));
  }
  return make_field("union", {}, nodes);
}

// Takes the scene's camera where the command line says nothing, and makes its grid for the light.
Content load_shown_scene(Options& options, Context& context) {
  SceneModel model = load_scene(options.input, options.time, context);
  const auto eye = options.eye ? options.eye : model.camera.eye;
  const auto target = options.target ? options.target : model.camera.target;
  if (!options.turned) {
    options.eye = eye;
    options.target = target;
  }
  if (!options.up_given && model.camera.up) options.view.up = *model.camera.up;
  if (!options.fov_given && model.camera.fov) options.view.fov = *model.camera.fov;
  const Field field = with_end(model.field, eye, target);
  FieldConvertOptions convert;
  const int pixels = std::max(options.width, options.height);
  convert.dim = options.dim > 0 ? options.dim : std::clamp(pixels / 3, 64, 512);
  const FieldConversion conversion =
      naming(options.input, [&] { return convert_field(field, convert, context.job()); });
  const Grid lit = model.has_grids ? recovered(conversion.grid, field, context.job())
                                   : steepened(conversion.grid, context.job());
  Content content{make_atlas(lit, context.job()), nullptr, std::move(model.materials), {}};
  const Box box = field.bounds();
  const glm::dvec3 margin(1e-4 * glm::length(box.size()));
  content.scene = std::make_unique<FieldTracer>(field, Box{box.lo - margin, box.hi + margin});
  return content;
}

Content load_content(Options& options, Context& context) {
  if (names_scene(options.input)) return load_shown_scene(options, context);
  const Grid grid = load(options, context);
  return {make_atlas(grid, context.job()), nullptr, {}, grid};
}

// Points in world units, from what surface_points() and surface_corners() count in.
std::vector<glm::dvec3> world_points(const Atlas& atlas, const std::vector<glm::vec3>& points) {
  std::vector<glm::dvec3> world(points.size());
  const glm::dvec3 base(atlas.lo * Atlas::kBrick);
  std::transform(points.begin(), points.end(), world.begin(),
                 [&](const glm::vec3& p) { return atlas.lattice.to_world(base + glm::dvec3(p)); });
  return world;
}

// The camera asked for; what is not said is chosen so that the content fills the picture.
Camera choose_camera(const Options& options, std::vector<glm::dvec3> content) {
  if (content.empty()) content.assign({glm::dvec3(-1), glm::dvec3(1)});
  Camera camera = frame(content, options.width, options.height, options.view);
  if (options.eye) {
    Box box;
    for (const glm::dvec3& point : content) box.add(point);
    camera.target = options.target.value_or(box.center());
    camera.eye = *options.eye;
    if (camera.eye == camera.target) {
      throw Error(ErrorKind::usage,
                  options.target ? "--eye and --target are the same point"
                                 : "--eye is the content's middle, which the camera looks at "
                                   "unless --target says otherwise");
    }
  } else if (options.target) {
    camera.eye += *options.target - camera.target;
    camera.target = *options.target;
  }
  return camera;
}

// What the channels of an AOV are called in an EXR.
std::vector<std::string> channels_of(const std::string& aov) {
  if (aov == "depth") return {"depth.Z"};
  if (aov == "normal") return {"normal.X", "normal.Y", "normal.Z"};
  if (aov == "steps") return {"steps.N"};
  if (aov == "id") return {"id.I"};
  return {"curvature.K"};
}

struct Rendering {
  Camera camera;
  HitBuffer hits;
  Picture picture;

  // Where the pixel's ray hits.
  [[nodiscard]] glm::dvec3 point(std::size_t pixel) const {
    const std::size_t column = pixel % hits.width;
    const std::size_t row = pixel / hits.width;
    const Ray ray =
        RayGenerator(camera).ray(static_cast<double>(column) + 0.5, static_cast<double>(row) + 0.5);
    return ray.origin + double(hits.depth[pixel]) * ray.direction;
  }
};

void fill_aov(const std::string& aov, const Content& content, const Rendering& r, std::size_t pixel,
              float* out) {
  const bool hit = std::isfinite(r.hits.depth[pixel]);
  if (aov == "depth") {
    *out = r.hits.depth[pixel];
  } else if (aov == "normal") {
    for (int a = 0; a < 3; ++a) out[a] = r.picture.normal[pixel][a];
  } else if (aov == "steps") {
    *out = r.hits.steps[pixel];
  } else if (aov == "id") {
    // Surfaces without a material are 1; those of the scene's n-th one, or painted with n, 1 + n.
    *out = static_cast<float>(hit ? 1 + r.picture.material[pixel] : 0);
  } else if (hit) {
    *out = mean_curvature_at(content.atlas, r.point(pixel));
  }
}

Image make_image(const Options& options, const Content& content, const Rendering& r,
                 const Job& job) {
  Image image{r.hits.width, r.hits.height, {"R", "G", "B"}, {}};
  for (const std::string& aov : options.aovs) {
    for (const std::string& name : channels_of(aov)) image.channels.push_back(name);
  }
  const std::size_t stride = image.channels.size();
  image.pixels.resize(r.hits.size() * stride);
  parallel_for(r.hits.size(), 4096, job, [&](std::size_t begin, std::size_t end) {
    for (std::size_t pixel = begin; pixel < end; ++pixel) {
      float* out = image.pixels.data() + pixel * stride;
      for (int a = 0; a < 3; ++a) *out++ = r.picture.color[pixel][a];
      for (const std::string& aov : options.aovs) {
        fill_aov(aov, content, r, pixel, out);
        out += channels_of(aov).size();
      }
    }
  });
  return image;
}

void report(const std::string& path, const Rendering& r, const Stopwatch& watch, Context& context) {
  const auto hits = static_cast<std::size_t>(std::count_if(
      r.hits.depth.begin(), r.hits.depth.end(), [](float d) { return std::isfinite(d); }));
  const auto steps = std::accumulate(r.hits.steps.begin(), r.hits.steps.end(), std::uint64_t{0});
  Json& result = context.result();
  result["width"] = r.hits.width;
  result["height"] = r.hits.height;
  result["rays"] = r.hits.size();
  result["hits"] = hits;
  result["steps_mean"] = static_cast<double>(steps) / static_cast<double>(r.hits.size());
  result["steps_max"] = *std::max_element(r.hits.steps.begin(), r.hits.steps.end());
  result["refined"] = r.picture.refined;
  result["seconds"] = watch.seconds();
  context.print("{}: {} x {} pixels, {} of {} rays hit, {:.1f} steps a ray, {:.2f} s", path,
                r.hits.width, r.hits.height, hits, r.hits.size(),
                result["steps_mean"].get<double>(), result["seconds"]["total"].get<double>());
}

void check_aovs(const Options& options) {
  if (options.aovs.empty() || holds_any_channel(options.output.path)) return;
  throw Error(ErrorKind::usage, options.output.path +
                                    ": --aov adds channels to an EXR, which a PNG cannot hold; "
                                    "name the output .exr");
}

void trace_and_shade(const Options& options, const Content& content,
                     const Surroundings& surroundings, Stopwatch& watch, const Job& job,
                     Rendering& r) {
  const Atlas& atlas = content.atlas;
  if (content.scene == nullptr) {
    r.hits = trace_primary(atlas, r.camera, job);
    watch.lap("trace");
    const SeenAtlas seen(atlas, options.look.material, content.grid);
    r.picture = shade(seen, atlas, surroundings, r.camera, r.hits, options.look, job);
  } else {
    r.hits = content.scene->trace_primary(r.camera, job);
    watch.lap("trace");
    const double pixel = glm::length(RayGenerator(r.camera).right());
    const SeenField seen(*content.scene, content.materials, options.look.material, 0.02 * pixel);
    r.picture = shade(seen, atlas, surroundings, r.camera, r.hits, options.look, job);
  }
  watch.lap("shade");
}

Exit run(Options options, const CLI::App& app, Context& context) {
  check_output(options.output);
  check_options_for(app, {kind_of(options.input, options.surface.iso.has_value())});
  check_aovs(options);
  // Hits, picture, image and its file are there at once.
  constexpr double kBytesPerPixel = 80;
  check_fits(kBytesPerPixel * options.width * options.height,
             fmt::format("a picture of {} x {} pixels", options.width, options.height),
             "ask for a smaller --size");
  const Job& job = context.job();
  Stopwatch watch;
  const Content content = load_content(options, context);
  const Atlas& atlas = content.atlas;
  watch.lap("load");

  const Surroundings surroundings = make_surroundings(atlas, job);
  Rendering r;
  r.camera = choose_camera(options, world_points(atlas, surface_corners(atlas, job)));
  watch.lap("shade");
  if (surroundings.points.empty()) {
    context.warn(options.input + " has no surface: the picture shows the background only");
  } else if (distance_at(atlas, r.camera.eye) < 0) {
    context.warn("the camera is inside the object and sees its surface from behind");
  }
  trace_and_shade(options, content, surroundings, watch, job, r);
  write_image(options.output.path, make_image(options, content, r, job));
  watch.lap("write");
  report(options.output.path, r, watch, context);
  if (!surroundings.points.empty() && context.result()["hits"] == 0) {
    context.warn("no ray hits the surface; leave --eye and --target out to see all of it");
  }
  return Exit::done;
}

}  // namespace

Run add_render(CLI::App& app) {
  auto options = std::make_shared<Options>();
  options->view.margin = 0.1;
  options->view.fov = 30;
  app.add_option("IN", options->input, "grid (.vdb), mesh, volume or scene (.yaml, .json) to show")
      ->required();
  add_output(app, options->output, image_extensions());
  app.add_option_function<std::string>(
         "--size",
         [options](const std::string& text) { parse_size(text, options->width, options->height); },
         "pixels of the picture")
      ->type_name("WxH")
      ->default_str("1024x1024");
  app.add_option(
         "--dim", options->dim,
         "voxels along the longest side of a mesh or volume; half the picture's size if not given")
      ->check(whole_number(2, 1 << 20));
  add_camera(app, *options);
  add_surface_options(app, options->surface);
  add_scene_options(app, options->time);
  app.add_option("--aov", options->aovs, "further channels of an .exr: " + one_of(kAovs))
      ->delimiter(',')
      ->allow_extra_args(false)
      ->check(known_word(kAovs));
  app.add_option("--samples", options->look.samples,
                 "rays for a pixel with an edge in it; 1 for no antialiasing")
      ->capture_default_str()
      ->check(whole_number(1, 256));
  app.add_flag_callback(
      "--no-floor", [options] { options->look.floor = false; }, "no shadow under the content");
  return [options, &app](Context& context) { return run(*options, app, context); };
}

}  // namespace sdfgrid::cli
