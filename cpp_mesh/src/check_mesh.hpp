// Is a mesh what it claims to be? Run on every mesh before it is handed out.
#ifndef CPP_MESH_CHECK_MESH_HPP
#define CPP_MESH_CHECK_MESH_HPP

#include "network.hpp"
#include "split_mesh.hpp"

namespace cpp_mesh {

// Throws MeshError that says what is wrong: areas, neighbours, Euler characteristic, sides.
void check_mesh(const SplitMesh& mesh, const Domain& domain);

// The fractures in the mesh are as long as the part of the polylines inside the body.
void check_fracture_length(const std::vector<FractureCell>& cells, const std::vector<Vec2>& xy,
                           const Network& network, const Domain& domain,
                           const Tolerances& tolerances);

} // namespace cpp_mesh

#endif
