// Polygons, discs, fixed points, edge cracks, and rosettes in whole bodies.
#include "api_mesh.hpp"
#include "checks.hpp"

#include <map>

namespace {

// A polygon that keeps the arrays of its specification.
struct TestPolygon {
    std::vector<double> corners;
    std::vector<int32_t> sides;
    std::vector<double> fixed;

    TestPolygon(const std::vector<Point>& points, std::vector<int32_t> edge_sides)
        : sides(std::move(edge_sides)) {
        for (const Point& p : points)
            corners.insert(corners.end(), p.begin(), p.end());
    }

    cm_spec spec(double size_fracture, double size_boundary) const {
        cm_spec spec = rectangle_spec(0.0, 0.0, size_fracture, size_boundary);
        spec.n_corners = static_cast<int32_t>(sides.size());
        spec.corners = corners.data();
        spec.edge_side = sides.data();
        spec.n_fixed = static_cast<int32_t>(fixed.size() / 2);
        spec.fixed = fixed.data();
        return spec;
    }
};

// Corners on a circle; every quarter begins with a corner.
TestPolygon disc(double radius, int n) {
    std::vector<Point> points;
    for (int k = 0; k < n; ++k) {
        const double angle = 2.0 * pi * k / n;
        points.push_back({radius * std::cos(angle), radius * std::sin(angle)});
    }
    return {points, std::vector<int32_t>(n, 7)};
}

// An L with a re-entrant corner at (1, 1).
TestPolygon angle_shape() {
    return {{{0.0, 0.0}, {2.0, 0.0}, {2.0, 1.0}, {1.0, 1.0}, {1.0, 2.0}, {0.0, 2.0}},
            {1, 2, 3, 4, 5, 6}};
}

void check_body(Checks& checks, const ApiMesh& mesh, double area, int euler,
                const std::string& name) {
    checks.is_true(mesh.error.empty(), name + ": " + mesh.error);
    checks.is_true(mesh.all_positive(), name + ": areas");
    checks.is_close(mesh.total_area(), area, 1e-12 * area, name + ": area");
    checks.is_equal(mesh.euler(), euler, name + ": Euler characteristic");
    checks.is_equal(mesh.side_faults(), 0, name + ": sides of fracture cells");
    for (int f = 0; f < mesh.counts.n_faces; ++f) {
        const bool is_outer = mesh.face_cells[2 * f + 1] < 0 && mesh.face_fracture_cell[f] < 0;
        checks.is_true((mesh.face_side[f] > 0) == is_outer, name + ": faces with a side");
    }
}

// The area of a regular polygon in a circle is R^2 n/2 sin(2 pi/n): it converges with order 2.
void disc_area(Checks& checks) {
    const double radius = 0.042;
    double previous = 0.0;
    for (const int n : {60, 120, 240}) {
        ApiMesh mesh;
        mesh.create(disc(radius, n).spec(0.005, 0.005), TestNetwork({}));
        const double polygon = radius * radius * 0.5 * n * std::sin(2.0 * pi / n);
        const std::string name = "disc of " + std::to_string(n);
        check_body(checks, mesh, polygon, 1, name);
        checks.is_close(mesh.side_length(7), 2.0 * n * radius * std::sin(pi / n), 1e-12 * radius,
                        name + ": circumference");
        const double fault = pi * radius * radius - mesh.total_area();
        if (previous > 0.0)
            checks.is_close(previous / fault, 4.0, 0.02, name + ": order 2");
        previous = fault;
    }
}

// Edges far shorter than the cells stay whole and spoil neither the number nor the shape of cells.
void short_edges(Checks& checks) {
    ApiMesh coarse, fine;
    coarse.create(disc(1.0, 60).spec(0.1, 0.1), TestNetwork({}));
    fine.create(disc(1.0, 600).spec(0.1, 0.1), TestNetwork({}));
    int n_outer = 0;
    for (int f = 0; f < fine.counts.n_faces; ++f)
        n_outer += fine.face_side[f] == 7;
    checks.is_equal(n_outer, 600, "short edges: one face each");
    checks.is_true(fine.smallest_angle() > 25.0,
                   "short edges: shape, " + std::to_string(fine.smallest_angle()));
    // Equilateral triangles as small as the edges would be this many.
    const double uniform = 4.0 / std::sqrt(3.0) * pi * std::pow(2.0 * pi / 600.0, -2.0);
    checks.is_true(fine.counts.n_cells < 0.1 * uniform,
                   "short edges: number of cells, " + std::to_string(fine.counts.n_cells));
    int n_inside = 0;
    for (int c = 0; c < fine.counts.n_cells; ++c) {
        const Point p = fine.node(fine.cell_nodes[3 * c]);
        n_inside += std::hypot(p[0], p[1]) < 0.7;
    }
    int n_inside_coarse = 0;
    for (int c = 0; c < coarse.counts.n_cells; ++c) {
        const Point p = coarse.node(coarse.cell_nodes[3 * c]);
        n_inside_coarse += std::hypot(p[0], p[1]) < 0.7;
    }
    checks.is_close(n_inside, n_inside_coarse, 0.1 * n_inside_coarse,
                    "short edges: as many cells inside as with long ones");
}

void reentrant(Checks& checks) {
    ApiMesh mesh;
    mesh.create(angle_shape().spec(0.1, 0.1), TestNetwork({}));
    check_body(checks, mesh, 3.0, 1, "L");
    const std::map<int, double> lengths = {{1, 2.0}, {2, 1.0}, {3, 1.0},
                                           {4, 1.0}, {5, 1.0}, {6, 2.0}};
    for (const auto& [side, length] : lengths)
        checks.is_close(mesh.side_length(side), length, 1e-12, "L: length of a side");
    checks.is_equal(mesh.locate({1.5, 1.5}), -1, "L: the notch is outside");
    checks.is_true(mesh.locate({0.5, 1.5}) >= 0, "L: the upper arm is inside");
    checks.is_true(mesh.smallest_angle() > 30.0, "L: shape");

    // A crack from the re-entrant corner, and one through the lower arm.
    ApiMesh cracked;
    cracked.create(angle_shape().spec(0.05, 0.2),
                   TestNetwork({{{1.0, 1.0}, {0.6, 0.6}}, {{1.5, 0.0}, {1.6, 1.0}}}));
    check_body(checks, cracked, 3.0, 2, "L with cracks");
    checks.is_equal(cracked.counts.n_tips, 1, "L with cracks: tips");
    checks.is_equal(cracked.kind({1.0, 1.0}), 2, "L with cracks: corner");
    checks.is_equal(cracked.copies({1.0, 1.0}), 2, "L with cracks: copies at the corner");
    checks.is_equal(cracked.kind({1.6, 1.0}), 2, "L with cracks: through the arm");
}

// An edge crack in a polygon turned by an angle, so that no side is parallel to an axis.
void oblique_edge_crack(Checks& checks) {
    const double angle = 0.3;
    const auto turn = [angle](Point p) {
        return Point{std::cos(angle) * p[0] - std::sin(angle) * p[1],
                     std::sin(angle) * p[0] + std::cos(angle) * p[1]};
    };
    TestPolygon plate({turn({0.0, -1.0}), turn({1.0, -1.0}), turn({1.0, 1.0}), turn({0.0, 1.0})},
                      {3, 2, 4, 1});
    cm_spec spec = plate.spec(0.05, 0.1);
    spec.rosette_sectors = 12;
    spec.rosette_radius = 0.03;
    ApiMesh mesh;
    mesh.create(spec, TestNetwork({{turn({0.0, 0.0}), turn({0.5, 0.0})}}));
    check_body(checks, mesh, 2.0, 1, "oblique plate");
    checks.is_equal(mesh.counts.n_tips, 1, "oblique plate: the end on the boundary is no tip");
    checks.is_close(mesh.tip_radius[0], 0.03, 0.0, "oblique plate: rosette");
    checks.is_equal(mesh.kind(turn({0.0, 0.0})), 2, "oblique plate: boundary point");
    checks.is_equal(mesh.copies(turn({0.0, 0.0})), 2, "oblique plate: copies");
    checks.is_close(mesh.side_length(1), 2.0, 1e-12, "oblique plate: side with the crack");
}

// Cells around a node: spokes and sectors.
void check_rosette(Checks& checks, const ApiMesh& mesh, int t, double radius, int sectors,
                   const std::string& name) {
    const Point tip = mesh.node(mesh.tip_node[t]);
    checks.is_close(mesh.tip_radius[t], radius, 1e-12 * radius, name + ": radius");
    int n = 0;
    for (int c = 0; c < mesh.counts.n_cells; ++c)
        for (int k = 0; k < 3; ++k)
            if (mesh.cell_nodes[3 * c + k] == mesh.tip_node[t]) {
                ++n;
                for (int l = 1; l < 3; ++l) {
                    const Point p = mesh.node(mesh.cell_nodes[3 * c + (k + l) % 3]);
                    checks.is_close(std::hypot(p[0] - tip[0], p[1] - tip[1]), radius,
                                    1e-10 * radius, name + ": spokes");
                }
            }
    checks.is_equal(n, sectors, name + ": sectors");
}

void rosettes_in_whole_bodies(Checks& checks) {
    cm_spec spec = rectangle_spec(1.0, 2.0, 0.02, 0.1);
    spec.rosette_sectors = 8;
    spec.rosette_radius = 0.02;
    const std::vector<double> radii = {0.0, 0.01, 0.005, 0.0};
    spec.end_radius = radii.data();
    ApiMesh mesh;
    mesh.create(spec, TestNetwork({{{0.0, 1.0}, {0.5, 1.0}}, {{0.3, 0.5}, {0.7, 0.4}}}));
    check_body(checks, mesh, 2.0, 0, "rosettes");
    checks.is_equal(mesh.counts.n_tips, 3, "rosettes: tips");
    for (int t = 0; t < mesh.counts.n_tips; ++t) {
        const bool is_first = mesh.tip_fracture[t] == 0;
        check_rosette(checks, mesh, t,
                      is_first               ? 0.01
                      : mesh.tip_end[t] == 1 ? 0.005
                                             : 0.02,
                      8, "rosettes, tip " + std::to_string(t));
    }
    checks.is_true(mesh.smallest_angle() > 20.0, "rosettes: shape");

    TestPolygon body = disc(0.042, 240);
    cm_spec disc_spec = body.spec(0.0005, 0.004);
    disc_spec.rosette_sectors = 16;
    disc_spec.rosette_radius = 0.0005;
    const double d = 0.005 * std::sqrt(0.5);
    ApiMesh cracked;
    cracked.create(disc_spec, TestNetwork({{{-d, -d}, {d, d}}}));
    check_body(checks, cracked, 0.042 * 0.042 * 120.0 * std::sin(pi / 120.0), 0, "cracked disc");
    for (int t = 0; t < 2; ++t)
        check_rosette(checks, cracked, t, 0.0005, 16, "cracked disc");
    checks.is_true(cracked.smallest_angle() > 20.0,
                   "cracked disc: shape, " + std::to_string(cracked.smallest_angle()));
}

void fixed_points(Checks& checks) {
    TestPolygon body = angle_shape();
    const std::vector<Point> wanted = {{0.0, 0.0},   {0.7, 0.0}, {0.33, 1.41},
                                       {1.3, 0.417}, {1.0, 1.0}, {1.5, 0.5}};
    for (const Point& p : wanted)
        body.fixed.insert(body.fixed.end(), p.begin(), p.end());
    cm_spec spec = body.spec(0.05, 0.2);
    spec.rosette_sectors = 12;
    spec.rosette_radius = 0.05;
    ApiMesh mesh;
    // The last point lies on a fracture and keeps the ring of its tip at a distance.
    mesh.create(spec, TestNetwork({{{1.2, 0.5}, {1.53, 0.5}}}));
    check_body(checks, mesh, 3.0, 0, "fixed points");
    for (const Point& p : wanted) {
        const int copies = p[0] == 1.5 ? 2 : 1;
        int n_exact = 0;
        for (int i = 0; i < mesh.counts.n_nodes; ++i)
            n_exact += mesh.node(i) == p;
        checks.is_equal(n_exact, copies, "fixed points: exactly there");
    }
    checks.is_equal(mesh.kind({1.5, 0.5}), 0, "fixed points: inside a fracture");
    for (int t = 0; t < 2; ++t)
        if (mesh.tip_end[t] == 2)
            check_rosette(checks, mesh, t, 0.03, 12, "fixed points");

    // Beside a tip: the ring keeps half the distance.
    TestPolygon near = angle_shape();
    near.fixed = {0.5, 0.54};
    spec = near.spec(0.05, 0.2);
    spec.rosette_sectors = 12;
    spec.rosette_radius = 0.05;
    ApiMesh beside;
    beside.create(spec, TestNetwork({{{0.5, 0.5}, {0.9, 0.5}}}));
    check_body(checks, beside, 3.0, 0, "fixed point beside a tip");
    check_rosette(checks, beside, 0, 0.02, 12, "fixed point beside a tip");
}

// The same again bit for bit, and the same in every unit of length.
void repeatable(Checks& checks) {
    const auto make = [](ApiMesh& mesh, double scale) {
        TestPolygon body = disc(0.042 * scale, 100);
        cm_spec spec = body.spec(0.0007 * scale, 0.004 * scale);
        spec.rosette_sectors = 12;
        spec.rosette_radius = 0.0005 * scale;
        return mesh.create(spec, TestNetwork({{{-0.004 * scale, -0.003 * scale},
                                               {0.004 * scale, 0.003 * scale}}}));
    };
    ApiMesh mesh, again;
    checks.is_true(make(mesh, 1.0) && make(again, 1.0), "repeatable: " + mesh.error);
    checks.is_true(mesh.xy == again.xy && mesh.cell_nodes == again.cell_nodes &&
                       mesh.face_side == again.face_side,
                   "repeatable: bit for bit");
    for (const double scale : {1e-6, 1e-3, 0.7, 1e2, 1e4}) {
        ApiMesh other;
        checks.is_true(make(other, scale), "scaled: " + other.error);
        const std::string name = "scaled by " + std::to_string(scale);
        checks.is_true(other.cell_nodes == mesh.cell_nodes && other.face_side == mesh.face_side,
                       name + ": the same cells");
        double largest = 0.0;
        for (std::size_t i = 0; i < mesh.xy.size() && i < other.xy.size(); ++i)
            largest = std::max(largest, std::abs(other.xy[i] / scale - mesh.xy[i]));
        checks.is_close(largest, 0.0, 1e-11 * 0.042, name + ": the same nodes");
    }
}

void refuse(Checks& checks, const cm_spec& spec, const std::vector<Polyline>& fractures,
            const std::string& who, const std::string& why) {
    ApiMesh mesh;
    checks.is_true(!mesh.create(spec, TestNetwork(fractures)), why + ": refused");
    checks.says(mesh.error, who, why + ": names");
    checks.says(mesh.error, why, why + ": reason");
}

void refusals(Checks& checks) {
    const TestPolygon body = angle_shape();
    const cm_spec spec = body.spec(0.05, 0.2);
    refuse(checks, spec, {{{0.5, 1.49998}, {1.5, 0.5}}}, "fracture 1",
           "of corner 4 of the boundary");
    refuse(checks, spec, {{{0.5, 1.6}, {1.6, 0.5}}}, "fracture 1", "leaves the domain");
    refuse(checks, spec, {{{1.0, 1.8}, {1.8, 1.0}}}, "fracture 1", "leaves the domain");
    refuse(checks, spec, {{{0.5, 0.5}, {1.5, 1.5}}}, "fracture 1", "leaves the domain");
    refuse(checks, spec, {{{0.9, 1.9}, {1.9, 0.9}}}, "fracture 1", "on the way to its vertex");
    refuse(checks, spec, {{{0.5, 0.5}, {1.0, 1.0}, {1.2, 0.5}}}, "fracture 1", "inner vertex");
    refuse(checks, spec, {{{1.2, 1.0}, {1.7, 1.0}}}, "fracture 1", "along the boundary");
    refuse(checks, spec, {{{1.2, 1.0}, {1.7, 0.99}}}, "fracture 1", "too small an angle");
    refuse(checks, spec, {{{0.3, 0.3}, {0.5, 0.3}}, {{1.2, 0.99998}, {1.7, 0.5}}}, "fracture 2",
           "of the boundary");
    const auto refuse_fixed = [&](Point p, const std::string& who, const std::string& why) {
        TestPolygon with = angle_shape();
        with.fixed = {0.2, 0.2, p[0], p[1]};
        refuse(checks, with.spec(0.05, 0.2), {{{0.3, 0.5}, {0.7, 0.5}}}, who, why);
    };
    refuse_fixed({1.5, 1.5}, "fixed point 2", "outside the body");
    refuse_fixed({0.5, 0.00001}, "fixed point 2", "of the boundary");
    refuse_fixed({0.5, 0.50001}, "fixed point 2", "of fracture 1");
    refuse_fixed({0.30001, 0.5}, "fixed point 2", "from fracture 1");
    refuse_fixed({0.20001, 0.2}, "fixed point 2", "from fixed point 1");
    refuse_fixed({0.00001, 0.0}, "fixed point 2", "from corner 1 of the boundary");

    const auto refuse_polygon = [&](const std::vector<Point>& corners, std::vector<int32_t> sides,
                                    const std::string& who, const std::string& why) {
        const TestPolygon polygon(corners, std::move(sides));
        refuse(checks, polygon.spec(0.05, 0.2), {}, who, why);
    };
    refuse_polygon({{0.0, 0.0}, {1.0, 0.0}}, {1, 1}, "the boundary", "at least 3 corners");
    refuse_polygon({{0.0, 0.0}, {0.0, 1.0}, {1.0, 0.0}}, {1, 1, 1}, "corners", "counter-clockwise");
    refuse_polygon({{0.0, 0.0}, {1.0, 0.0}, {1.0, 0.0}, {0.0, 1.0}}, {1, 1, 1, 1},
                   "corners 2 and 3", "at one place");
    refuse_polygon({{0.0, 0.0}, {1.0, 0.0}, {0.0, 1.0}}, {1, 0, 1}, "edge 2", "must be positive");
    refuse_polygon({{0.0, 0.0}, {1.0, 0.0}, {1.0, 1.0}, {0.3, -0.5}}, {1, 1, 1, 1}, "edges 1 and 3",
                   "meet");
    // A bow tie encloses nothing, but that is not what is wrong with it.
    refuse_polygon({{0.0, 0.0}, {1.0, 1.0}, {0.0, 1.0}, {1.0, 0.0}}, {1, 1, 1, 1}, "edges 1 and 3",
                   "meet");
    refuse_polygon({{0.0, 0.0}, {1.0, 0.0}, {1.0, 0.01}}, {1, 1, 1}, "corner 1", "too sharp");

    cm_spec window = spec;
    window.is_window = 1;
    refuse(checks, window, {}, "window", "must be a rectangle");
}

} // namespace

int main() {
    Checks checks;
    disc_area(checks);
    short_edges(checks);
    reentrant(checks);
    oblique_edge_crack(checks);
    rosettes_in_whole_bodies(checks);
    fixed_points(checks);
    repeatable(checks);
    refusals(checks);
    return checks.finish();
}
