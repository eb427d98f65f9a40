#include "plane_mesh.hpp"

#include <algorithm>

namespace cpp_mesh {

void sort_fracture_cells(std::vector<FractureCell>& cells) {
    std::stable_sort(cells.begin(), cells.end(), [](const FractureCell& a, const FractureCell& b) {
        return a.fracture != b.fracture ? a.fracture < b.fracture : a.s[0] < b.s[0];
    });
}

Quality quality_of(const PlaneMesh& mesh) {
    Quality quality;
    for (int c = 0; c < static_cast<int>(mesh.cells.size()); ++c) {
        for (int k = 0; k < 3; ++k) {
            const Vec2 p = mesh.xy[mesh.cells[c][k]], q = mesh.xy[mesh.cells[c][(k + 1) % 3]],
                       r = mesh.xy[mesh.cells[c][(k + 2) % 3]];
            const double angle = angle_between(q - p, r - p);
            if (quality.worst_cell < 0 || angle < quality.smallest_angle)
                quality = {angle, c};
        }
    }
    return quality;
}

EdgeTable::EdgeTable(const std::vector<Triangle>& cells, int n_nodes)
    : cells_(cells), first_(n_nodes + 1, 0), around_(3 * cells.size()) {
    for (const Triangle& cell : cells)
        for (int node : cell)
            ++first_[node + 1];
    for (int node = 0; node < n_nodes; ++node)
        first_[node + 1] += first_[node];
    std::vector<int> next(first_.begin(), first_.end() - 1);
    for (int c = 0; c < static_cast<int>(cells.size()); ++c)
        for (int node : cells[c])
            around_[next[node]++] = c;
}

int EdgeTable::cell(int a, int b) const {
    for (const int* c = begin(a); c != end(a); ++c)
        for (int k = 0; k < 3; ++k)
            if (cells_[*c][k] == a && cells_[*c][(k + 1) % 3] == b)
                return *c;
    return -1;
}

} // namespace cpp_mesh
