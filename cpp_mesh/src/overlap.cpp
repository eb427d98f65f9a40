#include "overlap.hpp"

#include "errors.hpp"
#include "locate.hpp"

namespace cpp_mesh {

namespace {

// Smaller shares of a cell than this are rounding errors of cells that only touch.
constexpr double smallest_share = 1e-14;

// Overlaps must cover a new cell up to rounding errors.
constexpr double largest_gap = 1e-11;

std::array<Vec2, 3> corners_of(const PlaneMesh& mesh, int cell) {
    const Triangle& node = mesh.cells[cell];
    return {mesh.xy[node[0]], mesh.xy[node[1]], mesh.xy[node[2]]};
}

} // namespace

// The second triangle is cut by the lines through the sides of the first (Sutherland and Hodgman
// 1974).
double common_area(const std::array<Vec2, 3>& first, const std::array<Vec2, 3>& second) {
    constexpr int most_corners = 9; // each of three cuts adds at most one, with room to spare
    std::array<Vec2, most_corners> polygon, cut;
    int n = 3;
    for (int k = 0; k < 3; ++k)
        polygon[k] =
            second[k] - first[0]; // differences first: areas lose no digits far from the origin
    for (int side = 0; side < 3; ++side) {
        const Vec2 a = first[side] - first[0], b = first[(side + 1) % 3] - first[0];
        int m = 0;
        for (int k = 0; k < n; ++k) {
            const Vec2 p = polygon[k], q = polygon[(k + 1) % n];
            const double dp = twice_area(a, b, p), dq = twice_area(a, b, q);
            if (dp >= 0.0)
                cut[m++] = p;
            if ((dp > 0.0 && dq < 0.0) || (dp < 0.0 && dq > 0.0))
                cut[m++] = along(p, q, dp / (dp - dq));
        }
        std::swap(polygon, cut);
        n = m;
        if (n < 3)
            return 0.0;
    }
    double area = 0.0;
    for (int k = 1; k + 1 < n; ++k)
        area += 0.5 * twice_area(polygon[0], polygon[k], polygon[k + 1]);
    return std::max(area, 0.0);
}

PatchMap map_of_patch(const PlaneMesh& old_mesh, const std::vector<char>& is_made_anew,
                      const PlaneMesh& new_mesh) {
    PatchMap map;
    std::vector<int> patch;
    for (int c = 0; c < static_cast<int>(old_mesh.cells.size()); ++c)
        (is_made_anew[c] ? patch : map.cell_old).push_back(c);
    map.cell_old.resize(new_mesh.cells.size(), -1);
    const CellTree tree(old_mesh.xy, old_mesh.cells, patch);
    std::vector<int> candidates;
    map.overlap_first.assign(1, 0);
    for (int c = 0; c < static_cast<int>(new_mesh.cells.size()); ++c) {
        if (map.cell_old[c] < 0) {
            const std::array<Vec2, 3> corner = corners_of(new_mesh, c);
            const double area = 0.5 * twice_area(corner[0], corner[1], corner[2]);
            Vec2 low = corner[0], high = corner[0];
            for (const Vec2& p : corner) {
                low = {std::min(low.x, p.x), std::min(low.y, p.y)};
                high = {std::max(high.x, p.x), std::max(high.y, p.y)};
            }
            tree.candidates(low, high, candidates);
            double covered = 0.0;
            for (int old_cell : candidates) {
                const double common = common_area(corner, corners_of(old_mesh, old_cell));
                if (common <= smallest_share * area)
                    continue;
                map.overlap_cell.push_back(old_cell);
                map.overlap_area.push_back(common);
                covered += common;
            }
            if (!(std::abs(covered - area) <= largest_gap * area))
                throw MeshError("the old cells do not cover a new cell of the patch");
        }
        map.overlap_first.push_back(static_cast<int>(map.overlap_cell.size()));
    }
    return map;
}

} // namespace cpp_mesh
