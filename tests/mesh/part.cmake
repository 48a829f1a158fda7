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
