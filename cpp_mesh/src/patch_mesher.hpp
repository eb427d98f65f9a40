// The one mesher of patches: cells of an old mesh are taken out, and the hole is meshed again.
#ifndef CPP_MESH_PATCH_MESHER_HPP
#define CPP_MESH_PATCH_MESHER_HPP

#include "patch.hpp"
#include "patch_task.hpp"

namespace cpp_mesh {

// What the two levels want differently.
struct PatchStyle {
    std::vector<FractureCell> kept_cells; // old cells on edges of the graph that are divided again
    // Nodes on the rim inside the body are smoothed with those in the patch where nothing holds
    // them; else they stay where they are.
    bool smooths_rim = false;
    // Edges that leave no room for cells of good shape are refused; else there are bad cells.
    bool refuses_narrow_places = false;
    bool divides_lone_sectors = false; // of the cells that are new
};

// The new mesh, checked: old cells that stay, in their order, then new ones. Throws MeshError. The
// task and the patch are used up.
Mesh mesh_patch(const PatchStyle& style, PatchTask& task, Patch& patch);

} // namespace cpp_mesh

#endif
