// Meshes of a rectangle with single fractures: areas, sizes, sides, tips, repeatability.
#include "api_mesh.hpp"
#include "checks.hpp"

namespace {

void check_whole(Checks& checks, const ApiMesh& mesh, double width, double height, int euler,
                 const std::string& name) {
    checks.is_true(mesh.all_positive(), name + ": all areas are positive");
    checks.is_close(mesh.total_area(), width * height, 1e-12 * width * height, name + ": area");
    checks.is_equal(mesh.euler(), euler, name + ": Euler characteristic");
    checks.is_equal(mesh.side_faults(), 0, name + ": sides of the fracture cells");
    checks.is_close(mesh.side_length(1), height, 1e-12 * height, name + ": left side");
    checks.is_close(mesh.side_length(2), height, 1e-12 * height, name + ": right side");
    checks.is_close(mesh.side_length(3), width, 1e-12 * width, name + ": bottom");
    checks.is_close(mesh.side_length(4), width, 1e-12 * width, name + ": top");
}

void without_fracture(Checks& checks) {
    ApiMesh mesh;
    checks.is_true(mesh.create(rectangle_spec(3.0, 2.0, 0.1, 0.1), TestNetwork({})),
                   "no fracture: " + mesh.error);
    check_whole(checks, mesh, 3.0, 2.0, 1, "no fracture");
    checks.is_equal(mesh.counts.n_tips, 0, "no fracture: tips");
    // Equilateral triangles of this size would be 1386.
    checks.is_close(mesh.counts.n_cells, 1386.0, 140.0, "no fracture: number of cells");
}

// Scene C1 of the thesis.
void centre_fracture(Checks& checks) {
    const double d = 0.05 * std::sqrt(0.5);
    const TestNetwork network({{{1.0 - d, 1.0 - d}, {1.0 + d, 1.0 + d}}});
    ApiMesh mesh;
    checks.is_true(mesh.create(rectangle_spec(2.0, 2.0, 0.01, 0.1), network), "C1: " + mesh.error);
    check_whole(checks, mesh, 2.0, 2.0, 0, "C1");
    checks.is_close(mesh.counts.n_cells, 2300.0, 150.0, "C1: number of cells");
    checks.is_equal(mesh.counts.n_fracture_cells, 10, "C1: fracture cells");
    for (int i = 0; i < mesh.counts.n_fracture_cells; ++i) {
        checks.is_close(mesh.fcell_s[2 * i], 0.01 * i, 1e-14, "C1: start of a fracture cell");
        checks.is_close(mesh.fcell_s[2 * i + 1], 0.01 * (i + 1), 1e-14, "C1: end");
    }
    checks.is_close(mesh.fracture_length(0), 0.1, 1e-14, "C1: length");
    checks.is_equal(mesh.counts.n_tips, 2, "C1: tips");
    for (int t = 0; t < 2; ++t) {
        const double sign = t == 0 ? -1.0 : 1.0;
        checks.is_equal(mesh.tip_end[t], t + 1, "C1: end of the polyline");
        checks.is_close(mesh.tip_direction[2 * t], sign * std::sqrt(0.5), 1e-12, "C1: ahead, x");
        checks.is_close(mesh.tip_direction[2 * t + 1], sign * std::sqrt(0.5), 1e-12,
                        "C1: ahead, y");
        checks.is_true(mesh.node(mesh.tip_node[t]) == mesh.point(mesh.tip_point[t]),
                       "C1: tip node and tip point lie at one place");
        checks.is_equal(mesh.copies(mesh.node(mesh.tip_node[t])), 1, "C1: tips are single");
        checks.is_close(mesh.tip_radius[t], 0.0, 0.0, "C1: no rosette");
    }
    for (int p = 0; p < mesh.counts.n_fracture_points; ++p)
        if (mesh.point_kind[p] == 0)
            checks.is_equal(mesh.copies(mesh.point(p)), 2, "C1: points between are double");
    checks.is_true(mesh.smallest_angle() > 30.0, "C1: shape of the cells");

    ApiMesh again;
    again.create(rectangle_spec(2.0, 2.0, 0.01, 0.1), network);
    checks.is_true(mesh.xy == again.xy && mesh.cell_nodes == again.cell_nodes &&
                       mesh.face_nodes == again.face_nodes,
                   "C1: the same mesh again, bit for bit");
}

void all_directions(Checks& checks) {
    for (int k = 0; k < 16; ++k) {
        const double angle = 2.0 * pi * k / 16.0 + 0.01;
        const Point end = {0.5 + 0.2 * std::cos(angle), 0.5 + 0.2 * std::sin(angle)};
        ApiMesh mesh;
        checks.is_true(
            mesh.create(rectangle_spec(1.0, 1.0, 0.05, 0.2), TestNetwork({{{0.5, 0.5}, end}})),
            mesh.error);
        check_whole(checks, mesh, 1.0, 1.0, 0, "direction " + std::to_string(k));
        checks.is_close(mesh.fracture_length(0), 0.2, 1e-14, "length in all directions");
    }
}

void other_units(Checks& checks) {
    // Far from the origin and small: coordinates as in a map, a laboratory sample.
    for (const double scale : {1e-3, 1.0, 1e3}) {
        const double x0 = 500.0 * scale;
        cm_spec spec = rectangle_spec(x0 + scale, 0.0, 0.02 * scale, 0.2 * scale);
        spec.x_min = x0;
        spec.y_min = -scale;
        ApiMesh mesh;
        checks.is_true(mesh.create(spec, TestNetwork({{{x0 + 0.3 * scale, -0.4 * scale},
                                                       {x0 + 0.6 * scale, -0.5 * scale}}})),
                       mesh.error);
        checks.is_close(mesh.total_area() / (scale * scale), 1.0, 1e-12, "scaled: area");
        checks.is_equal(mesh.side_faults(), 0, "scaled: sides");
    }
}

void kinked(Checks& checks) {
    const Polyline line = {{0.3, 0.5}, {0.5, 0.5}, {0.6, 0.4}, {0.6, 0.2}};
    ApiMesh mesh;
    checks.is_true(mesh.create(rectangle_spec(1.0, 1.0, 0.03, 0.2), TestNetwork({line})),
                   mesh.error);
    check_whole(checks, mesh, 1.0, 1.0, 0, "kinks");
    checks.is_close(mesh.fracture_length(0), 0.4 + std::sqrt(0.02), 1e-14, "kinks: length");
    checks.is_equal(mesh.kind(line[1]), 0, "kinks: a kink is inside the fracture");
    checks.is_equal(mesh.copies(line[1]), 2, "kinks: two copies");
    checks.is_close(mesh.fcell_s.back(), 0.4 + std::sqrt(0.02), 1e-14, "kinks: arc length");
}

// Cells grow from the fracture's size to the boundary's.
void graded(Checks& checks) {
    ApiMesh mesh;
    mesh.create(rectangle_spec(2.0, 2.0, 0.02, 0.2), TestNetwork({{{0.9, 1.0}, {1.1, 1.0}}}));
    double at_fracture = 0.0, at_corner = 0.0;
    int n_corner = 0;
    for (int f = 0; f < mesh.counts.n_faces; ++f) {
        const Point p = mesh.node(mesh.face_nodes[2 * f]),
                    q = mesh.node(mesh.face_nodes[2 * f + 1]);
        const double size = std::hypot(q[0] - p[0], q[1] - p[1]);
        if (mesh.face_fracture_cell[f] >= 0)
            at_fracture = std::max(at_fracture, size);
        if (std::hypot(p[0], p[1]) < 0.5) {
            at_corner += size;
            ++n_corner;
        }
    }
    checks.is_close(at_fracture, 0.02, 1e-12, "grading: fracture cells");
    checks.is_close(at_corner / n_corner, 0.2, 0.02, "grading: cells at a corner");
}

} // namespace

int main() {
    Checks checks;
    without_fracture(checks);
    centre_fracture(checks);
    all_directions(checks);
    other_units(checks);
    kinked(checks);
    graded(checks);
    return checks.finish();
}
