// A triangulation of the rectangle that conforms to the fractures but is not split along them.
#ifndef CPP_MESH_PLANE_MESH_HPP
#define CPP_MESH_PLANE_MESH_HPP

#include "geometry.hpp"

#include <array>
#include <vector>

namespace cpp_mesh {

using Triangle = std::array<int, 3>;

// An edge of the triangulation that belongs to a fracture, along the fracture's direction.
struct FractureCell {
    int fracture = 0;
    std::array<int, 2> node = {-1, -1};
    std::array<double, 2> s = {0.0, 0.0}; // arc length [m]
    int old_cell = -1;                    // the same cell in the mesh before a remeshing
};

// A ring of triangles that share a free tip.
struct Rosette {
    int tip_node = -1;
    double radius = 0.0;
};

struct PlaneMesh {
    std::vector<Vec2> xy;
    std::vector<Triangle> cells; // counter-clockwise
    std::vector<FractureCell> fracture_cells;
    std::vector<Rosette> rosettes;
};

// The smallest angle [rad] and the cell that has it.
struct Quality {
    double smallest_angle = 0.0;
    int worst_cell = -1;
};

Quality quality_of(const PlaneMesh& mesh);

// Leave out the nodes that no cell uses.
void drop_unused_nodes(PlaneMesh& mesh);

// By fracture, then by arc length.
void sort_fracture_cells(std::vector<FractureCell>& cells);

// Sides of cells by their nodes: which cell has the directed edge a -> b (counter-clockwise)?
class EdgeTable {
public:
    explicit EdgeTable(const std::vector<Triangle>& cells, int n_nodes);
    // Cell whose boundary runs from a to b, or -1.
    int cell(int a, int b) const;
    // The cell on the other side of edge k of a cell, or -1.
    int across(int cell, int k) const {
        if (across_.empty())
            find_neighbours();
        return across_[3 * cell + k];
    }
    // Cells around a node.
    const int* begin(int node) const { return around_.data() + first_[node]; }
    const int* end(int node) const { return around_.data() + first_[node + 1]; }

private:
    void find_neighbours() const;

    const std::vector<Triangle>& cells_;
    std::vector<int> first_, around_;
    mutable std::vector<int> across_; // made when first asked for
};

} // namespace cpp_mesh

#endif
