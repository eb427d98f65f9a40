// Judging without meshing: who is to blame, where, and why; and the joints of a network.
#include "api_mesh.hpp"
#include "checks.hpp"

#include <ctime>

namespace {

struct Who {
    int32_t kind;
    int32_t number;
};

// cm_check refuses with these culprits, and cm_create with the same words.
void refuse(Checks& checks, const cm_spec& spec, const std::vector<Polyline>& fractures, int kind,
            const std::vector<Who>& culprits, const std::string& reason) {
    TestNetwork network(fractures);
    const cm_network view = network.view();
    int32_t n_joints = 0;
    cm_fault fault;
    checks.is_true(cm_check(&spec, &view, 0, nullptr, &n_joints, nullptr) != 0,
                   reason + ": refused");
    const std::string message = cm_last_error();
    cm_last_fault(&fault);
    checks.is_equal(fault.kind, kind, reason + ": kind");
    checks.is_equal(fault.n_culprits, static_cast<long>(culprits.size()), reason + ": culprits");
    for (std::size_t k = 0; k < culprits.size(); ++k) {
        checks.is_equal(fault.culprit_kind[k], culprits[k].kind, reason + ": what");
        checks.is_equal(fault.culprit[k], culprits[k].number, reason + ": which");
    }
    checks.says(fault.reason == nullptr ? "" : fault.reason, reason, reason + ": words");
    ApiMesh mesh;
    checks.is_true(!mesh.create(spec, network), reason + ": not meshed");
    checks.is_true(mesh.error == message, reason + ": the same words, " + mesh.error);
}

cm_spec unit_square() {
    return rectangle_spec(1.0, 1.0, 0.05, 0.2);
}

void fractures(Checks& checks) {
    const cm_spec spec = unit_square();
    const Polyline level = {{0.3, 0.5}, {0.7, 0.5}};
    const Who first = {cm_culprit_fracture, 0}, second = {cm_culprit_fracture, 1};
    refuse(checks, spec, {level, {{0.5, 0.5}}}, cm_fault_number, {second},
           "{1} has fewer than two vertices");
    refuse(checks, spec, {level, {{0.5, 0.2}, {0.5, 0.2}}}, cm_fault_too_short, {second},
           "{1} has a segment of length 0 m at (0.5, 0.2), which is too short");
    refuse(checks, spec, {level, {{0.5, 0.8}, {0.5, 1.2}}}, cm_fault_outside, {second},
           "{1} leaves the domain at (0.5, 1.2)");
    refuse(checks, spec, {level, {{0.3, 0.0}, {0.7, 0.0}}}, cm_fault_boundary, {second},
           "{1} runs along the boundary at (0.3, 0)");
    refuse(checks, spec, {level, {{0.3, 0.2}, {0.5, 0.0}, {0.7, 0.2}}}, cm_fault_boundary, {second},
           "{1} has an inner vertex on the boundary at (0.5, 0)");
    refuse(checks, spec, {level, {{0.7, 0.5}, {0.3, 0.5}}}, cm_fault_overlap, {first, second},
           "{1} and {2} overlap");
    refuse(checks, spec, {level, {{0.5, 0.50002}, {0.5, 0.8}}}, cm_fault_too_near, {first, second},
           "{1} and {2} come within 2e-05 m at (0.5, 0.50002)");
    refuse(checks, spec, {level, {{0.3, 0.5}, {0.7, 0.51}}}, cm_fault_angle, {first, second},
           "{1} and {2} meet at too small an angle at (0.3, 0.5): 1.43");
    refuse(checks, spec, {level, {{0.3, 0.2}, {0.7, 0.2}, {0.3, 0.21}}}, cm_fault_angle, {second},
           "parts of {1} meet at too small an angle at (0.7, 0.2)");
    refuse(checks, spec, {level, {{0.3, 0.0}, {0.7, 0.002}}}, cm_fault_angle, {second},
           "{1} meets the boundary at too small an angle at (0.3, 0)");
    refuse(checks, spec, {level, {{0.00002, 0.0}, {0.5, 0.3}}}, cm_fault_too_near,
           {second, {cm_culprit_corner, 0}}, "only 2e-05 m from {2}");
}

void bodies(Checks& checks) {
    cm_spec spec = unit_square();
    const std::vector<int32_t> sides(4, 1);
    const auto polygon = [&](const std::vector<double>& corners) {
        spec.n_corners = static_cast<int32_t>(corners.size() / 2);
        spec.corners = corners.data();
        spec.edge_side = sides.data();
        return spec;
    };
    const std::vector<double> twice = {0.0, 0.0, 1.0, 0.0, 1.0, 1.0, 0.0, 0.0};
    refuse(checks, polygon(twice), {}, cm_fault_body,
           {{cm_culprit_corner, 3}, {cm_culprit_corner, 0}},
           "{1} and {2} lie at one place at (0, 0)");
    const std::vector<double> bow_tie = {0.0, 0.0, 1.0, 1.0, 0.0, 1.0, 1.0, 0.0};
    refuse(checks, polygon(bow_tie), {}, cm_fault_body,
           {{cm_culprit_edge, 0}, {cm_culprit_edge, 2}}, "{1} and {2} meet");
    const std::vector<double> sharp = {0.0, 0.0, 1.0, 0.0, 1.0, 0.01};
    refuse(checks, polygon(sharp), {}, cm_fault_angle, {{cm_culprit_corner, 0}}, "too sharp");
}

void fixed_points(Checks& checks) {
    const Who second = {cm_culprit_fixed, 1};
    const auto with = [&](const std::vector<double>& xy, const std::vector<Who>& culprits, int kind,
                          const std::string& reason) {
        cm_spec spec = unit_square();
        spec.n_fixed = static_cast<int32_t>(xy.size() / 2);
        spec.fixed = xy.data();
        refuse(checks, spec, {{{0.3, 0.5}, {0.7, 0.5}}}, kind, culprits, reason);
    };
    with({0.2, 0.2, 1.5, 0.5}, {second}, cm_fault_outside, "{1} lies outside the body");
    with({0.2, 0.2, 0.5, 0.50001}, {second, {cm_culprit_fracture, 0}}, cm_fault_too_near,
         "m of {2} at (0.5, 0.50001)");
    with({0.2, 0.2, 0.2, 0.20001}, {second, {cm_culprit_fixed, 0}}, cm_fault_too_near,
         "m from {2} at (0.2, 0.20001)");
    // On a fracture each face has a node; at a tip inside the body there is one.
    TestNetwork edge_crack({{{0.0, 0.5}, {0.7, 0.5}}});
    const cm_network view = edge_crack.view();
    for (const double x : {0.0, 0.5, 0.7}) {
        const std::array<double, 4> xy = {0.2, 0.2, x, 0.5};
        cm_spec spec = unit_square();
        spec.n_fixed = 2;
        spec.fixed = xy.data();
        int32_t n_joints = 0;
        const bool is_good = cm_check(&spec, &view, 0, nullptr, &n_joints, nullptr) == 0;
        checks.is_equal(is_good, x == 0.7, "a point on a fracture: refused but at the tip");
        if (is_good)
            continue;
        cm_fault fault;
        cm_last_fault(&fault);
        checks.is_equal(fault.kind, cm_fault_overlap, "a point on a fracture: kind");
        checks.is_true(fault.culprit_kind[0] == cm_culprit_fixed && fault.culprit[0] == 1 &&
                           fault.culprit_kind[1] == cm_culprit_fracture && fault.culprit[1] == 0,
                       "a point on a fracture: culprits");
        checks.says(fault.reason, "{1} lies on {2} at (", "a point on a fracture: reason");
    }
}

void joints(Checks& checks) {
    // A cross, a T, a V, a kink, an end on the boundary, and a fracture that crosses itself.
    TestNetwork network({{{0.1, 0.5}, {0.5, 0.5}, {0.9, 0.6}},
                         {{0.2, 0.3}, {0.2, 0.7}},
                         {{0.4, 0.5}, {0.4, 0.2}},
                         {{0.4, 0.2}, {0.6, 0.0}},
                         {{0.6, 0.8}, {0.9, 0.8}, {0.9, 0.9}, {0.7, 0.7}}});
    const cm_spec spec = unit_square();
    const cm_network view = network.view();
    int32_t n_joints = 0;
    cm_joint found[8];
    checks.is_true(cm_check(&spec, &view, 8, found, &n_joints, nullptr) == 0, cm_last_error());
    checks.is_equal(n_joints, 4, "joints");
    const auto has = [&](int32_t a, int32_t b, double x, double y) {
        for (int32_t k = 0; k < n_joints; ++k)
            if (found[k].fracture[0] == a && found[k].fracture[1] == b)
                return std::hypot(found[k].x - x, found[k].y - y) < 1e-12;
        return false;
    };
    checks.is_true(has(0, 1, 0.2, 0.5), "cross");
    checks.is_true(has(0, 2, 0.4, 0.5), "T");
    checks.is_true(has(2, 3, 0.4, 0.2), "V");
    checks.is_true(has(4, 4, 0.8, 0.8), "with itself");
    cm_fault fault;
    cm_last_fault(&fault);
    checks.is_equal(fault.kind, cm_fault_none, "no fault");
    checks.is_true(cm_check(&spec, &view, 1, found, &n_joints, nullptr) == 0 && n_joints == 4,
                   "more joints than there is room for");
}

// Fractures of very different lengths that meet, almost meet and end near the side: fracture cells
// within two of those of the mesh, cells within 15 %.
void expected_cells(Checks& checks) {
    TestNetwork network({{{0.1, 0.5}, {0.5, 0.5}, {0.9, 0.6}},
                         {{0.2, 0.3}, {0.2, 0.7}},
                         {{0.205, 0.31}, {0.205, 0.49}},
                         {{0.4, 0.505}, {0.4, 0.9}},
                         {{0.6, 0.2}, {0.99, 0.2}}});
    for (const double size : {0.05, 0.02, 0.005}) {
        const cm_spec spec = rectangle_spec(1.0, 1.0, size, 0.1);
        const cm_network view = network.view();
        int32_t n_joints = 0;
        double n_cells[2];
        checks.is_true(cm_check(&spec, &view, 0, nullptr, &n_joints, n_cells) == 0,
                       cm_last_error());
        ApiMesh mesh;
        checks.is_true(mesh.create(spec, network), cm_last_error());
        const double cells = mesh.counts.n_cells, fracture_cells = mesh.counts.n_fracture_cells;
        checks.is_close(n_cells[0], cells, 0.15 * cells, "expected cells, " + std::to_string(size));
        checks.is_close(n_cells[1], fracture_cells, 2.0, "expected fracture cells");
    }
}

// 5,000 crosses on a lattice, and a line along each side of it that ends near to none.
void many_segments(Checks& checks) {
    constexpr int columns = 100, rows = 50;
    std::vector<Polyline> crosses;
    for (int i = 1; i <= columns; ++i)
        for (int j = 1; j <= rows; ++j) {
            const double x = i + 0.1 * std::sin(i * j), y = j + 0.1 * std::cos(i * j);
            crosses.push_back({{x - 0.3, y}, {x + 0.4, y}});
            crosses.push_back({{x, y + 0.4}, {x, y - 0.3}});
        }
    crosses.push_back({{0.5, 0.4}, {columns + 0.5, 0.4}});
    crosses.push_back({{0.5, rows + 0.6}, {columns + 0.5, rows + 0.6}});
    TestNetwork network(crosses);
    const cm_spec spec = rectangle_spec(columns + 1.0, rows + 1.0, 0.05, 0.2);
    const cm_network view = network.view();
    std::vector<cm_joint> found(columns * rows);
    int32_t n_joints = 0;
    const std::clock_t start = std::clock();
    checks.is_true(cm_check(&spec, &view, columns * rows, found.data(), &n_joints, nullptr) == 0,
                   cm_last_error());
    const double seconds = static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
    checks.is_close(seconds, 0.0, 10.0, "10,002 segments in 10 s");
    checks.is_equal(n_joints, columns * rows, "a joint a cross");
    std::vector<char> is_found(columns * rows, 0);
    for (int32_t k = 0; k < std::min(n_joints, columns * rows); ++k) {
        const int cross = found[k].fracture[0] / 2, i = cross / rows + 1, j = cross % rows + 1;
        is_found[cross] = found[k].fracture[1] == 2 * cross + 1 &&
                          std::hypot(found[k].x - i - 0.1 * std::sin(i * j),
                                     found[k].y - j - 0.1 * std::cos(i * j)) < 1e-12;
    }
    checks.is_equal(std::count(is_found.begin(), is_found.end(), 1), columns * rows,
                    "each where its fractures cross");
}

} // namespace

int main() {
    Checks checks;
    fractures(checks);
    many_segments(checks);
    bodies(checks);
    fixed_points(checks);
    expected_cells(checks);
    joints(checks);
    cm_last_fault(nullptr);
    checks.is_true(cm_check(nullptr, nullptr, 0, nullptr, nullptr, nullptr) != 0,
                   "nothing to check");
    return checks.finish();
}
