// Growth: what a patch leaves alone, what it covers, how it joins other fractures and the boundary.
#include "api_mesh.hpp"
#include "checks.hpp"

namespace {

// Everything that must hold between an old mesh and the one made from it.
void check_map(Checks& checks, const ApiMesh& before, const ApiMesh& after,
               const std::string& name) {
    checks.is_true(after.all_positive(), name + ": areas are positive");
    checks.is_close(after.total_area(), before.total_area(), 1e-12 * before.total_area(),
                    name + ": area");
    checks.is_equal(after.side_faults(), 0, name + ": sides");
    for (int side = 1; side <= 4; ++side)
        checks.is_close(after.side_length(side), before.side_length(side), 1e-12,
                        name + ": boundary");
    std::vector<double> covered(before.counts.n_cells, 0.0);
    int moved = 0, open = 0;
    for (int c = 0; c < after.counts.n_cells; ++c) {
        double sum = 0.0;
        for (int k = after.overlap_first[c]; k < after.overlap_first[c + 1]; ++k) {
            sum += after.overlap_area[k];
            covered[after.overlap_cell[k]] += after.overlap_area[k];
        }
        const int old_cell = after.cell_old[c];
        if (old_cell < 0) {
            open += !(std::abs(sum - after.area(c)) <= 1e-12 * after.area(c));
            continue;
        }
        covered[old_cell] += after.area(c);
        open += after.overlap_first[c + 1] != after.overlap_first[c];
        for (int k = 0; k < 3; ++k)
            moved += before.node(before.cell_nodes[3 * old_cell + k]) !=
                     after.node(after.cell_nodes[3 * c + k]);
    }
    checks.is_equal(moved, 0, name + ": nodes outside the patch are bitwise the same");
    checks.is_equal(open, 0, name + ": overlaps cover each new cell to 1e-12");
    int uncovered = 0;
    for (int c = 0; c < before.counts.n_cells; ++c)
        uncovered += !(std::abs(covered[c] - before.area(c)) <= 1e-11 * before.area(c));
    checks.is_equal(uncovered, 0, name + ": each old cell is covered once");

    // Old fracture cells, whole or in parts, keep fracture, place and arc length. A new one has
    // grown, or takes the place of parts of two.
    std::vector<double> kept(before.counts.n_fracture_cells, 0.0);
    for (int i = 0; i < after.counts.n_fracture_cells; ++i)
        for (int k = 0; k < before.counts.n_fracture_cells && after.fcell_old[i] < 0; ++k)
            if (after.fcell_fracture[i] == before.fcell_fracture[k])
                kept[k] +=
                    std::max(0.0, std::min(after.fcell_s[2 * i + 1], before.fcell_s[2 * k + 1]) -
                                      std::max(after.fcell_s[2 * i], before.fcell_s[2 * k]));
    int changed = 0;
    for (int i = 0; i < after.counts.n_fracture_cells; ++i) {
        const int old_cell = after.fcell_old[i];
        if (old_cell < 0)
            continue;
        kept[old_cell] += after.fcell_s[2 * i + 1] - after.fcell_s[2 * i];
        changed += after.fcell_fracture[i] != before.fcell_fracture[old_cell] ||
                   after.fcell_s[2 * i] < before.fcell_s[2 * old_cell] ||
                   after.fcell_s[2 * i + 1] > before.fcell_s[2 * old_cell + 1];
        if (after.fcell_s[2 * i] == before.fcell_s[2 * old_cell])
            changed += after.point(after.fcell_points[2 * i]) !=
                       before.point(before.fcell_points[2 * old_cell]);
    }
    checks.is_equal(changed, 0, name + ": fracture cells stay");
    for (int i = 0; i < before.counts.n_fracture_cells; ++i)
        checks.is_close(kept[i], before.fcell_s[2 * i + 1] - before.fcell_s[2 * i], 1e-14,
                        name + ": old fracture cells are kept whole");
}

void grow_end(TestNetwork& network, int f, Point to) {
    network.fractures[f].push_back(to);
}

void grow_start(TestNetwork& network, int f, Point to) {
    const Point from = network.fractures[f].front();
    network.fractures[f].insert(network.fractures[f].begin(), to);
    network.s_start[f] -= std::hypot(to[0] - from[0], to[1] - from[1]);
}

void single_increment(Checks& checks) {
    TestNetwork network({{{0.9, 1.0}, {1.1, 1.0}}});
    ApiMesh before, after, again;
    checks.is_true(before.create(rectangle_spec(2.0, 2.0, 0.02, 0.2), network), before.error);
    const std::vector<double> xy = before.xy;
    TestNetwork grown = network;
    grow_end(grown, 0, {1.115, 0.98});
    grow_start(grown, 0, {0.885, 1.02});
    const std::vector<Point> centres = {{1.1, 1.0}, {0.9, 1.0}};
    checks.is_true(after.remesh(before, grown, centres, 0.1, 0.025), after.error);
    check_map(checks, before, after, "increment");
    checks.is_equal(after.euler(), 0, "increment: Euler characteristic");
    checks.is_equal(after.counts.n_fracture_cells, before.counts.n_fracture_cells + 2,
                    "increment: one new cell at each end");
    checks.is_equal(after.fcell_old.front(), -1, "increment: the first cell is new");
    checks.is_equal(after.fcell_old.back(), -1, "increment: the last cell is new");
    checks.is_close(after.fcell_s.front(), -0.025, 1e-14, "increment: arc length at the start");
    checks.is_close(after.fcell_s.back(), 0.225, 1e-14, "increment: arc length at the end");
    checks.is_equal(after.counts.n_tips, 2, "increment: tips");
    for (int t = 0; t < 2; ++t)
        checks.is_equal(after.copies(after.node(after.tip_node[t])), 1, "increment: tips single");
    checks.is_equal(after.copies({1.1, 1.0}), 2, "increment: the old tip is open now");

    // Far away nothing has changed.
    double farthest = 0.0;
    for (int c = 0; c < after.counts.n_cells; ++c)
        for (int k = 0; k < 3 && after.cell_old[c] < 0; ++k) {
            const Point p = after.node(after.cell_nodes[3 * c + k]);
            farthest = std::max(farthest, std::min(std::hypot(p[0] - 1.1, p[1] - 1.0),
                                                   std::hypot(p[0] - 0.9, p[1] - 1.0)));
        }
    checks.is_true(farthest <= 0.12, "increment: the patch is local, " + std::to_string(farthest));

    cm_counts counts;
    cm_sizes(before.handle, &counts);
    checks.is_equal(counts.n_cells, before.counts.n_cells, "increment: the old mesh is as it was");
    again.remesh(before, grown, centres, 0.1, 0.025);
    checks.is_true(again.xy == after.xy && again.cell_nodes == after.cell_nodes &&
                       again.overlap_area == after.overlap_area,
                   "increment: the same again, bit for bit");
}

// Thirty increments of both wings, as in scene C2.
void chain(Checks& checks) {
    const double d = 0.05 * std::sqrt(0.5), step = 0.005;
    TestNetwork network({{{1.0 - d, 1.0 - d}, {1.0 + d, 1.0 + d}}});
    ApiMesh meshes[2];
    checks.is_true(meshes[0].create(rectangle_spec(2.0, 2.0, 0.01, 0.1), network), "chain");
    double direction = (45.0 - 70.0) * pi / 180.0;
    for (int k = 0; k < 30; ++k) {
        const ApiMesh& before = meshes[k % 2];
        ApiMesh& after = meshes[(k + 1) % 2];
        const double dx = step * std::cos(direction), dy = step * std::sin(direction);
        const Point end = network.fractures[0].back(), start = network.fractures[0].front();
        grow_end(network, 0, {end[0] + dx, end[1] + dy});
        grow_start(network, 0, {start[0] - dx, start[1] - dy});
        const std::string name = "chain " + std::to_string(k + 1);
        if (!after.remesh(before, network, {end, start}, 5.0 * step, step)) {
            checks.is_true(false, name + ": " + after.error);
            return;
        }
        check_map(checks, before, after, name);
        checks.is_equal(after.euler(), 0, name + ": Euler characteristic");
        checks.is_equal(after.counts.n_fracture_cells, 10 + 2 * (k + 1), name + ": cells");
        checks.is_close(after.fracture_length(0), 0.1 + 2.0 * step * (k + 1), 1e-12,
                        name + ": length");
        checks.is_true(after.smallest_angle() > 15.0,
                       name + ": smallest angle " + std::to_string(after.smallest_angle()));
        direction *= 0.9;
    }
}

void joins_fracture(Checks& checks) {
    // Onto a fracture cell of the other (not at a node), and onto a node.
    for (const double y : {0.51, 0.52}) {
        TestNetwork network({{{0.3, 0.5}, {0.5, 0.5}}, {{0.56, 0.3}, {0.56, 0.7}}});
        ApiMesh before, after, later;
        checks.is_true(before.create(rectangle_spec(1.0, 1.0, 0.02, 0.1), network), before.error);
        const std::string name = y == 0.52 ? "T at a node" : "T in a cell";
        grow_end(network, 0, {0.56, y});
        checks.is_true(after.remesh(before, network, {{0.5, 0.5}}, 0.08, 0.02), after.error);
        check_map(checks, before, after, name);
        checks.is_equal(after.euler(), 0, name + ": Euler characteristic");
        checks.is_equal(after.kind({0.56, y}), 3, name + ": kind");
        checks.is_equal(after.copies({0.56, y}), 3, name + ": copies");
        checks.is_equal(after.counts.n_tips, 3, name + ": tips");
        int halves = 0;
        for (int i = 0; i + 1 < after.counts.n_fracture_cells; ++i)
            halves += after.fcell_old[i] >= 0 && after.fcell_old[i] == after.fcell_old[i + 1];
        checks.is_equal(halves, y == 0.52 ? 0 : 1, name + ": a cell in halves");
        // The other fracture still grows.
        grow_end(network, 1, {0.57, 0.72});
        checks.is_true(later.remesh(after, network, {{0.56, 0.7}}, 0.08, 0.02), later.error);
        check_map(checks, after, later, name + ", later");
    }
}

// A joint anywhere in a cell: cells near a short part of it are short too.
void joins_near_node(Checks& checks) {
    const TestNetwork network({{{0.3, 0.5}, {0.5, 0.5}}, {{0.56, 0.3}, {0.56, 0.7}}});
    ApiMesh before, after;
    checks.is_true(before.create(rectangle_spec(1.0, 1.0, 0.02, 0.1), network), before.error);
    for (const double share : {0.5, 0.2, 0.1, 0.03, 0.01}) {
        TestNetwork grown = network;
        const std::string name = "T near a node, " + std::to_string(share);
        grow_end(grown, 0, {0.56, 0.5 + 0.02 * share});
        checks.is_true(after.remesh(before, grown, {{0.5, 0.5}}, 0.08, 0.02), after.error);
        check_map(checks, before, after, name);
        checks.is_true(after.smallest_angle() > 15.0,
                       name + ": smallest angle " + std::to_string(after.smallest_angle()));
    }
}

// An oblique joint: no cell alone fills the sector between two fractures.
void joins_at_small_angles(Checks& checks) {
    for (const double degrees : {60.0, 45.0, 30.0, 20.0}) {
        const double slope = std::tan(degrees * pi / 180.0);
        TestNetwork network({{{0.5, 0.5}, {0.56 - 0.02 / slope, 0.48}}, {{0.3, 0.5}, {0.9, 0.5}}});
        network.fractures[0][0] = {0.56 - 0.2 / slope, 0.3};
        ApiMesh before, after;
        checks.is_true(before.create(rectangle_spec(1.0, 1.0, 0.02, 0.1), network), before.error);
        grow_end(network, 0, {0.56, 0.5});
        checks.is_true(after.remesh(before, network, {{0.56, 0.5}}, 0.08, 0.02), after.error);
        const std::string name = "T at " + std::to_string(degrees);
        check_map(checks, before, after, name);
        int lone = 0;
        for (int c = 0; c < after.counts.n_cells; ++c)
            for (int k = 0; k < 3; ++k) {
                const auto is_wall = [&](int face) {
                    return after.face_fracture_cell[after.cell_faces[3 * c + face]] >= 0;
                };
                const Point p = after.node(after.cell_nodes[3 * c + k]);
                lone += is_wall(k) && is_wall((k + 2) % 3) &&
                        std::hypot(p[0] - 0.56, p[1] - 0.5) < 1e-12;
            }
        checks.is_equal(lone, 0, name + ": lone cells");
    }
}

void crosses_fracture(Checks& checks) {
    TestNetwork network({{{0.3, 0.5}, {0.5, 0.5}}, {{0.53, 0.3}, {0.53, 0.7}}});
    ApiMesh before, after;
    checks.is_true(before.create(rectangle_spec(1.0, 1.0, 0.02, 0.1), network), before.error);
    grow_end(network, 0, {0.56, 0.51});
    checks.is_true(after.remesh(before, network, {{0.5, 0.5}}, 0.08, 0.02), after.error);
    check_map(checks, before, after, "crossing");
    checks.is_equal(after.kind({0.53, 0.505}), 4, "crossing: kind");
    checks.is_equal(after.copies({0.53, 0.505}), 4, "crossing: copies");
}

// A new tip a hundredth of a cell from another fracture: a run goes on, with flat cells there.
void stops_short(Checks& checks) {
    TestNetwork network({{{0.3, 0.5}, {0.5, 0.5}}, {{0.53, 0.3}, {0.53, 0.7}}});
    ApiMesh before, after;
    checks.is_true(before.create(rectangle_spec(1.0, 1.0, 0.02, 0.1), network), before.error);
    grow_end(network, 0, {0.53 - 2e-4, 0.506});
    checks.is_true(after.remesh(before, network, {{0.5, 0.5}}, 0.08, 0.02), after.error);
    check_map(checks, before, after, "short of a fracture");
    checks.is_equal(after.counts.n_tips, 4, "short of a fracture: tips");
}

// Two wings meet each other.
void joins_tip(Checks& checks) {
    TestNetwork network({{{0.3, 0.5}, {0.48, 0.5}}, {{0.52, 0.52}, {0.7, 0.52}}});
    ApiMesh before, after;
    checks.is_true(before.create(rectangle_spec(1.0, 1.0, 0.02, 0.1), network), before.error);
    grow_end(network, 0, {0.5, 0.51});
    grow_start(network, 1, {0.5, 0.51});
    checks.is_true(after.remesh(before, network, {{0.5, 0.51}}, 0.05, 0.02), after.error);
    check_map(checks, before, after, "tips meet");
    checks.is_equal(after.kind({0.5, 0.51}), 5, "tips meet: kind");
    checks.is_equal(after.copies({0.5, 0.51}), 2, "tips meet: copies");
    checks.is_equal(after.counts.n_tips, 2, "tips meet: tips");
}

void joins_boundary(Checks& checks) {
    ApiMesh before, after;
    TestNetwork network({{{0.5, 0.5}, {0.94, 0.5}}});
    checks.is_true(before.create(rectangle_spec(1.0, 1.0, 0.02, 0.1), network), before.error);
    // Ends all over a boundary edge: at nodes, near them, between them.
    for (int k = 0; k <= 20; ++k) {
        const double y = 0.44 + 0.12 * k / 20.0;
        TestNetwork grown = network;
        grow_end(grown, 0, {1.0, y});
        const std::string name = "to the boundary at " + std::to_string(y);
        if (!after.remesh(before, grown, {{0.94, 0.5}}, 0.1, 0.02)) {
            checks.is_true(false, name + ": " + after.error);
            continue;
        }
        check_map(checks, before, after, name);
        checks.is_equal(after.kind({1.0, y}), 2, name + ": kind");
        checks.is_equal(after.copies({1.0, y}), 2, name + ": copies");
        checks.is_equal(after.counts.n_tips, 1, name + ": tips");
        checks.is_equal(after.euler(), 1, name + ": Euler characteristic");
        checks.is_true(after.smallest_angle() > 22.0,
                       name + ": smallest angle " + std::to_string(after.smallest_angle()));
    }
    // Exactly onto each node of that side.
    for (int i = 0; i < before.counts.n_nodes; ++i) {
        const Point p = before.node(i);
        if (p[0] != 1.0 || std::abs(p[1] - 0.5) > 0.1)
            continue;
        TestNetwork grown = network;
        grow_end(grown, 0, p);
        checks.is_true(after.remesh(before, grown, {{0.94, 0.5}}, 0.1, 0.02), after.error);
        check_map(checks, before, after, "onto a boundary node");
        checks.is_equal(after.copies(p), 2, "onto a boundary node: copies");
    }
    TestNetwork corner({{{0.5, 0.5}, {0.95, 0.96}}});
    checks.is_true(before.create(rectangle_spec(1.0, 1.0, 0.02, 0.1), corner), before.error);
    grow_end(corner, 0, {1.0, 1.0});
    checks.is_true(after.remesh(before, corner, {{0.95, 0.96}}, 0.1, 0.02), after.error);
    check_map(checks, before, after, "into the corner");
    checks.is_equal(after.copies({1.0, 1.0}), 2, "into the corner: copies");
}

// A long new piece, far beyond the given centre: the patch holds it.
void far_beyond(Checks& checks) {
    TestNetwork network({{{0.3, 0.5}, {0.4, 0.5}}});
    ApiMesh before, after;
    checks.is_true(before.create(rectangle_spec(1.0, 1.0, 0.02, 0.1), network), before.error);
    grow_end(network, 0, {0.8, 0.7});
    checks.is_true(after.remesh(before, network, {}, 0.0, 0.02), after.error);
    check_map(checks, before, after, "far beyond");
    const double length = std::hypot(0.4, 0.2);
    checks.is_equal(after.counts.n_fracture_cells - before.counts.n_fracture_cells,
                    std::lround(length / 0.02), "far beyond: cells of the given size");
}

// A patch cut in two by a fracture, and several patches at once.
void several(Checks& checks) {
    TestNetwork network(
        {{{0.0, 0.5}, {1.0, 0.5}}, {{0.2, 0.3}, {0.3, 0.3}}, {{0.7, 0.7}, {0.8, 0.7}}});
    ApiMesh before, after;
    checks.is_true(before.create(rectangle_spec(1.0, 1.0, 0.04, 0.1), network), before.error);
    grow_end(network, 1, {0.33, 0.33});
    grow_start(network, 2, {0.67, 0.67});
    checks.is_true(after.remesh(before, network, {{0.3, 0.3}, {0.7, 0.7}, {0.5, 0.5}}, 0.25, 0.04),
                   after.error);
    check_map(checks, before, after, "several");
    checks.is_equal(after.euler(), 0, "several: Euler characteristic");
}

void refused(Checks& checks) {
    TestNetwork network({{{0.3, 0.5}, {0.5, 0.5}}, {{0.56, 0.3}, {0.56, 0.7}}});
    ApiMesh before, after;
    before.create(rectangle_spec(1.0, 1.0, 0.02, 0.1), network);
    const auto refuse = [&](const TestNetwork& changed, double size, const std::string& words) {
        checks.is_true(!after.remesh(before, changed, {{0.5, 0.5}}, 0.08, size), words);
        checks.says(after.error, words, "refused");
    };
    TestNetwork changed = network;
    grow_end(changed, 0, {0.5599995, 0.5});
    refuse(changed, 0.02, "fractures 1 and 2 come within");
    changed = network;
    grow_end(changed, 0, {0.4, 0.5});
    refuse(changed, 0.02, "parts of fracture 1 overlap");
    changed = network;
    grow_end(changed, 0, {1.1, 0.5});
    refuse(changed, 0.02, "fracture 1 leaves the domain");
    changed = network;
    changed.fractures[0][0][0] = 0.31;
    refuse(changed, 0.02, "fracture 1 has not only grown");
    changed = network;
    grow_start(changed, 0, {0.28, 0.5});
    changed.s_start[0] = 0.0;
    refuse(changed, 0.02, "fracture 1: the arc length");
    changed = network;
    changed.fractures.pop_back();
    changed.s_start.pop_back();
    refuse(changed, 0.02, "1 fractures instead of 2");
    refuse(network, 0.0, "must be positive");
}

// A disc and an L: a tip goes by a fixed point, and then to the boundary.
void other_bodies(Checks& checks) {
    struct Shape {
        std::string name;
        std::vector<double> corners;
        Point start, tip, beside, edge;
    };
    Shape disc{"disc", {}, {-0.2, 0.0}, {0.2, 0.0}, {0.23, 0.02}, {1.0, 0.0}};
    for (int k = 0; k < 256; ++k) {
        disc.corners.push_back(std::cos(2.0 * pi * k / 256));
        disc.corners.push_back(std::sin(2.0 * pi * k / 256));
    }
    const Shape ell{"L",          {0, 0, 2, 0, 2, 1, 1, 1, 1, 2, 0, 2},
                    {0.3, 0.4},   {0.7, 0.6},
                    {0.74, 0.65}, {1.5, 1.0}};
    for (const Shape& shape : {disc, ell}) {
        const int n = static_cast<int>(shape.corners.size() / 2);
        std::vector<int32_t> sides;
        for (int k = 0; k < n; ++k)
            sides.push_back(1 + (4 * k) / n);
        const std::vector<double> fixed = {shape.beside[0], shape.beside[1]};
        cm_spec spec = rectangle_spec(2.0, 2.0, 0.02, 0.2);
        spec.n_corners = n;
        spec.corners = shape.corners.data();
        spec.edge_side = sides.data();
        spec.n_fixed = 1;
        spec.fixed = fixed.data();
        TestNetwork network({{shape.start, shape.tip}});
        ApiMesh meshes[3];
        checks.is_true(meshes[0].create(spec, network), shape.name + ": " + meshes[0].error);
        for (int k = 1; k < 3; ++k) {
            const Point tip = network.fractures[0].back();
            Point next = shape.edge;
            if (k == 1)
                next = {0.95 * tip[0] + 0.05 * next[0], 0.95 * tip[1] + 0.05 * next[1]};
            grow_end(network, 0, next);
            checks.is_true(meshes[k].remesh(meshes[k - 1], network, {tip}, 0.1, 0.02),
                           shape.name + ": " + meshes[k].error);
            check_map(checks, meshes[k - 1], meshes[k], shape.name);
            checks.is_equal(meshes[k].copies(shape.beside), 1, shape.name + ": the fixed point");
        }
        checks.is_equal(meshes[2].counts.n_tips, 1, shape.name + ": the tip has reached the side");
    }
}

} // namespace

int main() {
    Checks checks;
    single_increment(checks);
    chain(checks);
    joins_fracture(checks);
    joins_near_node(checks);
    joins_at_small_angles(checks);
    crosses_fracture(checks);
    stops_short(checks);
    joins_tip(checks);
    joins_boundary(checks);
    far_beyond(checks);
    several(checks);
    other_bodies(checks);
    refused(checks);
    return checks.finish();
}
