// How much of each old cell does a new cell cover?
#ifndef CPP_MESH_OVERLAP_HPP
#define CPP_MESH_OVERLAP_HPP

#include "mesh.hpp"

namespace cpp_mesh {

// Area of the part that two counter-clockwise triangles have in common.
double common_area(const std::array<Vec2, 3>& first, const std::array<Vec2, 3>& second);

// How a mesh covers the one before whose marked cells were made again; the first cells of the new
// mesh are the others, in their order.
PatchMap map_of_patch(const PlaneMesh& old_mesh, const std::vector<char>& is_made_anew,
                      const PlaneMesh& new_mesh);

} // namespace cpp_mesh

#endif
