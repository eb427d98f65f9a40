// Whether a body and its fractures can be meshed, without meshing them.
#ifndef CPP_MESH_JUDGE_HPP
#define CPP_MESH_JUDGE_HPP

#include "mesh.hpp"

#include <array>
#include <vector>

namespace cpp_mesh {

// The graph of the fractures in the body. Throws MeshError with the culprits if the specification,
// the body or the network is at fault.
Graph judged_graph(const Specification& specification, const Network& network);

// A point inside the body where fractures meet: two of them, or parts of one (then twice the same).
struct Joint {
    std::array<int, 2> fracture = {-1, -1};
    Vec2 xy;
};

std::vector<Joint> joints_of(const Graph& graph);

// Throws MeshError where a fixed point is not one node: on a fracture, but for a tip inside the
// body, each face has a node of its own. Growth may bring that about, an input should not.
void check_fixed_points(const Graph& graph);

} // namespace cpp_mesh

#endif
