// A new mesh: graph, sizes, fracture cells, boundary, triangles, splitting, checks.
#include "check_mesh.hpp"
#include "errors.hpp"
#include "gmsh_session.hpp"
#include "mesh.hpp"
#include "rosette.hpp"
#include "skeleton.hpp"
#include "smooth.hpp"

#include <set>

namespace cpp_mesh {

namespace {

void check_specification(const Specification& spec) {
    const Rectangle& r = spec.rectangle;
    if (!(r.width() > 0.0 && r.height() > 0.0 && std::isfinite(r.diagonal())))
        throw MeshError("the rectangle to be meshed has no area");
    if (!(spec.size_fracture > 0.0 && spec.size_boundary > 0.0 &&
          std::isfinite(spec.size_boundary) && std::isfinite(spec.size_fracture)))
        throw MeshError("cell sizes must be positive");
    if (spec.size_boundary < spec.size_fracture)
        throw MeshError("cells at the boundary (" + number_text(spec.size_boundary) +
                        " m) must not be smaller than at the fractures (" +
                        number_text(spec.size_fracture) + " m)");
    if (spec.rosette_sectors != 0 && spec.rosette_sectors < 6)
        throw MeshError("a rosette needs at least 6 sectors, not " +
                        std::to_string(spec.rosette_sectors));
    if (spec.rosette_sectors != 0 && !(spec.rosette_radius > 0.0))
        throw MeshError("the rosette radius must be positive");
}

void check_network(const Network& network) {
    for (int f = 0; f < network.size(); ++f)
        for (int v = network.first[f]; v < network.first[f + 1]; ++v)
            if (!std::isfinite(network.xy[v].x) || !std::isfinite(network.xy[v].y))
                throw MeshError(fracture_name(f) + " has a vertex that is not a number");
}

// Is a point of the boundary inside the side from a to b? Coordinates on a side are exact.
bool lies_between(Vec2 p, Vec2 a, Vec2 b) {
    return a.x == b.x ? p.x == a.x && (p.y > a.y) != (p.y > b.y) && p.y != a.y && p.y != b.y
                      : p.y == a.y && (p.x > a.x) != (p.x > b.x) && p.x != a.x && p.x != b.x;
}

// Nodes of the rectangle's boundary, counter-clockwise: corners, ends of fractures, and what the
// sizes ask for between them.
std::vector<int> mesh_boundary(const Rectangle& rectangle, const Graph& graph,
                               const SizeField& size, std::vector<Vec2>& xy) {
    std::array<int, 4> corner_node = {-1, -1, -1, -1};
    const auto corners = rectangle.corners();
    std::vector<int> on_boundary;
    for (int p = 0; p < static_cast<int>(graph.points.size()); ++p) {
        if (!graph.points[p].on_boundary)
            continue;
        on_boundary.push_back(p);
        for (int c = 0; c < 4; ++c)
            if (graph.points[p].xy == corners[c])
                corner_node[c] = p;
    }
    for (int c = 0; c < 4; ++c) {
        if (corner_node[c] < 0) {
            corner_node[c] = static_cast<int>(xy.size());
            xy.push_back(corners[c]);
        }
    }
    std::vector<int> loop;
    for (int c = 0; c < 4; ++c) {
        const Vec2 a = corners[c], b = corners[(c + 1) % 4];
        std::vector<int> stops = {corner_node[c]};
        for (int p : on_boundary)
            if (lies_between(graph.points[p].xy, a, b))
                stops.push_back(p);
        std::sort(stops.begin() + 1, stops.end(),
                  [&](int p, int q) { return distance(a, xy[p]) < distance(a, xy[q]); });
        stops.push_back(corner_node[(c + 1) % 4]);
        for (std::size_t k = 0; k + 1 < stops.size(); ++k) {
            const Vec2 start = xy[stops[k]], stop = xy[stops[k + 1]];
            const std::vector<double> t = divide_segment(start, stop, size);
            loop.push_back(stops[k]);
            for (std::size_t i = 1; i + 1 < t.size(); ++i) {
                Vec2 p = along(start, stop, t[i]);
                // exactly on the side, which is how boundary faces are recognized
                if (a.x == b.x)
                    p.x = a.x;
                if (a.y == b.y)
                    p.y = a.y;
                loop.push_back(static_cast<int>(xy.size()));
                xy.push_back(p);
            }
        }
    }
    return loop;
}

} // namespace

Mesh create_mesh(const Specification& specification, const Network& network) {
    check_specification(specification);
    check_network(network);
    Mesh mesh;
    mesh.specification = specification;
    mesh.network = network;
    const Rectangle& rectangle = specification.rectangle;
    const Tolerances tolerances = tolerances_for(rectangle, specification.size_fracture);

    const Graph graph =
        build_graph(segments_of(network), rectangle, specification.is_window, tolerances);
    std::vector<SizeSource> sources;
    for (const GraphEdge& edge : graph.edges)
        sources.push_back({graph.points[edge.point[0]].xy, graph.points[edge.point[1]].xy,
                           specification.size_fracture});
    mesh.size = SizeField(std::move(sources), rectangle, specification.size_boundary);

    std::vector<RosettePlan> plans;
    if (specification.rosette_sectors > 0)
        plans = plan_rosettes(graph, rectangle, specification.rosette_radius);
    std::vector<SizeDisc> discs;
    for (const RosettePlan& plan : plans)
        discs.push_back(
            rosette_disc(graph.points[plan.point].xy, plan.radius, specification.rosette_sectors));
    mesh.size.set_discs(std::move(discs));

    std::vector<Vec2>& xy = mesh.plane.xy;
    std::vector<int> node_of_point;
    for (const GraphPoint& point : graph.points) {
        node_of_point.push_back(static_cast<int>(xy.size()));
        xy.push_back(point.xy);
    }
    Region region;
    region.loops.push_back(mesh_boundary(rectangle, graph, mesh.size, xy));
    Skeleton skeleton =
        divide_graph(graph, node_of_point, plans, specification.rosette_sectors, mesh.size, xy);
    std::set<int> tip_nodes;
    for (const Rosette& rosette : skeleton.rosettes)
        tip_nodes.insert(rosette.tip_node);
    for (const FractureCell& cell : skeleton.cells)
        if (tip_nodes.count(cell.node[0]) == 0 && tip_nodes.count(cell.node[1]) == 0)
            region.embedded.push_back(cell.node);
    for (const std::vector<int>& ring : skeleton.rings)
        region.loops.push_back(ring);

    const int n_fixed = static_cast<int>(xy.size());
    mesh.plane.cells = GmshSession::shared()->triangulate(region, mesh.size, xy);
    for (std::size_t k = 0; k < skeleton.rings.size(); ++k)
        add_sectors(skeleton.rosettes[k].tip_node, skeleton.rings[k], mesh.plane.cells);
    mesh.plane.fracture_cells = std::move(skeleton.cells);
    mesh.plane.rosettes = std::move(skeleton.rosettes);
    smooth(mesh.plane, n_fixed);

    check_fracture_length(mesh.plane.fracture_cells, xy, network, rectangle, tolerances);
    mesh.split = split(mesh.plane, rectangle);
    check_mesh(mesh.split, rectangle);
    return mesh;
}

} // namespace cpp_mesh
