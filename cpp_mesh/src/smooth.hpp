// Laplacian smoothing that never makes an element worse.
#ifndef CPP_MESH_SMOOTH_HPP
#define CPP_MESH_SMOOTH_HPP

#include "plane_mesh.hpp"

namespace cpp_mesh {

// Nodes from first_free on are moved towards the mean of their neighbours, each only where the
// smallest angle around it grows (Freitag, Jones and Plassmann 1995: "smart" smoothing).
void smooth(PlaneMesh& mesh, int first_free);

// The same for the given nodes.
void smooth(PlaneMesh& mesh, const std::vector<int>& nodes);

} // namespace cpp_mesh

#endif
