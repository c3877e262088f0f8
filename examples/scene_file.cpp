// A scene file in a game of one's own: read it, turn one of its parameters, step it, and read a quantity.
#include <carom/carom.h>
#include <carom/scene/scene.h>

#include <cstdio>

int main(int count, char** arguments) {
  using namespace carom;
  const char* path = count > 1 ? arguments[1] : CAROM_SCENES "/pendulum.json";
  const auto scene = scene::load_scene(path);
  if (!scene) return std::fprintf(stderr, "%s\n", scene.error().message.c_str()), 1;

  std::vector<scene::ParameterValue> values;
  for (int i = 2; i < count; ++i) {  // "angle=60 deg"
    auto value = scene->parse_parameter(arguments[i]);
    if (!value) return std::fprintf(stderr, "%s\n", value.error().message.c_str()), 1;
    values.push_back(*value);
  }
  auto world = scene->instantiate(values);
  if (!world) return std::fprintf(stderr, "%s\n", world.error().message.c_str()), 1;

  const auto energy = world->probe("energy.total");
  while (world->time() + 0.5 * world->dt < world->duration) {
    if (const auto stepped = world->step(); !stepped.ok())
      return std::fprintf(stderr, "%s\n", stepped.error().message.c_str()), 1;
  }
  std::printf("%s: %.2f s, %zu bodies, state hash %016llx\n", scene->name.c_str(), world->time(), world->bodies.size(),
              static_cast<unsigned long long>(world->state_hash()));
  if (energy.ok()) std::printf("energy %.6g J\n", world->read(*energy));
}
