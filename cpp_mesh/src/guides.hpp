// Lines that cells follow where there is room, without being cut: outlines of regions of the rock.
#ifndef CPP_MESH_GUIDES_HPP
#define CPP_MESH_GUIDES_HPP

#include "domain.hpp"
#include "network.hpp"
#include "rosette.hpp"
#include "size_field.hpp"

#include <array>
#include <vector>

namespace cpp_mesh {

// Edges for triangles to conform to, between places of their own numbering.
struct GuideEdges {
    std::vector<Vec2> places;
    std::vector<char> on_boundary; // of each place
    std::vector<std::array<int, 2>> edges;
};

// The parts of polylines in a rectangle, divided as the sizes ask. Bends of short pieces become
// chords. Edges are left out where they would force cells of poor shape or small size: near
// fractures, rosettes, corners and the boundary along them, near each other, at sharp angles and
// where they are short. So fractures may cross such lines at any angle, and end anywhere beside
// them.
GuideEdges guide_edges(const std::vector<std::vector<Vec2>>& lines, const Domain& domain,
                       const Graph& graph, const std::vector<RosettePlan>& rosettes,
                       const SizeField& size);

} // namespace cpp_mesh

#endif
