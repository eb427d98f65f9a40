// Smaller cells where the fractures leave little room, and at corners, where they meet or turn.
#ifndef CPP_MESH_NARROW_PLACES_HPP
#define CPP_MESH_NARROW_PLACES_HPP

#include "domain.hpp"
#include "network.hpp"
#include "size_field.hpp"

namespace cpp_mesh {

// Cells of the given size at a corner, where the stress is singular, growing from there.
SizeDisc corner_disc(Vec2 place, double size);

// Cells start from the length of an edge of the graph that is shorter than they should be, and from
// the distance of a point from an edge or the boundary that is so near, and grow from there.
void limit_sizes_in_narrow_places(const Graph& graph, const Domain& domain, SizeField& size);

// A fracture ends so near to another one, or to the boundary, that cells of the size wanted there
// would have angles below 12 degrees.
bool has_near_ends(const Graph& graph, const Domain& domain, const SizeField& size);

} // namespace cpp_mesh

#endif
