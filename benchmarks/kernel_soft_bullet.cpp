// Bullet's cloth, rope and soft body on the scenes of kernel_ropes.cpp, at several numbers of its position iterations:
// what a step costs, and how far things stretch that should not.
#ifdef CAROM_WITH_BULLET
#include <BulletSoftBody/btSoftBodyHelpers.h>
#include <BulletSoftBody/btSoftBodyRigidBodyCollisionConfiguration.h>
#include <BulletSoftBody/btSoftRigidDynamicsWorld.h>
#include <benchmark/benchmark.h>
#include <btBulletDynamicsCommon.h>

#include <algorithm>
#include <set>
#include <utility>

#include "carom/particles/soft_body.h"

namespace {

struct SoftWorld {
  btSoftBodyRigidBodyCollisionConfiguration configuration;
  btCollisionDispatcher dispatcher{&configuration};
  btDbvtBroadphase pairs;
  btSequentialImpulseConstraintSolver solver;
  btSoftRigidDynamicsWorld world{&dispatcher, &pairs, &solver, &configuration};

  SoftWorld() {
    world.setGravity({0, btScalar(-9.80665), 0});
    btSoftBodyWorldInfo& info = world.getWorldInfo();
    info.m_gravity = world.getGravity();
    info.air_density = btScalar(1.225);
    info.m_sparsesdf.Initialize();
  }
  void step() { world.stepSimulation(btScalar(1.0 / 60), 0); }
};

/// A flag of 1.5 m, 450 g, pinned along one edge, in wind of 8 m/s. Folds go through each other.
void bullet_flag(benchmark::State& state) {
  SoftWorld soft;
  const int side = int(state.range(0));
  btSoftBody* const cloth =
      btSoftBodyHelpers::CreatePatch(soft.world.getWorldInfo(), {1, 0, 0}, {1, btScalar(1.5), 0}, {btScalar(2.5), 0, 0},
                                     {btScalar(2.5), btScalar(1.5), 0}, side, side, 0, true);
  cloth->m_cfg.piterations = int(state.range(1));
  cloth->m_cfg.aeromodel = btSoftBody::eAeroModel::V_TwoSided;
  cloth->m_cfg.kDG = 1;
  cloth->setWindVelocity({8, 0, 1});
  cloth->setTotalMass(btScalar(0.45));
  for (int i = 0; i < cloth->m_nodes.size(); ++i)
    if (cloth->m_nodes[i].m_x.x() < btScalar(1.001)) cloth->setMass(i, 0);
  soft.world.addSoftBody(cloth);
  for (int i = 0; i < 90; ++i) soft.step();
  for (auto _ : state) soft.step();
  double greatest = 0, sum = 0;
  for (int i = 0; i < cloth->m_links.size(); ++i) {
    const btSoftBody::Link& link = cloth->m_links[i];
    const double stretch = double((link.m_n[0]->m_x - link.m_n[1]->m_x).length() / link.m_rl) - 1;
    greatest = std::max(greatest, stretch);
    sum += stretch;
  }
  state.counters["greatest stretch %"] = 100 * greatest;
  state.counters["mean stretch %"] = 100 * sum / cloth->m_links.size();
  soft.world.removeSoftBody(cloth);
  delete cloth;
}

/// A rope of 4 m that hangs straight down, with a load of a thousand times its weight.
void bullet_rope(benchmark::State& state) {
  SoftWorld soft;
  const int segments = int(state.range(0));
  btSoftBody* const rope =
      btSoftBodyHelpers::CreateRope(soft.world.getWorldInfo(), {0, 0, 0}, {0, -4, 0}, segments - 1, 1);
  rope->m_cfg.piterations = int(state.range(1));
  rope->setTotalMass(btScalar(0.4));
  rope->setMass(0, 0);
  btSphereShape shape(btScalar(.2));
  btVector3 inertia;
  shape.calculateLocalInertia(400, inertia);
  btRigidBody load(400, nullptr, &shape, inertia);
  load.setWorldTransform(btTransform(btQuaternion::getIdentity(), {0, btScalar(-4), 0}));
  soft.world.addRigidBody(&load);
  rope->appendAnchor(segments, &load, true);
  soft.world.addSoftBody(rope);
  for (int i = 0; i < 90; ++i) soft.step();
  for (auto _ : state) soft.step();
  double length = 0;
  for (int i = 0; i < rope->m_links.size(); ++i)
    length += double((rope->m_links[i].m_n[0]->m_x - rope->m_links[i].m_n[1]->m_x).length());
  state.counters["stretch %"] = 100 * (length / 4 - 1);
  soft.world.removeSoftBody(rope);
  soft.world.removeRigidBody(&load);
  delete rope;
}

/// A cube of half a metre, 125 kg, of the same tetrahedra, on the ground: its edges are links.
void bullet_soft_body(benchmark::State& state) {
  SoftWorld soft;
  btStaticPlaneShape plane({0, 1, 0}, 0);
  btRigidBody ground(0, nullptr, &plane);
  soft.world.addRigidBody(&ground);
  const int cells = int(state.range(0));
  const auto mesh = carom::particles::make_soft_box({0, .02, 0}, {.5, .5, .5}, cells, cells, cells);
  btAlignedObjectArray<btVector3> points;
  for (const auto& p : mesh.points) points.push_back({btScalar(p.x), btScalar(p.y), btScalar(p.z)});
  btSoftBody* const body = new btSoftBody(&soft.world.getWorldInfo(), points.size(), &points[0], nullptr);
  std::set<std::pair<int, int>> edges;
  for (std::size_t k = 0; k < mesh.tetrahedra.size(); k += 4) {
    int corner[4];
    for (std::size_t c = 0; c < 4; ++c) corner[c] = int(mesh.tetrahedra[k + c]);
    body->appendTetra(corner[0], corner[1], corner[2], corner[3]);
    for (int a = 0; a < 4; ++a)
      for (int b = a + 1; b < 4; ++b) edges.insert({std::min(corner[a], corner[b]), std::max(corner[a], corner[b])});
  }
  for (const auto& [a, b] : edges) body->appendLink(a, b);
  body->m_cfg.piterations = int(state.range(1));
  body->m_cfg.collisions = btSoftBody::fCollision::SDF_RS;
  body->setTotalMass(125);
  soft.world.addSoftBody(body);
  for (int i = 0; i < 90; ++i) soft.step();
  for (auto _ : state) soft.step();
  btScalar low = 1e9f, high = -1e9f;
  for (int i = 0; i < body->m_nodes.size(); ++i) {
    low = std::min(low, body->m_nodes[i].m_x.y());
    high = std::max(high, body->m_nodes[i].m_x.y());
  }
  double volume = 0;
  for (int i = 0; i < body->m_tetras.size(); ++i) {
    const btSoftBody::Tetra& t = body->m_tetras[i];
    const btVector3 o = t.m_n[0]->m_x;
    volume += double(btFabs((t.m_n[1]->m_x - o).dot((t.m_n[2]->m_x - o).cross(t.m_n[3]->m_x - o)))) / 6;
  }
  state.counters["volume %"] = 100 * volume / .125;
  state.counters["height %"] = 100 * double(high - low) / .5;
  soft.world.removeSoftBody(body);
  soft.world.removeRigidBody(&ground);
  delete body;
}

BENCHMARK(bullet_flag)->Args({64, 10})->Args({64, 50})->Args({64, 200})->Iterations(100)->Unit(benchmark::kMillisecond);
BENCHMARK(bullet_soft_body)->Args({8, 10})->Args({8, 50})->Iterations(100)->Unit(benchmark::kMillisecond);
BENCHMARK(bullet_rope)->Args({100, 10})->Args({100, 1000})->Iterations(100)->Unit(benchmark::kMillisecond);

}  // namespace
#endif
