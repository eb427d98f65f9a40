// The mesh that goes to the caller: split along the fractures, with faces and fracture cells.
#ifndef CPP_MESH_SPLIT_MESH_HPP
#define CPP_MESH_SPLIT_MESH_HPP

#include "domain.hpp"
#include "plane_mesh.hpp"

#include <array>
#include <vector>

namespace cpp_mesh {

// As in mesh_types.f90.
enum class PointKind { interior = 0, tip = 1, boundary = 2, joint_t = 3, joint_x = 4, corner = 5 };

struct Face {
    std::array<int, 2> node = {-1, -1}; // counter-clockwise around the first cell
    std::array<int, 2> cell = {-1, -1};
    int side = 0; // of the outer boundary, else 0
    int fracture_cell = -1;
};

struct FracturePoint {
    Vec2 xy;
    int plane_node = -1; // in the mesh before splitting
    PointKind kind = PointKind::interior;
    std::vector<int> cells;
    int copies = 1; // nodes that it has become
};

struct Tip {
    int point = -1;
    int node = -1;
    int fracture = -1;
    int end = 0; // 1 start, 2 end of the polyline
    Vec2 direction;
    double radius = 0.0;
};

struct SplitMesh {
    std::vector<Vec2> xy;
    std::vector<Triangle> cells;
    std::vector<std::array<int, 3>> cell_faces; // face k joins nodes k and (k+1)%3
    std::vector<Face> faces;
    std::vector<FractureCell> fracture_cells; // their nodes are those of the plane mesh
    std::vector<std::array<int, 2>> fracture_cell_points;
    std::vector<std::array<int, 2>> fracture_cell_faces; // side +, side -
    std::vector<FracturePoint> points;
    std::vector<Tip> tips;
};

SplitMesh split(const PlaneMesh& plane, const Domain& domain);

} // namespace cpp_mesh

#endif
