// Where a growing fracture may join another one or the boundary.
#ifndef CPP_MESH_JOIN_HPP
#define CPP_MESH_JOIN_HPP

#include "mesh.hpp"

namespace cpp_mesh {

struct JoinTarget {
    Vec2 xy;
    double distance = 0.0; // from the point that was asked about [m]
    int fracture = -1;     // that holds the target; -1: the boundary
    double s = 0.0;        // arc length on that fracture [m]
    int side = 0;          // of the boundary that holds the target; 0: a fracture
};

// The point nearest to `point` of those that the end (0 start, 1 end) of the fracture comes nearer
// to: on the other fractures, on the boundary, on parts of the fracture itself that it approaches
// anew. A target next to a point where fractures meet, bend or end, or to a corner, is that point,
// so that an end put there can be meshed. Throws MeshError if the network cannot be meshed, or if
// there is no target at all.
JoinTarget nearest_target(const Specification& specification, const Network& network, Vec2 point,
                          int fracture, int end);

} // namespace cpp_mesh

#endif
