// Fractures that have a cell size of their own: as long as wanted in a new mesh, where fractures
// grow, and in windows, where it is the largest that distance from the foci leads to.
#include "api_mesh.hpp"
#include "checks.hpp"

namespace {

constexpr double coarse = 0.25, fine = 0.005;

// One of 2 m, one of 0.1 m beside it.
TestNetwork two_lengths() {
    return TestNetwork({{{4.0, 5.0}, {6.0, 5.0}}, {{6.1, 5.02}, {6.2, 5.02}}});
}

struct Lengths {
    double shortest = 1e9, longest = 0.0;
    int n = 0;
};

Lengths lengths_of(const ApiMesh& mesh, int fracture) {
    Lengths found;
    for (int i = 0; i < mesh.counts.n_fracture_cells; ++i) {
        if (mesh.fcell_fracture[i] != fracture)
            continue;
        const double length = mesh.fcell_s[2 * i + 1] - mesh.fcell_s[2 * i];
        found.shortest = std::min(found.shortest, length);
        found.longest = std::max(found.longest, length);
        ++found.n;
    }
    return found;
}

void new_mesh(Checks& checks) {
    const std::vector<double> own = {coarse, fine};
    cm_spec spec = rectangle_spec(10.0, 10.0, fine, 1.0);
    ApiMesh mesh, uniform;
    uniform.create(spec, two_lengths());
    spec.own_size = own.data();
    checks.is_true(mesh.create(spec, two_lengths()), mesh.error);
    checks.is_true(mesh.all_positive(), "areas");
    checks.is_close(mesh.total_area(), 100.0, 1e-10, "area");
    const Lengths large = lengths_of(mesh, 0), small = lengths_of(mesh, 1);
    checks.is_equal(small.n, 20, "cells of the short one");
    checks.is_close(large.longest, coarse, 0.25 * coarse, "cells of the long one");
    checks.is_true(large.shortest < 0.3 * coarse, "smaller ones next to the short one");
    checks.is_true(4 * mesh.counts.n_cells < uniform.counts.n_cells, "far fewer cells in all");
    checks.is_true(mesh.smallest_angle() > 20.0, "shape");
}

void same_as_usual(Checks& checks) {
    const std::vector<double> own = {0.0, 0.05};
    cm_spec spec = rectangle_spec(10.0, 10.0, 0.05, 1.0);
    ApiMesh usual, mesh;
    usual.create(spec, two_lengths());
    spec.own_size = own.data();
    checks.is_true(mesh.create(spec, two_lengths()), mesh.error);
    checks.is_true(mesh.xy == usual.xy && mesh.cell_nodes == usual.cell_nodes,
                   "0, and the usual size, are the usual size");
}

// New cells of each fracture have its own size, not that of the call.
void growth(Checks& checks) {
    const std::vector<double> own = {coarse, fine};
    cm_spec spec = rectangle_spec(10.0, 10.0, fine, 1.0);
    spec.own_size = own.data();
    ApiMesh before, after;
    before.create(spec, two_lengths());
    TestNetwork grown = two_lengths();
    grown.fractures[0].insert(grown.fractures[0].begin(), {3.75, 5.0});
    grown.s_start[0] = -0.25;
    checks.is_true(after.remesh(before, grown, {{3.75, 5.0}}, 0.75, fine), after.error);
    checks.is_equal(lengths_of(after, 0).n, lengths_of(before, 0).n + 1,
                    "one cell of the long one");
    grown.fractures[1].push_back({6.2025, 5.02});
    ApiMesh last;
    checks.is_true(last.remesh(after, grown, {{6.2025, 5.02}}, 0.015, fine), last.error);
    checks.is_equal(lengths_of(last, 1).n, 21, "one cell of the short one");
}

// In a window for the long one's tip the short one keeps its cells, and the long one reaches its
// own size away from the tip.
void window(Checks& checks) {
    const std::vector<double> own = {coarse, fine}, foci = {4.0, 5.0},
                              radii = {0.125, 0.125, 0.5 * fine, 0.5 * fine};
    cm_spec spec = rectangle_spec(10.0, 10.0, 0.125, 2.0);
    spec.is_window = 1;
    spec.rosette_sectors = 12;
    spec.rosette_radius = 0.125;
    spec.n_foci = 1;
    spec.foci = foci.data();
    spec.focus_slope = 0.4;
    spec.focus_size = 0.125;
    spec.own_size = own.data();
    spec.end_radius = radii.data();
    ApiMesh mesh;
    checks.is_true(mesh.create(spec, two_lengths()), mesh.error);
    checks.is_true(mesh.all_positive(), "areas in a window");
    const Lengths large = lengths_of(mesh, 0), small = lengths_of(mesh, 1);
    checks.is_close(large.longest, coarse, 0.25 * coarse, "the long one far from its tip");
    checks.is_true(small.longest < 1.5 * fine, "the short one");
}

// Length of the shortest fracture cell that ends at a place.
double shortest_at(const ApiMesh& mesh, const Point& place) {
    double shortest = 1e9;
    for (int i = 0; i < mesh.counts.n_fracture_cells; ++i) {
        const Point a = mesh.point(mesh.fcell_points[2 * i]);
        const Point b = mesh.point(mesh.fcell_points[2 * i + 1]);
        for (const Point& p : {a, b})
            if (std::hypot(p[0] - place[0], p[1] - place[1]) < 1e-9)
                shortest = std::min(shortest, std::hypot(b[0] - a[0], b[1] - a[1]));
    }
    return shortest;
}

// Cells at a refined place, here a kink, are as small as asked for, and stay so when an end grows.
void refined_places(Checks& checks) {
    TestNetwork network({{{4.0, 5.0}, {5.0, 5.0}, {5.5, 5.5}}});
    const std::vector<double> kink = {5.0, 5.0, 0.003, 0.0};
    cm_spec spec = rectangle_spec(10.0, 10.0, 0.1, 1.0);
    spec.rosette_sectors = 12;
    spec.rosette_radius = 0.1;
    ApiMesh usual, mesh, grown;
    checks.is_true(usual.create(spec, network), usual.error);
    checks.is_true(shortest_at(usual, {5.0, 5.0}) > 0.05, "usual cells at a kink");
    spec.n_refined = 1;
    spec.refined = kink.data();
    checks.is_true(mesh.create(spec, network), mesh.error);
    checks.is_true(shortest_at(mesh, {5.0, 5.0}) < 1.5 * 0.003, "small cells at a kink");
    checks.is_true(lengths_of(mesh, 0).longest > 0.08, "usual ones farther away");
    checks.is_true(mesh.smallest_angle() > 20.0, "shape with a refined place");
    network.fractures[0].push_back({5.55, 5.55});
    checks.is_true(grown.grow(mesh, network), grown.error);
    checks.is_true(shortest_at(grown, {5.0, 5.0}) < 1.5 * 0.003, "still small after growth");
}

void refusals(Checks& checks) {
    const std::vector<double> own = {coarse, 3.0};
    cm_spec spec = rectangle_spec(10.0, 10.0, fine, 1.0);
    spec.own_size = own.data();
    ApiMesh mesh;
    checks.is_true(!mesh.create(spec, two_lengths()), "larger than at the boundary");
}

} // namespace

int main() {
    Checks checks;
    new_mesh(checks);
    same_as_usual(checks);
    growth(checks);
    window(checks);
    refined_places(checks);
    refusals(checks);
    return checks.finish();
}
