# Measuring by parts of the field, choosing by measured errors, and the chart on the command line.
find_package(nlohmann_json REQUIRED)
sdfgrid_test(choose_test SOURCES ${CMAKE_CURRENT_LIST_DIR}/choose_test.cpp
                                 ${CMAKE_CURRENT_LIST_DIR}/survey_test.cpp)
sdfgrid_test(chart_app_test SOURCES ${CMAKE_CURRENT_LIST_DIR}/command_test.cpp
                                    ${PROJECT_SOURCE_DIR}/tests/app/process.cpp
             PACKAGES nlohmann_json::nlohmann_json)
target_compile_definitions(chart_app_test PRIVATE SDFGRID_BINARY="$<TARGET_FILE:sdfgrid_app>")
add_dependencies(chart_app_test sdfgrid_app)
