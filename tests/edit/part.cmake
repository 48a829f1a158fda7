# Strokes against closed forms and slow references, undo, sessions and their crashes.
set(edit_grids ${CMAKE_CURRENT_LIST_DIR}/grids.cpp)
sdfgrid_test(edit_test SOURCES ${edit_grids} ${CMAKE_CURRENT_LIST_DIR}/combine_kernel_test.cpp
                               ${CMAKE_CURRENT_LIST_DIR}/sculptor_test.cpp
                               ${CMAKE_CURRENT_LIST_DIR}/stroke_file_test.cpp
                               ${CMAKE_CURRENT_LIST_DIR}/clay_test.cpp
                               ${CMAKE_CURRENT_LIST_DIR}/placement_test.cpp
                               ${CMAKE_CURRENT_LIST_DIR}/live_atlas_test.cpp
                               ${CMAKE_CURRENT_LIST_DIR}/undo_pool_test.cpp
                               ${CMAKE_CURRENT_LIST_DIR}/undo_budget_test.cpp
                               ${CMAKE_CURRENT_LIST_DIR}/undo_test.cpp
                               ${CMAKE_CURRENT_LIST_DIR}/stamp_test.cpp
                               ${CMAKE_CURRENT_LIST_DIR}/paint_test.cpp
                               ${CMAKE_CURRENT_LIST_DIR}/../app/process.cpp
             PACKAGES OpenVDB::openvdb)
target_compile_definitions(edit_test PRIVATE SDFGRID_BINARY="$<TARGET_FILE:sdfgrid_app>")
sdfgrid_test(redistance_test LABEL heavy
             SOURCES ${edit_grids} ${CMAKE_CURRENT_LIST_DIR}/redistance_test.cpp
                     ${CMAKE_CURRENT_LIST_DIR}/surface_oracle.cpp
             PACKAGES OpenVDB::openvdb)
sdfgrid_test(algebra_test SOURCES ${edit_grids} ${CMAKE_CURRENT_LIST_DIR}/algebra_test.cpp
             PACKAGES OpenVDB::openvdb)
# The kill -9 loop and the full disk run a program of their own.
add_executable(session_child ${edit_grids} ${CMAKE_CURRENT_LIST_DIR}/session_child.cpp)
target_link_libraries(session_child PRIVATE sdfgrid sdfgrid_flags OpenVDB::openvdb)
target_include_directories(session_child PRIVATE ${PROJECT_SOURCE_DIR}/tests)
sdfgrid_test(session_test LABEL heavy
             SOURCES ${edit_grids} ${CMAKE_CURRENT_LIST_DIR}/session_test.cpp
                     ${CMAKE_CURRENT_LIST_DIR}/session_damage_test.cpp
                     ${CMAKE_CURRENT_LIST_DIR}/session_undo_test.cpp
                     ${CMAKE_CURRENT_LIST_DIR}/session_crash_test.cpp
                     ${CMAKE_CURRENT_LIST_DIR}/../app/process.cpp
             PACKAGES OpenVDB::openvdb)
target_compile_definitions(session_test PRIVATE SDFGRID_SESSION_CHILD="$<TARGET_FILE:session_child>"
                                                SDFGRID_BINARY="$<TARGET_FILE:sdfgrid_app>")
add_dependencies(session_test session_child)

find_package(nlohmann_json REQUIRED)
sdfgrid_test(sculpt_app_test SOURCES ${CMAKE_CURRENT_LIST_DIR}/sculpt_app_test.cpp
                                   ${CMAKE_CURRENT_LIST_DIR}/../app/process.cpp
             PACKAGES nlohmann_json::nlohmann_json)
target_compile_definitions(sculpt_app_test PRIVATE SDFGRID_BINARY="$<TARGET_FILE:sdfgrid_app>")
add_dependencies(sculpt_app_test sdfgrid_app)
