#include "apps/command/picture.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "apps/command/canvas.h"
#include "apps/command/raster.h"

namespace carom::command {

using namespace math;
using host::ShapeKind;

namespace {

/// A round length near `wanted`: 1, 2 or 5 times a power of ten.
double round_length(double wanted) {
  const double power = std::pow(10.0, std::floor(std::log10(std::max(wanted, 1e-9))));
  const double lead = wanted / power;
  return (lead < 1.5 ? 1 : lead < 3.5 ? 2 : lead < 7.5 ? 5 : 10) * power;
}

std::string length_text(double metres) {
  if (metres >= 1000) return short_number(metres / 1000) + " km";
  if (metres >= 1) return short_number(metres) + " m";
  if (metres >= 0.01) return short_number(metres * 100) + " cm";
  return short_number(metres * 1000) + " mm";
}

std::uint32_t color_of(const host::BodyView& body) {
  if (body.color) return body.color & 0xffffff;
  if (body.type == rigid::BodyType::fixed) return 0x98a1a9;
  return palette(body.id);
}

void caption(cairo_t* c, const host::Simulation& simulation, int width, int height, const std::string& scale) {
  const host::Declaration& d = simulation.declaration();
  cairo_save(c);
  const double k = std::min(1.0, std::max(0.4, height / 720.0));  // small pictures have small letters
  cairo_scale(c, k, k);
  width = int(width / k);
  height = int(height / k);
  char line[128];
  std::snprintf(line, sizeof line, "t = %.2f s   ·   %zu bodies   ·   %s", simulation.time(), simulation.body_count(),
                scale.c_str());
  font(c, 20, true);
  const double w1 = text_width(c, d.title);
  font(c, 14);
  const double w = std::max(w1, text_width(c, line)) + 32;
  set(c, rgb(0xffffff, 0.82));
  cairo_rectangle(c, 16, 16, w, 60);
  cairo_fill(c);
  set(c, rgb(0x1d242b));
  font(c, 20, true);
  text(c, 32, 44, d.title, 0, 1);
  font(c, 14);
  set(c, rgb(0x4a5560));
  text(c, 32, 66, line, 0, 1);
  const std::string& message = simulation.base().state.message;
  if (!message.empty()) {
    const double m = text_width(c, message) + 24;
    set(c, rgb(0xffffff, 0.82));
    cairo_rectangle(c, 16, height - 46, std::min(m, width - 32.0), 30);
    cairo_fill(c);
    set(c, rgb(0x1d242b));
    text(c, 28, height - 26, message, 0, 1);
  }
  cairo_restore(c);
}

// --- the plane -----------------------------------------------------------------------------------------------------

struct Plane2 {
  double scale, left, top;
  double x(double v) const { return (v - left) * scale; }
  double y(double v) const { return (top - v) * scale; }
};

void grid2(cairo_t* c, const Plane2& view, int width, int height, double spacing) {
  cairo_set_line_width(c, 1);
  const double right = view.left + width / view.scale, bottom = view.top - height / view.scale;
  const auto stroke = [&](double i, double x0, double y0, double x1, double y1) {
    set(c, i == 0 ? rgb(0xb4bec8) : rgb(0xe1e6eb));
    cairo_move_to(c, x0, y0);
    cairo_line_to(c, x1, y1);
    cairo_stroke(c);
  };
  for (double i = std::ceil(view.left / spacing); i * spacing < right; ++i) {
    const double x = std::floor(view.x(i * spacing)) + 0.5;
    stroke(i, x, 0, x, height);
  }
  for (double i = std::ceil(bottom / spacing); i * spacing < view.top; ++i) {
    const double y = std::floor(view.y(i * spacing)) + 0.5;
    stroke(i, 0, y, width, y);
  }
}

/// Text on whatever lies below it, with a halo that keeps it readable.
void marked(cairo_t* c, double x, double y, const std::string& s, double x_align) {
  cairo_new_path(c);
  cairo_move_to(c, x - x_align * text_width(c, s), y);
  cairo_text_path(c, s.c_str());
  set(c, rgb(0xf6f8fa, 0.9));
  cairo_set_line_width(c, 4);
  cairo_stroke_preserve(c);
  set(c, rgb(0x5b6773));
  cairo_fill(c);
}

void grid_labels2(cairo_t* c, const Plane2& view, int width, int height, double spacing) {
  font(c, 12);
  const double right = view.left + width / view.scale, bottom = view.top - height / view.scale;
  for (double i = std::ceil(view.left / spacing); i * spacing < right; ++i) {
    const double x = view.x(i * spacing);
    if (x > 40 && x < width - 40) marked(c, x, height - 6, tick_text(i * spacing, spacing), 0.5);
  }
  for (double i = std::ceil(bottom / spacing); i * spacing < view.top; ++i) {
    const double y = view.y(i * spacing);
    if (y > 90 && y < height - 70) marked(c, width - 6, y + 4, tick_text(i * spacing, spacing) + " m", 1);
  }
}

void outline2(cairo_t* c, const host::ShapeView& s) {
  switch (s.kind) {
    case ShapeKind::circle:
      cairo_arc(c, 0, 0, s.radius, 0, 2 * pi);
      break;
    case ShapeKind::capsule:
      cairo_arc(c, 0, s.size.y, s.radius, 0, pi);
      cairo_arc(c, 0, -s.size.y, s.radius, pi, 2 * pi);
      cairo_close_path(c);
      break;
    case ShapeKind::polygon:
    case ShapeKind::segment:
    case ShapeKind::chain:
      for (std::size_t i = 0; i < s.points.size(); ++i) {
        if (i == 0)
          cairo_move_to(c, s.points[i].x, s.points[i].y);
        else
          cairo_line_to(c, s.points[i].x, s.points[i].y);
      }
      if (s.kind == ShapeKind::polygon || s.loop) cairo_close_path(c);
      break;
    default:
      break;
  }
}

void body2(cairo_t* c, const Plane2& view, const host::BodyView& body, bool awake) {
  const std::uint32_t base = color_of(body);
  for (const host::ShapeView& s : body.shapes) {
    const std::uint32_t color = s.look ? s.look & 0xffffff : base;
    double opacity = s.look ? double(s.look >> 24) / 255 : s.sensor ? 0.25 : 1;
    if (!awake && body.type == rigid::BodyType::dynamic) opacity *= 0.75;
    cairo_save(c);
    cairo_translate(c, view.x(body.position.x), view.y(body.position.y));
    cairo_scale(c, view.scale, -view.scale);
    cairo_rotate(c, 2 * std::atan2(double(body.rotation.z), double(body.rotation.w)));
    cairo_translate(c, s.local.p.x, s.local.p.y);
    cairo_rotate(c, 2 * std::atan2(double(s.local.q.z), double(s.local.q.w)));
    cairo_new_path(c);
    outline2(c, s);
    const bool open = s.kind == ShapeKind::segment || s.kind == ShapeKind::chain;
    cairo_set_line_join(c, CAIRO_LINE_JOIN_ROUND);
    if (!open) {
      set(c, rgb(color, opacity));
      if (s.kind == ShapeKind::polygon && s.radius > 0) {
        cairo_set_line_width(c, 2 * s.radius);
        cairo_stroke_preserve(c);
      }
      cairo_fill_preserve(c);
    }
    const Color k = rgb(color);
    set(c, {k.r * 0.55, k.g * 0.55, k.b * 0.55, opacity});
    cairo_set_line_width(c, (open ? 2.5 : 1.3) / view.scale);
    cairo_stroke(c);
    if (s.kind == ShapeKind::circle && body.type == rigid::BodyType::dynamic) {
      cairo_move_to(c, 0, 0);
      cairo_line_to(c, s.radius, 0);
      cairo_stroke(c);
    }
    cairo_restore(c);
  }
}

void surface2(cairo_t* c, const Plane2& view, const host::Surface& surface) {
  set(c, rgb(surface.rgba >> 8, (surface.rgba & 255) / 255.0));
  cairo_new_path(c);
  for (std::size_t i = 0; i + 2 < surface.triangles.size(); i += 3) {
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3f p = surface.corners[surface.triangles[i + k]];
      if (k == 0)
        cairo_move_to(c, view.x(p.x), view.y(p.y));
      else
        cairo_line_to(c, view.x(p.x), view.y(p.y));
    }
    cairo_close_path(c);
  }
  cairo_fill(c);
}

void points2(cairo_t* c, const Plane2& view, const host::Points& points) {
  for (std::size_t i = 0; i < points.positions.size(); ++i) {
    set(c, rgb(points.rgbas[i] >> 8, (points.rgbas[i] & 255) / 255.0));
    cairo_arc(c, view.x(points.positions[i].x), view.y(points.positions[i].y),
              std::max(0.7, double(points.radii[i]) * view.scale), 0, 2 * pi);
    cairo_fill(c);
  }
}

void scale_bar(cairo_t* c, double metres, double pixels, int width, int height) {
  cairo_save(c);
  const double k = std::min(1.0, std::max(0.4, height / 720.0));
  cairo_scale(c, k, k);
  pixels /= k;
  const double x = width / k - 40 - pixels, y = height / k - 40;
  set(c, rgb(0xffffff, 0.82));
  cairo_rectangle(c, x - 12, y - 24, pixels + 24, 36);
  cairo_fill(c);
  set(c, rgb(0x1d242b));
  cairo_set_line_width(c, 2);
  cairo_move_to(c, x, y - 5);
  cairo_line_to(c, x, y + 5);
  cairo_move_to(c, x, y);
  cairo_line_to(c, x + pixels, y);
  cairo_move_to(c, x + pixels, y - 5);
  cairo_line_to(c, x + pixels, y + 5);
  cairo_stroke(c);
  font(c, 14);
  text(c, x + 0.5 * pixels, y - 6, length_text(metres), 0.5, 1);
  cairo_restore(c);
}

Surface plane_picture(host::Simulation& simulation, const std::vector<host::BodyView>& bodies,
                      const std::vector<host::BodyPlace>& places, int width, int height, bool lettering) {
  Surface surface(cairo_image_surface_create(CAIRO_FORMAT_RGB24, width, height));
  const Context context(cairo_create(surface.get()));
  cairo_t* c = context.get();
  set(c, rgb(0xf6f8fa));
  cairo_paint(c);
  const host::Camera& camera = simulation.declaration().camera;
  Vec3d center = camera.target;
  for (const host::BodyView& body : bodies)
    if (camera.follow >= 0 && body.id == std::uint32_t(camera.follow)) center = body.position;
  double scale = height / std::max(camera.height, 1e-9);
  if (camera.width > 0) scale = std::min(scale, width / camera.width);
  const Plane2 view{scale, center.x - 0.5 * width / scale, center.y + 0.5 * height / scale};
  const double spacing = round_length(height / scale / 8);
  grid2(c, view, width, height, spacing);
  const host::StageBase::State& drawn = simulation.base().state;
  for (const host::Surface& s : drawn.surfaces)
    if (!s.corners.empty()) surface2(c, view, s);
  for (std::size_t i = 0; i < bodies.size(); ++i) body2(c, view, bodies[i], i < places.size() ? places[i].awake : true);
  points2(c, view, drawn.points);
  cairo_set_line_cap(c, CAIRO_LINE_CAP_ROUND);
  std::vector<host::Line> lines;
  simulation.lines(lines);
  for (const host::Line& line : lines) {
    // White pens are meant for a dark page.
    const std::uint32_t color = line.rgba >> 8 == 0xffffff ? 0x2b333b : line.rgba >> 8;
    set(c, rgb(color, (line.rgba & 255) / 255.0));
    cairo_set_line_width(c, 2);
    cairo_move_to(c, view.x(line.a.x), view.y(line.a.y));
    cairo_line_to(c, view.x(line.b.x), view.y(line.b.y));
    cairo_stroke(c);
  }
  if (!lettering) return surface;
  grid_labels2(c, view, width, height, spacing);
  scale_bar(c, spacing, spacing * scale, width, height);
  caption(c, simulation, width, height, "grid " + length_text(spacing));
  return surface;
}

// --- space ---------------------------------------------------------------------------------------------------------

Surface space_picture(host::Simulation& simulation, const std::vector<host::BodyView>& bodies, int width, int height,
                      bool lettering) {
  RasterScene scene;
  scene.camera = simulation.declaration().camera;
  scene.ground = simulation.declaration().ground;
  if (scene.camera.follow >= 0) {
    for (const host::BodyView& body : bodies) {
      if (body.id != std::uint32_t(scene.camera.follow)) continue;
      const Vec3d shift = body.position - scene.camera.target;
      scene.camera.target += shift;
      scene.camera.position += shift;
    }
  }
  scene.grid = round_length(distance(scene.camera.position, scene.camera.target) / 10);
  const int detail = bodies.size() > 3000 ? 8 : bodies.size() > 600 ? 14 : 28;
  for (const host::BodyView& body : bodies) {
    for (const host::ShapeView& shape : body.shapes) {
      if (shape.kind == ShapeKind::plane && !scene.ground && shape.size.y > 0.999f) scene.ground = body.position.y;
      tessellate(shape, simulation.meshes(), body.position, body.rotation, color_of(body), detail, scene.triangles);
    }
  }
  tessellate(simulation.base().state.points, scene.triangles);
  for (const host::Surface& s : simulation.base().state.surfaces)
    if (!s.corners.empty()) tessellate(s, scene.triangles);
  simulation.lines(scene.lines);
  const Image image = render(scene, width, height);
  Surface surface(cairo_image_surface_create(CAIRO_FORMAT_RGB24, width, height));
  unsigned char* data = cairo_image_surface_get_data(surface.get());
  const int stride = cairo_image_surface_get_stride(surface.get());
  cairo_surface_flush(surface.get());
  for (int y = 0; y < height; ++y)
    std::memcpy(data + std::ptrdiff_t(y) * stride, image.pixels.data() + std::size_t(y) * width,
                std::size_t(width) * 4);
  cairo_surface_mark_dirty(surface.get());
  if (!lettering) return surface;
  const Context context(cairo_create(surface.get()));
  caption(context.get(), simulation, width, height,
          scene.ground ? "grid " + length_text(scene.grid) : std::string("no ground"));
  if (!scene.ground) {
    // Where there is no grid to measure by, a bar at the distance of what one looks at.
    const double per_metre = 0.5 * height / std::tan(0.5 * scene.camera.field_of_view) /
                             distance(scene.camera.position, scene.camera.target);
    const double metres = round_length(140 / per_metre);
    scale_bar(context.get(), metres, metres * per_metre, width, height);
  }
  return surface;
}

}  // namespace

Surface picture_of(host::Simulation& simulation, int width, int height, bool lettering) {
  std::vector<host::BodyView> bodies;
  std::vector<host::BodyPlace> places;
  simulation.describe(nullptr, bodies);
  simulation.places(places);
  return simulation.declaration().dimension == 2 ? plane_picture(simulation, bodies, places, width, height, lettering)
                                                 : space_picture(simulation, bodies, width, height, lettering);
}

core::Status write_picture(host::Simulation& simulation, const std::string& path, int width, int height) {
  return write_png(picture_of(simulation, width, height).get(), path);
}

}  // namespace carom::command
