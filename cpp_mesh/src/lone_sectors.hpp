// Sectors between fractures with more than one cell.
#ifndef CPP_MESH_LONE_SECTORS_HPP
#define CPP_MESH_LONE_SECTORS_HPP

#include "plane_mesh.hpp"

namespace cpp_mesh {

// Divide each cell that alone fills a sector around a fracture point, between two fractures, or a
// fracture and the boundary: the finite volumes let such a corner turn about the point at no cost,
// so that its faces open or slip there by any amount. The edge opposite the point is halved, and
// with it the cell behind that edge; where it is a fracture cell, that is halved as well. Cells
// before the first one that may change stay as they are, and so do those that would divide them.
void divide_lone_sectors(PlaneMesh& mesh, int first_cell = 0);

} // namespace cpp_mesh

#endif
