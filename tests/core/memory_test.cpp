// How much memory there is, where the machine is not what limits it.
#include "sdfgrid/core/memory.h"

#include <gtest/gtest.h>
#include <sys/resource.h>

#include <fstream>
#include <string>

#include "sdfgrid/core/error.h"

namespace sdfgrid {
namespace {

// Lowers the limit of address space to what is used now and `room` bytes more, for a while.
class AddressSpace {
 public:
  explicit AddressSpace(double room) {
    ::getrlimit(RLIMIT_AS, &before_);
    ::rlimit now = before_;
    now.rlim_cur = static_cast<rlim_t>(used() + room);
    set_ = ::setrlimit(RLIMIT_AS, &now) == 0;
  }
  ~AddressSpace() { ::setrlimit(RLIMIT_AS, &before_); }
  AddressSpace(const AddressSpace&) = delete;
  AddressSpace& operator=(const AddressSpace&) = delete;
  [[nodiscard]] bool set() const { return set_; }

 private:
  static double used() {
    std::ifstream status("/proc/self/status");
    for (std::string word; status >> word;) {
      double kilobytes = 0;
      if (word == "VmSize:" && status >> kilobytes) return 1024 * kilobytes;
    }
    return 0;
  }
  ::rlimit before_{};
  bool set_ = false;
};

TEST(Memory, LimitOfAddressSpaceCounts) {
  const double before = available_memory();
  EXPECT_GT(before, 0);
  const AddressSpace limited(50e6);
  if (!limited.set()) GTEST_SKIP() << "the limit cannot be set here";
  EXPECT_LT(available_memory(), 51e6);
  EXPECT_NO_THROW(check_fits(1e6, "it", "wait"));
  try {
    check_fits(60e6, "the work", "do less");
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::failed);
    const std::string text = error.what();
    EXPECT_EQ(text.find("the work takes about 0.1 GB"), 0U) << text;
    EXPECT_NE(text.find("; do less"), std::string::npos) << text;
  }
}

}  // namespace
}  // namespace sdfgrid
