#include "patch_rim.hpp"

#include "boundary.hpp"
#include "errors.hpp"

#include <set>

namespace cpp_mesh {

namespace {

class RimDivider {
public:
    explicit RimDivider(PatchTask& task)
        : task_(task), points_(task.node_of_point.begin(), task.node_of_point.end()) {
        for (std::size_t p = 0; p < task.graph.points.size(); ++p)
            if (task.graph.points[p].on_boundary && !task.is_old(task.node_of_point[p]))
                new_ends_.insert(task.node_of_point[p]);
    }

    std::vector<int> divided(const std::vector<int>& loop) {
        const std::size_t n = loop.size();
        std::size_t first = 0;
        while (first < n && !is_stop(loop, first))
            ++first;
        std::vector<int> nodes;
        for (std::size_t k = first, next = 0; k < first + n; k = next) {
            next = k + 1;
            while (!is_stop(loop, next))
                ++next;
            if (is_on_boundary(loop[k % n], loop[(k + 1) % n]))
                divide(loop[k % n], loop[next % n], nodes);
            else
                nodes.push_back(loop[k % n]);
        }
        return nodes;
    }

    // Have all new ends of fractures been put in?
    bool is_complete() const { return new_ends_.empty(); }

private:
    bool is_on_boundary(int a, int b) const {
        return task_.edges.cell(a, b) >= 0 && task_.edges.cell(b, a) < 0;
    }

    // Does a node of a loop stay?
    bool is_stop(const std::vector<int>& loop, std::size_t k) const {
        const std::size_t n = loop.size();
        const int node = loop[k % n];
        const std::vector<Vec2>& corners = task_.old_mesh.specification.domain.corners();
        return !is_on_boundary(loop[(k + n - 1) % n], node) ||
               !is_on_boundary(node, loop[(k + 1) % n]) || points_.count(node) > 0 ||
               std::find(corners.begin(), corners.end(), task_.xy[node]) != corners.end();
    }

    void divide(int start, int stop, std::vector<int>& nodes) {
        std::vector<int> between;
        for (int node : new_ends_)
            if (distance_to_segment(task_.xy[node], task_.xy[start], task_.xy[stop]) <=
                task_.tolerances.same)
                between.push_back(node);
        for (int node : between)
            new_ends_.erase(node);
        divide_boundary(start, between, stop, task_.made.size, task_.xy, nodes);
    }

    PatchTask& task_;
    const std::set<int> points_; // nodes of the graph's points
    std::set<int> new_ends_;     // those on the boundary that are still to be put in
};

} // namespace

void divide_rims(PatchTask& task, Patch& patch) {
    RimDivider divider(task);
    for (PatchPart& part : patch.parts)
        for (std::vector<int>& loop : part.loops)
            loop = divider.divided(loop);
    if (!divider.is_complete())
        throw MeshError("a fracture reaches the boundary outside the patch that is remeshed");
}

} // namespace cpp_mesh
