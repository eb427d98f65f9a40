#include "region_edges.hpp"

#include "errors.hpp"

namespace cpp_mesh {

namespace {

// Edges that share no node are at least so far apart, in lengths of the shorter one.
constexpr double least_room = 0.05;

bool fit_together(std::array<int, 2> p, std::array<int, 2> q, const std::vector<Vec2>& xy,
                  double least_angle) {
    const Vec2 a = xy[p[0]], b = xy[p[1]], c = xy[q[0]], d = xy[q[1]];
    const double room = least_room * std::min(distance(a, b), distance(c, d));
    if (std::max(a.x, b.x) + room < std::min(c.x, d.x) ||
        std::max(c.x, d.x) + room < std::min(a.x, b.x) ||
        std::max(a.y, b.y) + room < std::min(c.y, d.y) ||
        std::max(c.y, d.y) + room < std::min(a.y, b.y))
        return true;
    int n_shared = 0;
    double angle = 1.0;
    for (int k = 0; k < 2; ++k) {
        for (int l = 0; l < 2; ++l) {
            if (p[k] != q[l])
                continue;
            ++n_shared;
            angle = angle_between(xy[p[1 - k]] - xy[p[k]], xy[q[1 - l]] - xy[q[l]]);
        }
    }
    if (n_shared == 0)
        return segment_distance(a, b, c, d) > room;
    return n_shared == 1 && angle > least_angle;
}

} // namespace

void check_region_edges(const Region& region, const std::vector<Vec2>& xy, double least_angle) {
    std::vector<std::array<int, 2>> edges = region.embedded;
    for (const std::vector<int>& loop : region.loops)
        for (std::size_t k = 0; k < loop.size(); ++k)
            edges.push_back({loop[k], loop[(k + 1) % loop.size()]});
    for (std::size_t i = 0; i < edges.size(); ++i)
        for (std::size_t j = 0; j < i; ++j)
            if (!fit_together(edges[i], edges[j], xy, least_angle))
                throw MeshError("edges of the patch meet");
}

} // namespace cpp_mesh
