#include "methods.h"

#include <algorithm>

#include "options.h"
#include "sdfgrid/transform/chamfer.h"

namespace sdfgrid::cli {
namespace {

std::vector<std::string> method_names(bool peers) {
  std::vector<std::string> names;
  for (const ConvertMethod& method : convert_methods()) {
    if (peers || !method.peer) names.push_back(method.name);
  }
  return names;
}

}  // namespace

CLI::Option* add_method(CLI::App& app, std::string& chosen) {
  std::vector<std::pair<std::string, std::string>> choices;
  for (const std::string& name : method_names(false)) choices.emplace_back(name, name);
  return add_choice(app, "--method", chosen, choices, "how distances are made");
}

CLI::Option* add_methods(CLI::App& app, std::vector<std::string>& chosen,
                         const std::string& purpose, bool peers) {
  const std::vector<std::string> names = method_names(peers);
  return app.add_option("--methods", chosen, purpose + ", all if not given: " + one_of(names))
      ->delimiter(',')
      ->allow_extra_args(false)
      ->type_name("WORDS")
      ->each([names](const std::string& word) {
        if (std::find(names.begin(), names.end(), word) == names.end()) {
          refuse_choice("--methods", word, names);
        }
      });
}

TransformOptions TransformChoice::options() const {
  TransformOptions options;
  options.bucket_width = bucket;
  if (!mask.empty()) options.steps = read_chamfer_steps(mask);
  return options;
}

void add_transform_choice(CLI::App& app, TransformChoice& choice) {
  app.add_option("--bucket", choice.bucket,
                 "width of the buckets of the marching methods, voxels; 0: a binary heap")
      ->check(CLI::Range(0.0, 16.0) & finite_number())
      ->capture_default_str();
  app.add_option("--mask", choice.mask,
                 "the steps of the method chamfer: a file of lines `x y z length`, in voxels, "
                 "x >= y >= z, each for all its permutations and signs")
      ->type_name("FILE");
}

}  // namespace sdfgrid::cli
