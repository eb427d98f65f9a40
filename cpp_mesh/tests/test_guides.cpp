// Lines that cells follow: nodes and edges on them, and where there is no room for them.
#include "api_mesh.hpp"
#include "checks.hpp"

namespace {

struct Guides {
    std::vector<int32_t> count;
    std::vector<double> xy;

    void add(const Polyline& line) {
        count.push_back(static_cast<int32_t>(line.size()));
        for (const Point& p : line)
            xy.insert(xy.end(), p.begin(), p.end());
    }

    cm_spec guide(cm_spec spec) const {
        spec.n_guides = static_cast<int32_t>(count.size());
        spec.guide_count = count.data();
        spec.guide_xy = xy.data();
        return spec;
    }
};

// Length of the edges between cells that lie on a line a x + b y = c.
double length_on(const ApiMesh& mesh, double a, double b, double c) {
    double length = 0.0;
    for (int f = 0; f < mesh.counts.n_faces; ++f) {
        const Point p = mesh.node(mesh.face_nodes[2 * f]),
                    q = mesh.node(mesh.face_nodes[2 * f + 1]);
        if (std::abs(a * p[0] + b * p[1] - c) < 1e-12 && std::abs(a * q[0] + b * q[1] - c) < 1e-12)
            length += std::hypot(q[0] - p[0], q[1] - p[1]);
    }
    return length;
}

void check_sound(Checks& checks, const ApiMesh& mesh, double area, const std::string& name) {
    checks.is_true(mesh.all_positive(), name + ": all areas are positive");
    checks.is_close(mesh.total_area(), area, 1e-12 * area, name + ": area");
    checks.is_true(mesh.smallest_angle() > 25.0,
                   name + ": shape of the cells, " + std::to_string(mesh.smallest_angle()));
}

// From side to side, beyond the body at both ends, and in several pieces.
void across_the_body(Checks& checks) {
    Guides guides;
    guides.add({{0.617, -1.0}, {0.617, 0.31}, {0.617, 5.0}});
    guides.add({{3.0, 0.45}, {-1.0, 0.45}}); // crosses the first: it makes room
    ApiMesh mesh;
    checks.is_true(mesh.create(guides.guide(rectangle_spec(2.0, 1.0, 0.1, 0.1)), TestNetwork({})),
                   mesh.error);
    check_sound(checks, mesh, 2.0, "across");
    checks.is_close(length_on(mesh, 1.0, 0.0, 0.617), 1.0, 1e-12, "all of the first line");
    const double second = length_on(mesh, 0.0, 1.0, 0.45);
    checks.is_true(second > 1.6 && second < 1.95, "most of the second line");
    checks.is_close(mesh.side_length(3), 2.0, 1e-12, "the side that a line ends on");

    ApiMesh plain, again;
    plain.create(rectangle_spec(2.0, 1.0, 0.1, 0.1), TestNetwork({}));
    checks.is_true(length_on(plain, 1.0, 0.0, 0.617) == 0.0, "nothing without a guide");
    checks.is_close(mesh.counts.n_cells, plain.counts.n_cells, 0.1 * plain.counts.n_cells,
                    "about as many cells");
    again.create(guides.guide(rectangle_spec(2.0, 1.0, 0.1, 0.1)), TestNetwork({}));
    checks.is_true(mesh.xy == again.xy, "the same mesh again, bit for bit");
}

// A closed square whose lower edge lies on the boundary; a line too close to another; a bend.
void little_room(Checks& checks) {
    Guides guides;
    guides.add({{0.6, 0.0}, {1.4, 0.0}, {1.4, 0.8}, {0.6, 0.8}, {0.6, 0.0}});
    guides.add({{1.42, -1.0}, {1.42, 3.0}});
    ApiMesh mesh;
    checks.is_true(mesh.create(guides.guide(rectangle_spec(2.0, 2.0, 0.1, 0.1)), TestNetwork({})),
                   mesh.error);
    check_sound(checks, mesh, 4.0, "square");
    checks.is_close(length_on(mesh, 0.0, 1.0, 0.8), 0.8, 1e-12, "its upper edge, corners and all");
    const double beside = length_on(mesh, 1.0, 0.0, 1.42);
    checks.is_true(beside > 0.9 && beside < 1.2, "a line beside it, where it goes on alone");

    Guides arc;
    Polyline line;
    for (int k = 0; k <= 400; ++k)
        line.push_back({0.7 + std::pow(-1.0 + 0.005 * k, 2), 0.005 * k});
    arc.add(line);
    ApiMesh bent;
    checks.is_true(bent.create(arc.guide(rectangle_spec(2.0, 2.0, 0.1, 0.1)), TestNetwork({})),
                   bent.error);
    check_sound(checks, bent, 4.0, "a bend of short pieces");
    int on_it = 0;
    for (int i = 0; i < bent.counts.n_nodes; ++i) {
        const Point p = bent.node(i);
        on_it += std::abs(p[0] - 0.7 - std::pow(p[1] - 1.0, 2)) < 1e-4 ? 1 : 0;
    }
    checks.is_true(on_it > 20, "nodes on the bend");
    checks.is_close(bent.counts.n_cells, 924.0, 140.0, "cells of the usual size");
}

// Fractures cross at any angle and end anywhere beside a line; growth across it.
void with_fractures(Checks& checks) {
    for (int k = 0; k < 12; ++k) {
        const double angle = pi * k / 12.0 + 0.003;
        const Point a = {1.0 - 0.3 * std::cos(angle), 1.0 - 0.3 * std::sin(angle)};
        const Point b = {1.0 + 0.3 * std::cos(angle), 1.0 + 0.3 * std::sin(angle)};
        const Point tip = {1.0 + 0.36 * std::cos(angle), 1.0 + 0.36 * std::sin(angle)};
        Guides guides;
        guides.add({{1.01, -1.0}, {1.01, 3.0}});
        guides.add({{b[0] + 0.001, -1.0}, {b[0] + 0.001, 3.0}}); // through the fracture's end
        TestNetwork network({{a, b}});
        ApiMesh mesh, grown;
        const std::string name = "fracture at " + std::to_string(15 * k) + " degrees";
        checks.is_true(mesh.create(guides.guide(rectangle_spec(2.0, 2.0, 0.04, 0.2)), network),
                       name + mesh.error);
        checks.is_true(mesh.all_positive(), name);
        checks.is_close(mesh.fracture_length(0), 0.6, 1e-12, name + ": length");
        checks.is_equal(mesh.side_faults(), 0, name + ": sides");
        network.fractures[0].push_back(tip);
        checks.is_true(grown.remesh(mesh, network, {tip}, 0.1, 0.04), name + grown.error);
        checks.is_true(grown.all_positive(), name + ", grown");
        checks.is_close(grown.fracture_length(0), 0.66, 1e-12, name + ", grown: length");
    }
}

} // namespace

int main() {
    Checks checks;
    across_the_body(checks);
    little_room(checks);
    with_fractures(checks);
    return checks.finish();
}
