sdfgrid_test(reference_test SOURCES ${CMAKE_CURRENT_LIST_DIR}/reference_test.cpp)
sdfgrid_test(compare_test SOURCES ${CMAKE_CURRENT_LIST_DIR}/compare_test.cpp PACKAGES OpenVDB::openvdb)
