// Hard cases: tips close to each other, flat angles, sharp kinks. Each is meshed, or refused with
// the fractures named.
#include "api_mesh.hpp"
#include "checks.hpp"

namespace {

constexpr double radius = 0.02;

cm_spec spec_with_rosettes() {
    cm_spec spec = rectangle_spec(1.0, 1.0, 0.02, 0.1);
    spec.rosette_sectors = 12;
    spec.rosette_radius = radius;
    return spec;
}

void check_quality(Checks& checks, const ApiMesh& mesh, double least_degrees,
                   const std::string& name) {
    double angle = 0.0;
    int32_t cell = -1;
    checks.is_true(cm_quality(mesh.handle, &angle, &cell) == 0, name + ": quality");
    checks.is_close(angle * 180.0 / pi, mesh.smallest_angle(), 1e-9, name + ": smallest angle");
    checks.is_true(angle * 180.0 / pi > least_degrees,
                   name + ": shape, " + std::to_string(angle * 180.0 / pi));
    checks.is_true(cell >= 0 && cell < mesh.counts.n_cells, name + ": worst cell");
}

bool check_meshed(Checks& checks, ApiMesh& mesh, const std::vector<Polyline>& fractures, int euler,
                  const std::string& name) {
    if (!mesh.create(spec_with_rosettes(), TestNetwork(fractures))) {
        checks.is_true(false, name + ": " + mesh.error);
        return false;
    }
    checks.is_true(mesh.all_positive(), name + ": areas");
    checks.is_close(mesh.total_area(), 1.0, 1e-12, name + ": area");
    checks.is_equal(mesh.euler(), euler, name + ": Euler characteristic");
    checks.is_equal(mesh.side_faults(), 0, name + ": sides");
    return true;
}

// Rings shrink to a third of the distance of two tips.
void close_tips(Checks& checks) {
    for (const double share : {1.0, 0.2, 0.05, 0.01}) {
        const double gap = share * radius;
        ApiMesh mesh;
        const std::string name = "tips apart by " + std::to_string(share) + " radii";
        if (!check_meshed(checks, mesh, {{{0.2, 0.5}, {0.5, 0.5}}, {{0.5 + gap, 0.5}, {0.8, 0.55}}},
                          -1, name))
            continue;
        check_quality(checks, mesh, 15.0, name);
        int n_small = 0;
        for (int t = 0; t < mesh.counts.n_tips; ++t)
            n_small += std::abs(mesh.tip_radius[t] - gap / 3.0) <= 1e-12;
        checks.is_equal(n_small, share < 2.0 ? 2 : 0, name + ": rings");

        ApiMesh stacked;
        if (check_meshed(checks, stacked,
                         {{{0.2, 0.5}, {0.5, 0.5}}, {{0.5, 0.5 + gap}, {0.8, 0.6}}}, -1,
                         name + ", stacked"))
            check_quality(checks, stacked, 10.0, name + ", stacked");
    }
    ApiMesh mesh;
    checks.is_true(
        !mesh.create(spec_with_rosettes(),
                     TestNetwork({{{0.2, 0.5}, {0.5, 0.5}}, {{0.5 + 1e-5, 0.5}, {0.8, 0.5}}})),
        "tips nearly at one place: refused");
    checks.says(mesh.error, "fractures 1 and 2", "tips nearly at one place: names");
}

// A crack ending on the boundary at a flat angle is refused, one that only comes near is meshed.
void flat_angles(Checks& checks) {
    const double slope = std::tan(pi / 180.0);
    ApiMesh mesh;
    checks.is_true(
        !mesh.create(spec_with_rosettes(), TestNetwork({{{0.1, 0.0}, {0.6, 0.5 * slope}}})),
        "1 degree on the boundary: refused");
    checks.says(mesh.error, "fracture 1 meets the boundary at too small an angle",
                "1 degree on the boundary: reason");
    for (const double gap : {0.02, 0.005, 0.001}) {
        ApiMesh near;
        const std::string name = "1 degree, " + std::to_string(gap) + " from the boundary";
        if (check_meshed(checks, near, {{{0.2, gap}, {0.7, gap + 0.5 * slope}}}, 0, name))
            check_quality(checks, near, 1.0, name);
    }
    ApiMesh crossing;
    checks.is_true(
        !crossing.create(spec_with_rosettes(),
                         TestNetwork({{{0.2, 0.5}, {0.8, 0.5}},
                                      {{0.3, 0.5 - 0.2 * slope}, {0.7, 0.5 + 0.2 * slope}}})),
        "crossing at 1 degree: refused");
    checks.says(crossing.error, "fractures 1 and 2 meet at too small an angle",
                "crossing at 1 degree: reason");
}

void sharp_kinks(Checks& checks) {
    for (const double degrees : {90.0, 120.0, 150.0}) {
        for (const double wing : {0.3, 1.0, 5.0}) {
            const double turn = degrees * pi / 180.0, length = wing * radius;
            const Point tip = {0.6 + length * std::cos(turn), 0.5 + length * std::sin(turn)};
            ApiMesh mesh;
            const std::string name = "kink by " + std::to_string(degrees) + ", wing of " +
                                     std::to_string(wing) + " radii";
            if (!check_meshed(checks, mesh, {{{0.3, 0.5}, {0.6, 0.5}, tip}}, 0, name))
                continue;
            check_quality(checks, mesh, 10.0, name);
            checks.is_equal(mesh.counts.n_tips, 2, name + ": tips");
            for (int t = 0; t < 2; ++t)
                checks.is_true(mesh.tip_radius[t] > 0.0, name + ": rosette");
        }
    }
}

// Cells become smaller next to short segments and where a kink comes near another fracture.
void narrow_places(Checks& checks) {
    Polyline bends = {{0.3, 0.5}};
    for (int k = 0; k < 8; ++k)
        bends.push_back({bends.back()[0] + 0.004, bends.back()[1] + (k % 2 == 0 ? 0.002 : 0.0)});
    bends.push_back({0.6, 0.6});
    ApiMesh mesh;
    if (check_meshed(checks, mesh, {bends}, 0, "short segments"))
        check_quality(checks, mesh, 20.0, "short segments");
    ApiMesh passing;
    if (check_meshed(checks, passing,
                     {{{0.2, 0.4}, {0.8, 0.4}}, {{0.3, 0.6}, {0.5, 0.401}, {0.7, 0.6}}}, -1,
                     "a kink near a fracture"))
        check_quality(checks, passing, 20.0, "a kink near a fracture");
    // The share of small cells stays small: they grow away from the place.
    ApiMesh free;
    if (check_meshed(checks, free, {{{0.2, 0.4}, {0.8, 0.4}}, {{0.3, 0.6}, {0.5, 0.5}, {0.7, 0.6}}},
                     -1, "a kink far from a fracture"))
        checks.is_true(passing.counts.n_cells < 1.5 * free.counts.n_cells,
                       "a kink near a fracture: number of cells, " +
                           std::to_string(passing.counts.n_cells) + " for " +
                           std::to_string(free.counts.n_cells));
}

// Coarse cells have good shapes, and stay few, where fractures almost touch each other or the
// boundary.
void near_ends(Checks& checks) {
    const auto mesh_of = [&](double end, ApiMesh& mesh, const std::string& name) {
        const TestNetwork network({{{0.2, 0.5}, {0.6 - end, 0.5}},
                                   {{0.6, 0.3}, {0.6, 0.7}},
                                   {{0.9, 0.6}, {1.0 - end, 0.63}}});
        checks.is_true(mesh.create(rectangle_spec(1.0, 1.0, 0.05, 0.2), network),
                       name + ": " + mesh.error);
    };
    ApiMesh apart;
    mesh_of(0.02, apart, "ends apart");
    for (const double gap : {9e-3, 2e-3, 2e-4, 6e-5}) {
        ApiMesh mesh;
        const std::string name = "ends within " + std::to_string(gap) + " m";
        mesh_of(gap, mesh, name);
        check_quality(checks, mesh, 15.0, name);
        checks.is_true(mesh.counts.n_cells < apart.counts.n_cells * (2.0 - 0.5 * std::log10(gap)),
                       name + ": number of cells, " + std::to_string(mesh.counts.n_cells) +
                           " for " + std::to_string(apart.counts.n_cells));
    }
}

// Rosettes far smaller than their body: fracture cells grow away from them as cells around do, by
// about 0.3 of their length, so that a factor of ten takes some eight cells at each end.
void tiny_rosettes(Checks& checks) {
    const TestNetwork network({{{0.9, 1.0}, {1.1, 1.02}}});
    for (int power = 3; power <= 6; ++power) {
        cm_spec spec = rectangle_spec(2.0, 2.0, 0.02, 0.2);
        spec.rosette_sectors = 12;
        spec.rosette_radius = std::pow(10.0, -power);
        ApiMesh mesh;
        const std::string name = "rosettes of 1e-" + std::to_string(power) + " m";
        checks.is_true(mesh.create(spec, network), name + ": " + mesh.error);
        check_quality(checks, mesh, 25.0, name);
        checks.is_close(mesh.counts.n_fracture_cells, 30.0 + 15.4 * (power - 3), 3.0,
                        name + ": fracture cells");
    }
}

} // namespace

int main() {
    Checks checks;
    close_tips(checks);
    flat_angles(checks);
    sharp_kinks(checks);
    narrow_places(checks);
    near_ends(checks);
    tiny_rosettes(checks);
    return checks.finish();
}
