sdfgrid_test(winding_test SOURCES ${CMAKE_CURRENT_LIST_DIR}/winding_test.cpp
             ${CMAKE_CURRENT_LIST_DIR}/gradient_bound_test.cpp)
