sdfgrid_test(transform_test SOURCES
  ${CMAKE_CURRENT_LIST_DIR}/antialiased_test.cpp
  ${CMAKE_CURRENT_LIST_DIR}/convert_dense_test.cpp
  ${CMAKE_CURRENT_LIST_DIR}/corner_test.cpp
  ${CMAKE_CURRENT_LIST_DIR}/dense_test.cpp
  ${CMAKE_CURRENT_LIST_DIR}/marching_test.cpp
  ${CMAKE_CURRENT_LIST_DIR}/mesh_test.cpp
  ${CMAKE_CURRENT_LIST_DIR}/methods_test.cpp
  ${CMAKE_CURRENT_LIST_DIR}/stability_test.cpp)

# Fast marching with every instruction set that this machine has.
foreach(isa baseline avx2 avx512)
  add_test(NAME Marching.${isa} COMMAND transform_test --gtest_filter=Marching.*)
  set_tests_properties(Marching.${isa} PROPERTIES ENVIRONMENT SDFGRID_ISA=${isa} LABELS fast)
endforeach()
