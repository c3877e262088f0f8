// A visual debugger for a game that uses Carom: the playground's page looks into the game's own world while the game
// runs its own loop and draws its own pictures.
//
//   auto debugger = carom::debugger::attach(world);              // prints where to look
//   while (playing) {
//     if (debugger->update()) world.step(1.0f / 60);             // false: somebody pressed Pause on the page
//     draw();
//   }
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "carom/core/result.h"
#include "carom/math/vec.h"
#include "carom/rigid/world.h"

namespace carom::debugger {

struct DebuggerOptions {
  std::string title = "Game";
  float dt = 1.0f / 60;          ///< s; the step of the game, for the page's arrows and its single steps
  math::Vec3d camera{8, 6, 12};  ///< where the page looks from at first
  math::Vec3d target{0, 1, 0};   ///< and what it looks at
  double height = 20;            ///< m from bottom to top of the page's view (worlds of two dimensions)
  std::string address = "127.0.0.1";
  unsigned short port = 8090;  ///< 0: any free one
  std::string page;            ///< folder of the built page; empty: where Carom was built
  double most_wait = 0.004;    ///< s that `update` may spend on pages
  bool say_where = true;       ///< prints the address once
};

/// Pages read and draw the world, pull at bodies, throw some in, ask why one moves, pause and step. They do so only
/// while the game waits in `update`, so that the game needs no lock.
class Debugger {
 public:
  Debugger(Debugger&&) noexcept;
  Debugger& operator=(Debugger&&) noexcept;
  /// Closes the pages and lets go of what they hold. The world must still be there.
  ~Debugger();

  /// Call once a turn of the game's loop, from the thread that steps the world and outside of a step. True: step the
  /// world now. Costs next to nothing while no page is open.
  bool update();
  std::string url() const;
  int pages() const;

  struct Implementation;

 private:
  template <class D>
  friend core::Result<Debugger> attach_to(rigid::World<D>& world, DebuggerOptions options);
  explicit Debugger(std::unique_ptr<Implementation> self);
  std::unique_ptr<Implementation> self_;
};

/// The world must stay where it is as long as the debugger lives. Errors: a port that is taken, an address that is
/// none.
core::Result<Debugger> attach(rigid::World2& world, DebuggerOptions options = {});
core::Result<Debugger> attach(rigid::World3& world, DebuggerOptions options = {});

}  // namespace carom::debugger
