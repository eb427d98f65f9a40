#include "smooth.hpp"

namespace cpp_mesh {

namespace {

constexpr int sweeps = 3;

double worst_shape_around(const PlaneMesh& mesh, const EdgeTable& edges, int node) {
    double worst = 1.0;
    for (const int* c = edges.begin(node); c != edges.end(node); ++c) {
        const Triangle& cell = mesh.cells[*c];
        worst = std::min(
            worst, sine_of_smallest_angle(mesh.xy[cell[0]], mesh.xy[cell[1]], mesh.xy[cell[2]]));
    }
    return worst;
}

} // namespace

void smooth(PlaneMesh& mesh, int first_free) {
    std::vector<int> nodes;
    for (int node = first_free; node < static_cast<int>(mesh.xy.size()); ++node)
        nodes.push_back(node);
    smooth(mesh, nodes);
}

void smooth(PlaneMesh& mesh, const std::vector<int>& nodes) {
    const EdgeTable edges(mesh.cells, static_cast<int>(mesh.xy.size()));
    for (int sweep = 0; sweep < sweeps; ++sweep) {
        for (int node : nodes) {
            Vec2 sum;
            int n_cells = 0;
            for (const int* c = edges.begin(node); c != edges.end(node); ++c, ++n_cells)
                for (int other : mesh.cells[*c])
                    if (other != node)
                        sum = sum + mesh.xy[other];
            const Vec2 before = mesh.xy[node];
            const double quality = worst_shape_around(mesh, edges, node);
            mesh.xy[node] = (0.5 / n_cells) * sum; // each neighbour is in two cells
            if (!(worst_shape_around(mesh, edges, node) > quality))
                mesh.xy[node] = before;
        }
    }
}

} // namespace cpp_mesh
