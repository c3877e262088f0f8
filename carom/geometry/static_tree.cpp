#include "carom/geometry/static_tree.h"

#include "carom/geometry/detail/tree_build.h"

namespace carom::geometry {

StaticTree build_static_tree(std::span<const Bounds3f> boxes, int leaf_size) {
  StaticTree tree;
  if (boxes.empty()) return tree;
  std::vector<detail::BuildItem<Vec3f>> items(boxes.size());
  for (std::size_t i = 0; i < boxes.size(); ++i) items[i] = {boxes[i], std::uint32_t(i)};
  tree.nodes.reserve(2 * boxes.size() / std::size_t(math::max(leaf_size, 1)) + 1);

  struct Job {
    std::size_t first, count;
    std::int64_t parent;  ///< whose second child this is; −1: none
    int depth;
  };
  std::vector<Job> jobs{{0, boxes.size(), -1, 0}};
  while (!jobs.empty()) {
    const Job job = jobs.back();
    jobs.pop_back();
    const std::size_t index = tree.nodes.size();
    if (job.parent >= 0) tree.nodes[std::size_t(job.parent)].link = std::uint32_t(index);
    StaticTree::Node node;
    node.bounds = items[job.first].box;
    for (std::size_t i = 1; i < job.count; ++i) node.bounds = merge(node.bounds, items[job.first + i].box);
    if (job.count <= std::size_t(math::max(leaf_size, 1))) {
      node.link = std::uint32_t(job.first);
      node.count = std::uint32_t(job.count);
      tree.nodes.push_back(node);
      continue;
    }
    tree.nodes.push_back(node);
    const std::size_t cut = detail::binned_split<Vec3f>(std::span(items).subspan(job.first, job.count), job.depth);
    jobs.push_back({job.first + cut, job.count - cut, std::int64_t(index), job.depth + 1});
    jobs.push_back({job.first, cut, -1, job.depth + 1});
  }
  tree.items.resize(items.size());
  for (std::size_t i = 0; i < items.size(); ++i) tree.items[i] = items[i].index;
  return tree;
}

}  // namespace carom::geometry
