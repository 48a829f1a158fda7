#include "sdfgrid/core/error.h"

namespace sdfgrid {

Error input_error(const std::string& file, const std::string& place, const std::string& problem,
                  const std::string& remedy) {
  std::string text = file + ": ";
  if (!place.empty()) text += place + ": ";
  text += problem;
  if (!remedy.empty()) text += "; " + remedy;
  return {ErrorKind::input, text};
}

}  // namespace sdfgrid
