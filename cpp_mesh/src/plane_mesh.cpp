#include "plane_mesh.hpp"

#include "errors.hpp"

#include <algorithm>

namespace cpp_mesh {

void drop_unused_nodes(PlaneMesh& mesh) {
    const int n_before = static_cast<int>(mesh.xy.size());
    std::vector<int> number(n_before, -1);
    for (const Triangle& cell : mesh.cells)
        for (int node : cell)
            number[node] = 0;
    int n = 0;
    for (int node = 0; node < n_before; ++node) {
        if (number[node] < 0)
            continue;
        mesh.xy[n] = mesh.xy[node];
        number[node] = n++;
    }
    mesh.xy.resize(n);
    for (Triangle& cell : mesh.cells)
        for (int& node : cell)
            node = number[node];
    for (FractureCell& cell : mesh.fracture_cells) {
        for (int& node : cell.node) {
            node = number[node];
            if (node < 0)
                throw MeshError("a node of " + fracture_name(cell.fracture) +
                                " is missing in the new triangles");
        }
    }
    for (Rosette& rosette : mesh.rosettes)
        rosette.tip_node = number[rosette.tip_node];
}

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

void EdgeTable::find_neighbours() const {
    across_.resize(3 * cells_.size());
    for (std::size_t c = 0; c < cells_.size(); ++c)
        for (int k = 0; k < 3; ++k)
            across_[3 * c + k] = cell(cells_[c][(k + 1) % 3], cells_[c][k]);
}

int EdgeTable::cell(int a, int b) const {
    for (const int* c = begin(a); c != end(a); ++c)
        for (int k = 0; k < 3; ++k)
            if (cells_[*c][k] == a && cells_[*c][(k + 1) % 3] == b)
                return *c;
    return -1;
}

} // namespace cpp_mesh
