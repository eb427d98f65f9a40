#include "skeleton.hpp"

#include "errors.hpp"

#include <set>

namespace cpp_mesh {

namespace {

// Arc lengths of an old cell and of the edge that it lies on agree up to this share of the cell.
constexpr double largest_rounding = 1e-6;

class GraphDivider {
public:
    GraphDivider(const Graph& graph, const std::vector<int>& node_of_point,
                 const std::vector<RosettePlan>& plans, int sectors,
                 const std::vector<FractureCell>& kept, const SizeField& size,
                 std::vector<Vec2>& xy)
        : graph_(graph), node_of_point_(node_of_point), plans_(plans), sectors_(sectors),
          kept_(kept), size_(size), xy_(xy) {}

    Skeleton run() {
        for (int e = 0; e < static_cast<int>(graph_.edges.size()); ++e)
            divide(e);
        if (n_kept_ != kept_.size())
            throw MeshError("a joint lies on a fracture cell that stays");
        sort_fracture_cells(skeleton_.cells);
        return std::move(skeleton_);
    }

private:
    // A node on the fracture and its arc length.
    struct Station {
        int node;
        double s;
    };

    // Kept cells, and the gaps between them.
    void divide(int e) {
        const GraphEdge& edge = graph_.edges[e];
        Station here = {node_of_point_[edge.point[0]], edge.s[0]};
        const Station stop = {node_of_point_[edge.point[1]], edge.s[1]};
        if (edge.old_cell >= 0) {
            add_cell(edge.fracture, here, stop, edge.old_cell);
            return;
        }
        for (const FractureCell& cell : kept_) {
            const double rounding = largest_rounding * (cell.s[1] - cell.s[0]);
            if (cell.fracture != edge.fracture || cell.s[0] < edge.s[0] - rounding ||
                cell.s[1] > edge.s[1] + rounding)
                continue;
            const Station from =
                cell.node[0] == here.node ? here : Station{cell.node[0], cell.s[0]};
            divide_gap(e, here, from);
            here = {cell.node[1], cell.s[1]};
            add_cell(edge.fracture, from, here, cell.old_cell);
            ++n_kept_;
        }
        divide_gap(e, here, here.node == stop.node ? here : stop);
    }

    void divide_gap(int e, Station start, Station stop) {
        if (start.node == stop.node)
            return;
        const int fracture = graph_.edges[e].fracture;
        const Station first = after_rosette(e, 0, start, stop);
        const Station last = after_rosette(e, 1, stop, start);
        if (first.node != start.node)
            add_cell(fracture, start, first);
        if (first.node != last.node)
            divide_between(fracture, first, last);
        if (last.node != stop.node)
            add_cell(fracture, last, stop);
    }

    // Where the ring around a tip crosses the gap between it and another station; the tip itself if
    // it is no tip with a rosette.
    Station after_rosette(int e, int end, Station tip, Station far) {
        for (const RosettePlan& plan : plans_) {
            if (plan.edge != e || plan.end != end || node_of_point_[plan.point] != tip.node)
                continue;
            const double whole = distance(xy_[tip.node], xy_[far.node]);
            Station station = far; // a ring as large as the gap ends at its other node
            if (plan.radius < whole * (1.0 - tie_margin)) {
                station.node = static_cast<int>(xy_.size());
                station.s = tip.s + (far.s - tip.s) * plan.radius / whole;
                xy_.push_back(xy_[tip.node] - plan.radius * plan.direction);
            } else if (plan.radius * (1.0 - tie_margin) > whole) {
                throw MeshError("a rosette has no room between fracture cells that stay");
            }
            skeleton_.rings.push_back(
                add_ring(xy_[tip.node], plan.direction, plan.radius, sectors_, station.node, xy_));
            skeleton_.rosettes.push_back({tip.node, plan.radius});
            return station;
        }
        return tip;
    }

    void divide_between(int fracture, Station first, Station last) {
        const Vec2 a = xy_[first.node], b = xy_[last.node];
        const std::vector<double> t = divide_segment(a, b, size_);
        Station previous = first;
        for (std::size_t k = 1; k < t.size(); ++k) {
            Station next = last;
            if (k + 1 < t.size()) {
                next = {static_cast<int>(xy_.size()), first.s + t[k] * (last.s - first.s)};
                xy_.push_back(along(a, b, t[k]));
            }
            add_cell(fracture, previous, next);
            previous = next;
        }
    }

    void add_cell(int fracture, Station start, Station stop, int old_cell = -1) {
        skeleton_.cells.push_back({fracture, {start.node, stop.node}, {start.s, stop.s}, old_cell});
    }

    const Graph& graph_;
    const std::vector<int>& node_of_point_;
    const std::vector<RosettePlan>& plans_;
    const int sectors_;
    const std::vector<FractureCell>& kept_;
    const SizeField& size_;
    std::vector<Vec2>& xy_;
    Skeleton skeleton_;
    std::size_t n_kept_ = 0;
};

} // namespace

std::vector<FractureCell> cells_outside_rosettes(const Skeleton& skeleton) {
    std::set<int> tips;
    for (const Rosette& rosette : skeleton.rosettes)
        tips.insert(rosette.tip_node);
    std::vector<FractureCell> cells;
    for (const FractureCell& cell : skeleton.cells)
        if (tips.count(cell.node[0]) == 0 && tips.count(cell.node[1]) == 0)
            cells.push_back(cell);
    return cells;
}

std::vector<int> nodes_of_lone_points(const Graph& graph, const std::vector<int>& node_of_point) {
    std::set<int> on_fracture;
    for (const GraphEdge& edge : graph.edges)
        on_fracture.insert(edge.point.begin(), edge.point.end());
    std::set<int> nodes;
    for (int p : graph.fixed_points)
        if (!graph.points[p].on_boundary && on_fracture.count(p) == 0)
            nodes.insert(node_of_point[p]);
    return {nodes.begin(), nodes.end()};
}

Skeleton divide_graph(const Graph& graph, const std::vector<int>& node_of_point,
                      const std::vector<RosettePlan>& plans, int sectors,
                      const std::vector<FractureCell>& kept, const SizeField& size,
                      std::vector<Vec2>& xy) {
    return GraphDivider(graph, node_of_point, plans, sectors, kept, size, xy).run();
}

} // namespace cpp_mesh
