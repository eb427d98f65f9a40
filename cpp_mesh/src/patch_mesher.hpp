// The one mesher of patches: cells of an old mesh are taken out, and the hole is meshed anew.
#ifndef CPP_MESH_PATCH_MESHER_HPP
#define CPP_MESH_PATCH_MESHER_HPP

#include "patch.hpp"
#include "patch_task.hpp"

namespace cpp_mesh {

// Do the nodes on the rim inside the body stay where they are, or are they smoothed with those in
// the patch where nothing holds them?
enum class Rim { stays, moves };

// The new mesh, checked. Fractures are the graph's, divided anew but for edges of old cells and the
// kept cells. Cells: old cells that stay, in their order, then new ones. Throws MeshError. The
// task and the patch are used up.
Mesh mesh_patch(PatchTask& task, Patch& patch, const std::vector<FractureCell>& kept, Rim rim);

} // namespace cpp_mesh

#endif
