#include "patch_fractures.hpp"

#include "errors.hpp"

#include <map>

namespace cpp_mesh {

namespace {

// Edges of the graph, one after the other, as chains of kept cells and gaps.
class ChainMaker {
public:
    ChainMaker(const Patch& patch, PatchTask& task) : task_(task) {
        const std::vector<FractureCell>& cells = task.old_mesh.plane.fracture_cells;
        for (int i = 0; i < static_cast<int>(cells.size()); ++i)
            if (!patch.holds(task.edges, cells[i]))
                kept_.push_back(i);
        for (int p = 0; p < static_cast<int>(task.node_of_point.size()); ++p)
            point_of_node_.try_emplace(task.node_of_point[p], p);
    }

    void divide(const GraphEdge& edge) {
        GraphEdge piece = edge;
        const auto add_piece = [&](int stop, double s, int old_cell) {
            piece.point[1] = stop;
            piece.s[1] = s;
            piece.old_cell = old_cell;
            pieces_.push_back(piece);
            piece.point[0] = stop;
            piece.s[0] = s;
        };
        const double same = task_.tolerances.same;
        for (int i : kept_) {
            const FractureCell& cell = task_.old_mesh.plane.fracture_cells[i];
            if (cell.fracture != edge.fracture || cell.s[0] < edge.s[0] - same ||
                cell.s[1] > edge.s[1] + same)
                continue;
            ++n_found_;
            const int start = point_of(cell.node[0]);
            if (start != piece.point[0])
                add_piece(start, cell.s[0], -1);
            add_piece(point_of(cell.node[1]), cell.s[1], i);
        }
        if (piece.point[0] != edge.point[1])
            add_piece(edge.point[1], edge.s[1], -1);
    }

    std::vector<GraphEdge> finish() {
        if (n_found_ != kept_.size())
            throw MeshError(
                "a joint lies on a fracture cell outside the patch that is meshed anew");
        return std::move(pieces_);
    }

private:
    int point_of(int node) {
        const auto [entry, is_new] =
            point_of_node_.try_emplace(node, static_cast<int>(task_.graph.points.size()));
        if (is_new) {
            task_.graph.points.push_back({task_.xy[node], false});
            task_.node_of_point.push_back(node);
        }
        return entry->second;
    }

    PatchTask& task_;
    std::vector<int> kept_; // old fracture cells
    std::map<int, int> point_of_node_;
    std::vector<GraphEdge> pieces_;
    std::size_t n_found_ = 0;
};

// The tips that rosettes are planned at have become ends of pieces.
void move_plans(PatchTask& task) {
    const auto at = [&](int point) { return task.graph.points[point].xy; };
    for (RosettePlan& plan : task.plans)
        for (int e = 0; e < static_cast<int>(task.graph.edges.size()); ++e) {
            const auto& point = task.graph.edges[e].point;
            if (point[plan.end] != plan.point)
                continue;
            plan.edge = e;
            if (!(distance(at(point[0]), at(point[1])) >= plan.radius * (1.0 - 1e-9)))
                throw MeshError("a rosette has no room in the patch that is meshed anew");
        }
}

} // namespace

void keep_fracture_cells(const Patch& patch, PatchTask& task) {
    ChainMaker chains(patch, task);
    for (const GraphEdge& edge : task.graph.edges)
        chains.divide(edge);
    task.graph.edges = chains.finish();
    move_plans(task);
}

} // namespace cpp_mesh
