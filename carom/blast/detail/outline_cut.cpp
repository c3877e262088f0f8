#include "carom/blast/detail/outline_cut.h"

#include <algorithm>

namespace carom::blast::detail {

using math::Vec2d;

double area_of(const Outline2& o) {
  double twice = 0;
  for (std::size_t i = 1; i + 1 < o.size(); ++i) twice += cross(o[i].p - o[0].p, o[i + 1].p - o[0].p);
  return 0.5 * twice;
}

void cut(std::vector<Outline2>& outlines, const HalfPlane& h, CutScratch2& scratch) {
  bool any_out = false;
  for (const Outline2& outline : outlines)
    for (const Corner2& c : outline) any_out = any_out || dot(h.normal, c.p) - h.offset > 0;
  if (!any_out) return;
  const Vec2d along{-h.normal.y, h.normal.x};
  auto& [corners, next, distance, exits, entries, used] = scratch;
  corners.clear(), next.clear(), exits.clear(), entries.clear();
  for (const Outline2& outline : outlines) {
    const std::size_t n = outline.size(), base = corners.size();
    for (const Corner2& c : outline) corners.push_back(c);
    next.resize(corners.size(), 0);
    for (std::size_t i = 0; i < n; ++i) next[base + i] = base + (i + 1) % n;
  }
  const std::size_t count = corners.size();
  distance.resize(count);
  for (std::size_t i = 0; i < count; ++i) distance[i] = dot(h.normal, corners[i].p) - h.offset;
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t j = next[i];
    const double a = distance[i], b = distance[j];
    if ((a > 0) == (b > 0)) continue;
    // From the corner within, so that both sides of a cut agree.
    const Vec2d in = a > 0 ? corners[j].p : corners[i].p, out = a > 0 ? corners[i].p : corners[j].p;
    const double t = a > 0 ? b / (b - a) : a / (a - b);
    const Vec2d p = in + t * (out - in);
    const std::size_t made = corners.size();
    corners.push_back({p, a > 0 ? corners[i].source : -1 - h.tag});
    next.push_back(j);
    (a > 0 ? entries : exits).push_back({made, dot(along, p)});
    if (a <= 0) next[i] = made;
  }
  const auto order = [](const CutScratch2::Crossing& a, const CutScratch2::Crossing& b) {
    return a.along != b.along ? a.along < b.along : a.corner < b.corner;
  };
  std::sort(exits.begin(), exits.end(), order);
  std::sort(entries.begin(), entries.end(), order);
  for (std::size_t k = 0; k < exits.size(); ++k) next[exits[k].corner] = entries[k].corner;
  used.assign(corners.size(), 0);
  std::size_t loops = 0;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    if (used[i] || (i < count && distance[i] > 0)) continue;
    if (loops == outlines.size()) outlines.emplace_back();
    Outline2& loop = outlines[loops];
    loop.clear();
    for (std::size_t at = i; !used[at]; at = next[at]) {
      used[at] = 1;
      loop.push_back(corners[at]);
    }
    if (loop.size() >= 3) ++loops;
  }
  outlines.resize(loops);
}

}  // namespace carom::blast::detail
