// `sdfgrid sample` as numpy reads it: each row's distance is that of the row's own point, with the
// sign that the other commands give it.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "app/process.h"

namespace sdfgrid::test {
namespace {

// The rows of a .npy of doubles.
std::vector<std::vector<double>> rows(const std::string& path, std::size_t columns) {
  std::ifstream in(path, std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(in), {}};
  EXPECT_NE(bytes.find("'<f8'"), std::string::npos);
  const std::size_t start = bytes.find('\n') + 1;
  std::vector<double> values((bytes.size() - start) / sizeof(double));
  std::memcpy(values.data(), bytes.data() + start, values.size() * sizeof(double));
  std::vector<std::vector<double>> table;
  for (std::size_t i = 0; i + columns <= values.size(); i += columns) {
    table.emplace_back(values.begin() + static_cast<std::ptrdiff_t>(i),
                       values.begin() + static_cast<std::ptrdiff_t>(i + columns));
  }
  return table;
}

// Signed distance to the unit cube whose lowest corner is at `corner`.
double to_cube(const std::vector<double>& p, const double corner[3]) {
  double outside = 0;
  double most = -1e300;
  for (std::size_t a = 0; a < 3; ++a) {
    const double q = std::abs(p[a] - corner[a] - 0.5) - 0.5;
    outside += std::max(q, 0.0) * std::max(q, 0.0);
    most = std::max(most, q);
  }
  return std::sqrt(outside) + std::min(most, 0.0);
}

class Sample : public ::testing::Test {
 protected:
  Folder folder_;
  std::string out_ = folder_.path("samples.npy");
};

TEST_F(Sample, DistancesBelongToTheWrittenPointsFarFromZero) {
  const double corner[3] = {612345, 4123456, 312};
  std::string text = "OFF\n8 12 0\n";
  for (const char* v :
       {"612345 4123456 312", "612346 4123456 312", "612346 4123457 312", "612345 4123457 312",
        "612345 4123456 313", "612346 4123456 313", "612346 4123457 313", "612345 4123457 313"}) {
    text += std::string(v) + "\n";
  }
  text += cube_off().substr(cube_off().find("3 0 2 1"));
  const std::string cube = folder_.write("utm.off", text);
  const Outcome outcome = run({"sample", cube, "-o", out_, "--random", "500"});
  ASSERT_EQ(outcome.exit, 0) << outcome.error;
  const auto table = rows(out_, 4);
  ASSERT_EQ(table.size(), 500U);
  for (const std::vector<double>& row : table) ASSERT_NEAR(row[3], to_cube(row, corner), 1e-6);
}

TEST_F(Sample, TurnsAMeshThatIsInsideOutAsConvertDoes) {
  std::string text = cube_off().substr(0, cube_off().find("3 0 2 1"));
  for (const char* face : {"3 0 1 2", "3 0 2 3", "3 4 6 5", "3 4 7 6", "3 0 5 1", "3 0 4 5",
                           "3 1 6 2", "3 1 5 6", "3 2 7 3", "3 2 6 7", "3 3 4 0", "3 3 7 4"}) {
    text += std::string(face) + "\n";
  }
  const std::string cube = folder_.write("inside_out.off", text);
  const Outcome outcome = run({"sample", cube, "-o", out_, "--random", "500", "--gradient"});
  ASSERT_EQ(outcome.exit, 0) << outcome.error;
  EXPECT_NE(outcome.error.find("inside out"), std::string::npos) << outcome.error;
  const double corner[3] = {0, 0, 0};
  int inside = 0;
  for (const std::vector<double>& row : rows(out_, 7)) {
    ASSERT_NEAR(row[3], to_cube(row, corner), 1e-6);
    inside += row[3] < 0 ? 1 : 0;
  }
  EXPECT_GT(inside, 50);
}

}  // namespace
}  // namespace sdfgrid::test
