#include "carom/rigid/detail/stages.h"

namespace carom::rigid::detail {
namespace {

template <class D, class F>
void run_blocks(StepContext<D>& context, int color, F&& f) {
  const ColorBlocks& blocks = context.world.scratch.blocks[color];
  if (blocks.count == 0) return;
  // A pass over a block takes a tenth (plane) to a quarter (space) of a microsecond, and handing a chunk to another
  // core about as long: few large chunks, and none for little work. No result depends on how a colour is cut.
  const int threads = context.scheduler.thread_count(), least = D::dimension == 2 ? 48 : 16;
  if (color == overflow_color || threads == 1 || blocks.count <= least) return f(blocks, 0, blocks.count);
  const int grain = max(least / 4, (blocks.count + 3 * threads - 1) / (3 * threads));
  context.scheduler.parallel_for(blocks.count, grain, [&](int begin, int end, int) { f(blocks, begin, end); });
}

/// Calls f(color) for those with something in them: the overflow first, because what is solved last holds best.
template <class D, class F>
void for_colors(StepContext<D>& context, F&& f) {
  const ConstraintGraph& graph = context.world.graph;
  const auto used = [&](int color) {
    return !graph.colors[color].manifolds.empty() || !graph.colors[color].joints.empty();
  };
  if (used(overflow_color)) f(overflow_color);
  for (int color = 0; color < color_count; ++color)
    if (used(color)) f(color);
}

}  // namespace

template <class D>
void solve_constraints(StepContext<D>& context) {
  const ContactKernels<D>& kernels = context.world.kernels;
  const float inverse_h = context.inverse_h, push_speed = context.push_speed;
  SolverBody<D>* const bodies = context.bodies;
  for (int substep = 0; substep < context.substeps; ++substep) {
    integrate_velocities(context);
    for_colors(context, [&](int color) {
      warm_start_joints(context, color);
      run_blocks(context, color, [&](const ColorBlocks& b, int begin, int end) {
        kernels.warm_start(bodies, b.blocks, b.extra, begin, end);
      });
    });
    for_colors(context, [&](int color) {
      solve_joints(context, color, true);
      run_blocks(context, color, [&](const ColorBlocks& b, int begin, int end) {
        kernels.solve(bodies, b.blocks, begin, end, inverse_h, push_speed);
      });
    });
    integrate_positions(context);
    for_colors(context, [&](int color) {
      solve_joints(context, color, false);
      run_blocks(context, color, [&](const ColorBlocks& b, int begin, int end) {
        kernels.relax(bodies, b.blocks, b.extra, begin, end, inverse_h);
      });
    });
  }
}

template <class D>
void restitute_contacts(StepContext<D>& context) {
  const ContactKernels<D>& kernels = context.world.kernels;
  for_colors(context, [&](int color) {
    if (!context.world.scratch.blocks[color].bounces) return;
    run_blocks(context, color, [&](const ColorBlocks& b, int begin, int end) {
      kernels.restitute(context.bodies, b.blocks, b.extra, begin, end);
    });
  });
}

template void solve_constraints<Dim2>(StepContext<Dim2>&);
template void solve_constraints<Dim3>(StepContext<Dim3>&);
template void restitute_contacts<Dim2>(StepContext<Dim2>&);
template void restitute_contacts<Dim3>(StepContext<Dim3>&);

}  // namespace carom::rigid::detail
