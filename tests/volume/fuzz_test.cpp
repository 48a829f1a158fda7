// Damaged volumes: whatever is in them, they are read or refused, and what is read is whole.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cstdlib>

#include "sdfgrid/volume/write.h"
#include "volume/volumes.h"

namespace sdfgrid {
namespace {

using namespace testing;

std::string damaged(std::string bytes, std::mt19937& random) {
  const bool headerward = random() % 4 != 0;  // samples can hardly be wrong
  for (auto changes = 1 + random() % 3; changes > 0 && !bytes.empty(); --changes) {
    const std::size_t range = headerward ? std::min(bytes.size(), std::size_t{360}) : bytes.size();
    const std::size_t at = random() % range;
    switch (random() % 5) {
      case 0:
        bytes[at] = static_cast<char>(bytes[at] ^ (1 << random() % 8));
        break;
      case 1:
        bytes[at] = "0123456789-+.e:(), %d\n\x7f\xff"[random() % 24];
        break;
      case 2:
        bytes.insert(at, bytes.substr(random() % bytes.size(), 1 + random() % 8));
        break;
      case 3:
        bytes.erase(at, 1 + random() % 8);
        break;
      default:
        bytes.resize(at);
        break;
    }
  }
  return bytes;
}

int number_of_cases() {
  const char* asked = std::getenv("SDFGRID_FUZZ_CASES");
  return asked == nullptr ? 200 : std::atoi(asked);
}

std::string nifti_bytes() {
  std::string bytes(352, '\0');
  const auto put = [&](std::size_t at, auto value) {
    bytes.replace(at, sizeof(value), bytes_of(value));
  };
  put(0, std::int32_t{348});
  const std::int16_t dims[] = {3, 5, 4, 3, 1, 1, 1, 1};
  for (std::size_t a = 0; a < 8; ++a) put(40 + 2 * a, dims[a]);
  put(70, std::int16_t{4});
  put(72, std::int16_t{16});
  for (std::size_t a = 0; a < 8; ++a) put(76 + 4 * a, 1.0F);
  put(108, 352.0F);
  bytes.replace(344, 3, "n+1");
  return bytes + sample_bytes<std::int16_t>(pattern_volume<std::int16_t>());
}

std::vector<NamedFile> inputs() {
  const TempDir folder;
  const auto written = [&](const char* name) {
    write_volume(pattern_volume<float>(), folder.path(name), Job());
    std::ifstream in(folder.path(name), std::ios::binary);
    return std::string(std::istreambuf_iterator<char>(in), {});
  };
  const std::string head = "NRRD0004\ntype: short\ndimension: 3\nsizes: 5 4 3\nendian: little\n";
  const std::string samples = sample_bytes<std::int16_t>(pattern_volume<std::int16_t>());
  return {{"a.npy", "npy", written("a.npy")},
          {"a.nrrd", "nrrd", written("a.nrrd")},
          {"gzip.nrrd", "gzip", head + "encoding: gzip\n\n" + gzip(samples)},
          {"many.nhdr", "nhdr", head + "encoding: raw\ndata file: s%d.raw 0 2 1\n"},
          {"a.nii", "nii", nifti_bytes()},
          {"a.nii.gz", "niigz", gzip(nifti_bytes())}};
}

class DamagedVolume : public ::testing::TestWithParam<NamedFile> {};

TEST_P(DamagedVolume, IsReadOrRefused) {
  const int cases = number_of_cases();
  const TempDir folder;
  for (int k = 0; k < 3; ++k) (void)folder.write(fmt::format("s{}.raw", k), std::string(40, 'a'));
  std::mt19937 random(7);
  int refused = 0;
  for (int i = 0; i < cases; ++i) {
    const std::string path = folder.write(GetParam().name, damaged(GetParam().bytes, random));
    try {
      const Volume volume = read(path).volume;
      ASSERT_GT(volume.size(), 0U);
      std::visit([&](const auto& values) { ASSERT_EQ(values.size(), volume.size()); },
                 volume.samples);
    } catch (const Error& error) {
      ASSERT_EQ(error.kind(), ErrorKind::input) << error.what();
      ASSERT_NE(std::string(error.what()).find(folder.path("")), std::string::npos) << error.what();
      ++refused;
    }
  }
  EXPECT_GT(refused, cases / 10);
}

// Every length: no file that is cut short anywhere is taken for whole.
TEST_P(DamagedVolume, CutAnywhereIsRefused) {
  if (GetParam().format == "nhdr") GTEST_SKIP() << "its samples are in other files";
  const TempDir folder;
  const std::string& bytes = GetParam().bytes;
  for (std::size_t length = 0; length < bytes.size(); ++length) {
    // gzip's last bytes end the stream and check it: all samples are there before them.
    if (GetParam().format.find("z") != std::string::npos && length + 10 >= bytes.size()) break;
    const std::string path = folder.write(GetParam().name, bytes.substr(0, length));
    EXPECT_NE(refusal(path), "") << "after " << length << " of " << bytes.size() << " bytes";
  }
}

INSTANTIATE_TEST_SUITE_P(EveryFormat, DamagedVolume, ::testing::ValuesIn(inputs()),
                         [](const auto& test) { return test.param.format; });

}  // namespace
}  // namespace sdfgrid
