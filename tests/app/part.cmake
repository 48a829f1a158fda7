# The command line's contract (exit codes, streams, files), kept by the binary itself.
find_package(nlohmann_json REQUIRED)
sdfgrid_test(app_test SOURCES ${CMAKE_CURRENT_LIST_DIR}/contract_test.cpp
                              ${CMAKE_CURRENT_LIST_DIR}/sample_test.cpp
                              ${CMAKE_CURRENT_LIST_DIR}/usage_test.cpp
                              ${CMAKE_CURRENT_LIST_DIR}/progress_test.cpp
                              ${CMAKE_CURRENT_LIST_DIR}/words_test.cpp
                              ${CMAKE_CURRENT_LIST_DIR}/process.cpp
                              ${PROJECT_SOURCE_DIR}/apps/sdfgrid/progress.cpp
             PACKAGES nlohmann_json::nlohmann_json)
# Measures how fast the program lets go, so it runs alone.
sdfgrid_test(interrupt_test SERIAL SOURCES ${CMAKE_CURRENT_LIST_DIR}/interrupt_test.cpp
                                           ${CMAKE_CURRENT_LIST_DIR}/process.cpp
             PACKAGES nlohmann_json::nlohmann_json)
foreach(test app_test interrupt_test)
  target_compile_definitions(${test} PRIVATE SDFGRID_BINARY="$<TARGET_FILE:sdfgrid_app>"
                                             SDFGRID_SOURCE_DIR="${PROJECT_SOURCE_DIR}")
  target_include_directories(${test} PRIVATE ${PROJECT_SOURCE_DIR}/apps)
  add_dependencies(${test} sdfgrid_app)
endforeach()
