// The substeps: passes over the bodies and over the colours of the constraint graph, with a barrier after each.
#include "carom/rigid/detail/contact_lanes.h"
#include "carom/rigid/detail/stages.h"

namespace carom::rigid::detail {
namespace {

constexpr int body_grain = 256;
/// Up to so many blocks a barrier (half a microsecond) costs more than a second core saves.
template <class D>
constexpr int few_blocks = D::dimension == 2 ? 12 : 8;

/// So few manifolds and joints of so few bodies are solved sooner by one thread than handed to and fro.
constexpr std::size_t few_rows = 300, few_bodies = 512;

/// Colours in the order of a sweep: the overflow first, because what is solved last holds best.
int color_of_rank(int rank) { return rank == 0 ? overflow_color : rank - 1; }

bool is_of_pushes(SolverPass pass) { return pass == SolverPass::take_back || pass == SolverPass::settle; }
bool leaves_joints(SolverPass pass) { return is_of_pushes(pass) || pass == SolverPass::turn_masses; }

/// Pieces of the joints of a colour.
template <class D>
int joint_units_of(const StepContext<D>& context, SolverPass pass, int color) {
  return leaves_joints(pass) ? 0 : joint_units(context.world, color);
}
template <class D>
int block_count_of(const StepContext<D>& context, SolverPass pass, int color) {
  const ColorBlocks& blocks = context.world.scratch.blocks[color];
  return pass == SolverPass::warm_start_again && !blocks.again ? 0 : blocks.count;
}

template <class D>
void add_body_stage(StepContext<D>& context, SolverPass pass, std::uint8_t order = 0) {
  context.world.scratch.solver_stages.push_back({pass, 0, 0, order});
  context.world.scratch.solver_loops.push_back({int(context.world.bodies.awake.size()), body_grain});
}

template <class D>
void add_tree_stage(StepContext<D>& context, SolverPass pass) {
  const int count = int(context.world.joints.trees.trees.size());
  if (count == 0) return;
  context.world.scratch.solver_stages.push_back({pass});
  context.world.scratch.solver_loops.push_back({count, tree_grain(context.world.joints.trees)});
}

template <class D>
void add_impact_stage(StepContext<D>& context, ImpactMoment moment) {
  if (context.world.scratch.impacts.empty()) return;
  context.world.scratch.solver_stages.push_back({SolverPass::impacts, 0, 0, std::uint8_t(moment)});
  context.world.scratch.solver_loops.push_back({1, 1});
}

/// One stage for every colour, its joints first, but one for neighbours that are small or serial: no result depends on
/// how the colours are cut, because one chunk runs them in their order, and within one no two share a body.
template <class D>
void add_color_stages(StepContext<D>& context, SolverPass pass, std::uint8_t order = 0) {
  std::vector<SolverStage>& stages = context.world.scratch.solver_stages;
  std::vector<core::TaskScheduler::Stage>& loops = context.world.scratch.solver_loops;
  const int threads = context.scheduler.thread_count();
  bool joining = false;
  for (int rank = 0; rank <= color_count; ++rank) {
    const int color = color_of_rank(rank);
    const int count = block_count_of(context, pass, color) + joint_units_of(context, pass, color);
    if (count == 0) continue;
    const bool serial = color == overflow_color || threads == 1 || count <= few_blocks<D>;
    if (serial && joining) {
      stages.back().last_rank = std::uint8_t(rank);
      continue;
    }
    stages.push_back({pass, std::uint8_t(rank), std::uint8_t(rank), order});
    if (serial)
      loops.push_back({1, 1});
    else
      loops.push_back({threads, 1});
    joining = serial;
  }
}

/// Is something so deep in something else that it is pushed out fast?
template <class D>
bool any_pushed(const WorldImplementation<D>& world) {
  bool any = false;
  for (int color = 0; color <= color_count; ++color)
    for_marked(world, color, mark_pushed, [&](std::int32_t) { any = true; });
  return any;
}

/// Room for the impulses of what settles.
template <class D>
void make_room_to_keep(StepContext<D>& context) {
  for (int color = 0; color <= overflow_color; ++color) {
    ColorBlocks& b = context.world.scratch.blocks[color];
    const std::size_t lanes = std::size_t(b.count) * std::size_t(context.world.kernels.width);
    if (b.count > 0) b.kept = context.arena.template allocate<float>(std::size_t(D::max_points) * lanes).data();
  }
}

template <class D>
void list_stages(StepContext<D>& context) {
  const int settling = any_pushed(context.world) ? settle_passes : 0;
  const bool takes_back = settling > 0 && is_weightless(context);
  if (takes_back) make_room_to_keep(context);
  StepScratch<D>& scratch = context.world.scratch;
  scratch.solver_stages.clear();
  scratch.solver_loops.clear();
  scratch.solver_stages.reserve(most_solver_stages(context.substeps, settling));
  scratch.solver_loops.reserve(most_solver_stages(context.substeps, settling));
  if (D::dimension == 3) add_body_stage(context, SolverPass::flights);
  for (int substep = 0; substep < context.substeps; ++substep) {
    // Whichever point of a face is solved first takes more than its share: from step to step each has its turn at every
    // place of the sequence, so that a tower's faces do not tilt. Within a step, in which a blow is shared out, there
    // is one order, and so it is in the relaxing pass, which says what each one carries.
    const auto order = std::uint8_t(context.world.step_count % 4);
    // The impulses of contacts go on from substep to substep. Their arms stay those of the step's start, so what all of
    // them together did to a body in one substep, which its velocity tells, is what they do to it first in the next: so
    // many passes over the contacts are saved. Those of joints turn with the bodies, and an impact takes away what
    // pressed there before it.
    const bool carry_on = substep > 0 && context.world.scratch.impacts.empty();
    if (substep > 0 && context.slender.any_jointed) {
      scratch.solver_stages.push_back({SolverPass::forget_blows});
      scratch.solver_loops.push_back({1, 1});
    }
    add_body_stage(context, SolverPass::velocities, carry_on ? 1 : 0);
    add_impact_stage(context, ImpactMoment::after_forces);
    add_color_stages(context, carry_on ? SolverPass::warm_start_again : SolverPass::warm_start);
    add_tree_stage(context, SolverPass::begin_trees);
    add_color_stages(context, SolverPass::solve, order);
    add_tree_stage(context, SolverPass::solve_trees);
    add_body_stage(context, SolverPass::positions);
    if (!context.slender.bodies.empty()) {
      scratch.solver_stages.push_back({SolverPass::turn_slender});
      scratch.solver_loops.push_back({1, 1});
      add_color_stages(context, SolverPass::turn_masses);
    }
    const bool last = substep + 1 == context.substeps;
    add_impact_stage(context, last ? ImpactMoment::end_of_step : ImpactMoment::end_of_substep);
    add_tree_stage(context, SolverPass::factorise_trees);
    if (takes_back) add_color_stages(context, SolverPass::take_back);
    for (int i = 0; i < settling; ++i) add_color_stages(context, SolverPass::settle);
    add_color_stages(context, SolverPass::relax);
    add_tree_stage(context, SolverPass::settle_trees);
  }
}

bool is_warm_start(SolverPass pass) { return pass == SolverPass::warm_start || pass == SolverPass::warm_start_again; }
bool is_of_trees(SolverPass pass) {
  return pass == SolverPass::begin_trees || pass == SolverPass::solve_trees || pass == SolverPass::factorise_trees ||
         pass == SolverPass::settle_trees;
}

template <class D>
void run_blocks(StepContext<D>& context, SolverStage stage, const ColorBlocks& b, int begin, int end) {
  const ContactKernels<D>& kernels = context.world.kernels;
  if (is_warm_start(stage.pass))
    kernels.warm_start(context.bodies, b.blocks, b.extra, begin, end, stage.pass == SolverPass::warm_start_again);
  else if (stage.pass == SolverPass::solve)
    kernels.solve(context.bodies, b.blocks, begin, end, context.inverse_h, context.push_speed, context.contact_softness,
                  stage.order);
  else if (stage.pass == SolverPass::take_back)
    kernels.take_back(context.bodies, b.blocks, b.kept, begin, end);
  else if (stage.pass == SolverPass::settle)
    kernels.settle(context.bodies, b.blocks, begin, end, context.inverse_h);
  else
    kernels.relax(context.bodies, b.blocks, b.extra, begin, end, context.inverse_h);
}

/// Does one of a block's lanes (1, 4, 8 or 16) have the mark? By words: it is asked of every block in each pass.
inline bool any_marked(const std::uint8_t* marks, int lanes, std::uint8_t mark) {
  std::uint64_t words[2] = {};
  __builtin_memcpy(words, marks, 8);
  if (lanes == 16) __builtin_memcpy(words + 1, marks + 8, 8);
  if (lanes < 8) words[0] &= (std::uint64_t(1) << 8 * lanes) - 1;
  return ((words[0] | words[1]) & (0x0101010101010101u * mark)) != 0;
}

/// The blocks in which something has the mark; the others are left alone.
template <class D>
void run_marked(StepContext<D>& context, SolverStage stage, std::uint8_t mark, int color, int begin, int end) {
  const ColorBlocks& blocks = context.world.scratch.blocks[color];
  const int lanes = color == overflow_color ? 1 : context.world.kernels.width;
  for (int k = begin; k < end; ++k)
    if (any_marked(blocks.marks + k * lanes, lanes, mark)) run_blocks(context, stage, blocks, k, k + 1);
}

template <class D>
void run_color(StepContext<D>& context, SolverStage stage, int color, ThreadShare share) {
  const ColorBlocks& blocks = context.world.scratch.blocks[color];
  if (is_warm_start(stage.pass))
    warm_start_joints(context, color, share);
  else if (!leaves_joints(stage.pass))
    solve_joints(context, color, stage.pass == SolverPass::solve, share);
  const int count = block_count_of(context, stage.pass, color), first = share.begin(count), last = share.end(count);
  if (first >= last) return;
  if constexpr (D::dimension == 3)
    if (stage.pass == SolverPass::turn_masses) return turn_masses(context, color, first, last);
  if (stage.pass == SolverPass::solve && blocks.kept != nullptr)
    context.world.kernels.keep(blocks.blocks, blocks.kept, first, last, context.contact_softness);
  if (is_of_pushes(stage.pass))
    run_marked(context, stage, mark_settles, color, first, last);
  else if (stage.pass == SolverPass::warm_start_again)
    run_marked(context, stage, mark_again, color, first, last);
  else
    run_blocks(context, stage, blocks, first, last);
}

template <class D>
void run_stage(StepContext<D>& context, int index, int begin, int end) {
  const SolverStage stage = context.world.scratch.solver_stages[std::size_t(index)];
  if constexpr (D::dimension == 3) {
    if (stage.pass == SolverPass::flights) return fly_through(context, begin, end);
    if (stage.pass == SolverPass::turn_slender) return turn_slender(context);
    if (stage.pass == SolverPass::forget_blows) return forget_blows(context);
    if (stage.pass == SolverPass::turn_masses && !context.slender.many) return;
  }
  if (stage.pass == SolverPass::velocities) return integrate_velocities(context, begin, end, stage.order != 0);
  if (stage.pass == SolverPass::positions) return integrate_positions(context, begin, end);
  if (stage.pass == SolverPass::impacts) return solve_impacts(context, ImpactMoment(stage.order));
  if (is_of_trees(stage.pass)) return run_trees(context, stage.pass, begin, end);
  const int parts = context.world.scratch.solver_loops[std::size_t(index)].count;
  for (int rank = stage.first_rank; rank <= stage.last_rank; ++rank)
    for (int part = begin; part < end; ++part) run_color(context, stage, color_of_rank(rank), {part, parts});
}

}  // namespace

template <class D>
void solve_constraints(StepContext<D>& context) {
  list_stages(context);
  prepare_drives(context);
  std::size_t rows = 0;
  for (const GraphColor& color : context.world.graph.colors) rows += color.manifolds.size() + color.joints.size();
  core::SerialScheduler alone;
  const bool few = rows <= few_rows && context.world.bodies.awake.size() <= few_bodies;
  core::TaskScheduler& scheduler = few ? alone : context.scheduler;
  scheduler.run_stages(context.world.scratch.solver_loops,
                       [&](int stage, int begin, int end, int) { run_stage(context, stage, begin, end); });
}

template <class D>
void restitute_contacts(StepContext<D>& context) {
  const ContactKernels<D>& kernels = context.world.kernels;
  for (int rank = 0; rank <= color_count; ++rank) {
    const ColorBlocks& b = context.world.scratch.blocks[color_of_rank(rank)];
    if (!b.bounces) continue;
    const auto run = [&](int begin, int end, int) { kernels.restitute(context.bodies, b.blocks, b.extra, begin, end); };
    if (rank == 0)
      run(0, b.count, 0);
    else
      context.scheduler.parallel_for(b.count, few_blocks<D>, run);
  }
}

template void solve_constraints<Dim2>(StepContext<Dim2>&);
template void solve_constraints<Dim3>(StepContext<Dim3>&);
template void restitute_contacts<Dim2>(StepContext<Dim2>&);
template void restitute_contacts<Dim3>(StepContext<Dim3>&);

}  // namespace carom::rigid::detail
