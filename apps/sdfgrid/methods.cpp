#include "methods.h"

#include <fmt/format.h>

#include <algorithm>

#include "options.h"
#include "sdfgrid/core/error.h"
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

// An option that none of the methods has a use for, but others have.
[[noreturn]] void refuse_for(const std::vector<std::string>& methods, const std::string& option,
                             bool TransformMethodInfo::*takes) {
  std::vector<std::string> takers;
  for (const TransformMethodInfo& info : transform_methods()) {
    if (info.*takes) takers.emplace_back(info.name);
  }
  throw Error(ErrorKind::usage, fmt::format("{} is for the method {}, not for {}", option,
                                            one_of(takers), one_of(methods)));
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
      ->check(known_word(names));
}

TransformOptions TransformChoice::options_for(const std::vector<std::string>& methods) const {
  TransformOptions options;
  bool any_buckets = methods.empty();
  bool any_steps = methods.empty();
  for (const TransformMethodInfo& info : transform_methods()) {
    if (std::find(methods.begin(), methods.end(), info.name) == methods.end()) continue;
    any_buckets = any_buckets || info.buckets;
    any_steps = any_steps || info.steps;
    if (info.steps && mask.empty()) {
      throw Error(ErrorKind::usage,
                  fmt::format("the method {} needs a mask: give --mask FILE", info.name));
    }
  }
  if (bucket && !any_buckets) refuse_for(methods, "--bucket", &TransformMethodInfo::buckets);
  if (!mask.empty() && !any_steps) refuse_for(methods, "--mask", &TransformMethodInfo::steps);
  if (bucket) options.bucket_width = *bucket;
  if (!mask.empty()) options.steps = read_chamfer_steps(mask);
  return options;
}

void add_transform_choice(CLI::App& app, TransformChoice& choice) {
  app.add_option(
         "--bucket", choice.bucket,
         fmt::format("width of the buckets of the marching methods, voxels, {} if not given; "
                     "0: a binary heap",
                     TransformOptions().bucket_width))
      ->check(CLI::Range(0.0, kMostBucket) & finite_number());
  app.add_option("--mask", choice.mask,
                 "the steps of the method chamfer: a file of lines `x y z length`, in voxels, "
                 "x >= y >= z, each for all its permutations and signs")
      ->type_name("FILE");
}

}  // namespace sdfgrid::cli
