// Growth on the coarse level: fracture cells stay as they are, nodes outside the patch too, and a
// map tells how the new cells cover the old ones.
#include "errors.hpp"
#include "mesh.hpp"
#include "overlap.hpp"
#include "patch_choice.hpp"
#include "patch_mesher.hpp"

namespace cpp_mesh {

namespace {

constexpr double margin_in_cells = 2.0;
constexpr double largest_ratio = 2.0;

void check_request(const Mesh& old_mesh, double radius, double size) {
    if (!(size > 0.0 && std::isfinite(size) && radius >= 0.0 && std::isfinite(radius)))
        throw MeshError("the size of new cells and the radius of the patch must be positive");
    if (!old_mesh.plane.rosettes.empty())
        throw MeshError("a mesh with rosettes cannot be remeshed; make a new one");
    if (!old_mesh.specification.domain.is_rectangle() ||
        !old_mesh.specification.fixed_points.empty())
        throw MeshError("only a mesh of a rectangle without fixed points can be remeshed in a "
                        "patch; make a new one");
}

// The old fracture cells and the new segments together.
Graph grown_graph(const Mesh& old_mesh, const Network& network, const Tolerances& tolerances) {
    std::vector<Segment> segments;
    for (const FractureCell& cell : old_mesh.plane.fracture_cells)
        segments.push_back({cell.fracture,
                            {old_mesh.plane.xy[cell.node[0]], old_mesh.plane.xy[cell.node[1]]},
                            cell.s,
                            static_cast<int>(segments.size())});
    for (const Segment& segment : grown_segments(old_mesh.network, network))
        segments.push_back(segment);
    return build_graph(segments, {}, old_mesh.specification.domain,
                       old_mesh.specification.is_window, tolerances);
}

} // namespace

Mesh remesh(const Mesh& old_mesh, const Network& network, const std::vector<Vec2>& centres,
            double radius, double size) {
    check_request(old_mesh, radius, size);
    PatchTask task(old_mesh, network, size);
    task.graph = grown_graph(old_mesh, network, task.tolerances);
    task.find_nodes_of_points();
    PatchRequest request;
    request.marked = cells_in_discs(old_mesh.plane, centres, radius);
    request.margin_in_cells = margin_in_cells;
    request.largest_ratio = largest_ratio;
    for (const GraphEdge& edge : task.graph.edges) {
        if (edge.old_cell >= 0)
            continue;
        const Vec2 a = task.graph.points[edge.point[0]].xy, b = task.graph.points[edge.point[1]].xy;
        task.made.size.add(SizeSource{a, b, size});
        request.new_segments.push_back({a, b});
    }
    request.size = task.made.size;
    Patch patch = choose_patch(request, task);
    Mesh mesh = mesh_patch(PatchStyle{}, task, patch);
    mesh.map = map_of_patch(old_mesh.plane, patch.is_made_anew, mesh.plane);
    return mesh;
}

} // namespace cpp_mesh
