#include "narrow_places.hpp"

#include <set>

namespace cpp_mesh {

namespace {

// Lengths and distances below this share of the wanted size are narrow.
constexpr double narrow_share = 0.6;

// Growth of cell sizes per distance from a narrow place: as fast as good shapes allow.
constexpr double growth = 0.6;

} // namespace

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
    for (int p : points) {
        const Vec2 place = graph.points[p].xy;
        const double wanted = size(place);
        double gap = wanted;
        for (const GraphEdge& edge : graph.edges)
            if (edge.point[0] != p && edge.point[1] != p)
                gap = std::min(gap, distance_to_segment(place, graph.points[edge.point[0]].xy,
                                                        graph.points[edge.point[1]].xy));
        if (!graph.points[p].on_boundary && !domain.is_deeper(place, gap))
            gap = std::min(gap, domain.depth(place));
        if (gap < narrow_share * wanted)
            discs.push_back({place, gap, gap, growth});
    }
    for (const SizeDisc& disc : discs)
        size.add(disc);
}

} // namespace cpp_mesh
