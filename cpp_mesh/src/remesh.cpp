// Growth: a patch around new fracture segments is taken out of a mesh and meshed anew.
#include "check_mesh.hpp"
#include "errors.hpp"
#include "gmsh_session.hpp"
#include "mesh.hpp"
#include "overlap.hpp"
#include "patch.hpp"
#include "skeleton.hpp"
#include "smooth.hpp"

namespace cpp_mesh {

namespace {

// Least distance of new segments from the rim of the patch, in new fracture cells: it leaves room
// for cells of good shape.
constexpr double margin_in_cells = 2.0;

// Cells longer than this times the wanted size are taken into the patch.
constexpr double largest_ratio = 2.0;

// A new end on the boundary replaces a boundary node that is nearer than this share of its edge.
constexpr double replaced_share = 0.35;

class Remesher {
public:
    Remesher(const Mesh& old_mesh, const Network& network, double size)
        : old_(old_mesh), rectangle_(old_mesh.specification.domain.box()), size_(size),
          tolerances_(tolerances_for(rectangle_, size)),
          edges_(old_.plane.cells, static_cast<int>(old_.plane.xy.size())),
          marked_(old_.plane.cells.size(), 0), xy_(old_.plane.xy) {
        new_.specification = old_.specification;
        new_.network = network;
        new_.size = old_.size;
    }

    Mesh run(const std::vector<Vec2>& centres, double radius) {
        grow_graph();
        choose_patch(centres, radius);
        find_nodes_of_points();
        skeleton_ = divide_graph(graph_, node_of_point_, {}, 0, new_.size, xy_);
        mesh_patch();
        assemble();
        check_fracture_length(new_.plane.fracture_cells, new_.plane.xy, new_.network,
                              new_.specification.domain, tolerances_);
        new_.split = split(new_.plane, new_.specification.domain);
        check_mesh(new_.split, new_.specification.domain);
        return std::move(new_);
    }

private:
    // The old fracture cells and the new segments together.
    void grow_graph() {
        std::vector<Segment> segments;
        for (const FractureCell& cell : old_.plane.fracture_cells) {
            Segment segment;
            segment.fracture = cell.fracture;
            segment.end = {xy_[cell.node[0]], xy_[cell.node[1]]};
            segment.s = cell.s;
            segment.old_cell = static_cast<int>(segments.size());
            segments.push_back(segment);
        }
        for (const Segment& segment : grown_segments(old_.network, new_.network))
            segments.push_back(segment);
        graph_ = build_graph(segments, {}, old_.specification.domain, old_.specification.is_window,
                             tolerances_);
        for (const GraphEdge& edge : graph_.edges)
            if (edge.old_cell < 0)
                new_.size.add(
                    {graph_.points[edge.point[0]].xy, graph_.points[edge.point[1]].xy, size_});
    }

    // Points of the graph that no old fracture cell ends at.
    std::vector<int> new_points() const {
        std::vector<char> is_old(graph_.points.size(), 0);
        for (std::size_t i = 0; i < old_.plane.fracture_cells.size(); ++i)
            for (int p : graph_.segment_points[i])
                is_old[p] = 1;
        std::vector<int> points;
        for (int p = 0; p < static_cast<int>(is_old.size()); ++p)
            if (!is_old[p])
                points.push_back(p);
        return points;
    }

    void choose_patch(const std::vector<Vec2>& centres, double radius) {
        mark_discs(old_.plane, centres, radius, marked_);
        for (const GraphEdge& edge : graph_.edges)
            if (edge.old_cell < 0)
                mark_near(old_.plane,
                          {graph_.points[edge.point[0]].xy, graph_.points[edge.point[1]].xy},
                          margin_in_cells * size_, marked_);
        mark_too_large();
        for (int p : new_points())
            if (graph_.points[p].on_boundary)
                mark_around_boundary_point(graph_.points[p].xy);
        make_simple(old_.plane, edges_, marked_);
        parts_ = patch_parts(old_.plane, edges_, marked_);
    }

    // Where the sizes have become much smaller, the old cells would leave no room to grow smoothly.
    void mark_too_large() {
        for (std::size_t c = 0; c < old_.plane.cells.size(); ++c) {
            const Triangle& node = old_.plane.cells[c];
            const Vec2 p = xy_[node[0]], q = xy_[node[1]], r = xy_[node[2]];
            const Vec2 centre = (1.0 / 3.0) * (p + q + r);
            const double longest = std::max({distance(p, q), distance(q, r), distance(r, p)});
            if (longest > largest_ratio * new_.size(centre) && !marked_[c])
                marked_[c] = 1;
        }
    }

    // A new end on the boundary may replace a node of the boundary edge that it lies on.
    void mark_around_boundary_point(Vec2 p) {
        for (int c = 0; c < static_cast<int>(old_.plane.cells.size()); ++c) {
            for (int k = 0; k < 3; ++k) {
                const int a = old_.plane.cells[c][k], b = old_.plane.cells[c][(k + 1) % 3];
                const int side = rectangle_.common_side(xy_[a], xy_[b]);
                if (side == 0 || side != rectangle_.common_side(xy_[a], p) ||
                    dot(p - xy_[a], p - xy_[b]) > 0.0 || edges_.cell(b, a) >= 0)
                    continue;
                for (int node : {a, b})
                    for (const int* d = edges_.begin(node); d != edges_.end(node); ++d)
                        marked_[*d] = 1;
            }
        }
    }

    // Old nodes keep their numbers; a new point gets a new node, also where it lies on the
    // boundary.
    void find_nodes_of_points() {
        node_of_point_.assign(graph_.points.size(), -1);
        is_on_fracture_.assign(xy_.size(), 0);
        for (std::size_t i = 0; i < old_.plane.fracture_cells.size(); ++i) {
            for (int k = 0; k < 2; ++k) {
                const int node = old_.plane.fracture_cells[i].node[k];
                node_of_point_[graph_.segment_points[i][k]] = node;
                is_on_fracture_[node] = 1;
            }
        }
        for (int p : new_points()) {
            const Vec2 xy = graph_.points[p].xy;
            if (is_corner(xy)) {
                node_of_point_[p] =
                    static_cast<int>(std::find(xy_.begin(), xy_.end(), xy) - xy_.begin());
                continue;
            }
            node_of_point_[p] = static_cast<int>(xy_.size());
            xy_.push_back(xy);
            is_on_fracture_.push_back(1);
            if (graph_.points[p].on_boundary)
                insert_on_boundary(node_of_point_[p]);
        }
    }

    bool is_corner(Vec2 p) const {
        const auto corners = rectangle_.corners();
        return std::find(corners.begin(), corners.end(), p) != corners.end();
    }

    // Put a node between the two boundary nodes of the patch around it, and take out one that is
    // too near.
    void insert_on_boundary(int node) {
        const Vec2 p = xy_[node];
        for (PatchPart& part : parts_) {
            for (std::vector<int>& loop : part.loops) {
                for (std::size_t k = 0; k < loop.size(); ++k) {
                    const Vec2 a = xy_[loop[k]], b = xy_[loop[(k + 1) % loop.size()]];
                    const int side = rectangle_.common_side(a, b);
                    if (side == 0 || side != rectangle_.common_side(a, p) ||
                        dot(p - a, p - b) > 0.0)
                        continue;
                    loop.insert(loop.begin() + static_cast<std::ptrdiff_t>(k) + 1, node);
                    remove_neighbour(loop, (k + 2) % loop.size(), (k + 3) % loop.size(), p, side);
                    const std::size_t here =
                        std::find(loop.begin(), loop.end(), node) - loop.begin();
                    const std::size_t n = loop.size();
                    remove_neighbour(loop, (here + n - 1) % n, (here + n - 2) % n, p, side);
                    return;
                }
            }
        }
        throw MeshError(
            "a fracture reaches the boundary outside the patch that is meshed anew at (" +
            number_text(p.x) + ", " + number_text(p.y) + ")");
    }

    // Take out loop[k] if it is too near to p and free: neither a corner nor on a fracture, with
    // the patch also beyond it, up to loop[beyond] on the same side.
    void remove_neighbour(std::vector<int>& loop, std::size_t k, std::size_t beyond, Vec2 p,
                          int side) const {
        const int node = loop[k];
        if (is_on_fracture_[node] || is_corner(xy_[node]) ||
            rectangle_.common_side(xy_[node], xy_[loop[beyond]]) != side)
            return;
        if (distance(xy_[node], p) < replaced_share * distance(xy_[node], xy_[loop[beyond]]))
            loop.erase(loop.begin() + static_cast<std::ptrdiff_t>(k));
    }

    // Fracture cells inside a part are those with an old node or a middle inside it and not on its
    // rim.
    void mesh_patch() {
        first_free_ = static_cast<int>(xy_.size());
        std::vector<int> part_of_cell(old_.plane.cells.size(), -1);
        for (std::size_t i = 0; i < parts_.size(); ++i)
            for (int c : parts_[i].cells)
                part_of_cell[c] = static_cast<int>(i);
        std::vector<Region> regions(parts_.size());
        for (std::size_t i = 0; i < parts_.size(); ++i)
            regions[i].loops = parts_[i].loops;
        for (const FractureCell& cell : skeleton_.cells) {
            const int part = cell.old_cell >= 0 ? part_around_old(cell.old_cell, part_of_cell)
                                                : part_around_new(cell, part_of_cell);
            if (part >= 0)
                regions[part].embedded.push_back(cell.node);
        }
        for (const Region& region : regions) {
            const std::vector<Triangle> cells =
                GmshSession::shared()->triangulate(region, new_.size, xy_);
            new_cells_.insert(new_cells_.end(), cells.begin(), cells.end());
        }
    }

    int part_around_old(int old_cell, const std::vector<int>& part_of_cell) const {
        const auto& node = old_.plane.fracture_cells[old_cell].node;
        const int left = edges_.cell(node[0], node[1]), right = edges_.cell(node[1], node[0]);
        return part_of_cell[left] == part_of_cell[right] ? part_of_cell[left] : -1;
    }

    int part_around_new(const FractureCell& cell, const std::vector<int>& part_of_cell) const {
        const Vec2 middle = 0.5 * (xy_[cell.node[0]] + xy_[cell.node[1]]);
        for (std::size_t c = 0; c < old_.plane.cells.size(); ++c) {
            const Triangle& node = old_.plane.cells[c];
            const Vec2 p = old_.plane.xy[node[0]], q = old_.plane.xy[node[1]],
                       r = old_.plane.xy[node[2]];
            if (part_of_cell[c] >= 0 && twice_area(p, q, middle) >= 0.0 &&
                twice_area(q, r, middle) >= 0.0 && twice_area(r, p, middle) >= 0.0)
                return part_of_cell[c];
        }
        throw MeshError("a new segment of " + fracture_name(cell.fracture) +
                        " lies outside the patch that is meshed anew");
    }

    // Old cells that stay, then new ones; nodes that no cell uses are left out.
    void assemble() {
        PatchMap map;
        std::vector<int> patch;
        PlaneMesh& plane = new_.plane;
        for (int c = 0; c < static_cast<int>(old_.plane.cells.size()); ++c) {
            if (marked_[c]) {
                patch.push_back(c);
            } else {
                plane.cells.push_back(old_.plane.cells[c]);
                map.cell_old.push_back(c);
            }
        }
        plane.cells.insert(plane.cells.end(), new_cells_.begin(), new_cells_.end());
        map.cell_old.resize(plane.cells.size(), -1);
        plane.fracture_cells = std::move(skeleton_.cells);

        plane.xy = std::move(xy_);
        smooth(plane, drop_unused_nodes(plane, first_free_));
        find_overlaps(old_.plane, patch, plane, map);
        new_.map = std::move(map);
    }

    const Mesh& old_;
    const Rectangle rectangle_;
    const double size_;
    const Tolerances tolerances_;
    const EdgeTable edges_;
    std::vector<char> marked_; // old cells of the patch
    std::vector<Vec2> xy_;     // old nodes, then new ones
    Mesh new_;
    Graph graph_;
    std::vector<PatchPart> parts_;
    std::vector<int> node_of_point_;
    std::vector<char> is_on_fracture_;
    Skeleton skeleton_;
    std::vector<Triangle> new_cells_;
    int first_free_ = 0;
};

} // namespace

Mesh remesh(const Mesh& old_mesh, const Network& network, const std::vector<Vec2>& centres,
            double radius, double size) {
    if (!(size > 0.0 && std::isfinite(size) && radius >= 0.0 && std::isfinite(radius)))
        throw MeshError("the size of new cells and the radius of the patch must be positive");
    if (!old_mesh.plane.rosettes.empty())
        throw MeshError("a mesh with rosettes cannot be remeshed; make a new one");
    if (!old_mesh.specification.domain.is_rectangle() ||
        !old_mesh.specification.fixed_points.empty())
        throw MeshError("only a mesh of a rectangle without fixed points can be remeshed in a "
                        "patch; make a new one");
    return Remesher(old_mesh, network, size).run(centres, radius);
}

} // namespace cpp_mesh
