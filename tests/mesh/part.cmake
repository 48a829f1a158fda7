sdfgrid_test(mesh_test SOURCES
  ${CMAKE_CURRENT_LIST_DIR}/diagnose_test.cpp
  ${CMAKE_CURRENT_LIST_DIR}/om_files.cpp
  ${CMAKE_CURRENT_LIST_DIR}/orient_test.cpp
  ${CMAKE_CURRENT_LIST_DIR}/read_fuzz_test.cpp
  ${CMAKE_CURRENT_LIST_DIR}/read_openmesh_test.cpp
  ${CMAKE_CURRENT_LIST_DIR}/read_refused_test.cpp
  ${CMAKE_CURRENT_LIST_DIR}/read_test.cpp
  ${CMAKE_CURRENT_LIST_DIR}/triangulate_test.cpp
  PACKAGES OpenMeshCore)
# GCC 12 takes the value that OpenMesh fills new vectors with for uninitialized.
set_source_files_properties(${CMAKE_CURRENT_LIST_DIR}/om_files.cpp PROPERTIES
  COMPILE_OPTIONS "$<$<CXX_COMPILER_ID:GNU>:-Wno-maybe-uninitialized>")

find_package(nlohmann_json REQUIRED)
sdfgrid_test(info_test SOURCES ${CMAKE_CURRENT_LIST_DIR}/info_test.cpp
                               ${CMAKE_CURRENT_LIST_DIR}/../app/process.cpp
             PACKAGES nlohmann_json::nlohmann_json)
target_compile_definitions(info_test PRIVATE SDFGRID_BINARY="$<TARGET_FILE:sdfgrid_app>")
add_dependencies(info_test sdfgrid_app)
