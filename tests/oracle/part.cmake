# Another library as the judge. CGAL's trees are GPL-3.0-or-later: these programs are not installed.
if(SDFGRID_WITH_CGAL)
  find_package(CGAL REQUIRED)
  sdfgrid_test(cgal_test SOURCES ${CMAKE_CURRENT_LIST_DIR}/cgal_test.cpp PACKAGES CGAL::CGAL)
  # CGAL's own headers shadow and convert as they like, and need the rounding that -frounding-math keeps.
  target_compile_options(cgal_test PRIVATE -Wno-shadow -Wno-conversion -Wno-pedantic)
endif()
