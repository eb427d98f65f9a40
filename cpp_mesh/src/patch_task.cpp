#include "patch_task.hpp"

#include <numeric>

namespace cpp_mesh {

PatchTask::PatchTask(const Mesh& given, const Network& network, const Tolerances& allowed)
    : old_mesh(given), edges(given.plane.cells, static_cast<int>(given.plane.xy.size())),
      tolerances(allowed), xy(given.plane.xy) {
    made.specification = given.specification;
    made.network = network;
    made.size = given.size;
}

void PatchTask::find_nodes_of_points() {
    std::vector<int> by_x(old_mesh.plane.xy.size());
    std::iota(by_x.begin(), by_x.end(), 0);
    std::sort(by_x.begin(), by_x.end(), [&](int a, int b) { return xy[a].x < xy[b].x; });
    for (const GraphPoint& point : graph.points) {
        const Vec2 p = point.xy;
        auto node = std::lower_bound(by_x.begin(), by_x.end(), p.x - tolerances.same,
                                     [&](int a, double x) { return xy[a].x < x; });
        while (node != by_x.end() && xy[*node].x <= p.x + tolerances.same &&
               !(std::abs(xy[*node].y - p.y) <= tolerances.same))
            ++node;
        if (node != by_x.end() && xy[*node].x <= p.x + tolerances.same) {
            node_of_point.push_back(*node);
        } else {
            node_of_point.push_back(static_cast<int>(xy.size()));
            xy.push_back(p);
        }
    }
}

} // namespace cpp_mesh
