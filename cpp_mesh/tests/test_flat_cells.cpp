// A cell without area goes, the region stays covered, and held edges stay.
#include "flat_cells.hpp"

#include "checks.hpp"

using namespace cpp_mesh;

namespace {

// A triangle with a fourth node in the middle of its lowest side, where gmsh has left a flat cell.
const std::vector<Vec2> xy = {{0.0, 0.0}, {2.0, 0.0}, {1.0, 0.0}, {1.0, 3.0}};
const std::vector<Triangle> left = {{3, 0, 1}, {1, 0, 2}};

double total_area(const std::vector<Triangle>& cells) {
    double total = 0.0;
    for (const Triangle& cell : cells)
        total += 0.5 * twice_area(xy[cell[0]], xy[cell[1]], xy[cell[2]]);
    return total;
}

} // namespace

int main() {
    Checks checks;
    for (const bool flat_first : {false, true}) {
        std::vector<Triangle> cells = left;
        if (flat_first)
            std::swap(cells[0], cells[1]);
        turn_flat_cells(xy, {}, cells);
        checks.is_true(std::abs(total_area(cells) - 3.0) < 1e-15, "the cells cover the triangle");
        for (const Triangle& cell : cells)
            checks.is_true(std::abs(0.5 * twice_area(xy[cell[0]], xy[cell[1]], xy[cell[2]]) - 1.5) <
                               1e-15,
                           "each covers a half of it");
    }
    std::vector<Triangle> cells = left;
    turn_flat_cells(xy, {{0, 1}}, cells);
    checks.is_true(cells == left, "a held edge stays");
    cells = {left[1]};
    turn_flat_cells(xy, {}, cells);
    checks.is_true(cells.size() == 1 && cells[0] == left[1], "a flat cell without neighbour stays");
    cells = {{0, 2, 3}, {2, 1, 3}};
    const std::vector<Triangle> fine = cells;
    turn_flat_cells(xy, {}, cells);
    checks.is_true(cells == fine, "other cells stay");
    return checks.finish();
}
