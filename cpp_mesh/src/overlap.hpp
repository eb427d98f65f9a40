// How much of each old cell does a new cell cover?
#ifndef CPP_MESH_OVERLAP_HPP
#define CPP_MESH_OVERLAP_HPP

#include "mesh.hpp"

namespace cpp_mesh {

// Area of the part that two counter-clockwise triangles have in common.
double common_area(const std::array<Vec2, 3>& first, const std::array<Vec2, 3>& second);

// Fill the overlaps of all new cells whose cell_old is -1 with the old cells of the patch.
void find_overlaps(const PlaneMesh& old_mesh, const std::vector<int>& patch,
                   const PlaneMesh& new_mesh, PatchMap& map);

} // namespace cpp_mesh

#endif
