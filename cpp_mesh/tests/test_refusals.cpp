// What cannot be meshed is refused, with the fractures named.
#include "api_mesh.hpp"
#include "checks.hpp"

#include <limits>

namespace {

void refuse(Checks& checks, const std::vector<Polyline>& fractures, const std::string& who,
            const std::string& why) {
    ApiMesh mesh;
    const bool is_made = mesh.create(rectangle_spec(1.0, 1.0, 0.05, 0.2), TestNetwork(fractures));
    checks.is_true(!is_made && mesh.handle == nullptr, why + ": refused");
    checks.says(mesh.error, who, why + ": names");
    checks.says(mesh.error, why, why + ": reason");
}

void refuse_spec(Checks& checks, const cm_spec& spec, const std::string& why) {
    ApiMesh mesh;
    checks.is_true(!mesh.create(spec, TestNetwork({{{0.3, 0.5}, {0.7, 0.5}}})), why + ": refused");
    checks.says(mesh.error, why, why + ": reason");
}

} // namespace

int main() {
    Checks checks;
    const Polyline level = {{0.3, 0.5}, {0.7, 0.5}};
    const double nan = std::numeric_limits<double>::quiet_NaN();

    refuse(checks, {{{0.3, 0.2}, {0.3, 0.2}}}, "fracture 1", "too short");
    refuse(checks, {level, {{0.3, 0.2}, {0.5, 0.2}, {0.50001, 0.2}}}, "fracture 2", "too short");
    refuse(checks, {{{0.5, 0.5}}}, "fracture 1", "fewer than two vertices");
    refuse(checks, {{{0.5, 0.5}, {nan, 0.5}}}, "fracture 1", "not a number");
    refuse(checks, {level, {{0.5, 0.8}, {0.5, 1.2}}}, "fracture 2", "leaves the domain");
    refuse(checks, {{{0.3, 0.5}, {0.5, 0.0}, {0.7, 0.5}}}, "fracture 1", "inner vertex");
    refuse(checks, {level, level}, "fractures 1 and 2", "overlap");
    refuse(checks, {level, {{0.7, 0.5}, {0.3, 0.5}}}, "fractures 1 and 2", "overlap");
    refuse(checks, {level, {{0.4, 0.5}, {0.6, 0.5}}}, "fractures 1 and 2", "overlap");
    refuse(checks, {level, {{0.5, 0.5}, {0.9, 0.5}}}, "fractures 1 and 2", "overlap");
    refuse(checks, {level, {{0.3, 0.5}, {0.5, 0.5}, {0.6, 0.7}}}, "fractures 1 and 2", "overlap");
    refuse(checks, {{{0.3, 0.5}, {0.7, 0.5}, {0.4, 0.5}}}, "fracture 1", "overlap");
    refuse(checks, {level, {{0.5, 0.50002}, {0.5, 0.8}}}, "fractures 1 and 2", "without meeting");
    refuse(checks, {level, {{0.5, 0.49998}, {0.5, 0.8}}}, "fractures 1 and 2", "without meeting");
    refuse(checks, {level, {{0.3, 0.49}, {0.7, 0.51}}, {{0.49999, 0.3}, {0.5001, 0.7}}}, "fracture",
           "apart");
    refuse(checks, {level, {{0.3, 0.5}, {0.7, 0.501}}}, "fractures 1 and 2", "too small an angle");
    refuse(checks, {{{0.5, 0.00002}, {0.5, 0.5}}}, "fracture 1", "of the boundary");
    refuse(checks, {{{0.3, 0.0}, {0.7, 0.0}}}, "fracture 1", "along the boundary");
    refuse(checks, {{{0.3, 0.0}, {0.7, 0.002}}}, "fracture 1", "too small an angle");
    refuse(checks, {{{0.5, 0.0}, {0.5, 0.5}}, {{0.50002, 0.0}, {0.7, 0.3}}}, "fractures 1 and 2",
           "without meeting");
    refuse(checks, {{{0.00002, 0.0}, {0.5, 0.5}}}, "fracture 1", "m from corner 1");

    refuse_spec(checks, rectangle_spec(0.0, 1.0, 0.05, 0.2), "no area");
    refuse_spec(checks, rectangle_spec(1.0, 1.0, 0.0, 0.2), "must be positive");
    refuse_spec(checks, rectangle_spec(1.0, 1.0, nan, 0.2), "must be positive");
    refuse_spec(checks, rectangle_spec(1.0, 1.0, 0.2, 0.05), "must not be smaller");
    cm_spec window = rectangle_spec(1.0, 1.0, 0.05, 0.2);
    window.rosette_sectors = 4;
    refuse_spec(checks, window, "at least 6 sectors");
    window.rosette_sectors = 12;
    window.rosette_radius = 1e-12; // gmsh would not end
    refuse_spec(checks, window, "fracture 1 has elements of 1e-12 m around its end");
    window.rosette_radius = 0.0;
    refuse_spec(checks, window, "radius must be positive");

    cm_counts counts;
    int32_t n = 0;
    checks.is_true(cm_sizes(nullptr, &counts) != 0, "no mesh: sizes");
    checks.is_true(cm_locate(nullptr, 0, nullptr, nullptr) != 0, "no mesh: locate");
    checks.is_true(cm_map_sizes(nullptr, &n) != 0, "no mesh: map");
    cm_mesh* none = nullptr;
    cm_destroy(&none);
    cm_destroy(nullptr);

    // A library that has refused still works.
    ApiMesh mesh;
    checks.is_true(mesh.create(rectangle_spec(1.0, 1.0, 0.05, 0.2), TestNetwork({level})),
                   mesh.error);
    checks.is_true(cm_map_sizes(mesh.handle, &n) != 0, "no map on a new mesh");
    checks.says(cm_last_error(), "not made by remeshing", "no map on a new mesh");
    return checks.finish();
}
