# Scene files: read, refused, saved, made into fields.
sdfgrid_test(scene_test SOURCES ${CMAKE_CURRENT_LIST_DIR}/scene_test.cpp
                                ${CMAKE_CURRENT_LIST_DIR}/convert_field_test.cpp
                                ${CMAKE_CURRENT_LIST_DIR}/field_trace_test.cpp
                                ${CMAKE_CURRENT_LIST_DIR}/formula_trace_test.cpp
                                ${CMAKE_CURRENT_LIST_DIR}/refused_test.cpp
                                ${CMAKE_CURRENT_LIST_DIR}/csg_surface_test.cpp
                                ${CMAKE_CURRENT_LIST_DIR}/file_leaves_test.cpp
                                ${CMAKE_CURRENT_LIST_DIR}/paint_scene_test.cpp
                                ${CMAKE_CURRENT_LIST_DIR}/words_test.cpp
                                ${CMAKE_CURRENT_LIST_DIR}/first_root.cpp
                                ${CMAKE_CURRENT_LIST_DIR}/../app/process.cpp
             PACKAGES OpenVDB::openvdb)
target_compile_definitions(scene_test PRIVATE SDFGRID_BINARY="")

# Rays against fields on every instruction set.
foreach(isa baseline avx2)
  add_test(NAME FieldTrace.${isa} COMMAND scene_test --gtest_filter=FieldTrace*)
  set_tests_properties(FieldTrace.${isa} PROPERTIES ENVIRONMENT SDFGRID_ISA=${isa} LABELS fast)
endforeach()

# A million rays: SDFGRID_HOSTILE_RAYS=1000000 build/release/tests/hostile_test --gtest_filter=*Solids
sdfgrid_test(hostile_test LABEL heavy
             SOURCES ${CMAKE_CURRENT_LIST_DIR}/hostile_test.cpp
                     ${CMAKE_CURRENT_LIST_DIR}/first_root.cpp
                     ${CMAKE_CURRENT_LIST_DIR}/../field/examples.cpp
                     ${CMAKE_CURRENT_LIST_DIR}/../field/file_leaves.cpp
             PACKAGES fmt::fmt)
foreach(isa baseline avx2)
  add_test(NAME Hostile.${isa} COMMAND hostile_test)
  set_tests_properties(Hostile.${isa} PROPERTIES LABELS heavy ENVIRONMENT
                                                 "SDFGRID_ISA=${isa};SDFGRID_HOSTILE_RAYS=3000")
endforeach()

find_package(nlohmann_json REQUIRED)
sdfgrid_test(scene_app_test SOURCES ${CMAKE_CURRENT_LIST_DIR}/scene_app_test.cpp
                                   ${CMAKE_CURRENT_LIST_DIR}/../app/process.cpp
             PACKAGES nlohmann_json::nlohmann_json)
target_compile_definitions(scene_app_test PRIVATE SDFGRID_BINARY="$<TARGET_FILE:sdfgrid_app>"
                                                  SDFGRID_SOURCE_DIR="${PROJECT_SOURCE_DIR}")
add_dependencies(scene_app_test sdfgrid_app)
