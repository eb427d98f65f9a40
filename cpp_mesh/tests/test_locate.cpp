// Point location.
#include "api_mesh.hpp"
#include "checks.hpp"

int main() {
    Checks checks;
    ApiMesh mesh;
    checks.is_true(mesh.create(rectangle_spec(2.0, 1.0, 0.02, 0.2),
                               TestNetwork({{{0.5, 0.5}, {1.0, 0.6}, {1.5, 0.4}}})),
                   mesh.error);

    // A point inside a cell is found there, wherever in the cell it lies.
    int wrong = 0;
    for (int c = 0; c < mesh.counts.n_cells; ++c)
        for (const auto& weight :
             {std::array<double, 3>{1.0 / 3, 1.0 / 3, 1.0 / 3},
              std::array<double, 3>{0.98, 0.01, 0.01}, std::array<double, 3>{0.01, 0.495, 0.495}}) {
            Point p = {0.0, 0.0};
            for (int k = 0; k < 3; ++k)
                for (int i = 0; i < 2; ++i)
                    p[i] += weight[k] * mesh.node(mesh.cell_nodes[3 * c + k])[i];
            wrong += mesh.locate(p) != c;
        }
    checks.is_equal(wrong, 0, "points inside cells");

    // A node belongs to any of the cells around it.
    wrong = 0;
    for (int c = 0; c < mesh.counts.n_cells; ++c)
        for (int k = 0; k < 3; ++k) {
            const Point p = mesh.node(mesh.cell_nodes[3 * c + k]);
            const int found = mesh.locate(p);
            bool is_corner = false;
            for (int l = 0; l < 3 && found >= 0; ++l)
                is_corner = is_corner || mesh.node(mesh.cell_nodes[3 * found + l]) == p;
            wrong += !is_corner;
        }
    checks.is_equal(wrong, 0, "nodes");

    for (const Point& p : {Point{0.0, 0.0}, Point{2.0, 1.0}, Point{2.0, 0.5}, Point{1.3, 1.0}})
        checks.is_true(mesh.locate(p) >= 0, "points on the boundary are inside");
    for (const Point& p : {Point{-1e-9, 0.5}, Point{2.0 + 1e-9, 0.5}, Point{1.0, 1.0 + 1e-9},
                           Point{1.0, -5.0}, Point{std::nan(""), 0.5}})
        checks.is_equal(mesh.locate(p), -1, "points outside");
    return checks.finish();
}
