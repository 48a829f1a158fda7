# How the project's own targets are made: one object library a room, so that a room builds and
# is tested without the others, and kernels compiled once for each instruction set.

# The sources include each other as "sdfgrid/room/header.h", in the tree as after installation.
file(MAKE_DIRECTORY ${PROJECT_BINARY_DIR}/include)
file(CREATE_LINK ${PROJECT_SOURCE_DIR}/libsdfgrid ${PROJECT_BINARY_DIR}/include/sdfgrid SYMBOLIC)

add_library(sdfgrid_flags INTERFACE)
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  # GCC 12 warns of overlaps in std::string's own code that cannot happen (GCC bug 105651).
  target_compile_options(sdfgrid_flags INTERFACE -Wno-restrict)
endif()
target_compile_options(sdfgrid_flags INTERFACE -Wall -Wextra -Wpedantic -Wshadow -Wconversion
                       -Wno-sign-conversion -fno-math-errno -fno-trapping-math)
if(SDFGRID_WERROR)
  target_compile_options(sdfgrid_flags INTERFACE -Werror)
endif()
if(SDFGRID_SANITIZE)
  target_compile_options(sdfgrid_flags INTERFACE -fsanitize=address,undefined
                         -fno-sanitize-recover=undefined -fno-omit-frame-pointer)
  target_link_options(sdfgrid_flags INTERFACE -fsanitize=address,undefined)
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    # Instrumented, GCC 12 takes its own std::regex for uninitialized (GCC bug 105562).
    target_compile_options(sdfgrid_flags INTERFACE -Wno-maybe-uninitialized)
  endif()
endif()

# sdfgrid_room(NAME ROOMS above... PACKAGES private ones...)
# Sources are all .cpp of the folder but *_kernel.cpp, which sdfgrid_kernel() compiles.
function(sdfgrid_room name)
  cmake_parse_arguments(ARG "" "" "ROOMS;PACKAGES" ${ARGN})
  file(GLOB sources CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/${name}/*.cpp)
  file(GLOB kernels CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/${name}/*_kernel.cpp)
  list(REMOVE_ITEM sources ${kernels} "")
  add_library(sdfgrid_${name} OBJECT ${sources})
  foreach(kernel IN LISTS kernels)
    sdfgrid_kernel(sdfgrid_${name} ${kernel})
  endforeach()
  target_include_directories(sdfgrid_${name} SYSTEM PUBLIC ${GLM_INCLUDE_DIR})
  target_include_directories(sdfgrid_${name} PUBLIC $<BUILD_INTERFACE:${PROJECT_BINARY_DIR}/include>)
  target_link_libraries(sdfgrid_${name} PRIVATE sdfgrid_flags fmt::fmt ${ARG_PACKAGES})
  foreach(room IN LISTS ARG_ROOMS)
    target_link_libraries(sdfgrid_${name} PRIVATE sdfgrid_${room})
  endforeach()
endfunction()

# Compiles one source for each instruction set, with SDFGRID_ISA set to the namespace to define.
# Only the vector kernels go through here: a file compiled for AVX-512 must not emit functions
# that other files share (std, GLM), or the linker could hand them to an older machine.
set(SDFGRID_ISAS baseline)
if(CMAKE_SYSTEM_PROCESSOR MATCHES "x86_64|AMD64")
  list(APPEND SDFGRID_ISAS avx2 avx512)
endif()
set(SDFGRID_ISA_FLAGS_baseline "")
set(SDFGRID_ISA_FLAGS_avx2 -march=x86-64-v3)
set(SDFGRID_ISA_FLAGS_avx512 -march=x86-64-v4 -mprefer-vector-width=512)
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  # GCC 12 warns of its own intrinsics (GCC bug 105593); the other two builds of the same source
  # still show what is uninitialized in ours.
  list(APPEND SDFGRID_ISA_FLAGS_avx512 -Wno-uninitialized -Wno-maybe-uninitialized)
endif()
function(sdfgrid_kernel target source)
  get_filename_component(stem ${source} NAME_WE)
  foreach(isa IN LISTS SDFGRID_ISAS)
    set(object ${target}_${stem}_${isa})
    add_library(${object} OBJECT ${source})
    target_compile_definitions(${object} PRIVATE SDFGRID_ISA=${isa})
    target_include_directories(${object} PRIVATE ${PROJECT_BINARY_DIR}/include)
    target_link_libraries(${object} PRIVATE sdfgrid_flags)
    # Kernels are optimized in every build type: at -O0 they are a hundred times slower.
    target_compile_options(${object} PRIVATE -O3 -ffp-contract=fast -Wno-psabi
                           ${SDFGRID_ISA_FLAGS_${isa}})
    if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
      # GCC 12 warns of its own AVX-512 header, which leaves unused lanes undefined on purpose.
      target_compile_options(${object} PRIVATE -Wno-uninitialized -Wno-maybe-uninitialized)
    endif()
    target_sources(${target} INTERFACE $<TARGET_OBJECTS:${object}>)
    set_property(GLOBAL APPEND PROPERTY SDFGRID_KERNEL_OBJECTS ${object})
  endforeach()
endfunction()
