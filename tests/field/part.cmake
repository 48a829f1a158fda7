# Roots as kernels compute them.
add_library(field_roots INTERFACE)
sdfgrid_kernel(field_roots ${CMAKE_CURRENT_LIST_DIR}/roots_kernel.cpp)
foreach(isa IN LISTS SDFGRID_ISAS)
  target_include_directories(field_roots_roots_kernel_${isa} PRIVATE ${PROJECT_SOURCE_DIR}/tests)
  target_compile_options(field_roots_roots_kernel_${isa} PRIVATE -ffp-contract=off)
endforeach()

# Analytic fields: every op of the list against brute force and the other readings.
sdfgrid_test(field_test SOURCES ${CMAKE_CURRENT_LIST_DIR}/blends_test.cpp
                                ${CMAKE_CURRENT_LIST_DIR}/brute_force.cpp
                                ${CMAKE_CURRENT_LIST_DIR}/exact_test.cpp
                                ${CMAKE_CURRENT_LIST_DIR}/examples.cpp
                                ${CMAKE_CURRENT_LIST_DIR}/field_test.cpp
                                ${CMAKE_CURRENT_LIST_DIR}/file_leaves.cpp
                                ${CMAKE_CURRENT_LIST_DIR}/formula_estimate_test.cpp
                                ${CMAKE_CURRENT_LIST_DIR}/formula_safety_test.cpp
                                ${CMAKE_CURRENT_LIST_DIR}/formula_test.cpp
                                ${CMAKE_CURRENT_LIST_DIR}/fractal_test.cpp
                                ${CMAKE_CURRENT_LIST_DIR}/glsl_test.cpp
                                ${CMAKE_CURRENT_LIST_DIR}/graph_test.cpp
                                ${CMAKE_CURRENT_LIST_DIR}/noise_test.cpp
                                ${CMAKE_CURRENT_LIST_DIR}/ops_test.cpp
                                ${CMAKE_CURRENT_LIST_DIR}/pairs.cpp
                                ${CMAKE_CURRENT_LIST_DIR}/repeat_test.cpp
                                ${CMAKE_CURRENT_LIST_DIR}/roots_test.cpp
                                ${CMAKE_CURRENT_LIST_DIR}/sampler_uses_test.cpp
                                ${CMAKE_CURRENT_LIST_DIR}/slope_test.cpp
                                ${CMAKE_CURRENT_LIST_DIR}/solids.cpp
                                ${CMAKE_CURRENT_LIST_DIR}/solids_corners.cpp
                                ${CMAKE_CURRENT_LIST_DIR}/solids_leaves.cpp
                                ${CMAKE_CURRENT_LIST_DIR}/solids_nodes.cpp
                                ${CMAKE_CURRENT_LIST_DIR}/solids_test.cpp
                                ${CMAKE_CURRENT_LIST_DIR}/union_tree_test.cpp
             PACKAGES fmt::fmt field_roots)
foreach(isa baseline avx2)
  add_test(NAME FieldOps.${isa} COMMAND field_test --gtest_filter=*Ops.*)
  set_tests_properties(FieldOps.${isa} PROPERTIES ENVIRONMENT SDFGRID_ISA=${isa} LABELS fast)
endforeach()

# Where EGL's headers are (libegl-dev); the test itself is skipped where there is no renderer.
find_path(SDFGRID_EGL_INCLUDE EGL/egl.h)
find_library(SDFGRID_EGL_LIBRARY EGL)
if(SDFGRID_EGL_INCLUDE AND SDFGRID_EGL_LIBRARY)
  sdfgrid_test(glsl_run_test SOURCES ${CMAKE_CURRENT_LIST_DIR}/glsl_run_test.cpp
                                     ${CMAKE_CURRENT_LIST_DIR}/examples.cpp
                                     ${CMAKE_CURRENT_LIST_DIR}/file_leaves.cpp
                                     ${CMAKE_CURRENT_LIST_DIR}/software_gl.cpp
               PACKAGES ${SDFGRID_EGL_LIBRARY})
else()
  message(STATUS "no EGL (package libegl-dev): GLSL is compiled in tests, not evaluated")
endif()
