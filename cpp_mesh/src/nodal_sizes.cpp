#include "nodal_sizes.hpp"

#include "errors.hpp"

#include <queue>
#include <utility>

namespace cpp_mesh {

NodalSizes::NodalSizes(const PlaneMesh& mesh, const std::vector<double>& cell_size, double largest)
    : xy_(mesh.xy), cells_(mesh.cells), size_(mesh.xy.size(), 0.0), tree_(xy_, cells_) {
    std::vector<int> n_cells(xy_.size(), 0);
    for (std::size_t c = 0; c < cells_.size(); ++c) {
        if (!(cell_size[c] > 0.0 && std::isfinite(cell_size[c])))
            throw MeshError("the size wanted in cell " + std::to_string(c + 1) +
                            " is not a positive number");
        for (int node : cells_[c]) {
            size_[node] += std::log(std::min(1.0, cell_size[c] / largest));
            ++n_cells[node];
        }
    }
    for (std::size_t node = 0; node < size_.size(); ++node)
        size_[node] = largest * std::exp(size_[node] / n_cells[node]);
    limit_growth();
}

// Smallest sizes first, each passes a limit on to its neighbours (Dijkstra's algorithm; the limited
// gradient is that of Persson 2006, "Mesh size functions for implicit geometries and PDE-based
// gradient limiting").
void NodalSizes::limit_growth() {
    const EdgeTable edges(cells_, static_cast<int>(xy_.size()));
    using Entry = std::pair<double, int>;
    std::priority_queue<Entry, std::vector<Entry>, std::greater<Entry>> queue;
    for (int node = 0; node < static_cast<int>(size_.size()); ++node)
        queue.push({size_[node], node});
    while (!queue.empty()) {
        const auto [size, node] = queue.top();
        queue.pop();
        if (size > size_[node])
            continue; // it has become smaller since
        for (const int* c = edges.begin(node); c != edges.end(node); ++c) {
            for (int other : cells_[*c]) {
                const double limit = size + growth * distance(xy_[node], xy_[other]);
                if (limit < size_[other]) {
                    size_[other] = limit;
                    queue.push({limit, other});
                }
            }
        }
    }
}

double NodalSizes::operator()(Vec2 p) const {
    const int cell = tree_.locate(p);
    if (cell < 0)
        return at_nearest_node(p);
    const Triangle& node = cells_[cell];
    const double whole = twice_area(xy_[node[0]], xy_[node[1]], xy_[node[2]]);
    double size = 0.0, smallest = size_[node[0]], largest = smallest;
    for (int k = 0; k < 3; ++k) {
        const double weight = twice_area(xy_[node[(k + 1) % 3]], xy_[node[(k + 2) % 3]], p) / whole;
        size += weight * size_[node[k]];
        smallest = std::min(smallest, size_[node[k]]);
        largest = std::max(largest, size_[node[k]]);
    }
    return std::clamp(size, smallest, largest);
}

// For points that rounding has put outside.
double NodalSizes::at_nearest_node(Vec2 p) const {
    std::size_t nearest = 0;
    for (std::size_t node = 1; node < xy_.size(); ++node)
        if (distance(xy_[node], p) < distance(xy_[nearest], p))
            nearest = node;
    return size_[nearest];
}

} // namespace cpp_mesh
