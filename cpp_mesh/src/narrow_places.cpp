#include "narrow_places.hpp"

#include "box_grid.hpp"

#include <set>

namespace cpp_mesh {

namespace {

// Lengths and distances below this share of the wanted size are narrow.
constexpr double narrow_share = 0.6;

// Growth of cell sizes per distance from a narrow place: as fast as good shapes allow.
constexpr double growth = 0.6;

// Growth of cell sizes per distance from a corner.
constexpr double growth_at_corners = 0.4;

// Below this share of the wanted size the distance of an end is too small for good shapes.
constexpr double near_share = 0.2;

// The clearance around the points of a graph.
class Clearances {
public:
    Clearances(const Graph& graph, const Domain& domain)
        : graph_(graph), domain_(domain), edges_(domain.box(), graph.edges.size()) {
        for (std::size_t e = 0; e < graph.edges.size(); ++e) {
            const Vec2 a = end(graph.edges[e], 0), b = end(graph.edges[e], 1);
            edges_.add(static_cast<int>(e), {std::min(a.x, b.x), std::min(a.y, b.y)},
                       {std::max(a.x, b.x), std::max(a.y, b.y)});
        }
    }

    // Distance of a point from what does not end there, or the gap given if that is less.
    double at(int point, double gap) {
        const Vec2 place = graph_.points[point].xy, reach = {gap, gap};
        for (int e : edges_.candidates(place - reach, place + reach)) {
            const GraphEdge& edge = graph_.edges[e];
            if (edge.point[0] != point && edge.point[1] != point)
                gap = std::min(gap, distance_to_segment(place, end(edge, 0), end(edge, 1)));
        }
        if (!graph_.points[point].on_boundary && !domain_.is_deeper(place, gap))
            gap = std::min(gap, domain_.depth(place));
        return gap;
    }

private:
    Vec2 end(const GraphEdge& edge, int k) const { return graph_.points[edge.point[k]].xy; }

    const Graph& graph_;
    const Domain& domain_;
    BoxGrid edges_;
};

} // namespace

SizeDisc corner_disc(Vec2 place, double size) {
    return {place, 0.0, size, growth_at_corners};
}

void limit_sizes_in_narrow_places(const Graph& graph, const Domain& domain, SizeField& size) {
    std::vector<SizeDisc> discs;
    std::set<int> points(graph.fixed_points.begin(), graph.fixed_points.end());
    for (const GraphEdge& edge : graph.edges) {
        points.insert(edge.point.begin(), edge.point.end());
        const Vec2 a = graph.points[edge.point[0]].xy, b = graph.points[edge.point[1]].xy;
        const double whole = distance(a, b);
        if (whole < narrow_share * size(0.5 * (a + b)))
            discs.push_back({0.5 * (a + b), 0.5 * whole, whole, growth});
    }
    Clearances clearances(graph, domain);
    for (int p : points) {
        const Vec2 place = graph.points[p].xy;
        const double wanted = size(place);
        const double gap = clearances.at(p, wanted);
        if (gap < narrow_share * wanted)
            discs.push_back({place, gap, gap, growth});
    }
    for (const SizeDisc& disc : discs)
        size.add(disc);
}

bool has_near_ends(const Graph& graph, const Domain& domain, const SizeField& size) {
    std::vector<int> n_edges(graph.points.size(), 0);
    for (const GraphEdge& edge : graph.edges)
        for (int p : edge.point)
            ++n_edges[p];
    Clearances clearances(graph, domain);
    for (int p = 0; p < static_cast<int>(n_edges.size()); ++p) {
        if (n_edges[p] != 1 || graph.points[p].on_boundary)
            continue;
        const double nearest = near_share * size(graph.points[p].xy);
        if (clearances.at(p, nearest) < nearest)
            return true;
    }
    return false;
}

} // namespace cpp_mesh
