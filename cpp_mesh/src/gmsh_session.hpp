// gmsh keeps global state; one session object owns it.
#ifndef CPP_MESH_GMSH_SESSION_HPP
#define CPP_MESH_GMSH_SESSION_HPP

#include "plane_mesh.hpp"
#include "size_field.hpp"
#include "work_limit.hpp"

#include <array>
#include <memory>
#include <mutex>
#include <vector>

namespace cpp_mesh {

// What to triangulate: loops of nodes, the first counter-clockwise around the region, the others
// around its holes, and edges and points inside that triangles must conform to. All edges stay as
// they are.
struct Region {
    std::vector<std::vector<int>> loops;
    std::vector<std::array<int, 2>> embedded;
    std::vector<int> points;
    bool is_rough = false; // triangles that the caller smooths, in half the time
};

class GmshSession {
public:
    // Started at the first call, shared by all later ones, ended when the process ends.
    static std::shared_ptr<GmshSession> shared();

    GmshSession();
    ~GmshSession();
    GmshSession(const GmshSession&) = delete;
    GmshSession& operator=(const GmshSession&) = delete;

    // One thread at a time; others wait. Triangles of the region; nodes that gmsh adds are appended
    // to xy. Fails where gmsh would cover the region more often than `coverage` times
    // (work_limit.hpp).
    std::vector<Triangle> triangulate(const Region& region, const SizeField& size,
                                      std::vector<Vec2>& xy,
                                      double coverage = WorkLimit::usual_coverage);

private:
    std::mutex at_work_;
};

} // namespace cpp_mesh

#endif
