// The rim of a patch where it is a part of the outer boundary.
#ifndef CPP_MESH_PATCH_RIM_HPP
#define CPP_MESH_PATCH_RIM_HPP

#include "patch.hpp"
#include "patch_task.hpp"

namespace cpp_mesh {

// Divide the edges there as the sizes now ask, between corners and points of the graph, of which
// new ones are put in. Other edges of the rim stay. Throws MeshError if a new point on the boundary
// lies outside the patch.
void divide_rims(PatchTask& task, Patch& patch);

} // namespace cpp_mesh

#endif
