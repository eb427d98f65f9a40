// Meshes whose sizes are wanted in the cells of an old mesh.
#include "api_mesh.hpp"
#include "checks.hpp"

#include <functional>
#include <limits>

namespace {

using SizeFunction = std::function<double(Point)>;

std::vector<double> wanted_in(const ApiMesh& mesh, const SizeFunction& wanted) {
    std::vector<double> sizes;
    for (int c = 0; c < mesh.counts.n_cells; ++c)
        sizes.push_back(wanted(mesh.centre(c)));
    return sizes;
}

void check_body(Checks& checks, const ApiMesh& mesh, double area, int euler,
                const std::string& name) {
    checks.is_true(mesh.error.empty(), name + ": " + mesh.error);
    checks.is_true(mesh.all_positive(), name + ": areas");
    checks.is_close(mesh.total_area(), area, 1e-12 * area, name + ": area");
    checks.is_equal(mesh.euler(), euler, name + ": Euler characteristic");
    checks.is_equal(mesh.side_faults(), 0, name + ": sides of fracture cells");
}

// Achieved over wanted sizes of all cells.
struct Ratios {
    double mean_log = 0.0;
    double share_within = 0.0; // a factor of 1.4 either way
};

Ratios ratios(const ApiMesh& mesh, const SizeFunction& wanted) {
    Ratios result;
    for (int c = 0; c < mesh.counts.n_cells; ++c) {
        const double ratio = mesh.size(c) / wanted(mesh.centre(c));
        result.mean_log += std::log(ratio) / mesh.counts.n_cells;
        result.share_within += (ratio < 1.4 && ratio > 1.0 / 1.4) * 1.0 / mesh.counts.n_cells;
    }
    return result;
}

// Largest ratio of the sizes of neighbours.
double largest_step(const ApiMesh& mesh) {
    double largest = 1.0;
    for (int f = 0; f < mesh.counts.n_faces; ++f) {
        if (mesh.face_cells[2 * f + 1] < 0)
            continue;
        const double a = mesh.size(mesh.face_cells[2 * f]),
                     b = mesh.size(mesh.face_cells[2 * f + 1]);
        largest = std::max({largest, a / b, b / a});
    }
    return largest;
}

// Sizes that grow by less than 0.3 per distance are met.
void follows(Checks& checks) {
    const std::vector<SizeFunction> functions = {
        [](Point) { return 0.03; },
        [](Point p) { return 0.005 + 0.15 * std::hypot(p[0] - 0.6, p[1] - 0.3); },
        [](Point p) { return 0.02 * std::exp(1.5 * p[0]); },
    };
    const cm_spec spec = rectangle_spec(1.0, 1.0, 0.02, 1.0);
    for (std::size_t k = 0; k < functions.size(); ++k) {
        const std::string name = "follows " + std::to_string(k);
        ApiMesh old_mesh, mesh, again;
        old_mesh.create(rectangle_spec(1.0, 1.0, 0.02, 0.02), TestNetwork({}));
        const std::vector<double> sizes = wanted_in(old_mesh, functions[k]);
        mesh.create_sized(spec, TestNetwork({}), old_mesh, sizes);
        check_body(checks, mesh, 1.0, 1, name);
        const Ratios found = ratios(mesh, functions[k]);
        checks.is_close(found.mean_log, 0.0, 0.1, name + ": mean of the logarithm");
        checks.is_true(found.share_within > 0.95,
                       name + ": share within 1.4, " + std::to_string(found.share_within));
        checks.is_true(mesh.smallest_angle() > 25.0,
                       name + ": shape, " + std::to_string(mesh.smallest_angle()));
        again.create_sized(spec, TestNetwork({}), old_mesh, sizes);
        checks.is_true(mesh.xy == again.xy && mesh.cell_nodes == again.cell_nodes,
                       name + ": the same again, bit for bit");
    }
}

// A jump of the wanted size by a factor of 100 becomes a gradual growth, and size_boundary a limit.
void grades(Checks& checks) {
    ApiMesh old_mesh, mesh;
    old_mesh.create(rectangle_spec(1.0, 1.0, 0.05, 0.05), TestNetwork({}));
    mesh.create_sized(rectangle_spec(1.0, 1.0, 0.01, 0.1), TestNetwork({}), old_mesh,
                      wanted_in(old_mesh, [](Point p) {
                          return std::hypot(p[0] - 0.5, p[1] - 0.5) < 0.1 ? 0.005 : 0.5;
                      }));
    check_body(checks, mesh, 1.0, 1, "grades");
    double largest = 0.0, at_centre = 0.0;
    for (int c = 0; c < mesh.counts.n_cells; ++c) {
        largest = std::max(largest, mesh.size(c));
        const Point p = mesh.centre(c);
        if (std::hypot(p[0] - 0.5, p[1] - 0.5) < 0.03)
            at_centre = std::max(at_centre, mesh.size(c));
    }
    checks.is_true(largest < 1.4 * 0.1, "grades: limit, " + std::to_string(largest));
    checks.is_true(at_centre < 1.4 * 0.005, "grades: centre, " + std::to_string(at_centre));
    // 1.3 is the growth that is asked for; triangles differ by some 40 % either way.
    checks.is_true(largest_step(mesh) < 1.3 * 1.7,
                   "grades: neighbours, " + std::to_string(largest_step(mesh)));
    checks.is_true(mesh.smallest_angle() > 22.0,
                   "grades: shape, " + std::to_string(mesh.smallest_angle()));
}

// A patch around an end that has grown, in a mesh by given sizes: cells as small as the new one at
// the new segment only.
void grows(Checks& checks) {
    ApiMesh old_mesh, sized, grown;
    const TestNetwork before({{{0.4, 0.5}, {0.6, 0.5}}}),
        after({{{0.4, 0.5}, {0.6, 0.5}, {0.61, 0.5}}});
    old_mesh.create(rectangle_spec(1.0, 1.0, 0.02, 0.2), before);
    sized.create_sized(rectangle_spec(1.0, 1.0, 0.02, 0.2), before, old_mesh,
                       wanted_in(old_mesh, [](Point p) {
                           return 0.04 + 0.2 * std::hypot(p[0] - 0.5, p[1] - 0.5);
                       }));
    checks.is_true(grown.remesh(sized, after, {{0.61, 0.5}}, 0.06, 0.01), grown.error);
    check_body(checks, grown, 1.0, 0, "grows");
    checks.is_true(grown.counts.n_cells < 1.5 * sized.counts.n_cells,
                   "grows: cells, " + std::to_string(grown.counts.n_cells) + " after " +
                       std::to_string(sized.counts.n_cells));
}

// Fracture cells follow the sizes over three orders of magnitude, also on what has grown.
void fractures(Checks& checks) {
    cm_spec spec = rectangle_spec(1.0, 2.0, 0.02, 0.2);
    spec.rosette_sectors = 12;
    spec.rosette_radius = 0.02;
    ApiMesh old_mesh;
    old_mesh.create(spec, TestNetwork({{{0.0, 1.0}, {0.5, 1.0}}, {{0.2, 0.4}, {0.8, 0.5}}}));
    const Point tip = {0.55, 1.05};
    const auto wanted = [&](Point p) {
        return 0.0003 + 0.2 * std::hypot(p[0] - tip[0], p[1] - tip[1]);
    };
    std::vector<double> radii = {0.0, 0.0005, 0.0, 0.0};
    spec.end_radius = radii.data();
    ApiMesh fine;
    fine.create_sized(spec, TestNetwork({{{0.0, 1.0}, {0.5, 1.0}, tip}, {{0.2, 0.4}, {0.8, 0.5}}}),
                      old_mesh, wanted_in(old_mesh, wanted));
    // Sizes of the coarse old mesh are not resolved at the tip yet: once more.
    ApiMesh mesh;
    mesh.create_sized(spec, TestNetwork({{{0.0, 1.0}, {0.5, 1.0}, tip}, {{0.2, 0.4}, {0.8, 0.5}}}),
                      fine, wanted_in(fine, wanted));
    check_body(checks, mesh, 2.0, 0, "fractures");
    checks.is_equal(mesh.counts.n_tips, 3, "fractures: tips");
    checks.is_close(mesh.fracture_length(0), 0.5 + 0.05 * std::sqrt(2.0), 1e-13,
                    "fractures: length");
    double smallest = 1.0, largest = 0.0;
    for (int i = 0; i < mesh.counts.n_fracture_cells; ++i) {
        if (mesh.fcell_fracture[i] != 0)
            continue;
        const Point a = mesh.point(mesh.fcell_points[2 * i]),
                    b = mesh.point(mesh.fcell_points[2 * i + 1]);
        const double size = std::hypot(b[0] - a[0], b[1] - a[1]);
        smallest = std::min(smallest, size);
        largest = std::max(largest, size);
        const double aim = wanted({0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1])});
        checks.is_true(size < 1.5 * aim && size > aim / 1.8,
                       "fractures: size over wanted " + std::to_string(size / aim));
        checks.is_close(mesh.fcell_s[2 * i + 1] - mesh.fcell_s[2 * i], size, 1e-14,
                        "fractures: arc lengths");
    }
    checks.is_true(largest > 100.0 * smallest, "fractures: graded");
    for (int t = 0; t < mesh.counts.n_tips; ++t)
        checks.is_close(mesh.tip_radius[t], mesh.tip_fracture[t] == 0 ? 0.0005 : 0.02, 1e-15,
                        "fractures: rosettes as given");
    checks.is_true(mesh.smallest_angle() > 18.0,
                   "fractures: shape, " + std::to_string(mesh.smallest_angle()));
}

// The same mesh in every unit of length.
void scale_free(Checks& checks) {
    const auto make = [](ApiMesh& mesh, double scale) {
        cm_spec spec = rectangle_spec(7.0 * scale, 6.0 * scale, 0.1 * scale, 1.0 * scale);
        spec.rosette_sectors = 12;
        spec.rosette_radius = 0.1 * scale;
        const TestNetwork network({{{3.0 * scale, 3.0 * scale}, {4.0 * scale, 3.0 * scale}},
                                   {{3.5 * scale, 4.0 * scale}, {4.5 * scale, 4.0 * scale}}});
        ApiMesh old_mesh;
        return old_mesh.create(spec, network) &&
               mesh.create_sized(spec, network, old_mesh, wanted_in(old_mesh, [scale](Point p) {
                                     return 0.02 * scale + 0.2 * std::hypot(p[0] - 4.0 * scale,
                                                                            p[1] - 3.0 * scale);
                                 }));
    };
    ApiMesh mesh;
    checks.is_true(make(mesh, 1.0), "scaled: " + mesh.error);
    for (const double scale : {1e-6, 1e-3, 0.3, 1e2, 1e4}) {
        ApiMesh other;
        checks.is_true(make(other, scale), "scaled: " + other.error);
        checks.is_true(other.cell_nodes == mesh.cell_nodes && other.tip_node == mesh.tip_node,
                       "scaled by " + std::to_string(scale) + ": the same cells");
        double largest = 0.0;
        for (std::size_t i = 0; i < mesh.xy.size() && i < other.xy.size(); ++i)
            largest = std::max(largest, std::abs(other.xy[i] / scale - mesh.xy[i]));
        checks.is_close(largest, 0.0, 1e-9, "scaled: the same nodes");
    }
}

void refusals(Checks& checks) {
    ApiMesh old_mesh, mesh;
    old_mesh.create(rectangle_spec(1.0, 1.0, 0.1, 0.2), TestNetwork({}));
    std::vector<double> sizes(old_mesh.counts.n_cells, 0.1);
    const auto refuse = [&](const cm_spec& spec, const std::string& why) {
        checks.is_true(!mesh.create_sized(spec, TestNetwork({}), old_mesh, sizes),
                       why + ": refused");
        checks.says(mesh.error, why, why + ": reason");
    };
    refuse(rectangle_spec(1.0, 2.0, 0.1, 0.2), "another body");
    for (const double wrong : {0.0, -1.0, std::numeric_limits<double>::quiet_NaN(),
                               std::numeric_limits<double>::infinity()}) {
        sizes[4] = wrong;
        refuse(rectangle_spec(1.0, 1.0, 0.1, 0.2), "cell 5 is not a positive number");
    }
    const cm_spec spec = rectangle_spec(1.0, 1.0, 0.1, 0.2);
    sizes.pop_back();
    refuse(rectangle_spec(1.0, 1.0, 0.1, 0.2), "another number of cells");
    TestNetwork empty({});
    const cm_network none = empty.view();
    cm_mesh* made = nullptr;
    checks.is_true(
        cm_create_sized(&spec, &none, nullptr, old_mesh.counts.n_cells, sizes.data(), &made) != 0 &&
            made == nullptr,
        "no old mesh: refused");
}

} // namespace

int main() {
    Checks checks;
    follows(checks);
    grades(checks);
    grows(checks);
    fractures(checks);
    scale_free(checks);
    refusals(checks);
    return checks.finish();
}
