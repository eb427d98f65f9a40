#include "flat_cells.hpp"

#include <algorithm>

namespace cpp_mesh {

namespace {

// Sine of the smallest angle below which a cell is flat.
constexpr double flat = 1e-9;

bool is_flat(const std::vector<Vec2>& xy, const Triangle& cell) {
    return !(twice_area(xy[cell[0]], xy[cell[1]], xy[cell[2]]) > 0.0) ||
           !(sine_of_smallest_angle(xy[cell[0]], xy[cell[1]], xy[cell[2]]) > flat);
}

// The corner at which the longest edge of a cell begins.
int start_of_longest(const std::vector<Vec2>& xy, const Triangle& cell) {
    int longest = 0;
    for (int k = 1; k < 3; ++k)
        if (distance(xy[cell[k]], xy[cell[(k + 1) % 3]]) >
            distance(xy[cell[longest]], xy[cell[(longest + 1) % 3]]))
            longest = k;
    return longest;
}

bool is_held(const std::vector<std::array<int, 2>>& held, int a, int b) {
    return std::any_of(held.begin(), held.end(), [&](const std::array<int, 2>& edge) {
        return (edge[0] == a && edge[1] == b) || (edge[0] == b && edge[1] == a);
    });
}

// The cell whose boundary runs from one node to another, and its third node; null if there is none.
Triangle* cell_along(std::vector<Triangle>& cells, int from, int to, int& third) {
    for (Triangle& cell : cells)
        for (int k = 0; k < 3; ++k)
            if (cell[k] == from && cell[(k + 1) % 3] == to) {
                third = cell[(k + 2) % 3];
                return &cell;
            }
    return nullptr;
}

} // namespace

void turn_flat_cells(const std::vector<Vec2>& xy, const std::vector<std::array<int, 2>>& held,
                     std::vector<Triangle>& cells) {
    for (Triangle& cell : cells) {
        if (!is_flat(xy, cell))
            continue;
        const int k = start_of_longest(xy, cell);
        const int a = cell[k], b = cell[(k + 1) % 3], middle = cell[(k + 2) % 3];
        int far = -1;
        Triangle* const other = is_held(held, a, b) ? nullptr : cell_along(cells, b, a, far);
        if (other == nullptr)
            continue;
        cell = {a, far, middle};
        *other = {far, b, middle};
    }
}

} // namespace cpp_mesh
