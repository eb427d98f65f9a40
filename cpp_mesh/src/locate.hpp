// Which cell holds a point?
#ifndef CPP_MESH_LOCATE_HPP
#define CPP_MESH_LOCATE_HPP

#include "plane_mesh.hpp"

#include <vector>

namespace cpp_mesh {

// Triangles by the bins of a regular grid that their boxes touch.
class CellBins {
public:
    // Only the given cells of the mesh.
    CellBins(const std::vector<Vec2>& xy, const std::vector<Triangle>& cells,
             std::vector<int> members);

    // The cell that holds p, or -1. On an edge it is one of the cells that share it.
    int locate(Vec2 p) const;

    // Cells whose bins the box touches, each once, in ascending order.
    void candidates(Vec2 low, Vec2 high, std::vector<int>& found) const;

private:
    int column(double x) const;
    int row(double y) const;

    const std::vector<Vec2>& xy_;
    const std::vector<Triangle>& cells_;
    Vec2 low_, high_;
    int n_ = 1; // columns and rows
    std::vector<int> first_, members_;
};

} // namespace cpp_mesh

#endif
