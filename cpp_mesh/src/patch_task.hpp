// What the patch mesher is given: a mesh that is to change, and what it is to become.
#ifndef CPP_MESH_PATCH_TASK_HPP
#define CPP_MESH_PATCH_TASK_HPP

#include "mesh.hpp"

#include <vector>

namespace cpp_mesh {

struct PatchTask {
    PatchTask(const Mesh& old_mesh, const Network& network, const Tolerances& tolerances);

    // To be called once the graph is known: its points get the old nodes where there are any, and
    // new nodes elsewhere.
    void find_nodes_of_points();

    bool is_old(int node) const { return node < static_cast<int>(old_mesh.plane.xy.size()); }

    const Mesh& old_mesh;
    const EdgeTable edges; // of the old cells
    const Tolerances tolerances;
    Mesh made;            // specification, network and sizes; the mesher adds cells
    std::vector<Vec2> xy; // old nodes, then new ones
    // The fractures of the new mesh; edges with an old cell stay whole.
    Graph graph;
    std::vector<int> node_of_point;
    std::vector<RosettePlan> plans; // of rosettes in the new mesh
};

} // namespace cpp_mesh

#endif
