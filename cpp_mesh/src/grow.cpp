// Growth in a body with singular tips: only patches around the tips that have moved are meshed
// anew. Graph, sizes and rosettes are those of a new mesh of the whole body (create.cpp); what lies
// outside the patches, and the rosettes of tips that stay, are those of the old one. Fracture cells
// within the patches are divided anew, so they grow again behind a tip that has moved on.
#include "boundary.hpp"
#include "check_mesh.hpp"
#include "errors.hpp"
#include "gmsh_session.hpp"
#include "mesh.hpp"
#include "narrow_places.hpp"
#include "patch.hpp"
#include "region_edges.hpp"
#include "skeleton.hpp"
#include "smooth.hpp"

#include <set>

namespace cpp_mesh {

namespace {

// Widths of the patch around new segments and rosettes, in cells of the size wanted there: the
// second is tried where the first leaves no room for cells of good shape. No whole numbers, lest
// rounding errors decide about cells.
constexpr double narrow_margin = 2.53;
constexpr double wide_margin = 4.17;

// Cells longer than this times the size that is now wanted are taken into the patch.
constexpr double largest_ratio = 1.83;

// Cells shorter than this times the size that is now wanted are taken into the patch: they have
// been made around a tip that has moved on.
constexpr double smallest_ratio = 0.77;

// So far around them, in radii.
constexpr double reach_of_rosettes = 7.0;

// A patch that holds more than this share of the cells is no patch.
constexpr double largest_share = 0.6;

// Cells of unfit size that hang together in smaller numbers are left as they are.
constexpr int smallest_part = 30;

// New cells may have smaller angles than those that they replace, down to this one [rad].
constexpr double fair_angle = 0.384;

// Rosettes are the same if their radii differ by no more than rounding errors.
constexpr double same_radius = 1e-6;

class Grower {
public:
    Grower(const Mesh& old_mesh, const Network& network, const RosetteRadii& radii,
           double margin_in_cells)
        : old_(old_mesh), margin_in_cells_(margin_in_cells), domain_(old_mesh.specification.domain),
          tolerances_(tolerances_for(domain_.box(), old_mesh.specification.size_fracture)),
          edges_(old_.plane.cells, static_cast<int>(old_.plane.xy.size())),
          marked_(old_.plane.cells.size(), 0), xy_(old_.plane.xy) {
        new_.specification = old_.specification;
        new_.specification.rosette_radii = radii;
        new_.network = network;
    }

    Mesh run() {
        make_graph();
        find_nodes_of_points();
        find_rosettes_that_stay();
        choose_patch();
        divide_rims();
        divide_fractures();
        mesh_patch();
        assemble();
        return std::move(new_);
    }

private:
    Vec2 at(int point) const { return graph_.points[point].xy; }

    void make_graph() {
        const Specification& spec = new_.specification;
        grown_ = grown_segments(old_.network, new_.network);
        graph_ =
            build_graph(segments_of(new_.network), spec.fixed_points, domain_, false, tolerances_);
        new_.size = old_.size;
        if (!new_.size.follows_other_mesh())
            for (const Segment& segment : grown_)
                new_.size.add(SizeSource{segment.end[0], segment.end[1], spec.size_fracture});
        if (spec.rosette_sectors > 0)
            plans_ = plan_rosettes(graph_, domain_, spec.rosette_radii);
        std::vector<SizeDisc> discs;
        for (const RosettePlan& plan : plans_)
            discs.push_back(rosette_disc(at(plan.point), plan.radius, spec.rosette_sectors));
        new_.size.set_discs(std::move(discs));
        limit_sizes_in_narrow_places(graph_, domain_, new_.size);
    }

    // The old nodes at the points of the graph; a point that is new gets a new node.
    void find_nodes_of_points() {
        const int n_old = static_cast<int>(old_.plane.xy.size());
        for (const GraphPoint& point : graph_.points) {
            int node = 0;
            while (node < n_old && !(std::abs(xy_[node].x - point.xy.x) <= tolerances_.same &&
                                     std::abs(xy_[node].y - point.xy.y) <= tolerances_.same))
                ++node;
            if (node == n_old) {
                node = static_cast<int>(xy_.size());
                xy_.push_back(point.xy);
            }
            node_of_point_.push_back(node);
        }
    }

    bool is_old(int node) const { return node < static_cast<int>(old_.plane.xy.size()); }

    void find_rosettes_that_stay() {
        stays_.assign(old_.plane.rosettes.size(), 0);
        for (const RosettePlan& plan : plans_)
            for (std::size_t k = 0; k < stays_.size(); ++k) {
                const Rosette& rosette = old_.plane.rosettes[k];
                if (rosette.tip_node == node_of_point_[plan.point] &&
                    std::abs(plan.radius - rosette.radius) <= same_radius * rosette.radius)
                    stays_[k] = 1;
            }
    }

    double margin_at(Vec2 p) const { return margin_in_cells_ * new_.size(p); }

    // Old rosettes that go, with what is around them.
    void mark_rosette(const Rosette& rosette) {
        const Vec2 tip = xy_[rosette.tip_node];
        mark_near(old_.plane, {tip, tip}, rosette.radius + margin_at(tip), marked_);
    }

    void choose_patch() {
        for (const Segment& segment : grown_) {
            const Vec2 middle = 0.5 * (segment.end[0] + segment.end[1]);
            mark_near(old_.plane, segment.end, margin_at(middle), marked_);
        }
        for (const RosettePlan& plan : plans_)
            if (kept_rosette(plan) < 0)
                mark_near(old_.plane, {at(plan.point), at(plan.point)},
                          plan.radius + margin_at(at(plan.point)), marked_);
        for (std::size_t k = 0; k < stays_.size(); ++k)
            if (!stays_[k])
                mark_rosette(old_.plane.rosettes[k]);
        const std::vector<char> is_at_growth = marked_;
        mark_unfit();
        do {
            make_simple(old_.plane, edges_, marked_);
        } while (give_up_cut_rosettes());
        const auto n_marked = std::count(marked_.begin(), marked_.end(), 1);
        if (static_cast<double>(n_marked) > largest_share * static_cast<double>(marked_.size()))
            throw MeshError("most of the mesh would have to be made anew");
        parts_ = patch_parts(old_.plane, edges_, marked_);
        leave_small_parts(is_at_growth);
    }

    // Where sizes have become much smaller, the old cells would leave no room to grow smoothly;
    // where a tip has moved on, they are needlessly small. An old mesh's own sizes never come back.
    void mark_unfit() {
        const SizeField added = new_.size.less(old_.size);
        std::vector<SizeDisc> gone;
        for (std::size_t k = 0; k < stays_.size(); ++k)
            if (!stays_[k])
                gone.push_back(rosette_disc(xy_[old_.plane.rosettes[k].tip_node],
                                            old_.plane.rosettes[k].radius,
                                            new_.specification.rosette_sectors));
        for (std::size_t c = 0; c < old_.plane.cells.size(); ++c) {
            if (marked_[c])
                continue;
            const Triangle& node = old_.plane.cells[c];
            const Vec2 p = xy_[node[0]], q = xy_[node[1]], r = xy_[node[2]];
            const Vec2 centre = (1.0 / 3.0) * (p + q + r);
            const double longest = std::max({distance(p, q), distance(q, r), distance(r, p)});
            if (longest > largest_ratio * added(centre))
                marked_[c] = 1;
            else if (std::any_of(gone.begin(), gone.end(),
                                 [&](const SizeDisc& disc) {
                                     return distance(centre, disc.centre) <
                                            reach_of_rosettes * disc.radius;
                                 }) &&
                     longest < smallest_ratio * new_.size(centre))
                marked_[c] = 1;
        }
    }

    // Some cells of unfit size apart from the growth are not worth a patch of their own.
    void leave_small_parts(const std::vector<char>& is_at_growth) {
        const auto is_small = [&](const PatchPart& part) {
            return static_cast<int>(part.cells.size()) < smallest_part &&
                   std::none_of(
                       part.cells.begin(), part.cells.end(),
                       [&](int c) { return is_at_growth[c] != 0; });
        };
        for (const PatchPart& part : parts_)
            if (is_small(part))
                for (int c : part.cells)
                    marked_[c] = 0;
        parts_.erase(std::remove_if(parts_.begin(), parts_.end(), is_small), parts_.end());
    }

    // A rosette with some cells in the patch is made anew as a whole.
    bool give_up_cut_rosettes() {
        bool has_changed = false;
        for (std::size_t k = 0; k < stays_.size(); ++k) {
            const int tip = old_.plane.rosettes[k].tip_node;
            if (!stays_[k] || std::none_of(edges_.begin(tip), edges_.end(tip),
                                           [&](int c) { return marked_[c] != 0; }))
                continue;
            stays_[k] = 0;
            has_changed = true;
            mark_rosette(old_.plane.rosettes[k]);
        }
        return has_changed;
    }

    // The old rosette at the tip of a plan if it stays, else -1.
    int kept_rosette(const RosettePlan& plan) const {
        for (std::size_t k = 0; k < stays_.size(); ++k)
            if (stays_[k] && old_.plane.rosettes[k].tip_node == node_of_point_[plan.point])
                return static_cast<int>(k);
        return -1;
    }

    bool is_on_boundary(int a, int b) const {
        return is_old(a) && is_old(b) && edges_.cell(a, b) >= 0 && edges_.cell(b, a) < 0;
    }

    // Where the patch reaches the outer boundary, its edges there are divided as the sizes now ask,
    // between corners, ends of fractures and fixed points.
    void divide_rims() {
        const std::set<int> points(node_of_point_.begin(), node_of_point_.end());
        for (PatchPart& part : parts_)
            for (std::vector<int>& loop : part.loops)
                loop = divided_loop(loop, points);
        for (std::size_t p = 0; p < graph_.points.size(); ++p)
            if (graph_.points[p].on_boundary && !is_old(node_of_point_[p]) &&
                !is_in_loop(node_of_point_[p]))
                throw MeshError("a fracture reaches the boundary outside the patch that is meshed "
                                "anew");
    }

    bool is_in_loop(int node) const {
        for (const PatchPart& part : parts_)
            for (const std::vector<int>& loop : part.loops)
                if (std::find(loop.begin(), loop.end(), node) != loop.end())
                    return true;
        return false;
    }

    std::vector<int> divided_loop(const std::vector<int>& loop, const std::set<int>& points) {
        const std::size_t n = loop.size();
        const auto& corners = domain_.corners();
        const auto is_stop = [&](std::size_t k) {
            const int node = loop[k % n];
            return !is_on_boundary(loop[(k + n - 1) % n], node) ||
                   !is_on_boundary(node, loop[(k + 1) % n]) || points.count(node) > 0 ||
                   std::find(corners.begin(), corners.end(), xy_[node]) != corners.end();
        };
        std::size_t first = 0;
        while (first < n && !is_stop(first))
            ++first;
        std::vector<int> divided;
        for (std::size_t k = first, next = 0; k < first + n; k = next) {
            next = k + 1;
            while (!is_stop(next))
                ++next;
            if (is_on_boundary(loop[k % n], loop[(k + 1) % n]))
                divide_between(loop[k % n], loop[next % n], divided);
            else
                divided.push_back(loop[k % n]);
        }
        return divided;
    }

    // From one stop on the boundary to the next, by way of new points between them.
    void divide_between(int start, int stop, std::vector<int>& loop) {
        const Vec2 a = xy_[start], b = xy_[stop];
        std::vector<int> stops = {start};
        for (std::size_t p = 0; p < graph_.points.size(); ++p)
            if (graph_.points[p].on_boundary && !is_old(node_of_point_[p]) &&
                distance_to_segment(graph_.points[p].xy, a, b) <= tolerances_.same)
                stops.push_back(node_of_point_[p]);
        std::sort(stops.begin() + 1, stops.end(),
                  [&](int p, int q) { return distance(a, xy_[p]) < distance(a, xy_[q]); });
        stops.push_back(stop);
        for (std::size_t k = 0; k + 1 < stops.size(); ++k)
            divide_boundary(stops[k], stops[k + 1], new_.size, xy_, loop);
    }

    // Fracture cells with a cell of the rest beside them stay as they are, those of rosettes that
    // stay among them.
    bool is_kept(const FractureCell& cell) const {
        for (int side = 0; side < 2; ++side)
            if (!marked_[edges_.cell(cell.node[side], cell.node[1 - side])])
                return true;
        return false;
    }

    // Edges of the graph as a chain of old cells that stay and of gaps between them, which are
    // divided anew.
    void divide_fractures() {
        Graph pieces;
        pieces.points = graph_.points;
        std::vector<RosettePlan> plans;
        std::vector<int> node_of_point = node_of_point_;
        const auto point_of = [&](int node) {
            for (std::size_t p = 0; p < node_of_point.size(); ++p)
                if (node_of_point[p] == node)
                    return static_cast<int>(p);
            pieces.points.push_back({xy_[node], false});
            node_of_point.push_back(node);
            return static_cast<int>(node_of_point.size()) - 1;
        };
        std::size_t n_kept = 0, n_found = 0;
        for (const FractureCell& cell : old_.plane.fracture_cells)
            n_kept += is_kept(cell);
        for (int e = 0; e < static_cast<int>(graph_.edges.size()); ++e) {
            const GraphEdge& edge = graph_.edges[e];
            GraphEdge piece = edge;
            const auto add_piece = [&](int stop, double s, int old_cell) {
                piece.point[1] = stop;
                piece.s[1] = s;
                piece.old_cell = old_cell;
                for (const RosettePlan& plan : plans_) {
                    if (plan.edge != e || piece.point[plan.end] != plan.point ||
                        kept_rosette(plan) >= 0)
                        continue;
                    plans.push_back(plan);
                    plans.back().edge = static_cast<int>(pieces.edges.size());
                }
                pieces.edges.push_back(piece);
                piece.point[0] = stop;
                piece.s[0] = s;
            };
            for (int i = 0; i < static_cast<int>(old_.plane.fracture_cells.size()); ++i) {
                const FractureCell& cell = old_.plane.fracture_cells[i];
                if (cell.fracture != edge.fracture || cell.s[0] < edge.s[0] - tolerances_.same ||
                    cell.s[1] > edge.s[1] + tolerances_.same || !is_kept(cell))
                    continue;
                ++n_found;
                const int start = point_of(cell.node[0]);
                if (start != piece.point[0])
                    add_piece(start, cell.s[0], -1);
                add_piece(point_of(cell.node[1]), cell.s[1], i);
            }
            if (piece.point[0] != edge.point[1])
                add_piece(edge.point[1], edge.s[1], -1);
        }
        if (n_found != n_kept)
            throw MeshError(
                "a joint lies on a fracture cell outside the patch that is meshed anew");
        check_room(pieces, plans);
        skeleton_ = divide_graph(pieces, node_of_point, plans, new_.specification.rosette_sectors,
                                 new_.size, xy_);
    }

    // A rosette must lie within the gap that it is made in.
    void check_room(const Graph& pieces, const std::vector<RosettePlan>& plans) const {
        for (const RosettePlan& plan : plans) {
            const auto& point = pieces.edges[plan.edge].point;
            if (!(distance(pieces.points[point[0]].xy, pieces.points[point[1]].xy) >=
                  plan.radius * (1.0 - 1e-9)))
                throw MeshError("a rosette has no room in the patch that is meshed anew");
        }
    }

    void mesh_patch() {
        std::vector<Region> regions(parts_.size());
        for (std::size_t i = 0; i < parts_.size(); ++i)
            regions[i].loops = parts_[i].loops;
        std::set<int> tips;
        for (std::size_t k = 0; k < skeleton_.rosettes.size(); ++k) {
            tips.insert(skeleton_.rosettes[k].tip_node);
            regions[part_around(old_.plane, parts_, xy_[skeleton_.rosettes[k].tip_node])]
                .loops.push_back(skeleton_.rings[k]);
        }
        for (const FractureCell& cell : skeleton_.cells)
            if (cell.old_cell < 0 && tips.count(cell.node[0]) == 0 && tips.count(cell.node[1]) == 0)
                regions[part_around(old_.plane, parts_,
                                    0.5 * (xy_[cell.node[0]] + xy_[cell.node[1]]))]
                    .embedded.push_back(cell.node);
        add_fixed_points(regions);
        first_free_ = static_cast<int>(xy_.size());
        for (const Region& region : regions) {
            check_region_edges(region, xy_, tolerances_.angle);
            // As at the outer boundary: cells start from the length of short edges there.
            limit_sizes_at_short_edges(domain_, region.loops[0], xy_, new_.size);
            const std::vector<Triangle> cells =
                GmshSession::shared()->triangulate(region, new_.size, xy_);
            new_cells_.insert(new_cells_.end(), cells.begin(), cells.end());
        }
        for (std::size_t k = 0; k < skeleton_.rings.size(); ++k)
            add_sectors(skeleton_.rosettes[k].tip_node, skeleton_.rings[k], new_cells_);
    }

    // Fixed points inside the patch and on no fracture stay nodes.
    void add_fixed_points(std::vector<Region>& regions) const {
        for (int p : graph_.fixed_points) {
            const int node = node_of_point_[p];
            const bool is_alone =
                std::none_of(graph_.edges.begin(), graph_.edges.end(), [&](const GraphEdge& edge) {
                    return edge.point[0] == p || edge.point[1] == p;
                });
            if (is_alone && !graph_.points[p].on_boundary &&
                std::all_of(edges_.begin(node), edges_.end(node),
                            [&](int c) { return marked_[c] != 0; }))
                regions[part_around(old_.plane, parts_, xy_[node])].points.push_back(node);
        }
    }

    // Old cells that stay, then new ones.
    void assemble() {
        PlaneMesh& plane = new_.plane;
        for (std::size_t c = 0; c < marked_.size(); ++c)
            if (!marked_[c])
                plane.cells.push_back(old_.plane.cells[c]);
        const std::size_t n_old = plane.cells.size();
        plane.cells.insert(plane.cells.end(), new_cells_.begin(), new_cells_.end());
        plane.fracture_cells = std::move(skeleton_.cells);
        for (std::size_t k = 0; k < stays_.size(); ++k)
            if (stays_[k])
                plane.rosettes.push_back(old_.plane.rosettes[k]);
        plane.rosettes.insert(plane.rosettes.end(), skeleton_.rosettes.begin(),
                              skeleton_.rosettes.end());
        plane.xy = std::move(xy_);
        smooth(plane, movable_nodes());
        drop_unused_nodes(plane, 0);
        check_shapes(n_old);
        check_fracture_length(plane.fracture_cells, plane.xy, new_.network, domain_, tolerances_);
        new_.split = split(plane, domain_);
        check_mesh(new_.split, domain_);
    }

    // The nodes that gmsh has added, and those of the rims that nothing holds.
    std::vector<int> movable_nodes() const {
        const PlaneMesh& plane = new_.plane;
        std::vector<char> is_held(plane.xy.size(), 0);
        for (int node : node_of_point_)
            is_held[node] = 1;
        for (const FractureCell& cell : plane.fracture_cells)
            for (int node : cell.node)
                is_held[node] = 1;
        for (std::size_t k = 0; k < stays_.size(); ++k) {
            const int tip = old_.plane.rosettes[k].tip_node;
            for (const int* c = edges_.begin(tip); stays_[k] && c != edges_.end(tip); ++c)
                for (int node : old_.plane.cells[*c])
                    is_held[node] = 1;
        }
        std::vector<int> nodes;
        for (const PatchPart& part : parts_) {
            for (const std::vector<int>& loop : part.loops) {
                for (int node : loop)
                    if (is_old(node) && !is_held[node] && is_inside(old_.plane, edges_, node))
                        nodes.push_back(node);
            }
        }
        for (int node = first_free_; node < static_cast<int>(plane.xy.size()); ++node)
            nodes.push_back(node);
        return nodes;
    }

    void check_shapes(std::size_t first) const {
        double least = std::sin(fair_angle);
        for (std::size_t c = 0; c < marked_.size(); ++c)
            if (marked_[c])
                least = std::min(least, shape(old_.plane, old_.plane.cells[c]));
        for (std::size_t c = first; c < new_.plane.cells.size(); ++c)
            if (!(shape(new_.plane, new_.plane.cells[c]) >= least))
                throw MeshError("the patch has cells of bad shape");
    }

    static double shape(const PlaneMesh& mesh, const Triangle& node) {
        return sine_of_smallest_angle(mesh.xy[node[0]], mesh.xy[node[1]], mesh.xy[node[2]]);
    }

    const Mesh& old_;
    const double margin_in_cells_;
    const Domain& domain_;
    const Tolerances tolerances_;
    const EdgeTable edges_;
    std::vector<char> marked_; // old cells of the patch
    std::vector<Vec2> xy_;     // old nodes, then new ones
    Mesh new_;
    std::vector<Segment> grown_;
    Graph graph_;
    std::vector<RosettePlan> plans_;
    std::vector<int> node_of_point_;
    std::vector<char> stays_; // old rosettes that stay
    std::vector<PatchPart> parts_;
    Skeleton skeleton_;
    std::vector<Triangle> new_cells_;
    int first_free_ = 0;
};

} // namespace

Mesh grow_mesh(const Mesh& old_mesh, const Network& network, const RosetteRadii& radii) {
    if (old_mesh.specification.is_window)
        throw MeshError("a window is not grown; make a new one");
    try {
        return Grower(old_mesh, network, radii, narrow_margin).run();
    } catch (const MeshError&) {
        return Grower(old_mesh, network, radii, wide_margin).run();
    }
}

} // namespace cpp_mesh
