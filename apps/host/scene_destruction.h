// Pictures of what a scene fires and breaks: projectiles with the way of their last step, fronts of blasts, pieces.
#pragma once

#include "apps/host/stage.h"
#include "carom/scene/destruction.h"

namespace carom::host {

class DestructionPicture {
 public:
  /// Draws it as it is after a step. Structures are the scene's bodies of their names; pieces keep their colour.
  template <class D>
  void draw(Stage<D>& stage, const scene::SceneWorld& world);

 private:
  struct Mark {
    math::Vec3d place{};
    double time = 0;     // s, when something hit there
    bool stays = false;  // in what does not move
  };
  template <class D>
  void draw_guns(Stage<D>& stage, const scene::DestructionOf<D>& all, double now);
  void draw_marks(StageBase& stage, double seen, double now);
  template <class D>
  void draw_fronts(Stage<D>& stage, const scene::DestructionOf<D>& all, double now);
  template <class D>
  void show_pieces(Stage<D>& stage, const scene::SceneWorld& world);

  std::vector<Mark> marks_;
  std::vector<math::Vec3f> places_;
};

}  // namespace carom::host
