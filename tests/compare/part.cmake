sdfgrid_test(reference_test SOURCES ${CMAKE_CURRENT_LIST_DIR}/reference_test.cpp)
sdfgrid_test(compare_test SOURCES ${CMAKE_CURRENT_LIST_DIR}/compare_test.cpp PACKAGES OpenVDB::openvdb)

sdfgrid_test(compare_command_test SOURCES ${CMAKE_CURRENT_LIST_DIR}/command_test.cpp
                                          ${CMAKE_CURRENT_LIST_DIR}/../app/process.cpp
             PACKAGES nlohmann_json::nlohmann_json)
target_compile_definitions(compare_command_test PRIVATE SDFGRID_BINARY="$<TARGET_FILE:sdfgrid_app>")
add_dependencies(compare_command_test sdfgrid_app)
