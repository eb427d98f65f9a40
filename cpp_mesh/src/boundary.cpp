#include "boundary.hpp"

namespace cpp_mesh {

namespace {

// Division into whole numbers of cells makes edges at least 2/3 of the wanted size; shorter ones
// are due to corners.
constexpr double short_share = 0.6;

// Growth of cell sizes per distance from a short edge: as fast as good shapes allow.
constexpr double growth_inwards = 0.6;

// The node of each corner: that of a graph point there, or a new one.
std::vector<int> nodes_of_corners(const Domain& domain, const Graph& graph,
                                  const std::vector<int>& on_boundary, std::vector<Vec2>& xy) {
    const std::vector<Vec2>& corners = domain.corners();
    std::vector<int> corner_node(corners.size(), -1);
    for (std::size_t c = 0; c < corners.size(); ++c)
        for (int p : on_boundary)
            if (graph.points[p].xy == corners[c])
                corner_node[c] = p;
    for (std::size_t c = 0; c < corners.size(); ++c) {
        if (corner_node[c] < 0) {
            corner_node[c] = static_cast<int>(xy.size());
            xy.push_back(corners[c]);
        }
    }
    return corner_node;
}

// Append the node `start` and new nodes after it on the way to `stop`.
void divide_edge(int start, int stop, const SizeField& size, std::vector<Vec2>& xy,
                 std::vector<int>& loop) {
    const Vec2 a = xy[start], b = xy[stop];
    const std::vector<double> t = divide_segment(a, b, size);
    loop.push_back(start);
    for (std::size_t i = 1; i + 1 < t.size(); ++i) {
        Vec2 p = along(a, b, t[i]);
        // exactly on the side, which is how boundary faces are recognized
        if (a.x == b.x)
            p.x = a.x;
        if (a.y == b.y)
            p.y = a.y;
        loop.push_back(static_cast<int>(xy.size()));
        xy.push_back(p);
    }
}

} // namespace

void divide_boundary(int start, std::vector<int> between, int stop, const SizeField& size,
                     std::vector<Vec2>& xy, std::vector<int>& loop) {
    const Vec2 first = xy[start];
    std::sort(between.begin(), between.end(),
              [&](int p, int q) { return distance(first, xy[p]) < distance(first, xy[q]); });
    between.push_back(stop);
    for (int next : between) {
        divide_edge(start, next, size, xy, loop);
        start = next;
    }
}

std::vector<int> mesh_boundary(const Domain& domain, const Graph& graph, const SizeField& size,
                               std::vector<Vec2>& xy) {
    std::vector<int> on_boundary;
    for (int p = 0; p < static_cast<int>(graph.points.size()); ++p)
        if (graph.points[p].on_boundary)
            on_boundary.push_back(p);
    const std::vector<int> corner_node = nodes_of_corners(domain, graph, on_boundary, xy);
    std::vector<int> loop;
    for (int edge = 0; edge < domain.edge_count(); ++edge) {
        std::vector<int> between;
        for (int p : on_boundary) {
            const Vec2 place = graph.points[p].xy;
            if (place != domain.start(edge) && place != domain.stop(edge) &&
                domain.is_on_edge(place, edge))
                between.push_back(p);
        }
        divide_boundary(corner_node[edge], between, corner_node[(edge + 1) % domain.edge_count()],
                        size, xy, loop);
    }
    return loop;
}

void limit_sizes_at_short_edges(const Domain& domain, const std::vector<int>& loop,
                                const std::vector<Vec2>& xy, SizeField& size) {
    if (domain.is_rectangle())
        return;
    std::vector<SizeDisc> discs;
    for (std::size_t k = 0; k < loop.size(); ++k) {
        const Vec2 a = xy[loop[k]], b = xy[loop[(k + 1) % loop.size()]];
        const Vec2 middle = 0.5 * (a + b);
        const double edge = distance(a, b);
        if (edge < short_share * size(middle))
            discs.push_back({middle, 0.5 * edge, edge, growth_inwards});
    }
    for (const SizeDisc& disc : discs)
        size.add(disc);
}

} // namespace cpp_mesh
