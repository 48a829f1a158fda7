# What the sources may include, and what the public headers cost.
sdfgrid_test(structure_test SOURCES ${CMAKE_CURRENT_LIST_DIR}/include_graph_test.cpp)
target_compile_definitions(structure_test PRIVATE SDFGRID_SOURCE_DIR="${PROJECT_SOURCE_DIR}")

# Each public header compiles alone, twice included, and brings no heavy package with it: one
# generated source a header, which fails to compile otherwise.
set(alone "")
foreach(header IN LISTS SDFGRID_PUBLIC_HEADERS)
  if(header STREQUAL "grid/vdb.h")
    set(light "")
  else()
    set(light "#include \"light.h\"\n")
  endif()
  string(MAKE_C_IDENTIFIER ${header} name)
  set(source ${PROJECT_BINARY_DIR}/alone/${name}.cpp)
  file(CONFIGURE OUTPUT ${source} @ONLY
       CONTENT "#include \"sdfgrid/@header@\"\n#include \"sdfgrid/@header@\"\n@light@")
  list(APPEND alone ${source})
endforeach()
add_library(public_headers_alone OBJECT ${alone})
target_include_directories(public_headers_alone PRIVATE ${CMAKE_CURRENT_LIST_DIR})
target_link_libraries(public_headers_alone PRIVATE sdfgrid sdfgrid_flags)
# Only grid/vdb.h needs it.
target_include_directories(public_headers_alone SYSTEM PRIVATE
  $<TARGET_PROPERTY:OpenVDB::openvdb,INTERFACE_INCLUDE_DIRECTORIES>)
