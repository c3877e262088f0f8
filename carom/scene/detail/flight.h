// A flight as a scene: the whole trajectory is integrated when the scene is instantiated, stepping walks along it.
#pragma once

#include "carom/rigid/free_body.h"
#include "carom/scene/scene.h"

namespace carom::scene::detail {
class Reader;

class Flight {
 public:
  rigid::FlightCase definition;
  std::vector<rigid::FlightRow> rows;  ///< one every step
  std::size_t at = 0;
  const rigid::FlightRow& now() const { return rows[at]; }
};

/// Reads the key "flight" and flies it. The reader has the variables and holds the error.
[[gnu::noinline]] bool build_flight(Reader& reader, const Scene& scene, SceneWorld& out);

struct FlightField {
  const char* name;
  const char* unit;
  double (*read)(const rigid::FlightRow& row);
};
std::span<const FlightField> flight_fields();

}  // namespace carom::scene::detail
