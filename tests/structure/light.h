// tests/structure/light.h: fails to compile after a heavy package was included.
#pragma once

#if defined(OPENVDB_VERSION_HAS_BEEN_INCLUDED)
#error "a public header includes OpenVDB"
#endif
#if defined(OPENMESH_CONFIG_H)
#error "a public header includes OpenMesh"
#endif
#if defined(OIIO_VERSION)
#error "a public header includes OpenImageIO"
#endif
#if defined(TBB_INTERFACE_VERSION)
#error "a public header includes TBB"
#endif
#if defined(CGAL_VERSION_NR)
#error "a public header includes CGAL"
#endif
#if defined(YAML_CPP_API)
#error "a public header includes yaml-cpp"
#endif
#if defined(FMT_VERSION)
#error "a public header includes fmt"
#endif
