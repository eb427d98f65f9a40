// The edges that bound and cut a region that gmsh is to mesh.
#ifndef CPP_MESH_REGION_EDGES_HPP
#define CPP_MESH_REGION_EDGES_HPP

#include "gmsh_session.hpp"

namespace cpp_mesh {

// Edges meet in common nodes only, and at angles of at least `least_angle` [rad], which leave room
// for cells: gmsh would not come to an end otherwise. Throws MeshError.
void check_region_edges(const Region& region, const std::vector<Vec2>& xy, double least_angle);

} // namespace cpp_mesh

#endif
