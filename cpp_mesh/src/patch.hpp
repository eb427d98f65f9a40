// The part of a mesh that is taken out and meshed anew.
#ifndef CPP_MESH_PATCH_HPP
#define CPP_MESH_PATCH_HPP

#include "plane_mesh.hpp"

#include <array>
#include <vector>

namespace cpp_mesh {

// Cells with all nodes within `radius` of a centre.
void mark_discs(const PlaneMesh& mesh, const std::vector<Vec2>& centres, double radius,
                std::vector<char>& marked);

// Cells nearer than `margin` to a segment.
void mark_near(const PlaneMesh& mesh, const std::array<Vec2, 2>& segment, double margin,
               std::vector<char>& marked);

// Mark more cells until no two parts of the patch, or of the rest, hang together by a single node,
// and no part of the rest is an island in the patch.
void make_simple(const PlaneMesh& mesh, const EdgeTable& edges, std::vector<char>& marked);

// A connected part of the patch.
struct PatchPart {
    std::vector<std::vector<int>> loops; // as in Region
    std::vector<int> cells;
};

std::vector<PatchPart> patch_parts(const PlaneMesh& mesh, const EdgeTable& edges,
                                   const std::vector<char>& marked);

// The part that holds a place. Throws MeshError if none does.
int part_around(const PlaneMesh& mesh, const std::vector<PatchPart>& parts, Vec2 p);

// No edge at the node is one of the boundary.
bool is_inside(const PlaneMesh& mesh, const EdgeTable& edges, int node);

} // namespace cpp_mesh

#endif
