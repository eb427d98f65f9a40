#include "patch_mesher.hpp"

#include "boundary.hpp"
#include "check_mesh.hpp"
#include "flat_cells.hpp"
#include "gmsh_session.hpp"
#include "lone_sectors.hpp"
#include "patch_rim.hpp"
#include "region_edges.hpp"
#include "skeleton.hpp"
#include "smooth.hpp"

namespace cpp_mesh {

namespace {

// What gmsh is to mesh: the parts of the patch without their rosettes.
std::vector<Region> regions_of(const PatchTask& task, const Patch& patch,
                               const Skeleton& skeleton) {
    const PlaneMesh& old_plane = task.old_mesh.plane;
    std::vector<Region> regions(patch.parts.size());
    const auto region_around = [&](Vec2 p) -> Region& {
        return regions[part_around(old_plane, patch.parts, p)];
    };
    for (std::size_t i = 0; i < regions.size(); ++i)
        regions[i].loops = patch.parts[i].loops;
    for (std::size_t k = 0; k < skeleton.rings.size(); ++k)
        region_around(task.xy[skeleton.rosettes[k].tip_node]).loops.push_back(skeleton.rings[k]);
    for (const FractureCell& cell : cells_outside_rosettes(skeleton))
        if (cell.old_cell < 0 || patch.holds(task.edges, old_plane.fracture_cells[cell.old_cell]))
            region_around(0.5 * (task.xy[cell.node[0]] + task.xy[cell.node[1]]))
                .embedded.push_back(cell.node);
    for (int node : nodes_of_lone_points(task.graph, task.node_of_point))
        if (patch.surrounds(task.edges, node))
            region_around(task.xy[node]).points.push_back(node);
    return regions;
}

// The cells that fill the patch; their nodes are appended to those of the task.
std::vector<Triangle> new_cells(const PatchStyle& style, const Skeleton& skeleton,
                                const Patch& patch, PatchTask& task) {
    std::vector<Triangle> cells;
    for (const Region& region : regions_of(task, patch, skeleton)) {
        if (style.refuses_narrow_places)
            check_region_edges(region, task.xy, task.tolerances.angle);
        // As at the outer boundary: cells start from the length of short edges there.
        limit_sizes_at_short_edges(task.old_mesh.specification.domain, region.loops[0], task.xy,
                                   task.made.size);
        std::vector<Triangle> triangles =
            GmshSession::shared()->triangulate(region, task.made.size, task.xy);
        turn_flat_cells(task.xy, region.embedded, triangles);
        cells.insert(cells.end(), triangles.begin(), triangles.end());
    }
    for (std::size_t k = 0; k < skeleton.rings.size(); ++k)
        add_sectors(skeleton.rosettes[k].tip_node, skeleton.rings[k], cells);
    return cells;
}

// Nodes of the rims inside the body that neither fractures nor rosettes nor points hold.
std::vector<int> free_nodes_of_rims(const PatchTask& task, const Patch& patch) {
    const PlaneMesh& old_plane = task.old_mesh.plane;
    std::vector<char> is_held(task.xy.size(), 0);
    for (int node : task.node_of_point)
        is_held[node] = 1;
    for (const FractureCell& cell : task.made.plane.fracture_cells)
        for (int node : cell.node)
            is_held[node] = 1;
    for (std::size_t k = 0; k < old_plane.rosettes.size(); ++k) {
        const int tip = old_plane.rosettes[k].tip_node;
        for (const int* c = task.edges.begin(tip);
             patch.rosette_stays[k] && c != task.edges.end(tip); ++c)
            for (int node : old_plane.cells[*c])
                is_held[node] = 1;
    }
    std::vector<int> nodes;
    for (const PatchPart& part : patch.parts)
        for (const std::vector<int>& loop : part.loops)
            for (int node : loop)
                if (task.is_old(node) && !is_held[node] && is_inside(old_plane, task.edges, node))
                    nodes.push_back(node);
    return nodes;
}

} // namespace

Mesh mesh_patch(const PatchStyle& style, PatchTask& task, Patch& patch) {
    const PlaneMesh& old_plane = task.old_mesh.plane;
    const Domain& domain = task.old_mesh.specification.domain;
    divide_rims(task, patch);
    Skeleton skeleton = divide_graph(task.graph, task.node_of_point, task.plans,
                                     task.made.specification.rosette_sectors, style.kept_cells,
                                     task.made.size, task.xy);
    const int first_free = static_cast<int>(task.xy.size());
    const std::vector<Triangle> cells = new_cells(style, skeleton, patch, task);

    PlaneMesh& plane = task.made.plane;
    for (std::size_t c = 0; c < old_plane.cells.size(); ++c)
        if (!patch.is_made_anew[c])
            plane.cells.push_back(old_plane.cells[c]);
    const int n_kept = static_cast<int>(plane.cells.size());
    plane.cells.insert(plane.cells.end(), cells.begin(), cells.end());
    plane.fracture_cells = std::move(skeleton.cells);
    for (std::size_t k = 0; k < old_plane.rosettes.size(); ++k)
        if (patch.rosette_stays[k])
            plane.rosettes.push_back(old_plane.rosettes[k]);
    plane.rosettes.insert(plane.rosettes.end(), skeleton.rosettes.begin(), skeleton.rosettes.end());

    std::vector<int> movable;
    if (style.smooths_rim)
        movable = free_nodes_of_rims(task, patch);
    for (int node = first_free; node < static_cast<int>(task.xy.size()); ++node)
        movable.push_back(node);
    plane.xy = std::move(task.xy);
    smooth(plane, movable);
    drop_unused_nodes(plane);
    if (style.divides_lone_sectors)
        divide_lone_sectors(plane, n_kept);

    check_fracture_length(plane.fracture_cells, plane.xy, task.made.network, domain,
                          task.tolerances);
    task.made.split = split(plane, domain);
    check_mesh(task.made.split, domain);
    return std::move(task.made);
}

} // namespace cpp_mesh
