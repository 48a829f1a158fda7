// tests/app/process.h: runs the sdfgrid binary as a user's script would, and sees what it did.
#pragma once

#include <sys/types.h>

#include <filesystem>
#include <string>
#include <vector>

namespace sdfgrid::test {

// A folder of its own for a test, removed with all that is in it.
class Folder {
 public:
  Folder();
  ~Folder();
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;

  [[nodiscard]] std::string path(const std::string& name) const { return (root_ / name).string(); }
  // Names of the files in it, hidden ones too, sorted.
  [[nodiscard]] std::vector<std::string> files() const;
  // Writes a file and returns its path.
  [[nodiscard]] std::string write(const std::string& name, const std::string& text) const;

 private:
  std::filesystem::path root_;
};

struct Outcome {
  int exit = -1;      // its exit code, or -1 if a signal ended it
  std::string out;    // standard output
  std::string error;  // standard error
};

// One run of the binary. Its output goes to files in a folder of its own, so that it never waits
// for us.
class Process {
 public:
  explicit Process(const std::vector<std::string>& arguments);
  ~Process();
  Process(const Process&) = delete;
  Process& operator=(const Process&) = delete;

  void send(int signal) const;
  // What it wrote to standard error so far.
  [[nodiscard]] std::string error_so_far() const;
  [[nodiscard]] Outcome wait();

 private:
  Folder folder_;
  pid_t pid_ = -1;
};

[[nodiscard]] Outcome run(const std::vector<std::string>& arguments);

// A closed unit cube of twelve triangles, as an OFF file's text.
[[nodiscard]] std::string cube_off();

}  // namespace sdfgrid::test
