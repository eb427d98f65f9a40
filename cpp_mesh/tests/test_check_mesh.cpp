// The oracle of every mesh: it accepts large meshes and sees small gaps.
#include "check_mesh.hpp"
#include "checks.hpp"
#include "errors.hpp"

namespace {

using namespace cpp_mesh;

constexpr double width = 2.0; // of the square [m]

// n x n squares, each of two triangles; one node on the lower side is lifted.
PlaneMesh plane_squares(int n, double lifted) {
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
    return plane;
}

SplitMesh squares(int n, double lifted, const Domain& domain) {
    SplitMesh mesh = split(plane_squares(n, lifted), domain);
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

// What is said of a mesh with two fractures of one edge each, in which a point of the second has
// one node too many, or the body has one that belongs to nothing.
std::string fault_of_cuts(bool at_fracture) {
    const Domain domain(Rectangle{0.0, width, 0.0, width});
    PlaneMesh plane = plane_squares(10, 0.0);
    plane.fracture_cells = {{0, {35, 36}, {0.0, 0.2}}, {1, {57, 58}, {0.0, 0.2}}};
    SplitMesh mesh = split(plane, domain);
    for (Face& face : mesh.faces)
        if (face.cell[1] < 0 && face.fracture_cell < 0)
            face.side = 1;
    check_mesh(mesh, domain);
    mesh.xy.push_back(mesh.xy.front());
    if (at_fracture)
        for (FracturePoint& point : mesh.points)
            point.copies += point.plane_node == 58;
    try {
        check_mesh(mesh, domain);
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
    // Node 58 of 11 in a row: x = 3 * 0.2 m, y = 5 * 0.2 m.
    checks.says(fault_of_cuts(true), "fracture 2 could not be cut open in the mesh at (0.6, 1)",
                "a point with a node too many");
    checks.says(fault_of_cuts(false), "1 cuts more or fewer", "a node too many");
    return checks.finish();
}
