// Fractures through the rim of a patch.
#ifndef CPP_MESH_PATCH_FRACTURES_HPP
#define CPP_MESH_PATCH_FRACTURES_HPP

#include "patch.hpp"
#include "patch_task.hpp"

namespace cpp_mesh {

// Old fracture cells that the patch does not hold become edges of the graph of their own, and so do
// the gaps between them, in which rosettes must have room. Throws MeshError where that does not go.
void keep_fracture_cells(const Patch& patch, PatchTask& task);

} // namespace cpp_mesh

#endif
