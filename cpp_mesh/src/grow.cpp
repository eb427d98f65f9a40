// Growth in a body with singular tips: graph, sizes and rosettes are those of a new mesh of the
// whole body (create.cpp); what lies outside the patches, and the rosettes of tips that stay, are
// those of the old one. Fracture cells within the patches are divided again, so they grow again
// behind a tip that has moved on.
#include "errors.hpp"
#include "mesh.hpp"
#include "narrow_places.hpp"
#include "patch_choice.hpp"
#include "patch_mesher.hpp"

namespace cpp_mesh {

namespace {

// The second margin is tried where the first leaves no room for cells of good shape. No whole
// numbers, lest rounding errors decide about cells.
constexpr double narrow_margin = 2.53;
constexpr double wide_margin = 4.17;
constexpr double largest_ratio = 1.83;

// A patch that holds more than this share of the cells is no patch.
constexpr double largest_share = 0.6;

// Cells of unfit size that hang together in smaller numbers are left as they are.
constexpr int smallest_part = 30;

// New cells may have smaller angles than those that they replace, down to this one [rad].
constexpr double fair_angle = 0.384;

void set_sizes(const std::vector<Segment>& grown, PatchTask& task) {
    const Specification& spec = task.made.specification;
    SizeField& size = task.made.size;
    if (!size.follows_other_mesh())
        for (const Segment& segment : grown)
            size.add(SizeSource{segment.end[0], segment.end[1], spec.size_along(segment.fracture),
                                spec.largest_along(segment.fracture)});
    if (spec.rosette_sectors > 0)
        task.plans = plan_rosettes(task.graph, spec.domain, spec.rosette_radii);
    size.set_discs(rosette_discs(task.graph, task.plans, spec.rosette_sectors, spec.ring_slope));
    for (const SizeDisc& disc : spec.refined)
        size.add(disc);
    limit_sizes_in_narrow_places(task.graph, spec.domain, size);
}

// Fracture cells that the patch does not hold.
std::vector<FractureCell> kept_cells(const PlaneMesh& old_mesh, const Patch& patch,
                                     const EdgeTable& edges) {
    std::vector<FractureCell> kept;
    for (std::size_t i = 0; i < old_mesh.fracture_cells.size(); ++i) {
        if (patch.holds(edges, old_mesh.fracture_cells[i]))
            continue;
        kept.push_back(old_mesh.fracture_cells[i]);
        kept.back().old_cell = static_cast<int>(i);
    }
    return kept;
}

double shape(const PlaneMesh& mesh, const Triangle& node) {
    return sine_of_smallest_angle(mesh.xy[node[0]], mesh.xy[node[1]], mesh.xy[node[2]]);
}

// New cells follow the old ones that stay.
void check_shapes(const PlaneMesh& old_mesh, const Patch& patch, const PlaneMesh& new_mesh) {
    double least = std::sin(fair_angle);
    std::size_t first = 0;
    for (std::size_t c = 0; c < old_mesh.cells.size(); ++c) {
        if (patch.is_made_anew[c])
            least = std::min(least, shape(old_mesh, old_mesh.cells[c]));
        else
            ++first;
    }
    for (std::size_t c = first; c < new_mesh.cells.size(); ++c)
        if (!(shape(new_mesh, new_mesh.cells[c]) >= least))
            throw MeshError("the patch has cells of bad shape");
}

Mesh grow_within(double margin_in_cells, const Mesh& old_mesh, const Network& network,
                 const RosetteRadii& radii) {
    const Specification& spec = old_mesh.specification;
    PatchTask task(old_mesh, network, tolerances_for(spec.domain.box(), spec.size_fracture));
    task.made.specification.rosette_radii = radii;
    const std::vector<Segment> grown = grown_segments(old_mesh.network, network);
    task.graph =
        build_graph(segments_of(network), spec.fixed_points, spec.domain, false, task.tolerances);
    set_sizes(grown, task);
    task.find_nodes_of_points();
    PatchRequest request;
    request.marked.assign(old_mesh.plane.cells.size(), 0);
    request.margin_in_cells = margin_in_cells;
    request.largest_ratio = largest_ratio;
    // An old mesh's own sizes never come back.
    request.size = task.made.size.less(old_mesh.size);
    request.smallest_part = smallest_part;
    for (const Segment& segment : grown)
        request.new_segments.push_back(segment.end);
    Patch patch = choose_patch(request, task);
    const auto n_cells = static_cast<double>(patch.is_made_anew.size());
    if (static_cast<double>(std::count(patch.is_made_anew.begin(), patch.is_made_anew.end(), 1)) >
        largest_share * n_cells)
        throw MeshError("most of the mesh would have to be remeshed");
    const PatchStyle style = {kept_cells(old_mesh.plane, patch, task.edges), true, true, false};
    Mesh mesh = mesh_patch(style, task, patch);
    check_shapes(old_mesh.plane, patch, mesh.plane);
    return mesh;
}

} // namespace

Mesh grow_mesh(const Mesh& old_mesh, const Network& network, const RosetteRadii& radii) {
    if (old_mesh.specification.is_window)
        throw MeshError("a window is not grown; make a new one");
    try {
        return grow_within(narrow_margin, old_mesh, network, radii);
    } catch (const MeshError&) {
        return grow_within(wide_margin, old_mesh, network, radii);
    }
}

} // namespace cpp_mesh
