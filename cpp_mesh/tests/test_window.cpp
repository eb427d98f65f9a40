// Windows: fractures cut by the edges, rosettes around the tips.
#include "api_mesh.hpp"
#include "checks.hpp"

namespace {

cm_spec window(double x_min, double x_max, double y_min, double y_max, double size, double radius) {
    cm_spec spec = rectangle_spec(x_max, y_max, size, 4.0 * size);
    spec.x_min = x_min;
    spec.y_min = y_min;
    spec.is_window = 1;
    spec.rosette_sectors = radius > 0.0 ? 12 : 0;
    spec.rosette_radius = radius;
    return spec;
}

void cut_fractures(Checks& checks) {
    // The first passes through, the second ends inside, the third leaves and returns, the fourth is
    // outside.
    TestNetwork network({{{-1.0, 0.3}, {2.0, 0.3}},
                         {{0.5, 0.6}, {0.5, 2.0}},
                         {{0.2, 0.9}, {-0.5, 0.9}, {-0.5, 0.6}, {0.2, 0.6}},
                         {{1.2, 0.0}, {1.2, 1.0}}});
    network.s_start = {10.0, 0.0, -1.0, 0.0};
    ApiMesh mesh;
    checks.is_true(mesh.create(window(0.0, 1.0, 0.0, 1.0, 0.05, 0.0), network), mesh.error);
    checks.is_close(mesh.total_area(), 1.0, 1e-12, "cut: area");
    checks.is_equal(mesh.euler(), 2, "cut: two parts");
    checks.is_equal(mesh.side_faults(), 0, "cut: sides");
    checks.is_equal(mesh.counts.n_tips, 3, "cut: tips");
    checks.is_close(mesh.fracture_length(0), 1.0, 1e-13, "cut: length of the first");
    checks.is_close(mesh.fracture_length(1), 0.4, 1e-13, "cut: length of the second");
    checks.is_close(mesh.fracture_length(2), 0.4, 1e-13, "cut: length of the third");
    checks.is_close(mesh.fracture_length(3), 0.0, 0.0, "cut: length of the fourth");
    checks.is_equal(mesh.kind({0.0, 0.3}), 2, "cut: end on the left edge");
    checks.is_equal(mesh.kind({0.5, 1.0}), 2, "cut: end on the top edge");
    checks.is_equal(mesh.kind({0.0, 0.9}), 2, "cut: the third leaves");
    checks.is_equal(mesh.kind({0.0, 0.6}), 2, "cut: the third returns");
    for (int i = 0; i < mesh.counts.n_fracture_cells; ++i) {
        // Arc lengths belong to the whole polyline.
        const double s = mesh.fcell_s[2 * i];
        const Point p = mesh.point(mesh.fcell_points[2 * i]);
        const double expected = mesh.fcell_fracture[i] == 0   ? 10.0 + p[0] + 1.0
                                : mesh.fcell_fracture[i] == 1 ? p[1] - 0.6
                                : p[1] > 0.75                 ? -1.0 + 0.2 - p[0]
                                                              : -1.0 + 1.0 + 0.5 + p[0];
        checks.is_close(s, expected, 1e-13, "cut: arc length");
    }
}

// Cutting loses no length, also of short and oblique pieces.
void cut_lengths(Checks& checks) {
    const double slope = 0.72 / 1.58;
    ApiMesh mesh;
    checks.is_true(mesh.create(window(0.0, 1.0, 0.0, 1.0, 0.05, 0.0),
                               TestNetwork({{{-0.37, 0.11}, {1.21, 0.83}},
                                            {{0.97, 0.1}, {2.97, 0.1 + 2.0 * slope}},
                                            {{0.5, -7.0}, {0.5, 0.001}},
                                            {{0.2, 1.0}, {0.2, 3.0}}})),
                   mesh.error);
    const double oblique = std::sqrt(1.0 + slope * slope);
    checks.is_close(mesh.fracture_length(0), oblique, 1e-14, "cut lengths: through");
    checks.is_close(mesh.fracture_length(1), 0.03 * oblique, 1e-15, "cut lengths: short");
    checks.is_close(mesh.fracture_length(2), 0.001, 1e-15, "cut lengths: very short");
    checks.is_close(mesh.fracture_length(3), 0.0, 0.0, "cut lengths: from the edge outwards");
    checks.is_equal(mesh.counts.n_tips, 2, "cut lengths: tips");
}

void check_rosette(Checks& checks, const ApiMesh& mesh, int t, double radius,
                   const std::string& name) {
    const int tip = mesh.tip_node[t];
    const Point centre = mesh.node(tip);
    checks.is_close(mesh.tip_radius[t], radius, 1e-12, name + ": radius");
    int n_sectors = 0;
    std::vector<double> angles;
    for (int c = 0; c < mesh.counts.n_cells; ++c) {
        bool has_tip = false;
        for (int k = 0; k < 3; ++k)
            has_tip = has_tip || mesh.cell_nodes[3 * c + k] == tip;
        if (!has_tip)
            continue;
        ++n_sectors;
        for (int k = 0; k < 3; ++k) {
            const int n = mesh.cell_nodes[3 * c + k];
            if (n == tip)
                continue;
            const double x = mesh.node(n)[0] - centre[0], y = mesh.node(n)[1] - centre[1];
            checks.is_close(std::hypot(x, y), radius, 1e-10 * radius, name + ": equal spokes");
            const double dx = mesh.tip_direction[2 * t], dy = mesh.tip_direction[2 * t + 1];
            // In units of a sector, from straight ahead.
            const double angle = std::atan2(dx * y - dy * x, dx * x + dy * y) * 12.0 / (2.0 * pi);
            checks.is_close(angle, std::round(angle), 1e-9, name + ": equal angles");
        }
    }
    checks.is_equal(n_sectors, 12, name + ": sectors");
    // The crack is the spoke behind the tip: two nodes there, one for each side.
    checks.is_equal(mesh.copies({centre[0] - radius * mesh.tip_direction[2 * t],
                                 centre[1] - radius * mesh.tip_direction[2 * t + 1]}),
                    2, name + ": two nodes on the crack");
}

void rosettes(Checks& checks) {
    const double d = 0.05 * std::sqrt(0.5);
    ApiMesh mesh;
    checks.is_true(mesh.create(window(0.75, 1.25, 0.75, 1.25, 0.005, 0.005),
                               TestNetwork({{{1.0 - d, 1.0 - d}, {1.0 + d, 1.0 + d}}})),
                   mesh.error);
    checks.is_equal(mesh.counts.n_tips, 2, "rosettes: tips");
    for (int t = 0; t < mesh.counts.n_tips; ++t)
        check_rosette(checks, mesh, t, 0.005, "rosettes");
    checks.is_close(mesh.total_area(), 0.25, 0.25e-12, "rosettes: area");
    checks.is_equal(mesh.euler(), 0, "rosettes: Euler characteristic");
    checks.is_equal(mesh.side_faults(), 0, "rosettes: sides");
    checks.is_close(mesh.fracture_length(0), 0.1, 1e-13, "rosettes: length");
    checks.is_true(mesh.smallest_angle() > 20.0,
                   "rosettes: shape, " + std::to_string(mesh.smallest_angle()));
}

// Wings at 70 degrees, one radius long: the ring touches the kink.
void short_wings(Checks& checks) {
    const double wing = 0.01, angle = 70.0 * pi / 180.0;
    const Polyline line = {{0.4 - wing * std::cos(angle), 0.5 + wing * std::sin(angle)},
                           {0.4, 0.5},
                           {0.6, 0.5},
                           {0.6 + wing * std::cos(angle), 0.5 - wing * std::sin(angle)}};
    for (const double radius : {0.01, 0.02}) {
        ApiMesh mesh;
        checks.is_true(mesh.create(window(0.0, 1.0, 0.0, 1.0, 0.01, radius), TestNetwork({line})),
                       mesh.error);
        for (int t = 0; t < mesh.counts.n_tips; ++t)
            check_rosette(checks, mesh, t, wing, "short wings");
        checks.is_true(mesh.smallest_angle() > 15.0,
                       "short wings: shape, " + std::to_string(mesh.smallest_angle()));
    }
}

// Something near makes the ring smaller: another fracture, another tip, the edge, the fracture's
// own length.
void reduced_rosettes(Checks& checks) {
    const auto first_radius = [&](const std::vector<Polyline>& fractures) {
        ApiMesh mesh;
        checks.is_true(mesh.create(window(0.0, 1.0, 0.0, 1.0, 0.02, 0.1), TestNetwork(fractures)),
                       mesh.error);
        check_rosette(checks, mesh, 0, mesh.tip_radius[0], "reduced");
        checks.is_close(mesh.total_area(), 1.0, 1e-12, "reduced: area");
        return mesh.tip_radius[0];
    };
    checks.is_close(first_radius({{{0.5, 0.5}, {0.9, 0.5}}}), 0.1, 0.0, "free: as wanted");
    checks.is_close(first_radius({{{0.5, 0.5}, {0.9, 0.5}}, {{0.44, 0.2}, {0.44, 0.8}}}), 0.03,
                    1e-12, "half the distance to another fracture");
    checks.is_close(first_radius({{{0.5, 0.5}, {0.9, 0.5}}, {{0.44, 0.5}, {0.2, 0.5}}}), 0.02,
                    1e-12, "a third of the distance to another tip");
    checks.is_close(first_radius({{{0.08, 0.5}, {0.6, 0.5}}}), 0.04, 1e-12,
                    "half the distance to the edge");
    checks.is_close(first_radius({{{0.5, 0.5}, {0.62, 0.5}}}), 0.04, 1e-12,
                    "a third of the fracture's length");
    checks.is_close(first_radius({{{0.5, 0.5}, {0.6, 0.5}}, {{0.6, 0.2}, {0.6, 0.8}}}), 0.05, 1e-12,
                    "half the distance to a joint");
}

// Cells at the places where fractures meet are as small as asked for and grow from there; far from
// a focus they are as many times larger as the place is farther away than cells are long.
void small_at_joints(Checks& checks) {
    const TestNetwork network({{{0.2, 0.5}, {0.8, 0.5}}, {{0.4, 0.2}, {0.6, 0.8}}});
    const Point joint = {0.5, 0.5};
    const double focus[] = {0.25, 0.5}, factor = 0.25 / 0.05;
    for (const double joint_size : {0.0, 0.002, 0.002 * factor}) {
        cm_spec spec = window(0.0, 1.0, 0.0, 1.0, 0.05, 0.05);
        spec.joint_size = std::min(joint_size, 0.002);
        if (joint_size > spec.joint_size) {
            spec.n_foci = 1;
            spec.foci = focus;
            spec.focus_size = 0.05;
        }
        ApiMesh mesh;
        checks.is_true(mesh.create(spec, network), mesh.error);
        double at_joint = 1.0, longest = 0.0;
        for (int i = 0; i < mesh.counts.n_fracture_cells; ++i) {
            const Point a = mesh.point(mesh.fcell_points[2 * i]);
            const Point b = mesh.point(mesh.fcell_points[2 * i + 1]);
            const double length = std::hypot(b[0] - a[0], b[1] - a[1]);
            for (const Point& p : {a, b})
                if (std::hypot(p[0] - joint[0], p[1] - joint[1]) < 1e-9)
                    at_joint = std::min(at_joint, length);
            longest = std::max(longest, length);
        }
        if (joint_size > 0.0)
            checks.is_close(at_joint, 1.2 * joint_size, 0.3 * joint_size, "joint: small cells");
        else
            checks.is_true(at_joint > 0.03, "joint: cells as elsewhere");
        checks.is_true(longest > 0.03, "joint: cells as asked for farther away");
        checks.is_close(mesh.total_area(), 1.0, 1e-12, "joint: area");
    }
}

// Cells along a fracture grow with the distance from a focus at its tip, up to the largest size.
void larger_far_from_foci(Checks& checks) {
    const TestNetwork network({{{0.5, 0.5}, {2.0, 0.5}}});
    const double focus[] = {0.5, 0.5}, size = 0.01, slope = 0.2, largest = 0.05;
    cm_spec spec = window(0.0, 1.0, 0.0, 1.0, size, size);
    ApiMesh even;
    checks.is_true(even.create(spec, network), even.error);
    checks.is_true(even.counts.n_fracture_cells >= 49, "without foci all cells are as at the tip");
    spec.n_foci = 1;
    spec.foci = focus;
    spec.focus_slope = slope;
    spec.focus_size = largest;
    for (const int is_rough : {0, 1}) {
        spec.is_rough = is_rough;
        ApiMesh mesh;
        checks.is_true(mesh.create(spec, network), mesh.error);
        double longest = 0.0;
        for (int i = 0; i < mesh.counts.n_fracture_cells; ++i) {
            const Point a = mesh.point(mesh.fcell_points[2 * i]);
            const Point b = mesh.point(mesh.fcell_points[2 * i + 1]);
            const double length = std::abs(b[0] - a[0]);
            const double farthest = std::max(a[0], b[0]) - focus[0];
            checks.is_true(length < 1.15 * std::min(size + slope * farthest, largest),
                           "focus: no cell larger than it may be");
            longest = std::max(longest, length);
        }
        checks.is_true(longest > 0.9 * largest, "focus: the largest cells far from it");
        checks.is_close(mesh.total_area(), 1.0, 1e-12, "focus: area");
        checks.is_true(mesh.smallest_angle() > 15.0,
                       "focus: shape, " + std::to_string(mesh.smallest_angle()));
    }
}

// Cells around a small ring grow as asked for beyond three radii, and not nearer to it.
void growth_around_rings(Checks& checks) {
    const Point tip = {0.5, 0.5};
    const double radius = 0.005;
    int n_near[2], n_all[2];
    for (const bool is_fast : {false, true}) {
        cm_spec spec = window(0.0, 1.0, 0.0, 1.0, 0.1, radius);
        spec.ring_slope = is_fast ? 0.6 : 0.0;
        ApiMesh mesh;
        checks.is_true(mesh.create(spec, TestNetwork({{tip, {2.0, 0.5}}})), mesh.error);
        n_all[is_fast] = mesh.counts.n_cells;
        n_near[is_fast] = 0;
        for (int c = 0; c < mesh.counts.n_cells; ++c)
            for (int k = 0; k < 3; ++k) {
                const Point p = mesh.node(mesh.cell_nodes[3 * c + k]);
                n_near[is_fast] += std::hypot(p[0] - tip[0], p[1] - tip[1]) < 2.0 * radius;
            }
    }
    checks.is_true(n_all[1] < 0.75 * n_all[0], "ring: fewer cells where they may grow faster");
    checks.is_true(n_near[1] > 0.8 * n_near[0], "ring: as many cells next to it");
}

} // namespace

int main() {
    Checks checks;
    cut_fractures(checks);
    cut_lengths(checks);
    rosettes(checks);
    short_wings(checks);
    reduced_rosettes(checks);
    small_at_joints(checks);
    larger_far_from_foci(checks);
    growth_around_rings(checks);
    return checks.finish();
}
