// Fracture cells: the edges of the graph divided into cells, with rosettes at the tips.
#ifndef CPP_MESH_SKELETON_HPP
#define CPP_MESH_SKELETON_HPP

#include "network.hpp"
#include "plane_mesh.hpp"
#include "rosette.hpp"
#include "size_field.hpp"

#include <vector>

namespace cpp_mesh {

struct Skeleton {
    std::vector<FractureCell> cells;
    std::vector<std::vector<int>> rings; // ring nodes of each rosette, the first on the crack
    std::vector<Rosette> rosettes;
};

// The cells that end at the tip of no rosette: those within a ring are edges of its triangles.
std::vector<FractureCell> cells_outside_rosettes(const Skeleton& skeleton);

// Nodes of the fixed points inside the body that lie on no fracture.
std::vector<int> nodes_of_lone_points(const Graph& graph, const std::vector<int>& node_of_point);

// Divide the edges of the graph; node_of_point gives the mesh node of each graph point, and new
// nodes are appended to xy. Edges of an old mesh stay whole, and so do the kept cells, which lie on
// other edges and are sorted by fracture and arc length. Throws MeshError where a joint or a
// rosette leaves no room for these.
Skeleton divide_graph(const Graph& graph, const std::vector<int>& node_of_point,
                      const std::vector<RosettePlan>& plans, int sectors,
                      const std::vector<FractureCell>& kept, const SizeField& size,
                      std::vector<Vec2>& xy);

} // namespace cpp_mesh

#endif
