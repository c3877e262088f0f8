// A world with all that a world can have, for tests of the whole state.
#pragma once

#include "carom/geometry/compound.h"
#include "carom/geometry/hull.h"
#include "carom/geometry/triangle_mesh.h"
#include "tests/rigid/scene_pieces.h"

namespace carom::rigid::test {

/// A scene with everything in it: piles, joints of several kinds, springs, wind, sensors, bullets, sleepers, meshes.
template <class D>
std::vector<BodyId> furnish(World<D>& world) {
  add_ground(world);
  std::vector<BodyId> bodies = add_heap(world, 5);
  for (const BodyId body : add_pyramid(world, 5, 9)) bodies.push_back(body);
  const BodyId post = add_body<D>(world, BodyType::fixed, box_shape<D>(0.1f, 0.1f, 0.1f), at<D>(-9, 9));
  BodyId last = post;
  for (int i = 0; i < 5; ++i) {
    const BodyId link = add_box<D>(world, at<D>(-10.0 - i, 9), 0.25f);
    HingeJointDef<D> d;
    d.body_a = last;
    d.body_b = link;
    d.frame_a.p = along<D>(-0.5f, 0);
    d.frame_b.p = along<D>(0.5f, 0);
    d.motor = {true, 0.5f, 20};
    d.limit = {true, -1, 1};
    world.create_joint(d).value();
    last = link;
    bodies.push_back(link);
  }
  SpringDamper<D> spring;
  spring.body_a = bodies[0];
  spring.point_b = at<D>(0, 8);
  spring.stiffness = 2000;
  spring.damping = 50;
  world.add_effector(spring).value();
  world.add_effector(Wind<D>{along<D>(3, 0)}).value();
  LinearDrag<D> drag;
  drag.coefficient = 20;
  world.add_effector(drag).value();
  const BodyId gate = world.create_body({.type = BodyType::fixed, .position = at<D>(0, 1)}).value();
  ShapeDef<D> s;
  s.sensor = true;
  world.add_shape(gate, box_shape<D>(2, 0.5f, 2), s).value();
  BodyDef<D> bullet;
  bullet.position = at<D>(-40, 1.2);
  bullet.linear_velocity = along<D>(60, 1);
  bullet.bullet = true;
  bullet.name = "bullet";
  bodies.push_back(world.create_body(bullet).value());
  world.add_shape(bodies.back(), ball_shape<D>(0.1f), {.density = 8000}).value();
  if constexpr (D::dimension == 3) {
    std::vector<Vec3f> vertices{{-3, 0, -3}, {3, 0.2f, -3}, {3, 0, 3}, {-3, 0.4f, 3}};
    add_body<D>(world, BodyType::fixed, geometry::make_triangle_mesh(vertices, {0, 2, 1, 0, 3, 2}).value(), {12, 0, 0});
    const std::vector<Vec3f> corners{{-0.4f, -0.3f, -0.3f}, {0.4f, -0.3f, -0.2f}, {0, 0.4f, 0}, {0, -0.2f, 0.5f}};
    bodies.push_back(add_body<D>(world, BodyType::dynamic, geometry::make_hull(corners).value(), {12, 1, 0}));
    std::vector<geometry::CompoundChild> parts{{geometry::Box{{0.5f, 0.1f, 0.1f}}, {}},
                                               {geometry::Sphere{0.3f}, {{0.5f, 0, 0}, {}}}};
    bodies.push_back(add_body<D>(world, BodyType::dynamic, geometry::make_compound(parts).value(), {11, 2, 0.3}));
  } else {
    add_body<D>(world, BodyType::fixed, geometry::make_chain({{4, 0}, {0, 0.5f}, {-4, 0}}, false).value(), {12, 0.2});
    bodies.push_back(add_box<D>(world, {12, 2}));
  }
  return bodies;
}

}  // namespace carom::rigid::test
