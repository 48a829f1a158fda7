// What the leak sanitizer is to overlook: teem does not free the decompressor of a damaged gzip
// file.
extern "C" const char* __lsan_default_suppressions();   // NOLINT: the sanitizer's name
extern "C" const char* __lsan_default_suppressions() {  // NOLINT
  return "leak:libteem.so\nleak:libz.so\n";
}
