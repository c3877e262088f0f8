// The passes of a step of ropes, in the order in which they run.
#pragma once

#include "carom/math/calculus.h"
#include "carom/particles/detail/fast_shapes.h"
#include "carom/particles/detail/nearest_surface.h"
#include "carom/particles/detail/rope_data.h"

namespace carom::particles::detail {

/// Where a segment is nearest to a shape: along it the distance to a convex shape has one least value.
template <class Distance>
double nearest_share(const Distance& distance) {
  return math::least_place(distance, 0, 1, 16);
}

/// Of what comes fast how far it is has to be told beside its edges, too.
inline bool nearest_surface(const RopeShape& near, Vec3f center, float radius, float margin, Vec3f& normal,
                            float& separation) {
  return near.fast ? nearest_surface(near.shape, center, radius, margin, normal, separation)
                   : nearest_plane(near.shape, center, radius, margin, normal, separation);
}

/// A segment's two ends, or a particle twice, in the frame of a shape.
struct RopePlace {
  Vec3d end[2];
  Vec3d at(double share) const { return lerp(end[0], end[1], share); }
};
inline RopePlace lerp(const RopePlace& a, const RopePlace& b, double t) {
  return {{math::lerp(a.end[0], b.end[0], t), math::lerp(a.end[1], b.end[1], t)}};
}
/// m, that neither end goes farther than.
inline double motion(const RopePlace& from, const RopePlace& to) {
  return math::max(distance(from.end[0], to.end[0]), distance(from.end[1], to.end[1]));
}
/// Where a segment is nearest to a shape.
struct RopeNearest {
  double share = 0.5;  ///< of the second end
  Vec3f normal{};
  double separation = 1e30;  ///< m
};

struct RopeSolver {
  RopeSet& set;
  rigid::World3& world;
  double dt;
  double h = 0;
  int substeps = 1;
  double elapsed = 0;  ///< s, of the step
  bool alert = false;  ///< a body is fast that may meet a rope
  Vec3d gravity{};

  Status run();

  // rope_bodies.cpp
  int body_index(rigid::BodyId id);  ///< −1: not there
  void gather();
  void find_mobility(std::size_t first);  ///< of the bodies from there on
  void find_joints(std::size_t first);
  void find_support(std::size_t first);
  /// The bodies' changes of velocity from all ropes' rows; `answers`: and what crossings answer to each other.
  void couple(bool answers);
  void commit_bodies();
  Vec3d change_at(int body, Vec3d arm) const;  ///< of the velocity of what holds a particle, by the solve
  Vec3d spin_change(int body) const;           ///< likewise of its spin
  void move_bodies();
  void hand_over();
  double share_at_start(const RopeBody& body) const;

  // rope_contact.cpp
  double reach_at(const Rope& rope, double speed) const;
  /// Shapes in the bounds, and those that may come there within the step.
  void find_shapes(const geometry::Bounds3d& bounds);
  /// m/s, of a particle at the start of the substep, or as it is solved if that is faster.
  double pace(const Rope& rope, std::size_t i, bool solved) const;
  void find_contacts(Rope& rope, bool solved);
  void offer(RopeContact& contact, int number, double separation, double speed) const;
  void touch(RopeContact& contact, const Rope& rope, int number) const;
  bool strayed(const Rope& rope, bool solved) const;             ///< from where things near it were looked for
  bool search(bool solved);                                      ///< anew round the ropes that strayed; true: some did
  void choose(Rope& rope);                                       ///< what each particle and segment meets next
  Vec3d shape_point(const RopeShape& shape, Vec3d point) const;  ///< in the shape's frame
  /// The same at the end of the substep, for a velocity; `solved`: with what the solve changes of the body's.
  Vec3d shape_point_after(const RopeShape& shape, Vec3d point, Vec3d velocity, bool solved) const;
  /// A segment in the shape's frame now; and where its ends' velocities take it.
  RopePlace edge_place(const Rope& rope, std::size_t e, const RopeShape& shape) const;
  RopePlace edge_place_after(const Rope& rope, std::size_t e, const RopeShape& shape,
                             const std::vector<Vec3d>& velocity, bool solved) const;
  RopeNearest nearest(const RopeShape& shape, const RopePlace& place, double radius) const;
  /// What is nearest of a motion within a substep where it ends (`last`), or where it would go into the shape;
  /// `separation` is what the plane there leaves at the end.
  RopeNearest meet(const RopeShape& shape, const RopePlace& now, const RopePlace& then, const RopeNearest& last,
                   double radius) const;
  void place_contacts(Rope& rope);  ///< at the start of a substep
  void place_contact(Rope& rope, std::size_t i, bool solved);
  /// Of what the solution takes deeper than it may, the planes where it is: true if there is any.
  bool place_again(Rope& rope);
  double depth_allowed(double separation) const;
  bool update_holds(Rope& rope, int iteration);  ///< true: something changed
  void place_hold(RopeContact& contact, RopeNode& node, Vec3d position, Vec3d velocity, double ahead, double radius,
                  bool solved) const;
  bool update_hold(RopeContact& contact, RopeNode& node, Vec3d velocity, int iteration) const;
  void keep_contact(RopeContact& contact, const RopeNode& node, bool gone) const;

  // rope_edges.cpp
  void find_edges(Rope& rope, int number, const geometry::Bounds3f& tight, bool solved);
  void place_edges(Rope& rope);
  bool place_edge(Rope& rope, std::size_t e, bool solved);
  void add_edges(Rope& rope) const;  ///< to the rows
  void react_edges(Rope& rope, bool coupled) const;
  Vec3d edge_answer(const Rope& rope, std::size_t edge, std::size_t t, int c) const;
  double free_share(const Rope& rope) const;
  void hold_back(Rope& rope) const;
  Vec3d edge_push(const Rope& rope, int node, int body, Vec3d velocity, Vec3d spin) const;

  // rope_crossings.cpp
  void find_crossings();
  bool tied_together(const RopeCross& cross) const;
  void place_crossings();  ///< at the start of a substep
  void add_crossings(Rope& rope, int index) const;
  void answer_crossing(const RopeCross& cross, int k, RopeAnswer& answer);
  void answer_crossings();
  void load_crossings(std::size_t size);  ///< of the bodies' system
  void mix_crossings(bool bodies);
  bool push_crossings();
  void keep_crossings();
  void tell_crossings();

  // rope_step.cpp
  int needed_substeps(const Rope& rope) const;
  void wind_winches(Rope& rope);
  void prepare(Rope& rope);       ///< what the particles are held by, at the start of a step
  void find_touched(Rope& rope);  ///< the bodies that move, at it
  void weigh(Rope& rope);         ///< winches turn; masses
  void forces(Rope& rope);
  void hold_grips(Rope& rope);
  void assemble(Rope& rope);
  void solve(Rope& rope);
  void refine(Rope& rope);
  void react(Rope& rope, bool coupled);  ///< impulses on the particles that the solution asks for
  double change(Rope& rope);             ///< the greatest strain by which the last iteration was off, squared; tensions
  bool comes_far() const;
  bool goes_wrong() const;
  bool turns_on_its_way() const;
  void undo();
  void substep(double duration, int halvings, bool searched);
  void take_part();
  void advance(Rope& rope, int index);
};

// rope_forces.cpp
void add_bending(Rope& rope);
void add_twist(Rope& rope, std::vector<RopeBody>& bodies, double h);
double bending_energy(const Rope& rope);
/// The first segment's director, carried along the rope without twist, at the last segment.
Vec3d carried_director(const Rope& rope, Vec3d director);

}  // namespace carom::particles::detail
