# Rays against slow references; the packets of each instruction set that the machine has.
sdfgrid_test(trace_test SOURCES ${CMAKE_CURRENT_LIST_DIR}/atlas_test.cpp
                                ${CMAKE_CURRENT_LIST_DIR}/atlas_kernel_test.cpp
                                ${CMAKE_CURRENT_LIST_DIR}/cubic_test.cpp
                                ${CMAKE_CURRENT_LIST_DIR}/grid_sampler_test.cpp
                                ${CMAKE_CURRENT_LIST_DIR}/lattice_field.cpp
                                ${CMAKE_CURRENT_LIST_DIR}/long_rays_test.cpp
                                ${CMAKE_CURRENT_LIST_DIR}/rough_grids.cpp
                                ${CMAKE_CURRENT_LIST_DIR}/trace_test.cpp
             PACKAGES OpenVDB::openvdb)
foreach(isa baseline avx2)
  add_test(NAME Packets.${isa} COMMAND trace_test --gtest_filter=Packets.*)
  set_tests_properties(Packets.${isa} PROPERTIES ENVIRONMENT SDFGRID_ISA=${isa} LABELS fast)
endforeach()
