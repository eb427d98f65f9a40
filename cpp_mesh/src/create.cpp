// A new mesh: graph, sizes, fracture cells, boundary, triangles, splitting, checks.
#include "boundary.hpp"
#include "check_mesh.hpp"
#include "errors.hpp"
#include "gmsh_session.hpp"
#include "guides.hpp"
#include "judge.hpp"
#include "lone_sectors.hpp"
#include "mesh.hpp"
#include "planned_sizes.hpp"
#include "rosette.hpp"
#include "skeleton.hpp"
#include "smooth.hpp"

namespace cpp_mesh {

namespace {

// The ends of guides on the boundary have the nodes from the given number on.
void embed_guides(const GuideEdges& guides, int first_on_boundary, Region& region,
                  std::vector<Vec2>& xy) {
    std::vector<int> node_of_place;
    for (std::size_t p = 0; p < guides.places.size(); ++p) {
        if (guides.on_boundary[p]) {
            node_of_place.push_back(first_on_boundary++);
        } else {
            node_of_place.push_back(static_cast<int>(xy.size()));
            xy.push_back(guides.places[p]);
        }
    }
    for (const auto& edge : guides.edges)
        region.embedded.push_back({node_of_place[edge[0]], node_of_place[edge[1]]});
}

// The sizes are wanted at the nodes of another mesh, or else grow from the fractures.
Mesh make_mesh(const Specification& specification, const Network& network,
               std::shared_ptr<const NodalSizes> wanted) {
    Mesh mesh;
    mesh.specification = specification;
    mesh.network = network;
    const Domain& domain = specification.domain;
    const Tolerances tolerances = tolerances_for(domain.box(), specification.size_fracture);

    Graph graph = judged_graph(specification, network);
    std::vector<RosettePlan> plans;
    if (specification.rosette_sectors > 0)
        plans = plan_rosettes(graph, domain, specification.rosette_radii);
    mesh.size = planned_sizes(specification, graph, plans, std::move(wanted));

    const std::size_t n_given = graph.points.size();
    GuideEdges guides;
    if (!specification.guides.empty()) {
        guides = guide_edges(specification.guides, domain, graph, plans, mesh.size);
        for (std::size_t p = 0; p < guides.places.size(); ++p)
            if (guides.on_boundary[p])
                graph.points.push_back({guides.places[p], true});
    }
    std::vector<Vec2>& xy = mesh.plane.xy;
    std::vector<int> node_of_point;
    for (const GraphPoint& point : graph.points) {
        node_of_point.push_back(static_cast<int>(xy.size()));
        xy.push_back(point.xy);
    }
    Region region;
    region.is_rough = specification.is_rough;
    region.loops.push_back(mesh_boundary(domain, graph, mesh.size, xy));
    limit_sizes_at_short_edges(domain, region.loops[0], xy, mesh.size);
    Skeleton skeleton =
        divide_graph(graph, node_of_point, plans, specification.rosette_sectors, {}, mesh.size, xy);
    for (const FractureCell& cell : cells_outside_rosettes(skeleton))
        region.embedded.push_back(cell.node);
    region.points = nodes_of_lone_points(graph, node_of_point);
    for (const std::vector<int>& ring : skeleton.rings)
        region.loops.push_back(ring);
    embed_guides(guides, static_cast<int>(n_given), region, xy);

    const int n_fixed = static_cast<int>(xy.size());
    mesh.plane.cells = GmshSession::shared()->triangulate(region, mesh.size, xy);
    for (std::size_t k = 0; k < skeleton.rings.size(); ++k)
        add_sectors(skeleton.rosettes[k].tip_node, skeleton.rings[k], mesh.plane.cells);
    mesh.plane.fracture_cells = std::move(skeleton.cells);
    mesh.plane.rosettes = std::move(skeleton.rosettes);
    smooth(mesh.plane, n_fixed);
    if (!specification.is_window && !specification.is_for_elements())
        divide_lone_sectors(mesh.plane);

    check_fracture_length(mesh.plane.fracture_cells, xy, network, domain, tolerances);
    mesh.split = split(mesh.plane, domain);
    check_mesh(mesh.split, domain);
    return mesh;
}

} // namespace

Mesh create_mesh(const Specification& specification, const Network& network) {
    return make_mesh(specification, network, nullptr);
}

Mesh create_mesh_sized(const Specification& specification, const Network& network,
                       const Mesh& old_mesh, const std::vector<double>& cell_size) {
    const Domain& domain = specification.domain;
    const Domain& old_domain = old_mesh.specification.domain;
    if (domain.is_rectangle() != old_domain.is_rectangle() ||
        domain.corners() != old_domain.corners())
        throw MeshError("the old mesh belongs to another body");
    return make_mesh(
        specification, network,
        std::make_shared<const NodalSizes>(old_mesh.plane, cell_size, specification.size_boundary));
}

} // namespace cpp_mesh
