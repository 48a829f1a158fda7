# Every package that the library stands on, found in one place, by the build and by
# find_package(sdfgrid) alike. All come from Debian 12.
set(CMAKE_THREAD_PREFER_PTHREAD TRUE)
find_package(Threads REQUIRED)
find_package(TBB REQUIRED)
find_package(OpenMesh REQUIRED)
find_package(fmt REQUIRED)
find_package(yaml-cpp REQUIRED)
find_path(GLM_INCLUDE_DIR glm/glm.hpp REQUIRED)

# OpenVDB brings a find module where others bring a package file, and one that talks.
list(APPEND CMAKE_MODULE_PATH "/usr/lib/${CMAKE_LIBRARY_ARCHITECTURE}/cmake/OpenVDB")
set(CMAKE_MESSAGE_LOG_LEVEL WARNING)
find_package(OpenVDB REQUIRED)
unset(CMAKE_MESSAGE_LOG_LEVEL)

# Debian's OpenImageIOConfig.cmake names tools and OpenCV headers of packages that the library does
# not need, and fails without them: take the library and its headers directly.
find_path(OpenImageIO_INCLUDE_DIR OpenImageIO/imageio.h REQUIRED)
find_library(OpenImageIO_LIBRARY OpenImageIO REQUIRED)
find_library(OpenImageIO_Util_LIBRARY OpenImageIO_Util REQUIRED)
find_path(Imath_INCLUDE_DIR ImathVec.h PATH_SUFFIXES Imath REQUIRED)
if(NOT TARGET sdfgrid::OpenImageIO)
  add_library(sdfgrid::OpenImageIO INTERFACE IMPORTED)
  set_target_properties(sdfgrid::OpenImageIO PROPERTIES
    INTERFACE_INCLUDE_DIRECTORIES "${OpenImageIO_INCLUDE_DIR};${Imath_INCLUDE_DIR}"
    INTERFACE_LINK_LIBRARIES "${OpenImageIO_LIBRARY};${OpenImageIO_Util_LIBRARY}")
endif()

# teem reads NRRD, libnifti NIfTI. Debian's teem has no CMake package that works, and libnifti's
# names tools that are not installed with it.
find_path(teem_INCLUDE_DIR teem/nrrd.h REQUIRED)
find_library(teem_LIBRARY teem REQUIRED)
find_path(nifti_INCLUDE_DIR nifti/nifti2_io.h REQUIRED)
find_library(nifti_LIBRARY nifti2 REQUIRED)
find_library(znz_LIBRARY znz REQUIRED)
if(NOT TARGET sdfgrid::volume_files)
  add_library(sdfgrid::volume_files INTERFACE IMPORTED)
  set_target_properties(sdfgrid::volume_files PROPERTIES
    INTERFACE_INCLUDE_DIRECTORIES "${teem_INCLUDE_DIR};${nifti_INCLUDE_DIR}/nifti"
    INTERFACE_LINK_LIBRARIES "${teem_LIBRARY};${nifti_LIBRARY};${znz_LIBRARY}")
endif()

# Blosc comes with OpenVDB and brings no package file.
find_path(Blosc_INCLUDE_DIR blosc.h REQUIRED)
find_library(Blosc_LIBRARY blosc REQUIRED)
if(NOT TARGET sdfgrid::Blosc)
  add_library(sdfgrid::Blosc INTERFACE IMPORTED)
  set_target_properties(sdfgrid::Blosc PROPERTIES
    INTERFACE_INCLUDE_DIRECTORIES "${Blosc_INCLUDE_DIR}"
    INTERFACE_LINK_LIBRARIES "${Blosc_LIBRARY}")
endif()
