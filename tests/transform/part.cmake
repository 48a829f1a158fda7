sdfgrid_test(transform_test SOURCES
  ${CMAKE_CURRENT_LIST_DIR}/dense_test.cpp)
