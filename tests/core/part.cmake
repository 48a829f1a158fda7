# What all rooms stand on: threads and memory.
sdfgrid_test(core_test SOURCES ${CMAKE_CURRENT_LIST_DIR}/memory_test.cpp
                               ${CMAKE_CURRENT_LIST_DIR}/parallel_test.cpp)
