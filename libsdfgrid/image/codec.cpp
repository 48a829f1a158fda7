#include "sdfgrid/image/codec.h"

#include <dlfcn.h>

#include "sdfgrid/core/error.h"

namespace sdfgrid {
namespace {

// First where the program says that it looks for libraries (the build and the package say so for
// what links sdfgrid), then where the library was to be installed. It is never unloaded:
// OpenImageIO's libraries were not made for that.
void* open_module() {
  void* module = dlopen(SDFGRID_PICTURES_MODULE, RTLD_NOW | RTLD_LOCAL);
  if (module == nullptr) {
    module = dlopen(SDFGRID_MODULE_FOLDER "/" SDFGRID_PICTURES_MODULE, RTLD_NOW | RTLD_LOCAL);
  }
  return module;
}

const PictureCodec* load() {
  if (void* module = open_module()) {
    if (void* entry = dlsym(module, kPictureCodecSymbol)) {
      return reinterpret_cast<PictureCodecEntry>(entry)();
    }
  }
  const char* reason = dlerror();
  throw Error(ErrorKind::failed, std::string("pictures can be neither read nor written: ") +
                                     (reason != nullptr ? reason : "the module has no entry") +
                                     "; install " SDFGRID_PICTURES_MODULE
                                     " again, in " SDFGRID_MODULE_FOLDER);
}

}  // namespace

const PictureCodec& picture_codec() {
  static const PictureCodec* const codec = load();
  return *codec;
}

}  // namespace sdfgrid
