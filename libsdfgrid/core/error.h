// core/error.h: what the library throws. One type with a kind, so that a caller (the command line,
// say) maps it to an exit code in one place and a message never depends on who prints it.
#pragma once

#include <stdexcept>
#include <string>

namespace sdfgrid {

enum class ErrorKind {
  failed,     // it broke while working: disk full, over the memory limit
  usage,      // the caller asked for something that does not exist or is out of range
  input,      // the input was refused: unreadable, malformed, empty, not finite
  cancelled,  // the caller's Job asked to stop
};

class Error : public std::runtime_error {
 public:
  Error(ErrorKind kind, const std::string& message) : std::runtime_error(message), kind_(kind) {}
  [[nodiscard]] ErrorKind kind() const { return kind_; }

 private:
  ErrorKind kind_;
};

// A refused input, as "FILE: PLACE: PROBLEM; REMEDY". `place` is a line ("line 12"), a byte
// ("byte 84") or a part ("header"), and may be empty when the whole file is at fault.
[[nodiscard]] Error input_error(const std::string& file, const std::string& place,
                                const std::string& problem, const std::string& remedy);

}  // namespace sdfgrid
