// From manifolds to the blocks of the wide solver, and from the solved blocks back.
#include <algorithm>
#include <atomic>
#include <bit>
#include <span>
#include <utility>

#include "carom/math/cpu.h"
#include "carom/math/simd.h"
#include "carom/rigid/detail/color_parts.h"
#include "carom/rigid/detail/contact_foresight.h"
#include "carom/rigid/detail/contact_lanes.h"
#include "carom/rigid/detail/contact_middle.h"
#include "carom/rigid/detail/stages.h"
// Parts of this file:
#include "carom/rigid/detail/contact_lane_begin.inl"
#include "carom/rigid/detail/contact_lane_gather.inl"
#include "carom/rigid/detail/contact_lane_store.inl"

namespace carom::rigid::detail {
namespace {

constexpr int block_grain = 8;
constexpr std::uint64_t order_steps = 16;  ///< from one ordering by place to the next

/// Contacts of a colour lie anywhere in memory: three rounds of pre-loading walk from the manifold to its contact to
/// its bodies, some lanes ahead of their use; preparing is bound by latency, and a round that comes before the memory
/// of the one before it waits. In the plane bodies are small and stay in the second cache: to call for them takes
/// longer than they do. Inlined always: to gcc a function that only pre-loads has no effect, and calls of it go.
template <class D>
CAROM_SIMD_INLINE void prefetch_manifold(const ContactSources<D>& from, const ShapeRecord<D>* shapes,
                                         std::span<const std::int32_t> list, std::size_t i, bool velocities) {
  constexpr std::size_t manifold_lanes = 96, contact_lanes = 40, body_lanes = 18;
  if (i + body_lanes >= list.size()) return;
  const ContactRecord<D>& c = from.contacts[from.manifolds[list[i + body_lanes]].contact];
  if constexpr (D::dimension == 3)
    for (const std::int32_t body : c.body) {
      prefetch_lines(from.motion + body, sizeof(BodyMotion<D>));
      __builtin_prefetch(from.pose + body);
      if (velocities || c.rolls) __builtin_prefetch(from.bodies + body);
      if ((c.flags & contact_dynamic) == 0) __builtin_prefetch(from.record + body);
    }
  if (D::dimension == 2 && c.rolls) {  // what put_middle asks for
    __builtin_prefetch(reinterpret_cast<const char*>(&c) + 64);
    prefetch_shapes(shapes, c);
  }
  if (i + contact_lanes >= list.size()) return;
  prefetch_lines(from.contacts + from.manifolds[list[i + contact_lanes]].contact,
                 D::dimension == 2 ? 64 : sizeof(ContactRecord<D>));
  if (i + manifold_lanes >= list.size()) return;
  prefetch_lines(from.manifolds + list[i + manifold_lanes], ManifoldRecord<D>::hot_bytes);
}

/// May blocks of the overflow, which share bodies, be taken at once?
enum class Overflow : std::uint8_t { at_once, in_order };

/// Calls f(manifolds of the colour, first, lanes, block, extra, marks) for the blocks of every colour, in parallel;
/// those of all colours at once, or colour by colour, the overflow in its order.
template <class D, int W, class F>
void for_blocks(StepContext<D>& context, Overflow overflow, F&& f) {
  WorldImplementation<D>& world = context.world;
  const auto run = [&](int color, int begin, int end) {
    const std::vector<std::int32_t>& manifolds = world.graph.colors[color].manifolds;
    const ColorBlocks& blocks = world.scratch.blocks[color];
    const int lanes = color == overflow_color ? 1 : W;
    for (int k = begin; k < end; ++k) {
      const int first = k * lanes;
      f(std::span<const std::int32_t>(manifolds), std::size_t(first), min(lanes, int(manifolds.size()) - first),
        static_cast<ContactBlock<D, W>*>(blocks.blocks)[k],
        blocks.extra == nullptr ? nullptr : static_cast<ContactExtra<D, W>*>(blocks.extra) + k, blocks.marks + first);
    }
  };
  if (overflow == Overflow::in_order) {
    for (int color = 0; color <= overflow_color; ++color) {
      const int count = world.scratch.blocks[color].count;
      if (count == 0) continue;
      if (count <= block_grain || color == overflow_color)
        run(color, 0, count);
      else
        context.scheduler.parallel_for(count, block_grain, [&](int begin, int end, int) { run(color, begin, end); });
    }
    return;
  }
  for_color_parts(context.scheduler, block_grain, [&](int color) { return world.scratch.blocks[color].count; }, run);
}

template <class D>
void take_again(WorldImplementation<D>& world, std::int32_t body) {
  // By all threads: all write the same.
  if (body >= 0 && world.bodies.is_awake(body))
    std::atomic_ref<std::uint8_t>(world.scratch.again[std::size_t(body)]).store(1, std::memory_order_relaxed);
}

/// Whether any of them strikes.
template <class D, int W>
bool prepare_blocks(StepContext<D>& context) {
  WorldImplementation<D>& world = context.world;
  for (int color = 0; color <= overflow_color; ++color) {
    const GraphColor& c = world.graph.colors[color];
    ColorBlocks& blocks = world.scratch.blocks[color];
    const int lanes = color == overflow_color ? 1 : W;
    blocks = {};
    blocks.count = (int(c.manifolds.size()) + lanes - 1) / lanes;
    if (blocks.count == 0) continue;
    blocks.blocks = context.arena.template allocate<ContactBlock<D, W>>(std::size_t(blocks.count)).data();
    if (c.extra > 0)
      blocks.extra = context.arena.template allocate<ContactExtra<D, W>>(std::size_t(blocks.count)).data();
    blocks.marks =
        context.arena.template allocate_zeroed<std::uint8_t>(c.manifolds.size() + 16).data();  // read by words
  }
  const ContactSources<D> sources = sources_of(context);
  const bool any_special = !world.shapes.extras.empty(), any_hits = world.hit_event_shapes > 0;
  // Where nothing rare is asked for, lanes find by themselves how their contacts roll and bounce, and who may hit.
  const bool by_kernel = !any_special && world.bodies.time_scale.empty();
  const bool may_wait = D::dimension == 2 && !any_special;
  std::atomic<bool> any_strikes = false;
  for_blocks<D, W>(context, Overflow::at_once,
                   [&](std::span<const std::int32_t> manifolds, std::size_t first, int lanes, ContactBlock<D, W>& block,
                       ContactExtra<D, W>* extra, std::uint8_t* marks) {
                     ContactRaw<D, W> raw;
                     const bool approaches = extra != nullptr || any_hits;
                     const std::span<const std::int32_t> list = manifolds.subspan(first, std::size_t(lanes));
                     // A few at a time: the processor waits where more lines are called for than it can wait for.
                     const auto call_ahead = [&](int part) __attribute__((always_inline)) {
                       for (int lane = lanes * part / 3; lane < lanes * (part + 1) / 3; ++lane)
                         prefetch_manifold(sources, world.shapes.record.data(), manifolds, first + std::size_t(lane),
                                           approaches);
                     };
                     call_ahead(0);
                     gather_block(context, sources, list, block, raw, extra, marks);
                     call_ahead(1);
                     std::uint32_t anew = world.kernels.prepare(&block, &raw, anchor_rate * context.inverse_dt,
                                                                friction_leak / float(context.substeps));
                     call_ahead(2);
                     for (std::uint32_t strikes = world.kernels.strikes(context.bodies, &block); strikes != 0;
                          strikes &= strikes - 1) {
                       const int lane = std::countr_zero(strikes);
                       take_again(world, block.body_a[lane]);
                       take_again(world, block.body_b[lane]);
                       any_strikes.store(true, std::memory_order_relaxed);
                     }
                     for (anew &= lane_bits(lanes); anew != 0; anew &= anew - 1) {
                       const int lane = std::countr_zero(anew);
                       const bool set = set_anchor(context, list[std::size_t(lane)], block, lane, may_wait);
                       marks[lane] |= set ? mark_anchored | mark_open : mark_anew;
                     }
                     if (by_kernel) {
                       if (any_hits) {
                         const float least = world.definition.restitution_threshold;
                         std::uint32_t hits = world.kernels.closing(sources, lanes, &block, least);
                         for (; hits != 0; hits &= hits - 1) {
                           const int lane = std::countr_zero(hits);
                           marks[lane] |= find_approach<D, W>(context, list[std::size_t(lane)], block, nullptr, lane);
                           prepare_special<D, W>(context, list[std::size_t(lane)], block, nullptr, lane);
                         }
                       }
                       if (extra == nullptr) return;
                       std::uint32_t bounces = world.kernels.approach(sources, list.data(), lanes, &block, extra);
                       for (; bounces != 0; bounces &= bounces - 1)
                         if (const int lane = std::countr_zero(bounces); lane < lanes) marks[lane] |= mark_bounces;
                       return;
                     }
                     for (int lane = 0; lane < lanes; ++lane) {
                       const std::int32_t m = list[std::size_t(lane)];
                       if (approaches) marks[lane] |= find_approach(context, m, block, extra, lane);
                       if (extra != nullptr) prepare_rolling(context, m, *extra, lane);
                       if (any_special || any_hits) prepare_special(context, m, block, extra, lane);
                       if (extra != nullptr) marks[lane] |= bounce_mark(*extra, lane);
                     }
                   });
  return any_strikes;
}

/// Finds the contacts that settle: those of bodies out of which something is pushed, or that are pushed themselves;
/// all, where these are many, because then the blow that pressed them into each other goes through all.
template <class D, int W>
void mark_settling(StepContext<D>& context) {
  WorldImplementation<D>& world = context.world;
  std::uint8_t* is_pushed = nullptr;  // by slot of the body
  std::span<std::int32_t> pushed;     // bodies
  std::size_t count = 0;
  for (int color = 0; color <= overflow_color; ++color)
    for_marked(world, color, mark_pushed, [&](std::int32_t manifold) {
      if (is_pushed == nullptr) {
        is_pushed = context.arena.template allocate_zeroed<std::uint8_t>(world.bodies.record.size()).data();
        pushed = context.arena.template allocate<std::int32_t>(world.bodies.record.size());
      }
      for (const std::int32_t body : world.contacts.at(world.contacts.manifold(manifold).contact).body)
        if (world.bodies.is_dynamic(body) && is_pushed[body] == 0) is_pushed[body] = 1, pushed[count++] = body;
    });
  if (count == 0) return;
  const bool weightless = is_weightless(context);  // where what was pushed is taken back
  const auto settles = [&](ContactBlock<D, W>& block, int lane, std::uint8_t& mark) {
    block.settles[lane] = 1;
    for (const std::int32_t body : {block.body_a[lane], block.body_b[lane]})
      if (weightless && body >= 0 && world.bodies.motion[std::size_t(body)].load_level > 0)
        block.again[lane] |= block_bears;
    mark |= mark_settles;
  };
  if (many_bodies * count > world.bodies.awake.size()) {
    for_blocks<D, W>(context, Overflow::at_once,
                     [&](std::span<const std::int32_t>, std::size_t, int lanes, ContactBlock<D, W>& block,
                         ContactExtra<D, W>*, std::uint8_t* marks) {
                       for (int lane = 0; lane < lanes; ++lane) settles(block, lane, marks[lane]);
                     });
    return;
  }
  for (const std::int32_t body : pushed.first(count))
    for_lanes_of<D, W>(
        world, body, [&](ContactBlock<D, W>& block, int lane, std::uint8_t& mark, int) { settles(block, lane, mark); });
}

/// Finds the contacts of bodies that take impulses again: those of joints and trees, what strikes, and who sleeps
/// beside somebody who is awake, not yet touched.
template <class D, int W>
void find_again(StepContext<D>& context, bool any_strikes) {
  WorldImplementation<D>& world = context.world;
  if (!any_contacts(world)) return;
  const bool any_asleep = world.sleeping.count() > 0;
  bool any_joint = false;
  const auto take = [&](std::int32_t body) {
    if (body != none && world.bodies.is_dynamic(body)) take_again(world, body), any_joint = true;
  };
  for (const GraphColor& color : world.graph.colors)
    for (const std::int32_t j : color.joints)
      for (const std::int32_t body : world.joints.headers[std::size_t(j)].body) take(body);
  for (const TreeRange& tree : world.joints.trees.trees)
    for (std::int32_t i = tree.first_body; i < tree.body_end; ++i) take(world.joints.trees.bodies[std::size_t(i)].body);
  if (!any_strikes && !any_joint && !any_asleep) return;
  const auto few = [&] {
    std::size_t count = 0;
    for (const std::int32_t body : world.bodies.awake) count += world.scratch.again[std::size_t(body)];
    return many_bodies * count <= world.bodies.awake.size();
  };
  if (!any_asleep && few()) {
    for (const std::int32_t body : world.bodies.awake)
      if (world.scratch.again[std::size_t(body)] != 0)
        for_lanes_of<D, W>(world, body, [](ContactBlock<D, W>& block, int lane, std::uint8_t& mark, int side) {
          block.again[lane] |= 1 << side;
          mark |= mark_again;
        });
  } else {
    // Who is awake is told beside, for as long: records of bodies lie too far apart to be asked by every contact.
    constexpr std::uint8_t awake = 2;
    std::uint8_t* const of = world.scratch.again.data();
    if (any_asleep)
      for (const std::int32_t body : world.bodies.awake) of[body] |= awake;
    for_blocks<D, W>(context, Overflow::at_once,
                     [&](std::span<const std::int32_t>, std::size_t, int lanes, ContactBlock<D, W>& block,
                         ContactExtra<D, W>*, std::uint8_t* marks) {
                       for (int lane = 0; lane < lanes; ++lane) {
                         bool may_sleep = any_asleep;
                         if (any_asleep)
                           for (const auto& point : block.point) may_sleep = may_sleep && point.separation[lane] >= 0;
                         const auto again = [&](std::int32_t body) {
                           if (body < 0) return 0;
                           return may_sleep && (of[body] & awake) == 0 ? 1 : of[body] & 1;
                         };
                         block.again[lane] = again(block.body_a[lane]) | again(block.body_b[lane]) << 1;
                         if (block.again[lane] != 0) marks[lane] |= mark_again;
                       }
                     });
    if (any_asleep)
      for (const std::int32_t body : world.bodies.awake) of[body] &= 1;
  }
  for (int color = 0; color <= overflow_color; ++color)
    for_marked(world, color, mark_again, [&](std::int32_t) { world.scratch.blocks[color].again = true; });
}

template <class D, int W>
void prepare_and_mark(StepContext<D>& context) {
  context.world.scratch.again.resize(context.world.bodies.record.size());
  const bool any_strikes = prepare_blocks<D, W>(context);
  bool any_turns = false;
  if constexpr (D::dimension == 3) any_turns = list_slender(context);
  find_again<D, W>(context, any_strikes || any_turns);
  mark_settling<D, W>(context);
  WorldImplementation<D>& world = context.world;
  if (world.hit_event_shapes == 0) return;
  std::vector<std::int32_t>& hits = world.scratch.hits;
  if (hits.capacity() < world.contacts.awake.size()) hits.reserve(world.contacts.awake.capacity());
  for (int color = 0; color <= overflow_color; ++color)
    for_marked(world, color, mark_hits, [&](std::int32_t manifold) { hits.push_back(manifold); });
}

template <class D, int W>
void store_blocks(StepContext<D>& context) {
  const ContactSources<D> sources = sources_of(context);
  for_blocks<D, W>(context, Overflow::in_order,
                   [&](std::span<const std::int32_t> manifolds, std::size_t first, int lanes, ContactBlock<D, W>& block,
                       ContactExtra<D, W>* extra, const std::uint8_t* marks) {
                     for (int lane = 0; lane < lanes; ++lane)
                       for (const std::int32_t body : {block.body_a[lane], block.body_b[lane]}) {
                         __builtin_prefetch(sources.loads + 4 * slot_of(body), 1);
                         __builtin_prefetch(sources.bodies + slot_of(body));
                       }
                     for (int lane = 0; lane < lanes; ++lane) {
                       const std::size_t i = first + std::size_t(lane);
                       if (i + 12 < manifolds.size()) {
                         const char* record = reinterpret_cast<const char*>(sources.manifolds + manifolds[i + 12]);
                         // Of most the impulses alone are written; few anchors are asked for.
                         const bool whole = (marks[lane + 12] & (mark_anew | mark_open)) != 0;
                         const std::size_t end = ManifoldRecord<D>::hot_bytes;
                         for (std::size_t k = whole ? 0 : offsetof(ManifoldRecord<D>, impulses); k < end; k += 64)
                           __builtin_prefetch(record + k, 1);
                       }
                     }
                     store_block(context, sources, manifolds.subspan(first, std::size_t(lanes)), block, extra, marks);
                   });
}

}  // namespace

/// Which share of the bodies that a thread moves in a colour another had in the colour before, if there are two: what a
/// snapshot holds is the same for any number of threads.
template <class D>
static float share_of_strangers(WorldImplementation<D>& world) {
  std::vector<std::uint8_t>& last = world.scratch.again;  // 0, as it is to be left
  last.resize(max(last.size(), world.bodies.record.size()));
  std::size_t met = 0, strange = 0;
  for (int color = 0; color < color_count; ++color) {
    const std::vector<std::int32_t>& list = world.graph.colors[color].manifolds;
    for (std::size_t i = 0; i < list.size(); ++i) {
      const std::uint8_t thread = i < list.size() / 2 ? 1 : 2;
      for (const std::int32_t body : world.contacts.at(world.contacts.manifold(list[i]).contact).body) {
        if (!world.bodies.is_dynamic(body)) continue;
        std::uint8_t& before = last[std::size_t(body)];
        met += before != 0, strange += before != 0 && before != thread;
        before = thread;
      }
    }
  }
  std::fill(last.begin(), last.end(), std::uint8_t(0));
  return float(strange) / float(max(met, std::size_t(1)));
}

template <class D>
void order_by_place(WorldImplementation<D>& world) {
  if (world.step_count % order_steps != 0) return;
  if (share_of_strangers(world) < 0.06f) return;  // as where bodies were made in rows
  const typename D::Bounds whole = world.shapes.trees[tree_dynamic].root_bounds();
  const typename D::Position size = whole.high - whole.low;
  int axis = 0;
  for (int k = 1; k < D::dimension; ++k)
    if (size[k] > size[axis]) axis = k;
  std::vector<std::uint64_t>& placed = world.scratch.placed;
  std::size_t begin[color_count], total = 0;
  for (int color = 0; color < color_count; ++color)
    begin[color] = std::exchange(total, total + world.graph.colors[color].manifolds.size());
  placed.reserve(world.contacts.manifolds.capacity());
  placed.resize(total);
  world.scheduler->parallel_for(color_count, 1, [&](int color, int, int) {
    std::vector<std::int32_t>& list = world.graph.colors[color].manifolds;
    const std::span<std::uint64_t> of_color = std::span(placed).subspan(begin[color], list.size());
    for (std::size_t i = 0; i < list.size(); ++i) {
      const std::int32_t(&body)[2] = world.contacts.at(world.contacts.manifold(list[i]).contact).body;
      const std::int32_t one = world.bodies.is_dynamic(body[0]) ? body[0] : body[1];
      const double along = world.bodies.pose[std::size_t(one)].position[axis] - whole.low[axis];
      const double share = along > 0 ? min(along / (size[axis] + 1e-6), 1.0) : 0;
      of_color[i] = std::uint64_t(share * 0xFFFFFF) << 32 | std::uint32_t(list[i]);
    }
    std::sort(of_color.begin(), of_color.end());
    for (std::size_t i = 0; i < list.size(); ++i) {
      list[i] = std::int32_t(of_color[i] & 0xFFFFFFFF);
      world.contacts.manifold(list[i]).place.position = std::int32_t(i);
    }
  });
}

template <class D>
void prepare_contacts(StepContext<D>& context) {
  if constexpr (math::widest_lanes > 4) {
    if (context.world.kernels.width == 16) return prepare_and_mark<D, 16>(context);
    if (context.world.kernels.width == 8) return prepare_and_mark<D, 8>(context);
  }
  prepare_and_mark<D, 4>(context);
}
template <class D>
void store_contacts(StepContext<D>& context) {
  if constexpr (math::widest_lanes > 4) {
    if (context.world.kernels.width == 16) return store_blocks<D, 16>(context);
    if (context.world.kernels.width == 8) return store_blocks<D, 8>(context);
  }
  store_blocks<D, 4>(context);
}

template <class D>
void contact_points_now(const WorldImplementation<D>& world, const ManifoldRecord<D>& m,
                        typename D::Position (&points)[D::max_points], float (&separations)[D::max_points],
                        typename D::Vector& normal) {
  const ContactRecord<D>& c = world.contacts.at(m.contact);
  // After a step the bodies have moved on from where the manifold was made: follow them as the kernel does for recycled
  // contacts (prepare_points2, prepare_points3).
  const typename D::Pose pose = shape_pose(world, world.shapes.at(c.shape[0]));
  typename D::Transform now;
  if (c.flags & contact_at_origin)
    now = relative(world.bodies.pose[std::size_t(c.body[0])], world.bodies.pose[std::size_t(c.body[1])]);
  else
    now = relative(pose, shape_pose(world, world.shapes.at(c.shape[1])));
  const typename D::Transform motion = now * inverse(c.base);
  normal = rotate(pose.rotation, m.manifold.normal);
  for (int i = 0; i < m.manifold.count; ++i) {
    const auto& point = m.manifold.points[i];
    const typename D::Vector half = (0.5f * point.separation) * m.manifold.normal, on_a = point.point - half;
    const typename D::Vector on_b = transform_point(motion, point.point + half);
    separations[i] = dot(on_b - on_a, m.manifold.normal);
    points[i] = world_point(pose, 0.5f * (on_a + on_b));
  }
}

template void order_by_place<Dim2>(WorldImplementation<Dim2>&);
template void order_by_place<Dim3>(WorldImplementation<Dim3>&);
template void prepare_contacts<Dim2>(StepContext<Dim2>&);
template void prepare_contacts<Dim3>(StepContext<Dim3>&);
template void store_contacts<Dim2>(StepContext<Dim2>&);
template void store_contacts<Dim3>(StepContext<Dim3>&);
template void contact_points_now<Dim2>(const WorldImplementation<Dim2>&, const ManifoldRecord<Dim2>&, Vec2d (&)[2],
                                       float (&)[2], Vec2f&);
template void contact_points_now<Dim3>(const WorldImplementation<Dim3>&, const ManifoldRecord<Dim3>&, Vec3d (&)[4],
                                       float (&)[4], Vec3f&);

}  // namespace carom::rigid::detail
