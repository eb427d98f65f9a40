// Cells without area, as gmsh leaves them where three nodes of an outline lie on a line.
#ifndef CPP_MESH_FLAT_CELLS_HPP
#define CPP_MESH_FLAT_CELLS_HPP

#include "plane_mesh.hpp"

#include <array>

namespace cpp_mesh {

// The edge between a flat cell and the cell on its other side is replaced by the other diagonal of
// the two, unless it is one of the held edges or the flat cell has no neighbour there.
void turn_flat_cells(const std::vector<Vec2>& xy, const std::vector<std::array<int, 2>>& held,
                     std::vector<Triangle>& cells);

} // namespace cpp_mesh

#endif
