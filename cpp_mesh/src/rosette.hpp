// Rings of equal triangles around free tips, in which a square-root singularity is resolved.
#ifndef CPP_MESH_ROSETTE_HPP
#define CPP_MESH_ROSETTE_HPP

#include "network.hpp"
#include "plane_mesh.hpp"
#include "size_field.hpp"

#include <vector>

namespace cpp_mesh {

// A rosette to be made around a free tip of the graph.
struct RosettePlan {
    int point = -1;      // graph point of the tip
    int edge = -1;       // graph edge that ends there
    int end = 0;         // which end of the edge
    double radius = 0.0; // [m]
    Vec2 direction;      // ahead of the tip
};

// Radii wanted for both ends of each fracture; 0 or none given: the default.
struct RosetteRadii {
    double usual = 0.0;                        // [m]
    std::vector<std::array<double, 2>> at_end; // by fracture: its start, its end

    double wanted(int fracture, int end) const;
};

// Free tips are points where a single edge ends inside the body. Radii are made smaller where
// something is near.
std::vector<RosettePlan> plan_rosettes(const Graph& graph, const Domain& domain,
                                       const RosetteRadii& radii);

// The rings' sizes for the size field; their triangles are smaller than those around, which beyond
// three radii grow by `far_slope` per distance.
std::vector<SizeDisc> rosette_discs(const Graph& graph, const std::vector<RosettePlan>& plans,
                                    int sectors, double far_slope);

// Ring nodes, counter-clockwise, appended to xy; the first is given and lies on the crack.
std::vector<int> add_ring(Vec2 tip, Vec2 direction, double radius, int sectors, int crack_node,
                          std::vector<Vec2>& xy);

// The triangles within a ring.
void add_sectors(int tip_node, const std::vector<int>& ring, std::vector<Triangle>& cells);

} // namespace cpp_mesh

#endif
