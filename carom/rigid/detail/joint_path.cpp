// The curves of path joints in a world's store.
#include "carom/rigid/detail/joint_path.h"

#include "carom/rigid/path.h"

namespace carom::rigid::detail {

namespace {

template <class D>
typename D::Vector knot_tangent(const PathJointDef<D>& definition, std::size_t k) {
  const auto points = definition.points;
  const std::size_t n = points.size();
  if (!definition.tangents.empty()) return definition.tangents[k];
  if (definition.closed || (k > 0 && k + 1 < n)) return 0.5f * (points[(k + 1) % n] - points[(k + n - 1) % n]);
  // At an end that of the parabola through the last three points, or of the line through two.
  const auto &end = points[k], &next = points[k == 0 ? 1 : n - 2];
  const auto after = n > 2 ? points[k == 0 ? 2 : n - 3] : 2.0f * next - end;
  return (k == 0 ? 0.5f : -0.5f) * (4.0f * next - 3.0f * end - after);
}

}  // namespace

template <class D>
void add_knots(JointStore<D>& joints, JointData<D>& data) {
  auto& definition = *data.template get<PathJointDef>();
  JointMore<D>& more = data.more();
  const auto points = definition.points;
  const std::size_t n = points.size(), count = n + (definition.closed ? 1 : 0);
  more.first_knot = std::int32_t(joints.knot_points.size());
  more.knot_count = std::int32_t(count);
  more.own_tangents = !definition.tangents.empty();
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t k = i % n;
    const auto tangent = knot_tangent(definition, k);
    joints.knot_points.push_back(points[k]);
    joints.knot_tangents.push_back(tangent);
    joints.knot_arcs.push_back(0);
  }
  const PathCurve<D> curve = curve_of(joints, data);
  double arc = 0;
  for (std::int32_t i = 1; i < more.knot_count; ++i) {
    const std::size_t knot = std::size_t(more.first_knot) + std::size_t(i);
    arc += definition.straight ? double(math::distance(joints.knot_points[knot], joints.knot_points[knot - 1]))
                               : double(curve.arc_within(i - 1, 1));
    joints.knot_arcs[knot] = float(arc);
  }
  definition.points = definition.tangents = {};
}

template <class D>
PathCurve<D> curve_of(const JointStore<D>& joints, const JointData<D>& data) {
  const auto& d = *data.template get<PathJointDef>();
  const std::size_t first = std::size_t(data.more().first_knot);
  return {{&joints.knot_points[first], &joints.knot_tangents[first], &joints.knot_arcs[first]},
          data.more().knot_count,
          d.closed,
          d.straight};
}

template <class D>
void drop_knots(JointStore<D>& joints, std::int32_t joint) {
  if (joints.at(joint).type != JointType::path) return;
  const std::int32_t first = joints.at(joint).more().first_knot, count = joints.at(joint).more().knot_count;
  const auto drop = [&](auto& values) {
    const auto begin = values.begin() + first;
    values.erase(begin, begin + count);
  };
  drop(joints.knot_points);
  drop(joints.knot_tangents);
  drop(joints.knot_arcs);
  for (LargeJoint<D>& other : joints.large)
    if (other.more.first_knot > first) other.more.first_knot -= count;
}

template <class D>
AnyJointDef<D> whole_definition(const JointStore<D>& joints, const JointData<D>& data) {
  AnyJointDef<D> whole = data.visit([](const auto& d) { return AnyJointDef<D>(d); });
  if (auto* path = std::get_if<PathJointDef<D>>(&whole)) {
    const std::size_t first = std::size_t(data.more().first_knot);
    const std::size_t n = std::size_t(data.more().knot_count - (path->closed ? 1 : 0));
    path->points = {&joints.knot_points[first], n};
    if (data.more().own_tangents) path->tangents = {&joints.knot_tangents[first], n};
  }
  return whole;
}

template void add_knots(JointStore<Dim2>&, JointData<Dim2>&);
template void add_knots(JointStore<Dim3>&, JointData<Dim3>&);
template PathCurve<Dim2> curve_of(const JointStore<Dim2>&, const JointData<Dim2>&);
template PathCurve<Dim3> curve_of(const JointStore<Dim3>&, const JointData<Dim3>&);
template void drop_knots(JointStore<Dim2>&, std::int32_t);
template void drop_knots(JointStore<Dim3>&, std::int32_t);
template AnyJointDef<Dim2> whole_definition(const JointStore<Dim2>&, const JointData<Dim2>&);
template AnyJointDef<Dim3> whole_definition(const JointStore<Dim3>&, const JointData<Dim3>&);

}  // namespace carom::rigid::detail

namespace carom::rigid {

template <class D>
typename D::Vector path_point(const PathJointDef<D>& path, float u) {
  const std::size_t n = path.points.size(), pieces = path.closed ? n : max(n, std::size_t{1}) - 1;
  if (n == 0) return {};
  if (pieces == 0) return path.points[0];
  const std::size_t piece = std::size_t(clamp(math::floor(u), 0.0f, float(pieces - 1)));
  const std::size_t next = (piece + 1) % n;
  const typename D::Vector p[2] = {path.points[piece], path.points[next]};
  const typename D::Vector tangent[2] = {detail::knot_tangent(path, piece), detail::knot_tangent(path, next)};
  const float arc[2] = {0, 0};
  const detail::PathCurve<D> curve({p, tangent, arc}, 2, false, path.straight);
  return curve.at({0, u - float(piece)}).p;
}

template CAROM_API math::Vec2f path_point(const PathJointDef<Dim2>&, float);
template CAROM_API math::Vec3f path_point(const PathJointDef<Dim3>&, float);

}  // namespace carom::rigid
