sdfgrid_test(transform_test SOURCES
  ${CMAKE_CURRENT_LIST_DIR}/dense_test.cpp
  ${CMAKE_CURRENT_LIST_DIR}/mesh_test.cpp
  ${CMAKE_CURRENT_LIST_DIR}/methods_test.cpp
  ${CMAKE_CURRENT_LIST_DIR}/stability_test.cpp)
