#include "judge.hpp"

#include "errors.hpp"

#include <algorithm>
#include <cmath>

namespace cpp_mesh {

namespace {

void check_specification(const Specification& spec) {
    if (spec.is_window && !spec.domain.is_rectangle())
        throw MeshError("a window must be a rectangle");
    for (int k = 0; k < static_cast<int>(spec.fixed_points.size()); ++k)
        if (!std::isfinite(spec.fixed_points[k].x) || !std::isfinite(spec.fixed_points[k].y))
            throw MeshError(
                {FaultKind::number, {{CulpritKind::fixed_point, k}}, {}, "{1} is not a number"});
    if (!(spec.size_fracture > 0.0 && spec.size_boundary > 0.0 &&
          std::isfinite(spec.size_boundary) && std::isfinite(spec.size_fracture)))
        throw MeshError("cell sizes must be positive");
    if (spec.size_boundary < spec.size_fracture)
        throw MeshError("cells at the boundary (" + number_text(spec.size_boundary) +
                        " m) must not be smaller than at the fractures (" +
                        number_text(spec.size_fracture) + " m)");
    for (const double size : spec.own_size)
        if (!(size >= 0.0 && (size <= spec.size_boundary || !spec.foci.places.empty())))
            throw MeshError("the own size of a fracture must be at most that at the boundary");
    if (spec.rosette_sectors != 0 && spec.rosette_sectors < 6)
        throw MeshError("a rosette needs at least 6 sectors, not " +
                        std::to_string(spec.rosette_sectors));
    if (spec.rosette_sectors != 0 && !(spec.rosette_radii.usual > 0.0))
        throw MeshError("the rosette radius must be positive");
}

void check_network(const Network& network) {
    for (int f = 0; f < network.size(); ++f)
        for (int v = network.first[f]; v < network.first[f + 1]; ++v)
            if (!std::isfinite(network.xy[v].x) || !std::isfinite(network.xy[v].y))
                throw MeshError({FaultKind::number,
                                 {fracture_culprit(f)},
                                 {},
                                 "{1} has a vertex that is not a number"});
}

// One edge goes on where the other ends, along one fracture.
bool follow(const Graph& graph, int before, int after) {
    const GraphEdge &a = graph.edges[before], &b = graph.edges[after];
    return before + 1 == after && a.fracture == b.fracture && a.point[1] == b.point[0];
}

} // namespace

Graph judged_graph(const Specification& specification, const Network& network) {
    check_specification(specification);
    check_network(network);
    const Domain& domain = specification.domain;
    return build_graph(segments_of(network), specification.fixed_points, domain,
                       specification.is_window,
                       tolerances_for(domain.box(), specification.size_fracture));
}

std::vector<Joint> joints_of(const Graph& graph) {
    std::vector<std::vector<int>> star(graph.points.size());
    for (int e = 0; e < static_cast<int>(graph.edges.size()); ++e)
        for (int p : graph.edges[e].point)
            star[p].push_back(e);
    std::vector<Joint> joints;
    for (std::size_t p = 0; p < star.size(); ++p) {
        const std::vector<int>& edges = star[p];
        if (graph.points[p].on_boundary || edges.size() < 2 ||
            (edges.size() == 2 && follow(graph, edges[0], edges[1])))
            continue;
        Joint joint;
        joint.xy = graph.points[p].xy;
        joint.fracture.fill(graph.edges[edges[0]].fracture);
        for (int e : edges)
            if (graph.edges[e].fracture != joint.fracture[0])
                joint.fracture[1] = graph.edges[e].fracture;
        joints.push_back(joint);
    }
    return joints;
}

void check_fixed_points(const Graph& graph) {
    for (std::size_t k = 0; k < graph.fixed_points.size(); ++k) {
        const int point = graph.fixed_points[k];
        int n_edges = 0, fracture = -1;
        for (const GraphEdge& edge : graph.edges) {
            if (edge.point[0] != point && edge.point[1] != point)
                continue;
            ++n_edges;
            fracture = edge.fracture;
        }
        const GraphPoint& place = graph.points[point];
        if (n_edges >= 2 || (n_edges == 1 && place.on_boundary))
            throw MeshError(
                {FaultKind::overlap,
                 {{CulpritKind::fixed_point, static_cast<int>(k)}, fracture_culprit(fracture)},
                 place.xy,
                 "{1} lies on {2} {at}, where it would act on one of its two faces "
                 "only; move it off the fracture"});
    }
}

} // namespace cpp_mesh
