// Cloths and soft bodies that meet each other: vertices of one held off the faces of another within the one linear
// system of all.
#pragma once

#include "carom/geometry/bounds.h"
#include "carom/particles/detail/soft_thing.h"

namespace carom::particles::detail {

/// A vertex of one thing before a face of another.
struct SoftMeet {
  int thing[2] = {0, 0};
  std::uint32_t vertex = 0, corner[3] = {0, 0, 0};
  Vec3f share{};     ///< of the corners, at the foot
  Vec3f normal{};    ///< from the face to the vertex
  float gap = 0;     ///< m, beyond what keeps them apart
  float apart = 0;   ///< m
  float before = 0;  ///< m/s, along the normal, before the solve
  float wanted = 0;  ///< m/s along the normal, where it is held
  float stiff = 0;   ///< kg: impulse for what it lacks of that
  float grip = 0;    ///< kg: impulse for what slips
  float rub = 0;     ///< N·s: friction, where it slides
  Vec3f slip{};      ///< m/s, before the solve
  bool active = false;
  Vec3f impulse{};  ///< N·s on the vertex, as the right-hand sides have it
};

/// Where the contacts of a step of several things are found and what they add to the system: to A x = b of all things
/// side by side they add Jᵀ G J, with J the velocity of a vertex against the face and G great along the normal (a
/// contact that hardly gives way) and friction's across it. The matrix stays symmetric and positive, and what a contact
/// gives to one it takes from the other.
class SoftMeeting {
 public:
  /// Finds the contacts of a substep. `things`: those of `numbers`, which tell them in memory.
  void find(std::span<SoftThing* const> things, float h);
  void set_numbers(std::span<const int> numbers) { numbers_ = numbers; }
  void enter();          ///< what is wanted, to the right-hand sides
  bool revise(float h);  ///< after a solve: lets go of what is drawn, holds what would pass. True: solve again
  void remember(float h);
  std::span<const SoftMeet> contacts() const { return meets_; }

  // Within a solve.
  void take_from_residuals();
  void answer();  ///< Jᵀ G J times the motions that the way up has
  void clear_answers();
  void settle();  ///< after it: the impulses as they are now, to the right-hand sides

 private:
  struct Near {
    float distance = 0, height = 0;
    int face = -1;
    Vec3f share{}, way{};
  };
  struct Grid {
    Vec3f low{};
    float inverse = 0;
    int count[3] = {0, 0, 0};
  };
  void find_pair(std::size_t a, std::size_t b, float h);
  void lay_faces(const SoftThing& b, Vec3d origin, Vec3f low, Vec3f high, float reach);
  void find_near(Vec3f at, float reach, Near& near) const;
  void find_normals(std::size_t thing);
  template <class See>
  void each_node(const SoftMeet& meet, const See& see) const;
  Vec3f against(const SoftMeet& meet, Vec3f vertex, Vec3f a, Vec3f b, Vec3f c) const;
  Vec3f change_of(const SoftMeet& meet) const;  ///< m/s, of the vertex against the face, by the solve
  void give(SoftMeet& meet, Vec3f impulse);

  struct Face {
    Vec3f a{}, u{}, v{}, normal{};
    std::uint32_t corner[3] = {0, 0, 0};
  };
  std::span<SoftThing* const> things_;
  std::span<const int> numbers_;
  std::vector<SoftMeet> meets_;
  std::vector<geometry::Bounds3d> bounds_;
  std::vector<Vec3f> mean_;
  std::vector<float> spread_;
  std::vector<SoftMeetingMemory> met_;
  std::vector<std::vector<Vec3f>> normals_;  ///< by thing and vertex; empty where nobody asks
  std::vector<Face> faces_;
  Grid grid_;
  std::vector<int> first_, list_;  ///< faces by cell
};

/// Solves the systems of all things at once; iterations. `tolerance` is relative to the right-hand side, or to that of
/// changes of `least` m/s if it is less. `again`: of the same systems with other holds.
int solve_system(std::span<SoftThing* const> things, SoftMeeting* meeting, double tolerance, float least, int most,
                 bool again);

}  // namespace carom::particles::detail
