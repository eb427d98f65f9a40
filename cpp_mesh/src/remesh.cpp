// Growth on the coarse level: fracture cells stay as they are, nodes outside the patch too, and a
// map tells how the new cells cover the old ones.
#include "errors.hpp"
#include "judge.hpp"
#include "mesh.hpp"
#include "narrow_places.hpp"
#include "overlap.hpp"
#include "patch_choice.hpp"
#include "patch_mesher.hpp"

namespace cpp_mesh {

namespace {

// The second margin is tried where the first leads to no valid mesh.
constexpr double first_margin = 2.0;
constexpr double second_margin = 4.0;
constexpr double largest_size_ratio = 2.0;

void check_request(const Mesh& old_mesh, double radius, double size) {
    if (!(size > 0.0 && std::isfinite(size) && radius >= 0.0 && std::isfinite(radius)))
        throw MeshError("the size of new cells and the radius of the patch must be positive");
    if (!old_mesh.plane.rosettes.empty())
        throw MeshError("a mesh with rosettes cannot be remeshed; make a new one");
}

// A joint nearer to a node inside a fracture than this share of a cell moves the node to its place:
// the parts of a divided cell would have neighbours too long for them.
constexpr double smallest_part = 0.35;

// What has grown may come nearer to nodes of cells than what is given may come to fractures: where
// an end almost touches another fracture, cells are no longer than what lies between.
constexpr double nearer = 0.1;

// The node between two cells of a fracture that go on straight, and through which no other goes, is
// moved to a place on one of them. False if there is no such node near the place.
bool move_node(Vec2 place, const Tolerances& tolerances, std::vector<Segment>& cells) {
    for (std::size_t i = 0; i < cells.size(); ++i) {
        const Vec2 a = cells[i].end[0], b = cells[i].end[1];
        if (distance(place, a) <= tolerances.same || distance(place, b) <= tolerances.same ||
            distance_to_segment(place, a, b) > tolerances.same)
            continue;
        const int near = distance(place, a) < distance(place, b) ? 0 : 1;
        const Vec2 node = cells[i].end[near];
        if (distance(place, node) >= smallest_part * distance(a, b))
            return false;
        std::size_t next = cells.size();
        int n_cells = 0;
        for (std::size_t k = 0; k < cells.size(); ++k)
            for (const Vec2& end : cells[k].end)
                n_cells += distance(end, node) <= tolerances.same;
        for (std::size_t k = 0; k < cells.size(); ++k)
            if (cells[k].fracture == cells[i].fracture && cells[k].end[1 - near] == node)
                next = k;
        if (next == cells.size() || n_cells != 2)
            return false;
        const Vec2 far = cells[next].end[near];
        if (distance_to_segment(node, far, cells[i].end[1 - near]) > tolerances.same)
            return false;
        const double s = cells[i].s[near] + (cells[i].s[1 - near] - cells[i].s[near]) *
                                                distance(place, node) / distance(a, b);
        for (const std::size_t k : {i, next}) {
            const int end = k == i ? near : 1 - near;
            cells[k].end[end] = place;
            cells[k].s[end] = s;
            cells[k].old_cell = -1;
        }
        return true;
    }
    return false;
}

// The old fracture cells and the new segments together.
Graph grown_graph(const Mesh& old_mesh, const Network& network, const Tolerances& tolerances) {
    std::vector<Segment> segments;
    for (const FractureCell& cell : old_mesh.plane.fracture_cells)
        segments.push_back({cell.fracture,
                            {old_mesh.plane.xy[cell.node[0]], old_mesh.plane.xy[cell.node[1]]},
                            cell.s,
                            static_cast<int>(segments.size())});
    const std::vector<Segment> grown = grown_segments(old_mesh.network, network);
    for (const Segment& segment : grown)
        for (const Vec2& end : segment.end)
            move_node(end, tolerances, segments);
    segments.insert(segments.end(), grown.begin(), grown.end());
    return build_graph(segments, old_mesh.specification.fixed_points, old_mesh.specification.domain,
                       old_mesh.specification.is_window, tolerances);
}

// Fractures meet each other, or new segments the boundary.
bool has_joints(const Graph& graph) {
    const auto is_on_boundary = [&](int p) { return graph.points[p].on_boundary; };
    return !joints_of(graph).empty() ||
           std::any_of(graph.edges.begin(), graph.edges.end(), [&](const GraphEdge& edge) {
               return edge.old_cell < 0 &&
                      (is_on_boundary(edge.point[0]) || is_on_boundary(edge.point[1]));
           });
}

Mesh remesh_within(double margin_in_cells, const Mesh& old_mesh, const Network& network,
                   const std::vector<Vec2>& centres, double radius, double size) {
    Tolerances tolerances = tolerances_for(old_mesh.specification.domain.box(), size);
    tolerances.near_miss *= nearer;
    PatchTask task(old_mesh, network, tolerances);
    task.graph = grown_graph(old_mesh, network, task.tolerances);
    task.find_nodes_of_points();
    PatchRequest request;
    request.marked = cells_in_discs(old_mesh.plane, centres, radius);
    request.margin_in_cells = margin_in_cells;
    request.largest_ratio = largest_size_ratio;
    for (const GraphEdge& edge : task.graph.edges) {
        if (edge.old_cell >= 0)
            continue;
        const Vec2 a = task.graph.points[edge.point[0]].xy, b = task.graph.points[edge.point[1]].xy;
        task.made.size.add(
            SizeSource{a, b, old_mesh.specification.size_along(edge.fracture, size)});
        request.new_segments.push_back({a, b});
    }
    // As in a new mesh: a joint leaves parts of cells of any length, and narrow sectors.
    const bool meets = has_joints(task.graph);
    const Domain& domain = old_mesh.specification.domain;
    if (meets || has_near_ends(task.graph, domain, task.made.size))
        limit_sizes_in_narrow_places(task.graph, domain, task.made.size);
    request.size = task.made.size;
    Patch patch = choose_patch(request, task);
    PatchStyle style;
    style.divides_lone_sectors = meets;
    Mesh mesh = mesh_patch(style, task, patch);
    mesh.map = map_of_patch(old_mesh.plane, patch.is_made_anew, mesh.plane);
    return mesh;
}

} // namespace

Mesh remesh(const Mesh& old_mesh, const Network& network, const std::vector<Vec2>& centres,
            double radius, double size) {
    check_request(old_mesh, radius, size);
    try {
        return remesh_within(first_margin, old_mesh, network, centres, radius, size);
    } catch (const MeshError&) {
        return remesh_within(second_margin, old_mesh, network, centres, radius, size);
    }
}

} // namespace cpp_mesh
