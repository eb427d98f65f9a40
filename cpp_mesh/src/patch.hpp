// The part of a mesh that is taken out and meshed again.
#ifndef CPP_MESH_PATCH_HPP
#define CPP_MESH_PATCH_HPP

#include "plane_mesh.hpp"

#include <array>
#include <vector>

namespace cpp_mesh {

// Which cells have all nodes within `radius` of a centre?
std::vector<char> cells_in_discs(const PlaneMesh& mesh, const std::vector<Vec2>& centres,
                                 double radius);

// Mark cells nearer than `margin` to a segment.
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

// The old cells that are made again, and the old rosettes that are not.
struct Patch {
    std::vector<char> is_made_anew; // by cell
    std::vector<PatchPart> parts;
    std::vector<char> rosette_stays; // by rosette

    bool touches(const EdgeTable& edges, int node) const {
        return std::any_of(edges.begin(node), edges.end(node),
                           [&](int c) { return is_made_anew[c] != 0; });
    }
    bool surrounds(const EdgeTable& edges, int node) const {
        return std::all_of(edges.begin(node), edges.end(node),
                           [&](int c) { return is_made_anew[c] != 0; });
    }
    // Cells on both sides of it are made again.
    bool holds(const EdgeTable& edges, const FractureCell& cell) const {
        return is_made_anew[edges.cell(cell.node[0], cell.node[1])] &&
               is_made_anew[edges.cell(cell.node[1], cell.node[0])];
    }
};

std::vector<PatchPart> patch_parts(const PlaneMesh& mesh, const EdgeTable& edges,
                                   const std::vector<char>& marked);

// The part that holds a place. Throws MeshError if none does.
int part_around(const PlaneMesh& mesh, const std::vector<PatchPart>& parts, Vec2 p);

// No edge at the node is one of the boundary.
bool is_inside(const PlaneMesh& mesh, const EdgeTable& edges, int node);

} // namespace cpp_mesh

#endif
