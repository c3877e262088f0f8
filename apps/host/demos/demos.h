// One function a demo; each lives in its own file beside this one.
#pragma once

#include <memory>
#include <span>
#include <type_traits>

#include "apps/host/demo.h"
#include "apps/host/registry.h"

namespace carom::host::demo {

using namespace math;

/// The demos of each folder here, in the order of the gallery.
std::span<const DemoEntry> particle_demos();
std::span<const DemoEntry> fluid_demos();
std::span<const DemoEntry> rope_demos();
std::span<const DemoEntry> environment_demos();
std::span<const DemoEntry> ballistics_demos();
std::span<const DemoEntry> blast_demos();
std::span<const DemoEntry> sports_demos();
std::span<const DemoEntry> billiards_demos();
std::span<const DemoEntry> figure_demos();
std::span<const DemoEntry> terrain_demos();
std::span<const DemoEntry> rule_demos();

std::unique_ptr<Demo> make_wrecking_ball();
std::unique_ptr<Demo> make_pyramids();
std::unique_ptr<Demo> make_collision_lab2();
std::unique_ptr<Demo> make_collision_lab3();
std::unique_ptr<Demo> make_hovercraft();
std::unique_ptr<Demo> make_target();
std::unique_ptr<Demo> make_mass_properties();
std::unique_ptr<Demo> make_race_ship();
std::unique_ptr<Demo> make_race_spring();
std::unique_ptr<Demo> make_race_orbit();
std::unique_ptr<Demo> make_tumbling_brick();
std::unique_ptr<Demo> make_intermediate_axis();
std::unique_ptr<Demo> make_rewind();
std::unique_ptr<Demo> make_conveyor();
std::unique_ptr<Demo> make_ground_materials();
std::unique_ptr<Demo> make_moving_meshes();
std::unique_ptr<Demo> make_ellipsoids();
std::unique_ptr<Demo> make_rounded();
std::unique_ptr<Demo> make_decomposition();
std::unique_ptr<Demo> make_decomposition_plane();
std::unique_ptr<Demo> make_card_house();
std::unique_ptr<Demo> make_events();
std::unique_ptr<Demo> make_hooks();
std::unique_ptr<Demo> make_joints();
std::unique_ptr<Demo> make_joints_plane();
std::unique_ptr<Demo> make_chain();
std::unique_ptr<Demo> make_paths();
std::unique_ptr<Demo> make_machines();
std::unique_ptr<Demo> make_free_axes();
std::unique_ptr<Demo> make_bridge();
std::unique_ptr<Demo> make_adviser();
std::unique_ptr<Demo> make_platforms();
std::unique_ptr<Demo> make_walker();
std::unique_ptr<Demo> make_strong_walker();
std::unique_ptr<Demo> make_rolling();
std::unique_ptr<Demo> make_bullets();
std::unique_ptr<Demo> make_far_away();

/// What `again()`, `copy()` and `assign()` of every demo are: another one like it, and its members.
template <class DemoType, class Base>
class Repeatable : public Base {
 public:
  std::unique_ptr<Demo> again() const override { return std::make_unique<DemoType>(); }
  std::unique_ptr<Demo> copy() const override {
    if constexpr (std::is_copy_constructible_v<DemoType> && std::is_copy_assignable_v<DemoType>)
      return std::make_unique<DemoType>(static_cast<const DemoType&>(*this));
    else
      return nullptr;
  }
  void assign(const Demo& other) override {
    if constexpr (std::is_copy_constructible_v<DemoType> && std::is_copy_assignable_v<DemoType>)
      static_cast<DemoType&>(*this) = static_cast<const DemoType&>(other);
  }
};

// One palette, chosen to stay apart in shade for the colour-blind.
inline constexpr std::uint32_t blue = 0x3b7dd8, orange = 0xe8833a, green = 0x3fa66b, red = 0xd1495b, gold = 0xe2b93b,
                               violet = 0x8a63c9, teal = 0x2f9c95, steel = 0x8d99a6, dark = 0x4a5560, sand = 0xcbb994;
constexpr std::uint32_t pen(std::uint32_t color, std::uint32_t alpha = 0xff) { return color << 8 | alpha; }

std::string format(const char* pattern, double a, double b = 0, double c = 0, double d = 0, double e = 0, double f = 0);

}  // namespace carom::host::demo
