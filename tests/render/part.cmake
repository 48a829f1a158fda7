# Pictures: written and read, framed, shaded, and asked for on the command line.
sdfgrid_test(image_test SOURCES ${CMAKE_CURRENT_LIST_DIR}/image_test.cpp)
sdfgrid_test(shade_test SOURCES ${CMAKE_CURRENT_LIST_DIR}/far_field_test.cpp
                                ${CMAKE_CURRENT_LIST_DIR}/framing_test.cpp
                                ${CMAKE_CURRENT_LIST_DIR}/scenes.cpp
                                ${CMAKE_CURRENT_LIST_DIR}/shade_test.cpp
             PACKAGES OpenVDB::openvdb)
find_package(nlohmann_json REQUIRED)
sdfgrid_test(render_app_test SOURCES ${CMAKE_CURRENT_LIST_DIR}/render_app_test.cpp
                                     ${CMAKE_CURRENT_LIST_DIR}/scenes.cpp
                                     ${CMAKE_CURRENT_LIST_DIR}/../app/process.cpp
             PACKAGES OpenVDB::openvdb nlohmann_json::nlohmann_json)
target_compile_definitions(render_app_test PRIVATE SDFGRID_BINARY="$<TARGET_FILE:sdfgrid_app>")
add_dependencies(render_app_test sdfgrid_app)
