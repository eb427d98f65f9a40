// The oracle of every mesh: it accepts large meshes and sees small gaps.
#include "check_mesh.hpp"
#include "checks.hpp"
#include "errors.hpp"

namespace {

using namespace cpp_mesh;

constexpr double width = 2.0; // of the square [m]

// n x n squares, each of two triangles; one node on the lower side is lifted.
SplitMesh squares(int n, double lifted, const Domain& domain) {
    PlaneMesh plane;
    for (int j = 0; j <= n; ++j)
        for (int i = 0; i <= n; ++i)
            plane.xy.push_back({width * i / n, width * j / n});
    plane.xy[n / 2].y += lifted;
    for (int j = 0; j < n; ++j) {
        for (int i = 0; i < n; ++i) {
            const int a = j * (n + 1) + i, b = a + 1, c = a + n + 1, d = c + 1;
            plane.cells.push_back({a, b, d});
            plane.cells.push_back({a, d, c});
        }
    }
    SplitMesh mesh = split(plane, domain);
    // The lifted node is meant to be a fault of the area alone.
    for (Face& face : mesh.faces)
        if (face.cell[1] < 0)
            face.side = 1;
    return mesh;
}

std::string fault_of(int n, double lifted) {
    const Domain domain(Rectangle{0.0, width, 0.0, width});
    try {
        check_mesh(squares(n, lifted, domain), domain);
    } catch (const MeshError& error) {
        return error.what();
    }
    return "";
}

} // namespace

int main() {
    Checks checks;
    for (const int n : {10, 250, 387})
        checks.is_true(fault_of(n, 0.0).empty(),
                       std::to_string(2 * n * n) + " cells: " + fault_of(n, 0.0));
    // A gap of 2e-8/387 m2, more than 1e-12 of the area.
    checks.says(fault_of(387, 1e-8), "exactly once", "a gap");
    checks.says(fault_of(10, -1e-8), "exactly once", "a bulge");
    return checks.finish();
}
