// What is asked of all corners or faces of a hull at once, compiled for several instruction sets; the same bits by all.
#pragma once

namespace carom::geometry::detail {

struct CornerKernels {
  /// Which of the vectors of Hull::vertex_lanes or normal_lanes lies farthest along (x, y, z); the first among equals.
  int (*farthest)(const float* lanes, int blocks, float x, float y, float z);
  /// The least and most of three sums, of each vector with a row of three.
  void (*extremes)(const float* lanes, int blocks, const float (&rows)[3][3], float (&least)[3], float (&most)[3]);
};

namespace corner_lanes_baseline {
extern const CornerKernels kernels;
}
namespace corner_lanes_avx2 {
extern const CornerKernels kernels;
}
/// Those of this machine.
const CornerKernels& corner_kernels();

}  // namespace carom::geometry::detail
