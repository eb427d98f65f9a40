// Joints of every kind: the kind of the point, the copies of its node, the topology of the cut
// rectangle.
#include "api_mesh.hpp"
#include "checks.hpp"

#include <set>

namespace {

enum Kind { interior = 0, tip = 1, boundary = 2, joint_t = 3, joint_x = 4, corner = 5 };

struct Expected {
    Point place;
    Kind kind;
    int copies;
};

struct Case {
    std::string name;
    std::vector<Polyline> fractures;
    int euler; // by hand: discs count 1, each hole in a part takes 1 off
    int tips;
    std::vector<Expected> points;
};

const std::vector<Case>& all_cases() {
    static const std::vector<Case> cases = {
        {"X",
         {{{0.3, 0.5}, {0.7, 0.5}}, {{0.5, 0.3}, {0.5, 0.7}}},
         0,
         4,
         {{{0.5, 0.5}, joint_x, 4}}},
        {"skew X",
         {{{0.3, 0.45}, {0.7, 0.55}}, {{0.35, 0.3}, {0.65, 0.7}}},
         0,
         4,
         {{{0.5, 0.5}, joint_x, 4}}},
        {"T",
         {{{0.3, 0.5}, {0.7, 0.5}}, {{0.5, 0.5}, {0.5, 0.7}}},
         0,
         3,
         {{{0.5, 0.5}, joint_t, 3}}},
        {"T at its own kink",
         {{{0.3, 0.5}, {0.5, 0.5}, {0.7, 0.4}}, {{0.5, 0.8}, {0.5, 0.5}}},
         0,
         3,
         {{{0.5, 0.5}, joint_t, 3}}},
        {"T onto itself",
         {{{0.3, 0.5}, {0.7, 0.5}, {0.7, 0.7}, {0.5, 0.7}, {0.5, 0.5}}},
         1, // a loop with a tail: the inside is a disc, the outside has one hole
         1,
         {{{0.5, 0.5}, joint_t, 3}}},
        {"V",
         {{{0.3, 0.5}, {0.5, 0.5}}, {{0.5, 0.5}, {0.6, 0.7}}},
         0,
         2,
         {{{0.5, 0.5}, corner, 2}}},
        {"Y",
         {{{0.5, 0.5}, {0.3, 0.5}}, {{0.5, 0.5}, {0.6, 0.7}}, {{0.6, 0.3}, {0.5, 0.5}}},
         0,
         3,
         {{{0.5, 0.5}, joint_x, 3}}},
        {"three through one point",
         {{{0.3, 0.5}, {0.7, 0.5}}, {{0.5, 0.3}, {0.5, 0.7}}, {{0.3, 0.3}, {0.7, 0.7}}},
         0,
         6,
         {{{0.5, 0.5}, joint_x, 6}}},
        {"crossing itself",
         {{{0.3, 0.5}, {0.7, 0.5}, {0.7, 0.7}, {0.5, 0.7}, {0.5, 0.3}}},
         1,
         2,
         {{{0.5, 0.5}, joint_x, 4}}},
        {"from the boundary", {{{0.0, 0.5}, {0.4, 0.5}}}, 1, 1, {{{0.0, 0.5}, boundary, 2}}},
        {"from side to side",
         {{{0.0, 0.4}, {1.0, 0.6}}},
         2,
         0,
         {{{0.0, 0.4}, boundary, 2}, {{1.0, 0.6}, boundary, 2}}},
        {"from the bottom to the top, crossed",
         {{{0.4, 0.0}, {0.6, 1.0}}, {{0.3, 0.5}, {0.7, 0.5}}},
         2,
         2,
         {{{0.4, 0.0}, boundary, 2}, {{0.5, 0.5}, joint_x, 4}}},
        {"two at one point of the boundary",
         {{{0.5, 0.0}, {0.3, 0.4}}, {{0.5, 0.0}, {0.7, 0.4}}},
         1,
         2,
         {{{0.5, 0.0}, boundary, 3}}},
        {"into a corner", {{{0.0, 0.0}, {0.4, 0.3}}}, 1, 1, {{{0.0, 0.0}, boundary, 2}}},
        {"closed triangle of X joints",
         {{{0.2, 0.3}, {0.8, 0.3}}, {{0.25, 0.2}, {0.6, 0.8}}, {{0.75, 0.2}, {0.4, 0.8}}},
         1, // the triangle inside is a disc, the outside has one hole
         6,
         {{{0.25 + 0.35 / 6.0, 0.3}, joint_x, 4}, {{0.75 - 0.35 / 6.0, 0.3}, joint_x, 4}}},
        {"grid of two by two",
         {{{0.2, 0.4}, {0.8, 0.4}},
          {{0.2, 0.6}, {0.8, 0.6}},
          {{0.4, 0.2}, {0.4, 0.8}},
          {{0.6, 0.8}, {0.6, 0.2}}},
         1,
         8,
         {{{0.4, 0.4}, joint_x, 4}, {{0.6, 0.4}, joint_x, 4}, {{0.6, 0.6}, joint_x, 4}}},
        {"two apart", {{{0.2, 0.3}, {0.5, 0.3}}, {{0.4, 0.7}, {0.8, 0.7}}}, -1, 4, {}},
        {"closed polygon",
         {{{0.4, 0.4}, {0.6, 0.4}, {0.6, 0.6}, {0.4, 0.6}, {0.4, 0.4}}},
         1,
         0,
         {{{0.4, 0.4}, corner, 2}, {{0.6, 0.6}, interior, 2}}},
    };
    return cases;
}

double length_of(const Polyline& line) {
    double sum = 0.0;
    for (std::size_t k = 0; k + 1 < line.size(); ++k)
        sum += std::hypot(line[k + 1][0] - line[k][0], line[k + 1][1] - line[k][1]);
    return sum;
}

// Nothing depends on the direction or the order in which fractures are given.
std::vector<Polyline> reversed(std::vector<Polyline> fractures) {
    for (Polyline& line : fractures)
        std::reverse(line.begin(), line.end());
    std::reverse(fractures.begin(), fractures.end());
    return fractures;
}

// Nodes on fractures, tips aside, that only one cell has: it fills its sector alone.
int lone_sectors(const ApiMesh& mesh) {
    std::vector<int> cells_around(mesh.counts.n_nodes, 0);
    for (int k = 0; k < 3 * mesh.counts.n_cells; ++k)
        ++cells_around[mesh.cell_nodes[k]];
    std::set<int> lone;
    for (int f = 0; f < mesh.counts.n_faces; ++f)
        if (mesh.face_fracture_cell[f] >= 0)
            for (int k = 0; k < 2; ++k)
                if (cells_around[mesh.face_nodes[2 * f + k]] < 2)
                    lone.insert(mesh.face_nodes[2 * f + k]);
    return static_cast<int>(lone.size());
}

void check_case(Checks& checks, const Case& c, const std::vector<Polyline>& fractures,
                const std::string& name) {
    ApiMesh mesh;
    if (!mesh.create(rectangle_spec(1.0, 1.0, 0.04, 0.15), TestNetwork(fractures))) {
        checks.is_true(false, name + ": " + mesh.error);
        return;
    }
    checks.is_true(mesh.all_positive(), name + ": areas");
    checks.is_close(mesh.total_area(), 1.0, 1e-12, name + ": area");
    checks.is_equal(mesh.euler(), c.euler, name + ": Euler characteristic");
    checks.is_equal(mesh.side_faults(), 0, name + ": sides");
    checks.is_equal(mesh.counts.n_tips, c.tips, name + ": tips");
    for (int t = 0; t < mesh.counts.n_tips; ++t)
        checks.is_equal(mesh.copies(mesh.node(mesh.tip_node[t])), 1, name + ": tips are single");
    for (const Expected& expected : c.points) {
        checks.is_equal(mesh.kind(expected.place), expected.kind, name + ": kind");
        checks.is_equal(mesh.copies(expected.place), expected.copies, name + ": copies");
    }
    for (std::size_t f = 0; f < fractures.size(); ++f)
        checks.is_close(mesh.fracture_length(static_cast<int>(f)), length_of(fractures[f]), 1e-13,
                        name + ": length");
    checks.is_equal(lone_sectors(mesh), 0, name + ": two cells or more in each sector");
    for (int p = 0; p < mesh.counts.n_fracture_points; ++p)
        for (int k = mesh.point_first[p]; k < mesh.point_first[p + 1]; ++k) {
            const int cell = mesh.point_cells[k];
            checks.is_true(mesh.fcell_points[2 * cell] == p || mesh.fcell_points[2 * cell + 1] == p,
                           name + ": cells of a point end there");
        }
    for (int i = 0; i + 1 < mesh.counts.n_fracture_cells; ++i)
        if (mesh.fcell_fracture[i] == mesh.fcell_fracture[i + 1])
            checks.is_true(mesh.fcell_points[2 * i + 1] == mesh.fcell_points[2 * i + 2] &&
                               mesh.fcell_s[2 * i + 1] == mesh.fcell_s[2 * i + 2],
                           name + ": cells follow each other along the fracture");
}

} // namespace

int main() {
    Checks checks;
    for (const Case& c : all_cases()) {
        check_case(checks, c, c.fractures, c.name);
        check_case(checks, c, reversed(c.fractures), c.name + ", reversed");
    }
    return checks.finish();
}
