// Nodes of the outer boundary.
#ifndef CPP_MESH_BOUNDARY_HPP
#define CPP_MESH_BOUNDARY_HPP

#include "domain.hpp"
#include "network.hpp"
#include "size_field.hpp"

#include <vector>

namespace cpp_mesh {

// Nodes of the boundary, counter-clockwise: corners, ends of fractures, fixed points, and what the
// sizes ask for between them. Points of the graph have the node of their own number; new nodes are
// appended to xy.
std::vector<int> mesh_boundary(const Domain& domain, const Graph& graph, const SizeField& size,
                               std::vector<Vec2>& xy);

// Append the node `start` on the boundary to the loop, and nodes after it on the way to `stop` on
// the same edge: those between, in any order, and new ones as the sizes ask.
void divide_boundary(int start, std::vector<int> between, int stop, const SizeField& size,
                     std::vector<Vec2>& xy, std::vector<int>& loop);

// Where corners of a polygon are so near to each other that edges are shorter than cells should be,
// cells start from the edge's length and grow inwards, so that they keep their shape. The sides of
// a rectangle are long.
void limit_sizes_at_short_edges(const Domain& domain, const std::vector<int>& loop,
                                const std::vector<Vec2>& xy, SizeField& size);

} // namespace cpp_mesh

#endif
