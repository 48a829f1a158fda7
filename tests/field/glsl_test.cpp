// The GLSL reading: compiled where glslangValidator is there.
#include <gtest/gtest.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "field/examples.h"
#include "sdfgrid/core/error.h"

namespace {

bool has_compiler() { return std::system("glslangValidator --version > /dev/null 2>&1") == 0; }

TEST(Glsl, EveryOpCompiles) {
  if (!has_compiler()) GTEST_SKIP() << "glslangValidator (package glslang-tools) is not there";
  const auto folder =
      std::filesystem::temp_directory_path() /
      ("sdfgrid_glsl_" + std::to_string(::testing::UnitTest::GetInstance()->random_seed()) +
       std::to_string(std::hash<std::string>{}(std::filesystem::current_path())));
  std::filesystem::create_directories(folder);
  const auto file = folder / "all.frag";
  // One shader with a function for each op: one start of the compiler.
  std::ofstream out(file);
  out << "#version 300 es\nprecision highp float;\nin vec3 at;\nout vec4 color;\n";
  std::string sum = "0.0";
  int n = 0;
  for (const Example& e : examples()) {
    const std::string name = "field_" + std::to_string(n);
    try {
      out << e.field.glsl(name);
    } catch (const sdfgrid::Error&) {
      continue;  // a Sampler
    }
    sum += " + " + name + "(at)";
    ++n;
  }
  out << "void main() { color = vec4(" << sum << "); }\n";
  out.close();
  EXPECT_GT(n, 30);
  const std::string command =
      "glslangValidator " + file.string() + " > " + (folder / "log").string() + " 2>&1";
  const int status = std::system(command.c_str());
  std::ifstream log(folder / "log");
  const std::string text((std::istreambuf_iterator<char>(log)), {});
  EXPECT_EQ(status, 0) << text.substr(0, 2000);
  std::filesystem::remove_all(folder);
}

TEST(Glsl, IsOneFunction) {
  const std::string text = sdfgrid::make_field("sphere", {{"radius", 2}}).glsl("ball");
  EXPECT_TRUE(text.starts_with("float ball(vec3 p) {\n")) << text;
  EXPECT_NE(text.find("2.0"), std::string::npos) << text;
}

}  // namespace
