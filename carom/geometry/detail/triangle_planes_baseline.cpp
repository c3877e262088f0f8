// The planes of triangles for 4 lanes.
#include "carom/geometry/detail/triangle_planes.h"
#include "carom/geometry/detail/wide3.h"
#include "carom/geometry/triangle_mesh.h"

#define CAROM_PLANES_NAMESPACE triangle_planes_baseline
#define CAROM_PLANES_WIDTH 4
#include "carom/geometry/detail/triangle_planes.inl"
#undef CAROM_PLANES_NAMESPACE
#undef CAROM_PLANES_WIDTH
