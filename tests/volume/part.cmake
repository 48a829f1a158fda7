# Volumes in and out, the surface in them, and the commands that take them. gzip and libnifti's own
# writer make files that the library did not.
find_package(nlohmann_json REQUIRED)
find_package(ZLIB REQUIRED)
sdfgrid_test(volume_test SOURCES ${CMAKE_CURRENT_LIST_DIR}/isosurface_test.cpp
                                 ${CMAKE_CURRENT_LIST_DIR}/nifti_test.cpp
                                 ${CMAKE_CURRENT_LIST_DIR}/npy_raw_test.cpp
                                 ${CMAKE_CURRENT_LIST_DIR}/nrrd_test.cpp
                                 ${CMAKE_CURRENT_LIST_DIR}/stack_test.cpp
                                 ${CMAKE_CURRENT_LIST_DIR}/write_test.cpp
                                 ${CMAKE_CURRENT_LIST_DIR}/fuzz_test.cpp
                                 ${CMAKE_CURRENT_LIST_DIR}/leaks.cpp
             PACKAGES sdfgrid::volume_files sdfgrid::OpenImageIO OpenVDB::openvdb ZLIB::ZLIB)
sdfgrid_test(volume_app_test SOURCES ${CMAKE_CURRENT_LIST_DIR}/command_test.cpp
                                     ${PROJECT_SOURCE_DIR}/tests/app/process.cpp
             PACKAGES nlohmann_json::nlohmann_json)
target_compile_definitions(volume_app_test PRIVATE SDFGRID_BINARY="$<TARGET_FILE:sdfgrid_app>")
add_dependencies(volume_app_test sdfgrid_app)
