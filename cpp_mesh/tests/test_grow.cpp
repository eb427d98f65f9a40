// Growth in bodies with rosettes: what a patch leaves alone, and how far the mesh is one that could
// have been made again.
#include "api_mesh.hpp"
#include "checks.hpp"

#include <utility>

namespace {

// A body and how it is meshed; the arrays must outlive the specification.
struct Body {
    std::vector<double> corners, fixed;
    std::vector<int32_t> sides;
    cm_spec spec{};

    explicit Body(cm_spec given) : spec(given) {
        spec.rosette_sectors = 12;
        spec.rosette_radius = spec.size_fracture;
    }
    Body(const Body&) = delete;
    Body& operator=(const Body&) = delete;

    void make_disc(double radius, int n) {
        for (int k = 0; k < n; ++k) {
            corners.push_back(radius * std::cos(2.0 * pi * k / n));
            corners.push_back(radius * std::sin(2.0 * pi * k / n));
        }
        sides.assign(n, 1);
        spec.n_corners = n;
        spec.corners = corners.data();
        spec.edge_side = sides.data();
    }

    void fix(std::vector<double> points) {
        fixed = std::move(points);
        spec.n_fixed = static_cast<int32_t>(fixed.size() / 2);
        spec.fixed = fixed.data();
    }
};

// Place of a fracture's end, and a new vertex there: straight on, then turned by an angle.
void advance(TestNetwork& network, int fracture, int end, double step, double turn) {
    Polyline& line = network.fractures[fracture];
    const Point tip = end == 1 ? line.front() : line.back();
    const Point behind = end == 1 ? line[1] : line[line.size() - 2];
    const double angle = std::atan2(tip[1] - behind[1], tip[0] - behind[0]) + turn;
    const Point next = {tip[0] + step * std::cos(angle), tip[1] + step * std::sin(angle)};
    if (end == 1) {
        network.s_start[fracture] -= std::hypot(next[0] - tip[0], next[1] - tip[1]);
        line.insert(line.begin(), next);
    } else {
        line.push_back(next);
    }
}

std::set<Point> nodes_of(const ApiMesh& mesh) {
    std::set<Point> nodes;
    for (int i = 0; i < mesh.counts.n_nodes; ++i)
        nodes.insert(mesh.node(i));
    return nodes;
}

double share_kept(const ApiMesh& before, const ApiMesh& after) {
    const std::set<Point> old_nodes = nodes_of(before);
    int kept = 0;
    for (int i = 0; i < after.counts.n_nodes; ++i)
        kept += static_cast<int>(old_nodes.count(after.node(i)));
    return static_cast<double>(kept) / after.counts.n_nodes;
}

// Nodes of the triangles around the free tip of a fracture's end.
std::set<Point> ring_of(const ApiMesh& mesh, int fracture, int end) {
    std::set<Point> ring;
    for (int t = 0; t < mesh.counts.n_tips; ++t)
        for (int c = 0; c < mesh.counts.n_cells; ++c)
            for (int k = 0; k < 3; ++k)
                if (mesh.tip_fracture[t] == fracture && mesh.tip_end[t] == end &&
                    mesh.cell_nodes[3 * c + k] == mesh.tip_node[t])
                    for (int l = 0; l < 3; ++l)
                        ring.insert(mesh.node(mesh.cell_nodes[3 * c + l]));
    return ring;
}

// The same body, split the same way, with the rosettes and the arc lengths of a mesh made again,
// and with cells of about its sizes and shapes.
void check_like_new(Checks& checks, const ApiMesh& grown, const ApiMesh& anew,
                    const std::string& name) {
    checks.is_true(grown.error.empty(), name + ": " + grown.error);
    checks.is_true(grown.all_positive(), name + ": areas");
    checks.is_close(grown.total_area(), anew.total_area(), 1e-12 * anew.total_area(),
                    name + ": area");
    checks.is_equal(grown.euler(), anew.euler(), name + ": Euler characteristic");
    checks.is_equal(grown.side_faults(), 0, name + ": sides of fracture cells");
    checks.is_equal(grown.counts.n_tips, anew.counts.n_tips, name + ": tips");
    for (int t = 0; t < anew.counts.n_tips && t < grown.counts.n_tips; ++t) {
        checks.is_close(grown.tip_radius[t], anew.tip_radius[t], 1e-9 * anew.tip_radius[t],
                        name + ": rosette");
        checks.is_true(grown.node(grown.tip_node[t]) == anew.node(anew.tip_node[t]),
                       name + ": place of the tip");
    }
    double s = 0.0, s_anew = 0.0;
    for (int i = 0; i < grown.counts.n_fracture_cells; ++i)
        s += grown.fcell_s[2 * i + 1] - grown.fcell_s[2 * i];
    for (int i = 0; i < anew.counts.n_fracture_cells; ++i)
        s_anew += anew.fcell_s[2 * i + 1] - anew.fcell_s[2 * i];
    checks.is_close(s, s_anew, 1e-12 * s_anew, name + ": arc length");
    checks.is_true(grown.smallest_angle() >= 22.0, name + ": smallest angle");
    const double cells = static_cast<double>(grown.counts.n_cells) / anew.counts.n_cells;
    checks.is_close(cells, 1.05, 0.2, name + ": number of cells against a new mesh");
}

// Two wings in a disc: each increment changes a part of the mesh only, and after many of them it is
// still like new.
void wings(Checks& checks, double unit) {
    const std::string name = "wings, unit " + std::to_string(unit);
    cm_spec spec{};
    spec.size_fracture = 1.0 * unit;
    spec.size_boundary = 5.0 * unit;
    Body body(spec);
    body.make_disc(42.0 * unit, 96);
    body.fix({0.0, 42.0 * unit, 0.0, -42.0 * unit});
    TestNetwork network({{{-3.5 * unit, -3.5 * unit}, {3.5 * unit, 3.5 * unit}}});
    ApiMesh meshes[2], anew;
    meshes[0].create(body.spec, network);
    double worst = 180.0, worst_anew = 180.0, least_kept = 1.0;
    int now = 0;
    for (int k = 0; k < 22; ++k) {
        const double turn = k == 0 ? 70.0 / 180.0 * pi : -1.5 / 180.0 * pi;
        for (int end : {1, 2})
            advance(network, 0, end, 1.0 * unit, turn);
        meshes[1 - now].grow(meshes[now], network);
        anew.create(body.spec, network);
        check_like_new(checks, meshes[1 - now], anew, name + " " + std::to_string(k));
        if (!meshes[1 - now].error.empty())
            return;
        least_kept = std::min(least_kept, share_kept(meshes[now], meshes[1 - now]));
        worst = std::min(worst, meshes[1 - now].smallest_angle());
        worst_anew = std::min(worst_anew, anew.smallest_angle());
        now = 1 - now;
    }
    checks.is_true(least_kept > 0.7, name + ": share kept " + std::to_string(least_kept));
    checks.is_true(worst > worst_anew - 5.0, name + ": smallest angle " + std::to_string(worst) +
                                                 " against " + std::to_string(worst_anew));
    // Cells behind the tips have become as long again as in a new mesh.
    checks.is_close(static_cast<double>(meshes[now].counts.n_fracture_cells) /
                        anew.counts.n_fracture_cells,
                    1.0, 0.1, name + ": number of fracture cells");
    std::printf("%s: smallest angle %.1f, of new meshes %.1f; kept %.2f; cells %d, new %d\n",
                name.c_str(), worst, worst_anew, least_kept, meshes[now].counts.n_cells,
                anew.counts.n_cells);
}

// One end grows; the rosettes of the others and a fixed point next to it stay where they are, and a
// second try from the same mesh knows nothing of the first.
void leaves_others(Checks& checks) {
    Body body(rectangle_spec(10.0, 8.0, 0.1, 1.0));
    body.fix({5.0, 4.6});
    TestNetwork network({{{3.0, 4.0}, {5.0, 4.0}}, {{7.0, 3.0}, {8.0, 5.0}}});
    ApiMesh before, first, second, third, anew;
    before.create(body.spec, network);
    TestNetwork left = network, right = network;
    advance(left, 0, 2, 0.1, 0.5);
    advance(right, 0, 2, 0.1, -0.5);
    first.grow(before, left);
    second.grow(before, right);
    third.grow(before, left);
    anew.create(body.spec, left);
    check_like_new(checks, first, anew, "others");
    checks.is_true(first.xy == third.xy && first.cell_nodes == third.cell_nodes,
                   "others: the same again, bit for bit");
    checks.is_true(first.xy != second.xy, "others: another direction is another mesh");
    checks.is_equal(first.copies({5.0, 4.6}), 1, "others: fixed point");
    checks.is_true(ring_of(first, 0, 1) == ring_of(before, 0, 1), "others: rosette at the far end");
    for (int end : {1, 2})
        checks.is_true(ring_of(first, 1, end) == ring_of(before, 1, end), "others: other fracture");
    checks.is_true(ring_of(first, 0, 2) != ring_of(before, 0, 2), "others: the end that has grown");
    checks.is_true(share_kept(before, first) > 0.8, "others: share kept");
}

// Ends that join another fracture, the boundary of a rectangle, that of a disc.
void joins(Checks& checks) {
    {
        Body body(rectangle_spec(10.0, 8.0, 0.1, 1.0));
        TestNetwork network({{{3.0, 4.0}, {4.8, 4.0}}, {{5.0, 3.0}, {5.0, 5.0}}});
        ApiMesh before, after, anew;
        before.create(body.spec, network);
        network.fractures[0].push_back({5.0, 4.03});
        after.grow(before, network);
        anew.create(body.spec, network);
        check_like_new(checks, after, anew, "joins a fracture");
        checks.is_equal(after.kind({5.0, 4.03}), 3, "joins a fracture: kind");
    }
    {
        Body body(rectangle_spec(10.0, 8.0, 0.1, 1.0));
        TestNetwork network({{{8.0, 4.0}, {9.8, 4.0}}});
        ApiMesh before, after, anew;
        before.create(body.spec, network);
        network.fractures[0].push_back({10.0, 4.03});
        after.grow(before, network);
        anew.create(body.spec, network);
        check_like_new(checks, after, anew, "joins a side");
        checks.is_equal(after.kind({10.0, 4.03}), 2, "joins a side: kind");
        checks.is_close(after.side_length(2), 8.0, 1e-12, "joins a side: its length");
    }
    {
        cm_spec spec{};
        spec.size_fracture = 0.05;
        spec.size_boundary = 0.3;
        Body body(spec);
        body.make_disc(2.0, 64);
        TestNetwork network({{{0.5, 0.0}, {1.9, 0.0}}});
        ApiMesh before, after, anew;
        before.create(body.spec, network);
        network.fractures[0].push_back({2.0, 0.0});
        after.grow(before, network);
        anew.create(body.spec, network);
        check_like_new(checks, after, anew, "joins a corner");
        checks.is_equal(after.kind({2.0, 0.0}), 2, "joins a corner: kind");
    }
}

// Sizes wanted in an old mesh hold on; the ends have the radii that are given for them.
void follows_sizes(Checks& checks) {
    Body body(rectangle_spec(10.0, 8.0, 0.1, 1.0));
    TestNetwork network({{{3.0, 4.0}, {5.0, 4.0}}});
    ApiMesh first, sized, grown;
    first.create(body.spec, network);
    std::vector<double> sizes;
    for (int c = 0; c < first.counts.n_cells; ++c) {
        const Point p = first.centre(c);
        sizes.push_back(0.02 + 0.2 * std::min(std::hypot(p[0] - 3.0, p[1] - 4.0),
                                              std::hypot(p[0] - 5.0, p[1] - 4.0)));
    }
    const std::vector<double> radii = {0.02, 0.02};
    body.spec.end_radius = radii.data();
    sized.create_sized(body.spec, network, first, sizes);
    advance(network, 0, 2, 0.05, 0.4);
    grown.grow(sized, network, radii);
    checks.is_true(grown.error.empty(), "sizes: " + grown.error);
    checks.is_true(share_kept(sized, grown) > 0.5, "sizes: share kept");
    checks.is_true(grown.smallest_angle() > 22.0, "sizes: shape");
    for (int t = 0; t < grown.counts.n_tips; ++t)
        checks.is_close(grown.tip_radius[t], 0.02, 1e-12, "sizes: rosette");
    double far_size = 0.0;
    for (int c = 0; c < grown.counts.n_cells; ++c)
        if (std::hypot(grown.centre(c)[0] - 5.0, grown.centre(c)[1] - 4.0) < 0.1)
            far_size = std::max(far_size, grown.size(c));
    checks.is_true(far_size < 0.06, "sizes: around the new tip, " + std::to_string(far_size));
}

// What is no growth of the old mesh is refused.
void refuses(Checks& checks) {
    Body body(rectangle_spec(10.0, 8.0, 0.1, 1.0));
    const TestNetwork network({{{3.0, 4.0}, {5.0, 4.0}}});
    ApiMesh before, after;
    before.create(body.spec, network);
    checks.is_true(!after.grow(before, TestNetwork({{{3.0, 4.0}, {5.0, 4.1}}})),
                   "refuses: a moved vertex");
    checks.says(after.error, "grown", "refuses: a moved vertex");
    checks.is_true(!after.grow(before, TestNetwork({{{3.0, 4.0}, {5.0, 4.0}, {9.5, 7.5}}})) ||
                       after.smallest_angle() >= 22.0,
                   "refuses: far growth, or makes it well");
    cm_spec window = rectangle_spec(1.0, 1.0, 0.1, 0.1);
    window.is_window = 1;
    before.create(window, TestNetwork({{{0.3, 0.5}, {0.6, 0.5}}}));
    checks.is_true(!after.grow(before, TestNetwork({{{0.3, 0.5}, {0.6, 0.5}, {0.7, 0.5}}})),
                   "refuses: a window");
}

} // namespace

int main() {
    Checks checks;
    wings(checks, 1.0);
    wings(checks, 1e-3);
    leaves_others(checks);
    joins(checks);
    follows_sizes(checks);
    refuses(checks);
    return checks.finish();
}
