// Groups of triangles, for the least that every processor has.
#include "carom/geometry/detail/triangle_groups.h"
#include "carom/geometry/detail/wide3.h"

#define CAROM_GROUPS_NAMESPACE triangle_groups_baseline
#include "carom/geometry/detail/triangle_groups.inl"
#undef CAROM_GROUPS_NAMESPACE
