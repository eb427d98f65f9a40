// What a handle of the C API stands for.
#ifndef CPP_MESH_MESH_HPP
#define CPP_MESH_MESH_HPP

#include "network.hpp"
#include "plane_mesh.hpp"
#include "rosette.hpp"
#include "size_field.hpp"
#include "split_mesh.hpp"

#include <algorithm>
#include <optional>
#include <vector>

namespace cpp_mesh {

struct Specification {
    Domain domain;
    double size_fracture = 0.0;
    double size_boundary = 0.0;
    bool is_window = false;
    int rosette_sectors = 0;
    RosetteRadii rosette_radii;
    std::vector<Vec2> fixed_points;        // become nodes
    std::vector<std::vector<Vec2>> guides; // lines that cells follow where there is room
    double joint_size = 0.0;               // where fractures meet; 0: as along them
    std::vector<SizeDisc> refined;         // places with smaller cells, which grow from there
    SizeFoci foci;                         // away from which sizes grow along fractures
    bool is_rough = false;                 // triangles are smoothed here, not by gmsh
    double ring_slope = 0.3;      // growth of sizes per distance beyond three radii of rosettes
    std::vector<double> own_size; // along each fracture, 0: the usual one; empty: of all

    // Meshes with a singular tip, a polygon or fixed points are those of finite elements on whole
    // bodies.
    bool is_for_elements() const {
        return !is_window &&
               (rosette_sectors > 0 || !domain.is_rectangle() || !fixed_points.empty());
    }
    double size_along(int fracture) const { return size_along(fracture, size_fracture); }
    double size_along(int fracture, double usual) const {
        if (own_size.empty() || !(own_size[fracture] > 0.0))
            return usual;
        return foci.places.empty() ? own_size[fracture] : std::min(own_size[fracture], usual);
    }
    // Where foci let sizes grow along a fracture that has one of its own.
    double largest_along(int fracture) const {
        return foci.places.empty() || own_size.empty() ? 0.0 : own_size[fracture];
    }
};

// How a remeshed mesh covers the one before.
struct PatchMap {
    std::vector<int> cell_old;      // -1 in the patch
    std::vector<int> overlap_first; // by new cell
    std::vector<int> overlap_cell;
    std::vector<double> overlap_area; // [m2]
};

struct Mesh {
    Specification specification;
    Network network;
    SizeField size;
    PlaneMesh plane;
    SplitMesh split;
    std::optional<PatchMap> map; // only of a remeshed mesh
};

// A new mesh of the body and the part of the network in it.
Mesh create_mesh(const Specification& specification, const Network& network);

// The same with sizes that are wanted in the cells of an old mesh of the body [m], up to
// size_boundary; fractures may have grown since.
Mesh create_mesh_sized(const Specification& specification, const Network& network,
                       const Mesh& old_mesh, const std::vector<double>& cell_size);

// A mesh that differs from an old one only near the centres, where fractures have grown; new
// fracture cells have about the given size [m].
Mesh remesh(const Mesh& old_mesh, const Network& network, const std::vector<Vec2>& centres,
            double radius, double size);

// A mesh of a body with singular tips after growth, made again only around the tips that have
// moved; the radii are those of all tips. Throws MeshError where that does not go: make a new mesh
// then.
Mesh grow_mesh(const Mesh& old_mesh, const Network& network, const RosetteRadii& radii);

// The cells of a mesh, whose nodes have moved along with tips that have gone on, or back, along the
// last pieces of their paths, or turned with these: nodes as near to a piece as `reach` times its
// length. Throws MeshError where the network differs
// otherwise, or cells would have a bad shape: make a new mesh then.
Mesh move_tips(const Mesh& old_mesh, const Network& network, double reach);

} // namespace cpp_mesh

#endif
