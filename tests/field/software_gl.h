// tests/field/software_gl.h: runs GLSL functions of a point on Mesa's software renderer, without a
// display or a graphics card.
#pragma once

#include <memory>
#include <string>
#include <vector>

class SoftwareGl {
 public:
  // Null where there is no EGL that draws without a display; `why` then says what is missing.
  static std::unique_ptr<SoftwareGl> start(std::string& why);
  virtual ~SoftwareGl() = default;
  // The values of `float NAME(vec3 p)`, given by its text, at n points (x, y and z of each).
  // Throws std::runtime_error with the compiler's log.
  virtual std::vector<float> run(const std::string& text, const std::string& name,
                                 const std::vector<float>& points) = 0;
  // What draws, as it calls itself.
  [[nodiscard]] virtual std::string name() const = 0;
};
