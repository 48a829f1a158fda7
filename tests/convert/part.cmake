sdfgrid_test(convert_test SOURCES
  ${CMAKE_CURRENT_LIST_DIR}/brick_kernel_test.cpp
  ${CMAKE_CURRENT_LIST_DIR}/convert_test.cpp
  ${CMAKE_CURRENT_LIST_DIR}/sign_test.cpp
  PACKAGES OpenVDB::openvdb)
sdfgrid_test(convert_memory_test SOURCES ${CMAKE_CURRENT_LIST_DIR}/memory_test.cpp SERIAL)
