# What `cmake --install` puts where, and what find_package(sdfgrid) finds.
include(CMakePackageConfigHelpers)

# Public headers are all but those that say "(not installed)" or "internal to" in the comment that
# opens them.
file(GLOB headers CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/libsdfgrid/*/*.h)
set(SDFGRID_PUBLIC_HEADERS "")
foreach(header IN LISTS headers)
  file(READ ${header} text LIMIT 4096)
  string(FIND "${text}" "#pragma once" end)
  string(SUBSTRING "${text}" 0 ${end} opening)
  if(NOT opening MATCHES "not[ \n/]+installed|[Ii]nternal[ \n/]+to")
    file(RELATIVE_PATH name ${PROJECT_SOURCE_DIR}/libsdfgrid ${header})
    list(APPEND SDFGRID_PUBLIC_HEADERS ${name})
  endif()
endforeach()

foreach(name IN LISTS SDFGRID_PUBLIC_HEADERS)
  get_filename_component(room ${name} DIRECTORY)
  install(FILES ${PROJECT_SOURCE_DIR}/libsdfgrid/${name}
          DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/sdfgrid/${room})
endforeach()

set(package_folder ${CMAKE_INSTALL_LIBDIR}/cmake/sdfgrid)
install(TARGETS sdfgrid EXPORT sdfgridTargets ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
install(TARGETS sdfgrid_pictures LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR}/sdfgrid)
install(EXPORT sdfgridTargets NAMESPACE sdfgrid:: DESTINATION ${package_folder})
configure_package_config_file(${PROJECT_SOURCE_DIR}/cmake/sdfgridConfig.cmake.in
                              ${PROJECT_BINARY_DIR}/sdfgridConfig.cmake
                              INSTALL_DESTINATION ${package_folder})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/sdfgridConfigVersion.cmake
                                 COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/sdfgridConfig.cmake
              ${PROJECT_BINARY_DIR}/sdfgridConfigVersion.cmake
              ${PROJECT_SOURCE_DIR}/cmake/Dependencies.cmake
        DESTINATION ${package_folder})
install(FILES ${PROJECT_SOURCE_DIR}/LICENSE ${PROJECT_SOURCE_DIR}/LICENSE.md
        DESTINATION ${CMAKE_INSTALL_DOCDIR})
